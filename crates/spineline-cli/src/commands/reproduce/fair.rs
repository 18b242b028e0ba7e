//! Beyond the paper: the lines on the same films, including left-out bends, with patients as the unit.

use spineline::action::LineKind;
use spineline::analysis::{FilmRole, probability};
use spineline::cohort::{Cohort, ErrorKind, LinePairTest, PairedComparison, RoleErrors};
use spineline::evaluate::Baseline;
use spineline::multibody::Support;

use super::row::{Cell, Row, Section};
use super::runs::support_words;

pub const NONE: &str = "not given";

/// Errors and differences by kind of film.
pub fn section(cohorts: [&Cohort; 3], support: Support) -> Section {
    let mut rows = Vec::new();
    let row = |quantity: String, unit, ours, verdict| Row {
        quantity,
        unit,
        paper: NONE.to_owned(),
        ours,
        verdict,
    };
    let pairs = [
        [LineKind::Inflection, LineKind::Iliac],
        [LineKind::Inflection, LineKind::Estimated],
        [LineKind::Iliac, LineKind::Estimated],
    ];
    for role in FilmRole::ALL {
        for kind in [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated] {
            let name = format!("{role}, {kind} (mm)");
            rows.push(row(name, "mm", cohorts.map(|c| error(c, kind, role)), String::new()));
        }
        for baseline in Baseline::ALL.into_iter().filter(|_| role != FilmRole::Fitted) {
            let name = format!("{role}, without mechanics: {baseline} (mm)");
            let ours = cohorts.map(|c| baseline_error(c, baseline, role));
            rows.push(row(name, "mm", ours, String::new()));
        }
        for (kind, baseline) in against_baselines(role) {
            let name = format!(
                "  {} - {baseline} (mm, 95 % over patients)",
                kind.to_string().replace(" line", "")
            );
            let ours = cohorts.map(|c| difference(baseline_test(c, kind, baseline, role)));
            rows.push(row(name, "mm", ours, String::new()));
        }
        for lines in pairs {
            let of = |c| test(c, lines, role);
            let compared = |c| of(c).map(|test| &test.comparison);
            let [first, second] = lines.map(|kind| kind.to_string().replace(" line", ""));
            rows.push(row(
                format!("  {first} - {second} (mm, 95 % over patients)"),
                "mm",
                cohorts.map(|c| difference(compared(c))),
                String::new(),
            ));
            let verdict = verdict(cohorts.map(of), role);
            rows.push(row("    p (Holm)".to_owned(), "p", cohorts.map(|c| holm(of(c))), verdict));
        }
    }
    let title = format!("Fair comparison with {}", support_words(support));
    let note = "An error is the mean over patients of the location errors of a line; films without a result stand in brackets. A difference compares two lines, or a line and a prediction without mechanics, on the films that both predict; below zero the first is nearer. Left-out bends: the stiffness comes from the other bend, and only the force is fitted. The estimated line takes two more numbers from every film, so its smaller error does not speak for it. With `--fit ferguson`, the default here, it is also fitted to whole shapes, and the other lines are not. Intervals resample patients. p flips the signs of the patients' differences and is corrected by Holm over the 18 tests of a column. The paper pools 14 vertebrae of one spine as if they were 14 patients: prefer these p.";
    Section { title, support: Some(support), rows, note }
}

/// Location error of a pattern of joint rotations over patients.
pub fn baseline_error(cohort: &Cohort, baseline: Baseline, role: FilmRole) -> Cell {
    let mut errors = cohort.baselines.errors.iter();
    let found = errors.find(|one| one.baseline == baseline && one.role == role);
    let missing = || Cell::value(f64::NAN, 0, "-".to_owned());
    found.map_or_else(missing, |one| Cell::of(&one.location_mm.patients, 2))
}

pub fn error(cohort: &Cohort, kind: LineKind, role: FilmRole) -> Cell {
    let found = |e: &&RoleErrors| e.kind == kind && e.role == role;
    let missing = || Cell::value(f64::NAN, 0, "-".to_owned());
    cohort.compared.errors.iter().find(found).map_or_else(missing, |errors| {
        let mut cell = Cell::of(&errors.location_mm.patients, 2);
        if errors.without_result > 0 {
            cell.text = format!("[{} without] {}", errors.without_result, cell.text);
        }
        cell
    })
}

fn test(cohort: &Cohort, lines: [LineKind; 2], role: FilmRole) -> Option<&LinePairTest> {
    cohort
        .compared
        .tests
        .iter()
        .find(|t| t.lines == lines && t.role == role && t.error == ErrorKind::Location)
}

/// Every line with every prediction without mechanics that knows no more of a film of this role.
fn against_baselines(role: FilmRole) -> impl Iterator<Item = (LineKind, Baseline)> {
    let fair = Baseline::ALL.into_iter().filter(|baseline| !baseline.knows_tilt());
    let baselines: Vec<Baseline> = fair.filter(|_| role != FilmRole::Fitted).collect();
    let lines = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated].into_iter();
    lines.flat_map(move |kind| baselines.clone().into_iter().map(move |one| (kind, one)))
}

fn baseline_test(
    cohort: &Cohort,
    kind: LineKind,
    baseline: Baseline,
    role: FilmRole,
) -> Option<&PairedComparison> {
    let mut tests = cohort.baselines.tests.iter();
    let found = tests.find(|t| t.model == kind && t.baseline == baseline && t.role == role);
    found.map(|test| &test.comparison)
}

fn difference(found: Option<&PairedComparison>) -> Cell {
    let found = found.and_then(|found| Some((found, found.bootstrap?)));
    let Some((comparison, [low, high])) = found else {
        return Cell::value(f64::NAN, 0, "-".to_owned());
    };
    let mean = comparison.mean_difference;
    let text = format!("{mean:+.2} ({low:.2} to {high:.2})");
    Cell::value(mean, comparison.patients(), text)
}

fn holm(test: Option<&LinePairTest>) -> Cell {
    let found = test.and_then(|test| Some((test, test.holm_p?)));
    found.map_or_else(
        || Cell::value(f64::NAN, 0, "-".to_owned()),
        |(test, p)| Cell::value(p, test.comparison.patients(), format!("p {}", probability(p))),
    )
}

/// Which line predicts better, by scenario; fitted films get no verdict.
fn verdict(tests: [Option<&LinePairTest>; 3], role: FilmRole) -> String {
    if role == FilmRole::Fitted {
        return String::new();
    }
    let better: Vec<String> = ["rod", "bend", "pull"]
        .into_iter()
        .zip(tests)
        .filter_map(|(scenario, test)| {
            let test = test?;
            match (test.predicts_better(), test.nearer()) {
                (Some(kind), _) => Some(format!("{scenario}: the {kind} predicts better")),
                (None, Some(kind)) => Some(format!(
                    "{scenario}: the {kind} is nearer, with more numbers from each film"
                )),
                (None, None) => None,
            }
        })
        .collect();
    if better.is_empty() { "no significant difference".to_owned() } else { better.join("; ") }
}
