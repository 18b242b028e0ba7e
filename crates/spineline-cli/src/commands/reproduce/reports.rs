//! Reports of a reproduction: the cohort and one patient of every group, with the paper's support.

use std::path::Path;

use spineline::analysis::{Analysis, Case, Subject};
use spineline::multibody::Support;
use spineline_files::{Provenance, results_line};
use spineline_report::cohort::Patients;
use spineline_report::patient::Patient;
use spineline_report::{Document, cohort, html, patient};

use super::drawings::EXAMPLE;
use super::files::analysis_file;
use super::runs::Run;
use crate::analysis::confidence::Confidence;
use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::provenance::generator;

/// `cohort-GROUP.html` for every group, and `patient-GROUP.html` and `.pdf` of the first subject.
pub fn write(
    outputs: &Outputs,
    folder: &Path,
    runs: &[Run],
    provenance: &Provenance,
) -> Result<(), Failure> {
    for run in runs.iter().filter(|run| run.support == Support::Free) {
        let group = run.name;
        let cohort = of_cohort(run, provenance);
        outputs.write(&folder.join(format!("cohort-{group}.html")), html(&cohort))?;
        let (case, analysis) = (&run.cases[EXAMPLE], &run.analyses[EXAMPLE]);
        let patient = of_patient(case, analysis, provenance);
        outputs.write(&folder.join(format!("patient-{group}.html")), html(&patient))?;
        #[cfg(feature = "pdf")]
        {
            let pdf = crate::run::pdf::pdf(&patient, &provenance.date_utc)?;
            outputs.write(&folder.join(format!("patient-{group}.pdf")), pdf)?;
        }
    }
    Ok(())
}

fn of_cohort(run: &Run, provenance: &Provenance) -> Document {
    let subjects: Vec<Subject> = run.cases.iter().map(|case| case.subject.clone()).collect();
    let patients = run.cases.iter().zip(&run.analyses);
    let files: Vec<_> = patients.map(|(case, one)| analysis_file(case, one, provenance)).collect();
    cohort::report(&Patients {
        analyses: &run.analyses,
        subjects: &subjects,
        together: &run.cohort,
        refused: &[],
        generator: &generator(),
        json: &results_line(&files),
    })
}

fn of_patient(case: &Case, analysis: &Analysis, provenance: &Provenance) -> Document {
    let file = analysis_file(case, analysis, provenance);
    patient::report(&Patient {
        json: &results_line(&file),
        ..Confidence::default().report(analysis, case, &generator())
    })
}
