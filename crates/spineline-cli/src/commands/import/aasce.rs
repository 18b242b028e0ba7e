//! AASCE landmarks: a verdict on every row, and a case for every row without faults.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use spineline::analysis::{CASE_ID_RULE, Case, is_case_id};
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::ImageGeometry;
use spineline::warning::counted;
use spineline_files::{CaseFile, FileError, is_picture_name};
use spineline_landmarks::{
    AasceRow, AasceRows, AasceVerdict, LandmarkError, LandmarkHint, image_sizes, judge_aasce,
    picture_names, read_file,
};
use spineline_report::terminal::{self, Lines};
use spineline_tables::{RowVerdict, verdicts_table};

use super::args::ImportArgs;
use crate::run::failure::{Ending, Failure};
use crate::run::film_decoder::{Decoder, film_bytes};
use crate::run::outputs::{Outputs, OverwriteArgs, print, width};

pub fn run(args: &ImportArgs) -> Result<Ending, Failure> {
    let [side] = &args.patient_left[..] else {
        return Err(Failure::usage(
            "these landmarks name sides of the picture: give the side with the patient's left once for all films, with --patient-left image-right or image-left",
        ));
    };
    if side.posture.is_some() {
        return Err(Failure::usage(
            "--patient-left is for all AASCE films: give it without a posture",
        ));
    }
    for folder in &args.paths {
        import(args, folder, side.value)?;
    }
    Ok(Ending::Done)
}

fn import(args: &ImportArgs, folder: &Path, side: ImageSide) -> Result<(), Failure> {
    let name = folder.file_name().map_or_else(|| "aasce".into(), |name| name.to_string_lossy());
    let first = format!("{name}-0001");
    if !is_case_id(&first) {
        let what = format!("its cases are named after it, and `{first}` is not valid");
        let help = format!("rename the folder: an identifier has {CASE_ID_RULE}");
        return Err(Failure::input(folder.display(), what, help));
    }
    let verdicts = args.out.as_ref().filter(|_| !args.list);
    let verdicts = verdicts.map(|out| out.join(format!("{name}-verdicts.csv")));
    if let Some(there) = verdicts.as_ref().filter(|path| path.exists()) {
        let help = "choose another folder with --out, one for each set of this name";
        let what = "a set of this name was imported here already";
        return Err(Failure::input(there.display(), what, help));
    }
    let outputs = Outputs::new(OverwriteArgs { overwrite: false }, []);
    if let Some(out) = &args.out {
        outputs.folder(out)?;
    }
    let (mut table, mut clean, mut text) = (Vec::new(), 0, Lines::default());
    for row in rows(args, folder, side)? {
        let case_id = format!("{name}-{:04}", row.line);
        let verdict = judge_aasce(&row.film, side).map_err(|error| fail(folder, &error))?;
        let found = match verdict {
            AasceVerdict::Clean { main_angle } => {
                clean += 1;
                if let Some(out) = args.out.as_ref().filter(|_| !args.list) {
                    let path = out.join(format!("{case_id}.json"));
                    outputs.write(&path, case_text(folder, &case_id, &row, side)?)?;
                }
                Ok(main_angle)
            }
            AasceVerdict::Faults(faults) => {
                let words: Vec<String> = faults.iter().map(ToString::to_string).collect();
                let words = words.join("; ");
                let note = format!("! line {}: {words}", row.line);
                text.text(&terminal::paragraph(&note, width(), "  "));
                Err(words)
            }
        };
        table.push(RowVerdict { line: row.line, case_id, found });
    }
    text.line(format!(
        "{}: {clean} of {} without faults; cases are written for these only",
        folder.display(),
        counted(table.len(), "row")
    ));
    if let Some(verdicts) = verdicts {
        outputs.write(&verdicts, verdicts_table(&table).to_csv()?)?;
        text.line(format!("Verdicts on every row: {}", verdicts.display()));
    }
    outputs.commit()?;
    print(text).map(|_| ())
}

fn rows(args: &ImportArgs, folder: &Path, side: ImageSide) -> Result<Vec<AasceRow>, Failure> {
    let table_at = |path: &Path| read_file(path).map_err(|error| fail(path, &error));
    let table = args.sizes.clone().unwrap_or_else(|| folder.join("image_sizes.csv"));
    let is_listed = args.pictures.is_none() && (args.sizes.is_some() || table.exists());
    let listed = if is_listed {
        Some(image_sizes(&table_at(&table)?).map_err(|error| fail(&table, &error))?)
    } else {
        None
    };
    let (names, landmarks) =
        (table_at(&folder.join("filenames.csv"))?, table_at(&folder.join("landmarks.csv"))?);
    let sizes = match listed {
        Some(sizes) => sizes,
        None => {
            let names = picture_names(&names).map_err(|error| fail(folder, &error))?;
            sizes_of_pictures(args, folder, &names)?
        }
    };
    let hint = LandmarkHint { patient_left: Some(side), ..LandmarkHint::default() };
    AasceRows::new(&names, &landmarks, &sizes, &hint)
        .and_then(Iterator::collect)
        .map_err(|error| fail(folder, &error))
}

/// Sizes of the pictures themselves, decoded as every film is.
fn sizes_of_pictures(
    args: &ImportArgs,
    folder: &Path,
    names: &[String],
) -> Result<BTreeMap<String, (u32, u32)>, Failure> {
    let published = || {
        let data = folder.join("../../data");
        folder.file_name().map_or_else(|| data.clone(), |name| data.join(name))
    };
    let folders = match &args.pictures {
        Some(pictures) => vec![pictures.clone()],
        None => vec![folder.to_owned(), published()],
    };
    let decoder = Decoder::new()?;
    let bar = crate::run::progress::bar("reading pictures", names.len());
    let mut sizes = BTreeMap::new();
    for (line, name) in (1..).zip(names) {
        bar.inc(1);
        if !is_picture_name(name) {
            let what =
                format!("filenames.csv, line {line}: `{name}` is not the name of a file alone");
            let help = "leave the folder out, and name it with --pictures";
            return Err(Failure::input(folder.display(), what, help));
        }
        let path = folders.iter().map(|folder| folder.join(name)).find(|path| path.is_file());
        let Some(path) = path else {
            let help =
                "--pictures names the folder of the pictures, or --sizes a table of their sizes";
            let what =
                format!("filenames.csv, line {line}: the picture is not in {}", listed(&folders));
            return Err(Failure::input(folder.display(), what, help));
        };
        let film = decoder
            .decode(film_bytes(&path)?)
            .map_err(|error| Failure::of(path.display(), &error))?;
        sizes.insert(name.clone(), (film.columns, film.rows));
    }
    bar.finish_and_clear();
    Ok(sizes)
}

fn listed(folders: &[PathBuf]) -> String {
    folders.iter().map(|folder| folder.display().to_string()).collect::<Vec<_>>().join(" or ")
}

fn fail(place: &Path, error: &LandmarkError) -> Failure {
    match error {
        LandmarkError::File(FileError::Read { source, .. }) => Failure::input(
            place.display(),
            source,
            "an AASCE folder has filenames.csv and landmarks.csv; --pictures names the folder of its pictures",
        ),
        _ => Failure::landmarks(place, error),
    }
}

/// A case of one erect film in pixels: the set lacks a spacing.
fn case_text(
    folder: &Path,
    id: &str,
    row: &AasceRow,
    patient_left: ImageSide,
) -> Result<String, Failure> {
    let (columns, rows) = row.film.size.unwrap_or_default();
    let image = ImageGeometry { columns, rows, spacing: None, patient_left };
    let film = row
        .film
        .clone()
        .into_film(Some(Posture::Erect), Some(image))
        .map_err(|error| fail(folder, &error))?;
    Ok(spineline_files::to_text(&CaseFile::from_case(&Case::of_films(id, vec![film]))))
}
