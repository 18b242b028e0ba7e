//! One patient as a terminal shows it: the answers on one screen, and all numbers behind them.

use spineline::analysis::Analysis;

use super::short::on_terminal;
use super::verdict::sentences;
use super::{Patient, measured, model, space, uncertainty};
use crate::document::{Column, Document, Section, Table};
use crate::hypotheses;

// The notes of the report, each short enough for one line.
const ERRORS: &str = "Ferguson errors: caudal region first. Counter-rotating: against the force.";
const NUMBERS: &str = "Numbers fitted: multipliers + forces + free line. A bend left out: stiffness fitted to the other bend.";

/// Which line, how sure, how stiff, what next: at most 25 lines of 100 columns, and other loads where these were compared. A program
/// prints the warnings elsewhere ([`crate::WarningCounts`]).
#[must_use]
pub fn summary(patient: &Patient<'_>) -> Document {
    let compared = hypotheses::of_patient(patient.analysis);
    document(patient, std::iter::once(on_terminal(patient)).chain(compared).collect())
}

/// The summary, then the numbers of the report without figures. Parts that every analysis has need no titles: the captions of
/// their tables name them.
#[must_use]
pub fn full(patient: &Patient<'_>) -> Document {
    let analysis = patient.analysis;
    let compared = analysis.comparison();
    let mut verdict = Section::new("verdict", "");
    sentences(&mut verdict, analysis);
    let mut line = Section::new("line", "");
    line.table(best_fit(analysis));
    let mut errors = Section::new("errors", "");
    errors.table(all_errors(analysis));
    let mut stiffness = Section::new("stiffness", "");
    model::multipliers_in_short(&mut stiffness, analysis);
    let mut comparison = Section::new("comparison", "");
    let mut by_line = model::by_line(analysis);
    by_line.note =
        [&by_line.note, NUMBERS, model::other_data(compared)].join(" ").trim_end().to_owned();
    comparison.table(by_line);
    let mut sections = vec![on_terminal(patient), verdict, films(analysis)];
    sections.extend(space::both_films(analysis));
    sections.extend(space::axial(analysis));
    sections.extend([line, errors, stiffness, comparison]);
    sections.extend(hypotheses::of_patient(analysis));
    if let Some(found) = patient.identifiability {
        let title = "Identifiability of the multipliers from the bending films";
        let mut section = Section::new("identifiability", title);
        uncertainty::identifiability(&mut section, analysis, found);
        sections.push(section);
    }
    sections.extend(patient.uncertainty.map(|found| uncertainty::numbers(analysis, found)));
    sections.retain(|section| !section.blocks.is_empty());
    document(patient, sections)
}

fn document(patient: &Patient<'_>, sections: Vec<Section>) -> Document {
    Document {
        analysis: patient.json.to_owned(),
        ..Document::new("Patient", subject(patient.analysis), patient.generator, sections)
    }
}

fn subject(analysis: &Analysis) -> String {
    let synthetic = if analysis.synthetic { " · SYNTHETIC" } else { "" };
    format!(
        "{}{synthetic} · films: {} · lengths in {}",
        analysis.case_id,
        analysis.movement.films.len(),
        analysis.movement.erect().outline.scale
    )
}

/// The erect curve, its clinical angles, and what was fitted to every film.
fn films(analysis: &Analysis) -> Section {
    let mut section = Section::new("films", "");
    let mut words = measured::curve_sentences(analysis);
    words.push(format!("{}. {}.", analysis.balance_words(), analysis.lenke_words()));
    section.paragraph(words.join(" "));
    let clinical = measured::clinical(analysis);
    section.table(Table {
        caption: format!("{}, positive in the direction of the erect curve", clinical.caption),
        note: String::new(),
        ..clinical
    });
    section.table(measured::curves(analysis));
    section
}

fn best_fit(analysis: &Analysis) -> Table {
    let mut table = measured::best_fit(analysis);
    table.caption.push_str(" (in brackets 95 % confidence intervals; negative is right)");
    table
}

/// Errors of all lines in one table, those on fitted films first.
fn all_errors(analysis: &Analysis) -> Table {
    let kinds = [(true, "fitted"), (false, "held out")];
    let kinds = kinds.map(|(fitted, name)| (model::error_table(analysis, fitted), name));
    let mut columns = vec![Column::words("Films")];
    columns.extend(kinds[0].0.columns.iter().cloned());
    let mut all = Table::new("Errors of the models on fitted and held-out films", columns);
    for (table, name) in kinds {
        for row in table.rows {
            all.row([vec![name.to_owned()], row].concat());
        }
    }
    let levels = analysis.movement.levels().as_slice();
    let [lowest, top] = [levels[1], levels[levels.len() - 1]];
    all.note = format!("Location errors: {lowest} to {top}. {ERRORS}");
    all
}
