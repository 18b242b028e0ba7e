//! Several patients as text.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, LineModel, probability};
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
    text.push_str(&sentences(&cohort));
    text
}

/// A cohort in plain sentences.
fn sentences(cohort: &Cohort) -> String {
    let mut text = format!(
        "{} patients{}; {} with exactly two inflections\n",
        cohort.patients,
        if cohort.synthetic { " (all synthetic)" } else { "" },
        cohort.two_inflections
    );
    for line in &cohort.lines {
        for (films, errors) in [("fitted", &line.fitted), ("held out", &line.held_out)] {
            if errors.location_mm.patients.n == 0 {
                continue;
            }
            let interval = errors.location_mm.bootstrap.map_or_else(String::new, |[low, high]| {
                format!(", 95 % interval over patients {low:.2} to {high:.2}")
            });
            text.push_str(&format!(
                "{:15} {films:8}  location error {:.2} mm{interval}; Ferguson error {:.2}°; films without a result: {}\n",
                line.kind.to_string(), errors.location_mm.patients.mean, errors.ferguson_deg.patients.mean, errors.unusable
            ));
        }
    }
    let (rejected, tested) = cohort.line_rejected;
    if tested > 0 {
        text.push_str(&format!(
            "In {rejected} of {tested} bends the load that the joints' rotations prefer does not run through the inflections\n"
        ));
    }
    if let Some(t) = cohort.location_test.patients {
        text.push_str(&format!(
            "Inflection against iliac line, one mean per patient: {:+.2} mm (p {}, two-sided, n = {})\n",
            t.mean_difference, probability(t.p_two_sided), t.n
        ));
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
