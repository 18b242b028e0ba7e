//! Documents of phantoms, and their parts.

use spineline::analysis::{Analysis, AnalysisOptions, Case, Subject, analyze};
use spineline::cohort::{Cohort, CohortPatient, RefusedCase};
use spineline_report::cohort::Patients;
use spineline_report::document::Section;
use spineline_report::patient::{self, Patient};
use spineline_report::{Document, cohort};

/// What the program that made a document is called in it.
pub const GENERATOR: &str = "spineline test";

pub fn analyzed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("a phantom is sound")
}

/// A patient without requested results.
pub fn shown<'a>(case: &'a Case, analysis: &'a Analysis, json: &'a str) -> Patient<'a> {
    Patient {
        case,
        analysis,
        pictures: &[],
        identifiability: None,
        uncertainty: None,
        generator: GENERATOR,
        json,
    }
}

/// The report of a patient.
pub fn report(case: &Case) -> Document {
    patient::report(&shown(case, &analyzed(case), "{}"))
}

/// The report of a cohort.
pub fn cohort_report(
    analyses: &[Analysis],
    subjects: &[Subject],
    refused: &[RefusedCase],
) -> Document {
    cohort::report(&Patients {
        analyses,
        subjects,
        together: &Cohort::of(&analyses.iter().map(CohortPatient::of).collect::<Vec<_>>(), 1),
        refused,
        generator: GENERATOR,
        json: "[]",
    })
}

pub fn section<'a>(document: &'a Document, id: &str) -> &'a Section {
    document.sections.iter().find(|section| section.id == id).expect("the section is there")
}
