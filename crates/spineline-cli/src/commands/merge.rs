//! `spineline merge`: the tables of parts of a cohort as one.

use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};

use clap::Args;
use spineline::warning::counted;
use spineline_files::{
    InputFile, MAX_ANALYSES_BYTES, Provenance, ProvenanceFile, parse_provenance, read_bytes,
    read_text, sha256_hex, to_text,
};
use spineline_tables::{CsvMerger, MergeError, ParquetMerger, csv_case_ids, parquet_case_ids};

use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, OverwriteArgs, print};
use crate::run::progress::bar;
use crate::run::provenance::this_run;
use crate::run::shard::Shard;

pub const EXAMPLES: &str = "\
A part is a folder that `analyze --tables` has written. Its tables must be as they were written, and all parts must come from one version \
of this program with the same options. Parts of `analyze --shard` are put in order, and a missing one is named. No patient may be in two parts.

The CSV files equal the files of one run, byte by byte. Statistics of the cohort (`analyze --cohort`) are not merged: they need all patients.

Examples:
  spineline analyze cases/ --shard 1/2 --tables part1
  spineline analyze cases/ --shard 2/2 --tables part2
  spineline merge part1 part2 --out tables";

#[derive(Args)]
pub struct MergeArgs {
    /// Folders of tables
    #[arg(required = true, value_name = "FOLDER")]
    parts: Vec<PathBuf>,
    /// Write the merged tables into this folder
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    #[command(flatten)]
    overwrite: OverwriteArgs,
}

/// The file that lists the others of a folder.
const LIST: &str = "provenance.json";
/// Explains the columns, and is the same in every part.
const DICTIONARY: &str = "dictionary.csv";
/// Key of the provenance in a Parquet file.
const ORIGIN: &str = "spineline.provenance";

pub fn run(args: &MergeArgs) -> Result<Ending, Failure> {
    let parts = args.parts.iter().map(|folder| Part::read(folder)).collect::<Result<_, _>>()?;
    let parts = in_order(parts)?;
    check_alike(&parts)?;
    let cases = check_cases(&parts)?;
    let inputs = parts.iter().flat_map(|part| part.files().map(|file| part.path(&file.name)));
    let inputs: Vec<PathBuf> = inputs.chain(parts.iter().map(|part| part.path(LIST))).collect();
    let outputs = Outputs::new(args.overwrite, inputs.iter().map(PathBuf::as_path));
    outputs.folder(&args.out)?;
    let origins: Vec<&Provenance> = parts.iter().map(|part| part.list.provenance()).collect();
    let provenance = Provenance::joining(this_run()?, &origins)
        .ok_or_else(|| Failure::usage("give the folder of at least one part"))?;
    let names: Vec<&str> = parts[0].files().map(|file| file.name.as_str()).collect();
    let progress = bar("merging", names.len());
    let mut files = Vec::new();
    for name in names {
        files.push(merge_table(name, &parts, &args.out, &provenance, &outputs)?);
        progress.inc(1);
    }
    progress.finish_and_clear();
    let merged = files.len();
    let list = ProvenanceFile::new(files, provenance);
    outputs.write(&args.out.join(LIST), to_text(&list))?;
    outputs.commit()?;
    print(format!(
        "{} of {} in {} of {}",
        counted(cases, "case"),
        counted(parts.len(), "part"),
        counted(merged, "file"),
        args.out.display()
    ))
}

/// A folder of tables.
struct Part {
    folder: PathBuf,
    list: ProvenanceFile,
    shard: Option<Shard>,
}

impl Part {
    fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(LIST);
        if folder.is_dir() && !path.exists() {
            let help = "give folders that `spineline analyze --tables` has written";
            return Err(Failure::input(folder.display(), "it has no provenance.json", help));
        }
        let list = read_text(&path).and_then(|text| parse_provenance(&text));
        let list = list.map_err(|error| Failure::file(&path, &error))?;
        let shard = Shard::of_command(&list.provenance().command);
        Ok(Self { folder: folder.to_owned(), list, shard })
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    fn files(&self) -> impl Iterator<Item = &InputFile> {
        self.list.files.iter()
    }

    /// A table, which must be as it was written.
    fn table(&self, name: &str) -> Result<Vec<u8>, Failure> {
        let path = self.path(name);
        let bytes =
            read_bytes(&path, MAX_ANALYSES_BYTES).map_err(|error| Failure::file(&path, &error))?;
        let is_listed = |file: &InputFile| file.name == name && file.sha256 == sha256_hex(&bytes);
        if !self.files().any(is_listed) {
            let what =
                "it is not as the analysis wrote it (another SHA-256 than in provenance.json)";
            let help = "analyse this part again";
            return Err(Failure::input(path.display(), what, help));
        }
        Ok(bytes)
    }

    fn refused(&self, what: &str, help: &str) -> Failure {
        Failure::input(self.folder.display(), what, help)
    }
}

/// Shards in their order, if all parts are shards; other parts as they were given.
fn in_order(mut parts: Vec<Part>) -> Result<Vec<Part>, Failure> {
    let Some(first) = parts.iter().find_map(|part| part.shard) else { return Ok(parts) };
    for part in &parts {
        if part.shard.is_none_or(|shard| shard.of != first.of) {
            let what = format!("it is not one of {} shards, as other parts are", first.of);
            return Err(part.refused(&what, "merge the shards of one cohort alone"));
        }
    }
    parts.sort_by_key(|part| part.shard);
    for pair in parts.windows(2) {
        if let (Some(shard), true) = (pair[1].shard, pair[0].shard == pair[1].shard) {
            let what = format!("it is shard {shard}, as is {}", pair[0].folder.display());
            return Err(pair[1].refused(&what, "give every shard once"));
        }
    }
    let there: BTreeSet<usize> = parts.iter().filter_map(|part| Some(part.shard?.number)).collect();
    let missing = (1..=first.of).filter(|number| !there.contains(number));
    let missing: Vec<String> =
        missing.map(|number| Shard { number, ..first }.to_string()).collect();
    if missing.is_empty() {
        return Ok(parts);
    }
    let shown = missing.iter().take(10).cloned().collect::<Vec<_>>().join(", ");
    let more = if missing.len() > 10 { ", …" } else { "" };
    Err(Failure::input(
        "the cohort",
        format!("{} missing: {shown}{more}", counted(missing.len(), "shard")),
        "give the folders of all shards, or run `spineline analyze --shard` for the missing ones",
    ))
}

/// Refuses parts of another request or with other tables than the first.
fn check_alike(parts: &[Part]) -> Result<(), Failure> {
    let names = |part: &Part| part.files().map(|file| file.name.clone()).collect::<Vec<_>>();
    for part in &parts[1..] {
        let first = &parts[0];
        if !part.list.provenance().is_like(first.list.provenance()) {
            let what = format!(
                "it was made with another version or other options than {}",
                first.folder.display()
            );
            return Err(
                part.refused(&what, "analyse all parts with one version and the same options")
            );
        }
        if names(part) != names(first) {
            let what = format!("it has other tables than {}", first.folder.display());
            return Err(part.refused(&what, "analyse all parts with the same --tables-format"));
        }
    }
    Ok(())
}

/// Refuses a case in two parts; counts all, refused ones too.
fn check_cases(parts: &[Part]) -> Result<usize, Failure> {
    let mut known: HashMap<String, &Part> = HashMap::new();
    for part in parts {
        let has = |name: &str| part.files().any(|file| file.name == name);
        let ids = if has("patients.csv") {
            csv_case_ids(&text_of(part, "patients.csv")?).map_err(failed(part, "patients.csv"))?
        } else {
            parquet_case_ids(part.table("patients.parquet")?)
                .map_err(failed(part, "patients.parquet"))?
        };
        let mut ids: Vec<String> = ids.into_iter().collect();
        ids.sort();
        for id in ids {
            if let Some(other) = known.insert(id.clone(), part) {
                let what = format!("the case {id} is in {} too", other.folder.display());
                return Err(part.refused(
                    &what,
                    "give every case its own `case_id`, and every case to one part",
                ));
            }
        }
    }
    Ok(known.len())
}

fn text_of(part: &Part, name: &str) -> Result<String, Failure> {
    String::from_utf8(part.table(name)?).map_err(|error| {
        Failure::input(part.path(name).display(), error, "analyse this part again")
    })
}

fn failed(part: &Part, name: &str) -> impl Fn(MergeError) -> Failure {
    let place = part.path(name);
    move |error| Failure::input(place.display(), error, "analyse this part again")
}

/// Writes one table of all parts.
fn merge_table(
    name: &str,
    parts: &[Part],
    out: &Path,
    provenance: &Provenance,
    outputs: &Outputs,
) -> Result<InputFile, Failure> {
    let mut merged = outputs.begin(&out.join(name))?;
    if name == DICTIONARY {
        let first = parts[0].table(name)?;
        if let Some(other) =
            parts.iter().find(|part| part.table(name).is_ok_and(|own| own != first))
        {
            return Err(other.refused("its dictionary differs", "analyse this part again"));
        }
        merged.add(first)?;
    } else if name.ends_with(".parquet") {
        let mut merger = ParquetMerger::default();
        for part in parts {
            let added = merger.add(part.table(name)?, &[ORIGIN]).map_err(failed(part, name))?;
            merged.add(added)?;
        }
        let origin = to_text(&provenance.clone().of_listed_file());
        merged.add(merger.finish(&[(ORIGIN, &origin)]).map_err(failed(&parts[0], name))?)?;
    } else {
        let mut merger = CsvMerger::default();
        for part in parts {
            merged.add(merger.add(&text_of(part, name)?).map_err(failed(part, name))?)?;
        }
    }
    merged.keep()
}
