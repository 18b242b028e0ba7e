//! `spineline analyze`: one patient, or a cohort.

use std::fs;
use std::path::{Path, PathBuf};

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::Posture;
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;
use spineline_io::{AnalysisFile, ModelFile};
use spineline_report::figures;

use crate::args::AnalyzeArgs;
use crate::failure::{Ending, Failure};
use crate::progress::map_all;
use crate::rows::{chain_text, csv_text};
use crate::{cohort, comparison, identifiability, models, print, report, uncertainty};

/// What wrote a file.
pub fn generator() -> String {
    format!("spineline {}", env!("CARGO_PKG_VERSION"))
}

pub fn run(args: &AnalyzeArgs) -> Result<Ending, Failure> {
    let options = args.options.options()?;
    let paths = case_files(&args.cases)?;
    let outputs = [&args.json, &args.csv, &args.chain, &args.cohort].into_iter().flatten();
    let to_stdout = outputs.filter(|path| path.as_os_str() == "-").count();
    if to_stdout > 1 {
        return Err(Failure::usage(
            "only one of --json, --csv, --chain and --cohort can go to the standard output",
        ));
    }
    if args.model.is_some() && paths.len() != 1 {
        return Err(Failure::usage("--model writes the model of one case; give one case file"));
    }
    let results = map_all("analysing", &paths, args.threads, |path| {
        let case = read_case(path)?;
        Ok((analyze_case(path, &case, &options)?, case))
    })?;
    let (mut analyses, mut sureness) = (Vec::new(), Vec::new());
    let mut ending = Ending::Done;
    for result in results {
        match result {
            Ok((analysis, case)) => {
                sureness.push(Sureness::ask(&case, &analysis, args)?);
                analyses.push(analysis);
            }
            Err(failure) if paths.len() == 1 => return Err(failure),
            Err(failure) => {
                eprintln!("{failure}");
                ending = Ending::BadInput;
            }
        }
    }
    for analysis in &analyses {
        eprint!("{}", report::warnings(analysis));
    }
    write_files(args, &analyses, &sureness, paths.len() > 1)?;
    if to_stdout == 0 {
        print(&match &analyses[..] {
            [one] if paths.len() == 1 => {
                let compared = Some(models::text(&analyses)).filter(|text| !text.is_empty());
                let sure = sureness.iter().flat_map(|sure| sure.texts(one));
                let parts = [report::text(one)].into_iter().chain(compared).chain(sure);
                parts.collect::<Vec<_>>().join("\n")
            }
            all => format!("{}{}", cohort::text(all, &cohort::of(all)), models::text(all)),
        })?;
    }
    if ending == Ending::Done && !analyses.iter().all(Analysis::is_converged) {
        ending = Ending::NotConverged;
    }
    Ok(ending)
}

/// What was asked about how sure the numbers of one patient are.
struct Sureness {
    identified: Option<Vec<Option<Identifiability>>>,
    spread: Option<Uncertainty>,
}

impl Sureness {
    fn ask(case: &Case, analysis: &Analysis, args: &AnalyzeArgs) -> Result<Self, Failure> {
        let asked = &args.uncertainty;
        let identified =
            asked.identifiability.then(|| identifiability::run(analysis, args.threads));
        Ok(Self {
            identified: identified.transpose()?,
            spread: uncertainty::run(case, analysis, asked, args.threads)?,
        })
    }

    fn texts(&self, analysis: &Analysis) -> impl Iterator<Item = String> {
        let identified =
            self.identified.as_ref().map(|found| identifiability::text(analysis, found));
        let spread = self.spread.as_ref().map(|found| uncertainty::text(analysis, found));
        identified.into_iter().chain(spread)
    }

    fn write(&self, analysis: &Analysis, mut file: AnalysisFile) -> AnalysisFile {
        if let Some(found) = &self.identified {
            file = file.with_identifiability(analysis, found);
        }
        if let Some(found) = &self.spread {
            file = file.with_uncertainty(analysis, found);
        }
        file
    }
}

/// The case files behind files and folders, in order; a folder stands for the `.json` files in it.
pub fn case_files(given: &[PathBuf]) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    for path in given {
        if !path.is_dir() {
            files.push(path.clone());
            continue;
        }
        let entries = fs::read_dir(path).and_then(Iterator::collect::<Result<Vec<_>, _>>).map_err(
            |error| Failure::input(&path.display().to_string(), &error, "check the folder"),
        )?;
        let mut inside: Vec<PathBuf> = entries
            .into_iter()
            .map(|entry| entry.path())
            .filter(|file| file.extension().is_some_and(|e| e == "json") && !is_truth(file))
            .collect();
        if inside.is_empty() {
            let place = path.display().to_string();
            return Err(Failure::input(
                &place,
                &"no .json file in this folder",
                "give a folder of case files",
            ));
        }
        inside.sort();
        files.append(&mut inside);
    }
    Ok(files)
}

/// The truth of a phantom lies beside its case.
fn is_truth(path: &Path) -> bool {
    path.to_string_lossy().ends_with(".truth.json")
}

pub fn analyze_file(path: &Path, options: &AnalysisOptions) -> Result<Analysis, Failure> {
    analyze_case(path, &read_case(path)?, options)
}

fn read_case(path: &Path) -> Result<Case, Failure> {
    spineline_io::read_text(path)
        .and_then(|text| spineline_io::parse_case(&text))
        .map_err(|error| Failure::file(path, &error))
}

fn analyze_case(path: &Path, case: &Case, options: &AnalysisOptions) -> Result<Analysis, Failure> {
    analyze(case, options)
        .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))
}

fn write_files(
    args: &AnalyzeArgs,
    analyses: &[Analysis],
    sureness: &[Sureness],
    many: bool,
) -> Result<(), Failure> {
    if let Some(path) = &args.json {
        let files: Vec<AnalysisFile> = analyses
            .iter()
            .zip(sureness)
            .map(|(one, sure)| sure.write(one, AnalysisFile::new(one, &generator())))
            .collect();
        let text = match &files[..] {
            [one] if !many => spineline_io::to_text(one),
            all => spineline_io::to_text(&all),
        };
        write_or_print(path, &text)?;
    }
    if let Some(path) = &args.csv {
        write_or_print(path, &csv_text(analyses)?)?;
    }
    if let Some(path) = &args.chain {
        write_or_print(path, &chain_text(analyses)?)?;
    }
    if let Some(path) = &args.cohort {
        let found = cohort::of(analyses);
        let text = if path.extension().is_some_and(|end| end == "csv") {
            comparison::cohort_csv(&found)?
        } else {
            spineline_io::to_text(&cohort::file(analyses, &found, &generator()))
        };
        write_or_print(path, &text)?;
    }
    if let (Some(path), [analysis]) = (&args.model, analyses) {
        let kind = args.model_line.kind();
        let Some(model) = analysis.models.iter().find(|model| model.kind == kind) else {
            let text =
                format!("there is no model with the {kind}, so --model has nothing to write");
            return Err(Failure::input(
                &analysis.case_id,
                &text,
                "the warnings say why; try --model-line iliac",
            ));
        };
        write_or_print(
            path,
            &spineline_io::to_text(&ModelFile::new(analysis, model, &generator())),
        )?;
    }
    if let Some(folder) = &args.figures {
        for analysis in analyses {
            draw(analysis, folder)?;
        }
    }
    Ok(())
}

/// Writes a file as a whole: a reader never sees half of it.
pub fn write_file(path: &Path, content: impl AsRef<[u8]>) -> Result<(), Failure> {
    let failed = |error: &std::io::Error| Failure::write(&path.display().to_string(), error);
    if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        fs::create_dir_all(folder).map_err(|error| failed(&error))?;
    }
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(".part");
    let part = path.with_file_name(name);
    fs::write(&part, content).and_then(|()| fs::rename(&part, path)).map_err(|error| failed(&error))
}

/// Writes a file, or to the standard output for `-`.
pub fn write_or_print(path: &Path, text: &str) -> Result<(), Failure> {
    if path.as_os_str() == "-" { print(text).map(|_| ()) } else { write_file(path, text) }
}

/// The figures of one patient.
fn draw(analysis: &Analysis, folder: &Path) -> Result<(), Failure> {
    let save = |name: &str, svg: &str| {
        write_file(
            &folder.join(format!("{}-{name}.svg", analysis.case_id.replace(['/', '\\'], "_"))),
            svg,
        )
    };
    save("overview", &figures::case_overview(analysis))?;
    if let Some(svg) = figures::rotations(analysis) {
        save("rotations", &svg)?;
    }
    for posture in Posture::MOVED {
        if let Some(svg) = figures::measured_and_simulated(analysis, posture) {
            save(&format!("simulated-{}", posture.key()), &svg)?;
        }
    }
    Ok(())
}
