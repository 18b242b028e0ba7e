//! Analyses of many patients → a report: verdict and exclusions first, the method last.

mod by_patient;
mod errors;
mod movement;
mod people;
mod profiles;
mod readers;

use spineline::analysis::{Analysis, Subject};
use spineline::cohort::RefusedCase;
use spineline::warning::counted;

use crate::document::{Document, Notice, Section};
use crate::{hypotheses, patient};
pub use by_patient::PatientRow;

/// What a report of a cohort is made from.
#[derive(Debug, Clone, Copy)]
pub struct Patients<'a> {
    /// The results of every patient.
    pub analyses: &'a [Analysis],
    /// Data of the patients, in the same order.
    pub subjects: &'a [Subject],
    /// Their statistics.
    pub together: &'a spineline::cohort::Cohort,
    /// Excluded cases.
    pub refused: &'a [RefusedCase],
    /// Program that makes the report.
    pub generator: &'a str,
    /// The analyses as a JSON array, to be embedded.
    pub json: &'a str,
}

/// The report of a cohort. Pictures of single patients are left to their own reports.
#[must_use]
pub fn report(patients: &Patients<'_>) -> Document {
    let mut sections = vec![people::verdict(patients), people::flow(patients)];
    sections.push(people::table_1(patients));
    sections.push(people::lenke(patients));
    sections.extend(profiles::section(patients.analyses));
    sections.push(movement::section(patients.together));
    sections.push(errors::by_kind_of_film(patients.together));
    sections.push(errors::tests(patients.together));
    let rows: Vec<PatientRow> = patients.analyses.iter().map(PatientRow::of).collect();
    sections.extend(hypotheses::section(
        rows.iter().map(PatientRow::hypotheses),
        &patients.together.baselines,
    ));
    sections.push(by_patient::section(&rows, patients.together));
    sections.push(readers::section(patients.analyses));
    sections.push(how(patients));
    Document {
        title: "Cohort report".to_owned(),
        subject: size(patients.analyses.len()),
        generator: patients.generator.to_owned(),
        banners: banners(patients),
        sections,
        analysis: patients.json.to_owned(),
    }
}

/// The numbers of a cohort in about a page, without figures; a terminal shows it.
#[must_use]
pub fn summary(
    patients: &[PatientRow],
    together: &spineline::cohort::Cohort,
    refused: &[RefusedCase],
    generator: &str,
) -> Document {
    let mut verdict = Section::new("verdict", "Verdict");
    let mut sections = if patients.is_empty() {
        people::refused(&mut verdict, refused, 0);
        verdict.paragraph("No case could be analysed.");
        vec![verdict]
    } else {
        people::sentences(&mut verdict, together, refused);
        let mut tests = Section::new("tests", "Comparison of the lines");
        errors::compared(&mut tests, together, PatientRow::MAX_SHOWN);
        vec![verdict, by_patient::summary(patients, together), tests]
    };
    sections.extend(hypotheses::section(
        patients.iter().map(PatientRow::hypotheses),
        &together.baselines,
    ));
    let synthetic = if together.synthetic { " · SYNTHETIC" } else { "" };
    Document {
        title: "Cohort".to_owned(),
        subject: format!("{}{synthetic}", size(patients.len())),
        generator: generator.to_owned(),
        banners: Vec::new(),
        sections,
        analysis: String::new(),
    }
}

fn banners(patients: &Patients<'_>) -> Vec<Notice> {
    let mut all = patient::banners(patients.together.synthetic);
    // All patients of a run share their options.
    all.extend(patients.analyses.first().and_then(|first| patient::of_options(&first.options)));
    all
}

fn size(patients: usize) -> String {
    counted(patients, "patient")
}

fn how(patients: &Patients<'_>) -> Section {
    let mut section = Section::new("method", "How this report was made");
    // All patients of a run share their options.
    if let Some(first) = patients.analyses.first() {
        section.table(patient::options(patients.generator, &first.options));
        section.table(patient::published());
    }
    section.paragraph("Statistics: a patient is the unit. One mean per patient enters every interval and every test except those called pooled, which are the paper's and treat vertebrae of one spine as independent. Intervals resample patients.");
    section
}
