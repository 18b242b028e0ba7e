//! Analyses of many patients → a report: verdict and exclusions first, the method last.

mod by_patient;
mod data;
mod errors;
mod movement;
mod people;
mod profiles;
mod readers;
mod short;

use spineline::cohort::RefusedCase;
use spineline::warning::counted;

use crate::document::{Document, Notice, Section};
use crate::{hypotheses, patient};
pub use by_patient::PatientRow;
pub use data::Patients;

/// The report of a cohort. Single patients have pictures in their own reports.
#[must_use]
pub fn report(patients: &Patients<'_>) -> Document {
    let rows: Vec<PatientRow> = patients.analyses.iter().map(PatientRow::of).collect();
    let mut sections = Vec::new();
    if !rows.is_empty() {
        sections.push(short::short(&rows, patients.together, usize::MAX));
    }
    sections.extend([people::verdict(patients), people::flow(patients)]);
    sections.push(people::table_1(patients));
    sections.push(people::lenke(patients));
    sections.extend(profiles::section(patients.analyses));
    sections.push(movement::section(patients.together));
    sections.push(errors::by_kind_of_film(patients.together));
    sections.push(errors::tests(patients.together));
    sections.extend(hypotheses::section(
        rows.iter().filter(|row| row.counts()).map(PatientRow::hypotheses),
        &patients.together.baselines,
    ));
    sections.push(by_patient::section(&rows, patients.together));
    sections.push(readers::section(patients.analyses));
    sections.push(how(patients));
    let subject = size(patients.analyses.len());
    Document {
        banners: banners(patients),
        analysis: patients.json.to_owned(),
        ..Document::new("Cohort report", subject, patients.generator, sections)
    }
}

/// Data for the texts of a terminal.
#[derive(Debug, Clone, Copy)]
pub struct Rows<'a> {
    /// The patients.
    pub patients: &'a [PatientRow],
    /// Their statistics.
    pub together: &'a spineline::cohort::Cohort,
    /// Excluded cases.
    pub refused: &'a [RefusedCase],
    /// Program that makes the text.
    pub generator: &'a str,
}

/// Which line, how sure, what next, and other loads where these were compared.
#[must_use]
pub fn summary(rows: &Rows<'_>) -> Document {
    document(rows, std::iter::once(answers(rows)).chain(compared_loads(rows)).collect())
}

/// The summary, then the numbers of the report without figures.
#[must_use]
pub fn full(rows: &Rows<'_>) -> Document {
    let Rows { patients, together, .. } = *rows;
    let mut sections = vec![answers(rows)];
    if !patients.is_empty() {
        let mut verdict = Section::new("verdict", "Verdict");
        people::sentences(&mut verdict, together, &[]);
        let mut tests = Section::new("tests", "Comparison of the lines");
        errors::compared(&mut tests, together, PatientRow::MAX_SHOWN);
        sections.extend([verdict, by_patient::summary(patients, together), tests]);
    }
    sections.extend(compared_loads(rows));
    document(rows, sections)
}

fn compared_loads(rows: &Rows<'_>) -> Option<Section> {
    let counted = rows.patients.iter().filter(|row| row.counts());
    hypotheses::section(counted.map(PatientRow::hypotheses), &rows.together.baselines)
}

fn answers(rows: &Rows<'_>) -> Section {
    let Rows { patients, together, refused, .. } = *rows;
    let mut section = Section::new("short", "");
    people::refused(&mut section, refused, patients.len());
    if patients.is_empty() {
        section.paragraph("No case could be analysed.");
        return section;
    }
    section.blocks.extend(short::on_terminal(patients, together).blocks);
    section
}

fn document(rows: &Rows<'_>, sections: Vec<Section>) -> Document {
    let synthetic = if rows.together.synthetic { " · SYNTHETIC" } else { "" };
    let subject = format!("{}{synthetic}", size(rows.patients.len()));
    Document::new("Cohort", subject, rows.generator, sections)
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
