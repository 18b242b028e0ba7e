//! Several patients as text.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, LineModel};
use spineline::cohort::Cohort;

use crate::table::Table;

/// The lines that the table shows.
const LINES: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
/// The bootstrap of the summary starts from here.
const BOOTSTRAP_SEED: u64 = 1;

/// A table of patients, and what they say together.
pub fn text(analyses: &[Analysis]) -> String {
    if analyses.is_empty() {
        return "no case could be analysed\n".to_owned();
    }
    let mut table = Table::new([
        "Case",
        "main Cobb",
        "inflections",
        "inflection line",
        "iliac line",
        "estimated line",
        "joints against",
        "warnings",
    ]);
    for analysis in analyses {
        table.row(row(analysis));
    }
    let cohort = Cohort::of(&analyses.iter().collect::<Vec<_>>(), BOOTSTRAP_SEED);
    let mut text = format!(
        "Mean location errors in mm, fitted bends / held-out films; joints that turn against the inflection line's force\n{}\n",
        table.text()
    );
    for sentence in cohort.sentences() {
        text.push_str(&sentence);
        text.push('\n');
    }
    text
}

/// One patient's line.
fn row(analysis: &Analysis) -> Vec<String> {
    let main = analysis
        .clinical
        .iter()
        .max_by(|a, b| a.cobb[0].1.abs().rad().total_cmp(&b.cobb[0].1.abs().rad()));
    let error = |model: &LineModel, fitted: bool| {
        model.mean_location_error_mm(fitted).map_or_else(|| "-".to_owned(), |e| format!("{e:.1}"))
    };
    let mut row = vec![
        analysis.case_id.clone(),
        main.map_or_else(String::new, |c| format!("{:.0}°", c.cobb[0].1.abs().deg())),
        analysis.inflections.all.len().to_string(),
    ];
    for kind in LINES {
        let model = analysis.models.iter().find(|m| m.kind == kind);
        row.push(model.map_or_else(
            || "-".to_owned(),
            |m| format!("{} / {}", error(m, true), error(m, false)),
        ));
    }
    let inflection = analysis.models.iter().find(|m| m.kind == LINES[0]);
    let against: Vec<String> = inflection
        .into_iter()
        .flat_map(|m| &m.postures)
        .filter(|s| s.fitted)
        .map(|s| s.contradicted.len().to_string())
        .collect();
    row.push(against.join(", "));
    row.push(analysis.warnings.all().len().to_string());
    row
}
