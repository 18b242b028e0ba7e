//! `spineline learn-prior`: the distribution of joint rotations over a cohort.

use std::path::PathBuf;

use clap::Args;
use spineline::analysis::AnalysisOptions;
use spineline::cohort::{CohortPatient, KnownPatients, learn_rotation_prior};
use spineline::measure::TiltRule;
use spineline_files::{FilmOrigin, InputFile, Provenance, RotationPriorFile};
use spineline_report::rotation_prior;

use crate::analysis::case::analyze_input;
use crate::options::choice::choice;
use crate::options::values::threads;
use crate::run::failure::{Ending, Failure};
use crate::run::inputs::{CaseInput, case_files, count_once};
use crate::run::messages::say;
use crate::run::outputs::{Outputs, OverwriteArgs, is_stdout, print_document};
use crate::run::provenance::{generator, this_run};
use crate::run::threads::map_all;

/// Seed of the intervals over patients.
const SEED: u64 = 1;

pub const EXAMPLES: &str = "\
A mean rotation per joint, and how the rotations vary together. `analyze --rotation-prior FILE` then predicts the bends of other patients \
from it, without mechanics and, with the tilt of T2, by lines and loads: a model is worth its parameters where it predicts better. The errors that this command prints are of patients \
who were left out.

A cohort needs no file for predictions without mechanics: `analyze` predicts each of its patients from the others.

Examples:
  spineline learn-prior cases/ --out prior.json
  spineline analyze new/case.json --rotation-prior prior.json";

#[derive(Args)]
pub struct LearnPriorArgs {
    /// Case files, or folders of them, of at least five patients with a bending film
    #[arg(required = true, value_name = "CASE")]
    cases: Vec<PathBuf>,
    /// Write the distribution to this file (`-`: standard output)
    #[arg(long, value_name = "FILE")]
    out: PathBuf,
    /// Landmarks from which the tilt of a vertebra is measured; `analyze` takes the file with the same ones only
    #[arg(long, value_parser = choice::<TiltRule>(), default_value = TiltRule::default().key())]
    tilt: TiltRule,
    #[command(flatten)]
    overwrite: OverwriteArgs,
    /// Number of threads; 0 uses all cores. The results do not depend on it
    #[arg(long, default_value = "0", value_parser = threads)]
    threads: usize,
}

pub fn run(args: &LearnPriorArgs) -> Result<Ending, Failure> {
    let paths = case_files(&args.cases)?;
    let outputs = Outputs::new(args.overwrite, paths.iter().map(PathBuf::as_path));
    outputs.file(&args.out)?;
    let Patients { patients, inputs, ending } = read(&paths, args)?;
    let learned = learn_rotation_prior(&patients, SEED);
    let learned = learned.map_err(|error| {
        let help = "give the folders of more cases, each with an erect and a bending film";
        Failure::input("the cohort", error, help)
    })?;
    let films = FilmOrigin::of(patients.iter().map(CohortPatient::is_synthetic));
    let ids: Vec<String> = patients.iter().map(|patient| patient.case_id().to_owned()).collect();
    let provenance = Provenance::new(this_run()?, films, inputs);
    let provenance = provenance.of_cases(ids.iter().cloned()).with_seed(SEED);
    let file = RotationPriorFile::new(&learned, ids, args.tilt, provenance);
    outputs.write(&args.out, spineline_files::to_text(&file))?;
    outputs.commit_and_say()?;
    if !is_stdout(&args.out) {
        let document = rotation_prior::summary(&learned, films != FilmOrigin::Real, &generator());
        print_document(&document)?;
    }
    Ok(ending)
}

/// The patients that are learned from.
struct Patients {
    patients: Vec<CohortPatient>,
    inputs: Vec<InputFile>,
    ending: Ending,
}

/// Reads and analyses all cases. Those that cannot be used are reported and left out.
fn read(paths: &[PathBuf], args: &LearnPriorArgs) -> Result<Patients, Failure> {
    let options = AnalysisOptions { tilt: args.tilt, ..AnalysisOptions::default() };
    let results = map_all("analysing", paths, args.threads, |path| {
        let input = CaseInput::read(path)?;
        let analysis = analyze_input(path, &input, &options)?;
        Ok::<_, Failure>((CohortPatient::of(&analysis), input))
    })?;
    let mut known = KnownPatients::default();
    let mut patients = Patients { patients: Vec::new(), inputs: Vec::new(), ending: Ending::Done };
    for result in results {
        match result.and_then(|(patient, source)| checked(&mut known, patient, source)) {
            Ok((patient, input)) => {
                patients.patients.push(patient);
                patients.inputs.push(input);
            }
            Err(failure) => {
                say(&failure);
                patients.ending = Ending::BadInput;
            }
        }
    }
    Ok(patients)
}

/// Refuses a patient who was read before or has a doubted film.
fn checked(
    known: &mut KnownPatients,
    patient: CohortPatient,
    source: CaseInput,
) -> Result<(CohortPatient, InputFile), Failure> {
    let name = &source.input.name;
    count_once(known, name, &source.case)?;
    if patient.has_doubted_film() {
        let text = format!(
            "the case {} has a film that may not show what it is named after, so nothing is learned from it",
            source.case.id
        );
        return Err(Failure::input(name, text, "`spineline check` names the film"));
    }
    Ok((patient, source.input))
}
