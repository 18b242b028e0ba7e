//! Documents of phantoms, and their parts.

use spineline::analysis::{Analysis, AnalysisOptions, Case, Subject, analyze};
use spineline::anatomy::Posture;
use spineline::cohort::{Cohort, CohortPatient, RefusedCase};
use spineline_phantom::{Readers, Scenario, generate};
use spineline_report::cohort::{PatientRow, Patients, Rows};
use spineline_report::document::Section;
use spineline_report::patient::{self, Patient};
use spineline_report::{Document, cohort};

/// What the program that made a document is called in it.
pub const GENERATOR: &str = "spineline test";

/// A phantom of a subject, read with the usual errors.
pub fn case(subject: usize, scenario: Scenario) -> Case {
    generate(subject, scenario, &Readers::scaled(1.0), 1).expect("a subject of table 1").case
}

/// A rod of a subject, read without error.
pub fn exact_rod(subject: usize) -> Case {
    generate(subject, Scenario::Rod, &Readers::exact(), 1).expect("a subject of table 1").case
}

/// A rod of a subject, read without error, of which some films are kept.
pub fn rod_with_films(subject: usize, films: &[Posture]) -> Case {
    let mut case = exact_rod(subject);
    case.films.retain(|film| films.contains(&film.posture));
    case
}

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

/// The cohort of these analyses.
pub fn cohort_of(analyses: &[Analysis]) -> Cohort {
    Cohort::of(&analyses.iter().map(CohortPatient::of).collect::<Vec<_>>(), 1)
}

/// Rows of a cohort without refused cases.
pub fn rows<'a>(patients: &'a [PatientRow], together: &'a Cohort) -> Rows<'a> {
    Rows { patients, together, refused: &[], generator: GENERATOR }
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
        together: &cohort_of(analyses),
        refused,
        generator: GENERATOR,
        json: "[]",
    })
}

pub fn figure_names(document: &Document) -> Vec<&str> {
    document.figures().map(|figure| figure.name.as_str()).collect()
}

pub fn section<'a>(document: &'a Document, id: &str) -> &'a Section {
    document.sections.iter().find(|section| section.id == id).expect("the section is there")
}

/// The text with one blank between words.
pub fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
