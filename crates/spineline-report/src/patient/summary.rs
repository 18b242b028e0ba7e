//! One patient in about a page: what a terminal shows.

use spineline::analysis::Analysis;

use super::{Patient, measured, model, sentences, uncertainty};
use crate::document::{Document, Notice, Section};
use crate::hypotheses;

/// The numbers of the report in about a page, without figures. The warnings are in [`warnings`], since a program prints
/// them elsewhere.
#[must_use]
pub fn summary(patient: &Patient<'_>) -> Document {
    let analysis = patient.analysis;
    let compared = analysis.compare_lines();
    let mut verdict = Section::new("verdict", "Verdict");
    sentences(&mut verdict, analysis, &compared);
    let mut films = Section::new("films", "Films");
    measured::curve(&mut films, analysis);
    let mut sections = vec![verdict, films];
    if analysis.postures.iter().any(|p| p.preferred_line.is_some()) {
        let mut line = Section::new("line", "Identification of the line of action");
        line.table(measured::best_fit(analysis));
        sections.push(line);
    }
    if !analysis.models.is_empty() {
        sections.push(errors(analysis));
        let mut stiffness = Section::new("stiffness", "Stiffness");
        stiffness.paragraph(model::scale_constraint(analysis));
        model::multipliers_in_short(&mut stiffness, analysis);
        sections.push(stiffness);
        sections.push(model::comparison(analysis, &compared));
    }
    sections.extend(hypotheses::section(std::slice::from_ref(analysis)));
    if let Some(found) = patient.identifiability {
        let title = "Identifiability of the multipliers from the bending films";
        let mut section = Section::new("identifiability", title);
        uncertainty::identifiability(&mut section, analysis, found);
        sections.push(section);
    }
    sections.extend(patient.uncertainty.map(|found| uncertainty::numbers(analysis, found)));
    sections.retain(|section| !section.blocks.is_empty());
    Document {
        title: "Patient".to_owned(),
        subject: subject(analysis),
        generator: patient.generator.to_owned(),
        banners: Vec::new(),
        sections,
        analysis: patient.json.to_owned(),
    }
}

fn subject(analysis: &Analysis) -> String {
    let synthetic = if analysis.synthetic { " · SYNTHETIC" } else { "" };
    format!(
        "{}{synthetic} · films: {} · lengths in {}",
        analysis.case_id,
        analysis.postures.len(),
        analysis.erect().outline.scale
    )
}

fn errors(analysis: &Analysis) -> Section {
    let mut section = Section::new("errors", "Errors of the models");
    let mut fitted = model::error_table(analysis, true);
    let held_out = model::error_table(analysis, false);
    if !held_out.rows.is_empty() {
        // It stands below the second table.
        fitted.note.clear();
    }
    section.table(fitted);
    section.table(held_out);
    section
}

/// Contradictions, warnings and notes of one patient in the order of the analysis, each with the case in front of its place.
#[must_use]
pub fn warnings(analysis: &Analysis) -> Vec<Notice> {
    let with_case = |notice: Notice| {
        let place = [analysis.case_id.as_str(), &notice.place];
        let place: Vec<&str> = place.into_iter().filter(|part| !part.is_empty()).collect();
        Notice { place: place.join(", "), ..notice }
    };
    analysis.warnings.all().iter().map(|warning| with_case(warning.into())).collect()
}
