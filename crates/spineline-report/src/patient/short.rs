//! The first page: what a reader in a hurry takes away.

use spineline::analysis::{Analysis, FilmRole, Identification, LineModel};
use spineline::evaluate::Baseline;

use crate::document::{Column, Figure, Section, Table};
use crate::figures;
use crate::phrases::{none, sentence_case};

/// Three sentences, a picture and a table.
pub fn short(analysis: &Analysis) -> Section {
    let mut section = Section::new("short", "In short");
    for sentence in analysis.headline() {
        section.paragraph(sentence);
    }
    if !analysis.comparison().lines.is_empty() {
        section.table(table(analysis));
    }
    if let Some(svg) = figures::predictions(analysis) {
        let caption = "The line with the smallest error, and the best prediction without mechanics, on films that were not fitted.";
        section.figure(Figure::new("predictions", caption, svg));
    }
    section
}

/// Errors of every line beside those without mechanics.
fn table(analysis: &Analysis) -> Table {
    let compared = analysis.comparison();
    let columns = vec![
        Column::words("Prediction"),
        Column::numbers("Left-out bends (mm)"),
        Column::numbers("Neutral, traction (mm)"),
        Column::numbers("Fitted bends (mm)"),
        Column::words("Counter-rotating joints per bend"),
        Column::words("Stiffness values identified"),
    ];
    let mut table = Table::new("Mean location errors", columns);
    let mm = |mm: Option<f64>| mm.map_or_else(none, |mm| format!("{mm:.1}"));
    let roles = [FilmRole::LeftOutBend, FilmRole::HeldOut, FilmRole::Fitted];
    for (i, line) in compared.lines.iter().enumerate() {
        let Some(model) = analysis.models.iter().find(|model| model.kind == line.kind) else {
            continue;
        };
        let mut row = vec![sentence_case(&line.kind.to_string())];
        row.extend(roles.map(|role| mm(compared.errors(i, role).map(|found| found.location_mm))));
        row.extend([counter_rotating(model), identified(analysis, model)]);
        table.row(row);
    }
    for baseline in Baseline::ALL {
        let errors = roles.map(|role| Some(compared.baseline_errors(baseline, role)?.1));
        if errors.iter().all(Option::is_none) {
            continue;
        }
        let mut row = vec![format!("Without mechanics: {baseline}")];
        row.extend(errors.map(mm));
        row.extend([none(), none()]);
        table.row(row);
    }
    table.note = "Only errors on films that were not fitted are evidence for a line. The estimated line takes two more numbers from each of these films.".to_owned();
    table
}

/// Counter-rotating joints of the fitted bends, such as `6, 8 of 14`.
fn counter_rotating(model: &LineModel) -> String {
    let bends = || model.postures.iter().filter(|s| s.fitted && s.is_usable());
    let counts: Vec<String> = bends().map(|s| s.contradicted.len().to_string()).collect();
    match bends().next() {
        Some(first) => format!("{} of {}", counts.join(", "), first.joints()),
        None => none(),
    }
}

fn identified(analysis: &Analysis, model: &LineModel) -> String {
    let verdicts = model.verdicts(analysis);
    let known = verdicts.iter().filter(|verdict| {
        matches!(verdict.identification, Identification::Absolute | Identification::RatioOnly)
    });
    format!("{} of {}", known.count(), verdicts.len())
}
