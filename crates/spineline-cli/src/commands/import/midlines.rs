//! Midlines of the back surface as a case without pictures: every level is estimated.

use std::path::Path;

use spineline::analysis::Case;
use spineline::measure::Film;
use spineline_files::{CaseFile, to_text};
use spineline_landmarks::{LandmarkError, LandmarkFormat, LandmarkHint, read_landmarks};
use spineline_report::terminal::Lines;

use super::args::ImportArgs;
use super::write::check_free;
use crate::run::failure::{Ending, Failure};
use crate::run::outputs::{Outputs, OverwriteArgs, print};

pub fn run(args: &ImportArgs) -> Result<Ending, Failure> {
    let (Some(folder), Some(case_id)) = (&args.out, &args.case_id) else {
        return Err(Failure::usage("--midlines needs --out and --case-id"));
    };
    check_free(folder)?;
    let mut films: Vec<Film> = Vec::new();
    for path in &args.paths {
        for film in read(path)? {
            if films.iter().any(|known| known.posture == film.posture) {
                let what = format!("it has a second {} midline", film.posture);
                let help =
                    "give all midlines of a posture in one file, each with its observer and repeat";
                return Err(Failure::input(path.display(), what, help));
            }
            films.push(film);
        }
    }
    films.sort_by_key(|film| film.posture);
    let postures: Vec<String> = films.iter().map(|film| film.posture.to_string()).collect();
    let case = Case::of_films(case_id, films);
    let outputs = Outputs::new(OverwriteArgs { overwrite: false }, []);
    outputs.folder(folder)?;
    let path = folder.join("case.json");
    outputs.write(&path, to_text(&CaseFile::from_case(&case)))?;
    outputs.commit()?;
    let path = path.display();
    let mut text = Lines::of(format!("{path}: {}", postures.join(", ")));
    text.line("No vertebra was seen: the levels were placed by arc length and are estimates.");
    text.line(format!("Try: spineline check {path}"));
    print(text)
}

fn read(path: &Path) -> Result<Vec<Film>, Failure> {
    let fail = |error: &LandmarkError| Failure::landmarks(path, error);
    let file = read_landmarks(path, &LandmarkHint::default()).map_err(|error| fail(&error))?;
    if file.format != LandmarkFormat::SurfaceMidlines {
        let what = "it has landmarks, and no midlines of the back surface";
        let help = "give the film with --film and this file with --landmarks, without --midlines";
        return Err(Failure::input(path.display(), what, help));
    }
    let films = file.films.into_iter().map(|film| film.into_film(None, None));
    films.collect::<Result<_, _>>().map_err(|error| fail(&error))
}
