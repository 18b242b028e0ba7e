//! A cohort as text.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, LineModel};
use spineline::cohort::Cohort;

use super::lines;
use super::table::{Table, wrap};

/// The lines that the table shows.
const LINES: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];
const WIDTH: usize = 110;

/// A table of patients, and their statistics.
pub fn text(analyses: &[Analysis], cohort: &Cohort) -> String {
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
        "counter-rotating joints",
        "warnings",
    ]);
    for analysis in analyses {
        table.row(row(analysis));
    }
    let mut text = format!(
        "Mean location errors in mm, fitted bends / held-out films; joints that rotate against the inflection line's force\n{}\n",
        table.text()
    );
    text.push_str(&lines::cohort_text(cohort));
    text.push('\n');
    for sentence in cohort.sentences() {
        text.push_str(&wrap(&sentence, WIDTH, "  "));
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
    let counter_rotating: Vec<String> = inflection
        .into_iter()
        .flat_map(|m| &m.postures)
        .filter(|s| s.fitted)
        .map(|s| s.contradicted.len().to_string())
        .collect();
    row.push(counter_rotating.join(", "));
    row.push(analysis.warnings.all().len().to_string());
    row
}
