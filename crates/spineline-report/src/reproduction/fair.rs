//! Beyond the paper: the lines on the same films, including left-out bends, with patients as the unit.

use spineline::action::LineKind;
use spineline::analysis::FilmRole;
use spineline::cohort::{Cohort, ErrorKind, LinePairTest, PairedComparison, PredictionErrors};
use spineline::evaluate::Baseline;
use spineline::multibody::Support;
use spineline::number::{interval, probability, signed};

use super::Columns;
use super::numbers::{Cell, PaperNumber, Part, ours, support_words};
use crate::phrases::{LINES, line_in_short};

/// The pairs of lines that are compared.
pub(super) const PAIRS: [[LineKind; 2]; 3] = [
    [LineKind::Inflection, LineKind::Iliac],
    [LineKind::Inflection, LineKind::Estimated],
    [LineKind::Iliac, LineKind::Estimated],
];

const NOTE: &str = "An error is the mean over patients of the location errors of a line; films without a result stand in brackets. A difference compares two lines, or a line and a prediction without mechanics, on the films that both predict; below zero the first is nearer. Where a prediction knows the tilt of the top vertebra, so does the line. Left-out bends: the stiffness comes from the other bend, and only the force is fitted. The estimated line takes two more numbers from every film, so its smaller error does not speak for it. With Ferguson angles as the target (the paper's), it is also fitted to whole shapes, and the other lines are not. Intervals resample patients. p flips the signs of the patients' differences and is corrected by Holm over the 18 tests of a column. The paper pools 14 vertebrae of one spine as if they were 14 patients: prefer these p. The paper does not give these numbers; – marks a number without a result.";

/// Errors and differences by kind of film.
pub(super) fn part(columns: &Columns<'_>, support: Support) -> Part {
    let rows = FilmRole::ALL.into_iter().flat_map(|role| of_role(columns, role)).collect();
    let title = format!("Fair comparison with {}", support_words(support));
    Part { title, support: Some(support), rows, note: NOTE.to_owned() }
}

fn of_role(columns: &Columns<'_>, role: FilmRole) -> Vec<PaperNumber> {
    let mut rows = Vec::new();
    for kind in LINES {
        let name = format!("{role}, {kind} (mm)");
        rows.push(ours(name, "mm", columns.map(|c| error(c, kind, role))));
    }
    for baseline in Baseline::ALL.into_iter().filter(|_| role != FilmRole::Fitted) {
        let name = format!("{role}, without mechanics: {} (mm)", baseline.long_name());
        rows.push(ours(name, "mm", columns.map(|c| baseline_error(c, baseline, role))));
    }
    for kind in LINES.into_iter().filter(|_| role != FilmRole::Fitted) {
        let name = format!("{role}, {kind} with tilt (mm)");
        rows.push(ours(name, "mm", columns.map(|c| error_with_tilt(c, kind, role))));
    }
    for (kind, baseline) in against_baselines(role) {
        let line = line_in_short(kind);
        let name = format!("  {line} − {} (mm, 95 % over patients)", baseline.long_name());
        let found = columns.map(|c| difference(baseline_test(c, kind, baseline, role)));
        rows.push(ours(name, "mm", found));
    }
    for lines in PAIRS {
        let of = |c| test(c, lines, role);
        let name = format!("  {} (mm, 95 % over patients)", pair_words(lines));
        let found = columns.map(|c| difference(of(c).map(|test| &test.comparison)));
        rows.push(ours(name, "mm", found));
        let verdict = verdict(columns, columns.map(of), role);
        let holm = ours("    p (Holm)".to_owned(), "p", columns.map(|c| holm(of(c))));
        rows.push(PaperNumber { verdict, ..holm });
    }
    rows
}

/// The first line minus the second, such as `inflection − iliac`.
pub(super) fn pair_words(lines: [LineKind; 2]) -> String {
    lines.map(line_in_short).join(" − ")
}

/// Location error of a prediction without mechanics over patients.
pub(super) fn baseline_error(cohort: &Cohort, baseline: Baseline, role: FilmRole) -> Cell {
    prediction_error(&cohort.baselines.errors, baseline, role)
}

/// Location error of a line with the tilt of the top vertebra.
pub(super) fn error_with_tilt(cohort: &Cohort, kind: LineKind, role: FilmRole) -> Cell {
    prediction_error(&cohort.baselines.lines_with_tilt, kind, role)
}

fn prediction_error<By: PartialEq>(
    errors: &[PredictionErrors<By>],
    by: By,
    role: FilmRole,
) -> Cell {
    let found = errors.iter().find(|one| one.by == by && one.role == role);
    found.map_or_else(Cell::missing, |one| Cell::of(&one.location_mm.patients, 2))
}

pub(super) fn error(cohort: &Cohort, kind: LineKind, role: FilmRole) -> Cell {
    cohort.compared.of_line(kind, role).map_or_else(Cell::missing, |errors| {
        Cell::of(&errors.location_mm.patients, 2).without(errors.without_result)
    })
}

pub(super) fn test(cohort: &Cohort, lines: [LineKind; 2], role: FilmRole) -> Option<&LinePairTest> {
    cohort.compared.test(lines, role, ErrorKind::Location)
}

/// Every line with every prediction without mechanics, from as much of T2.
fn against_baselines(role: FilmRole) -> impl Iterator<Item = (LineKind, Baseline)> {
    let tested = Baseline::ALL.into_iter().filter(|one| one.is_tested());
    let baselines: Vec<Baseline> = tested.filter(|_| role != FilmRole::Fitted).collect();
    LINES
        .into_iter()
        .flat_map(move |kind| baselines.clone().into_iter().map(move |one| (kind, one)))
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

pub(super) fn difference(found: Option<&PairedComparison>) -> Cell {
    let Some(comparison) = found.filter(|found| found.mean_difference.is_finite()) else {
        return Cell::missing();
    };
    let mean = comparison.mean_difference;
    let mut text = signed(mean, 2);
    if let Some(ends) = comparison.bootstrap {
        text += &format!(" ({})", interval(ends, 2));
    }
    Cell::value(mean, comparison.patients(), text)
}

fn holm(test: Option<&LinePairTest>) -> Cell {
    let found = test.and_then(|test| Some((test, test.holm_p?)));
    found.map_or_else(Cell::missing, |(test, p)| {
        Cell::value(p, test.comparison.patients(), format!("p {}", probability(p)))
    })
}

/// Which line predicts better, by group; fitted films get no verdict.
fn verdict(columns: &Columns<'_>, tests: Vec<Option<&LinePairTest>>, role: FilmRole) -> String {
    if role == FilmRole::Fitted {
        return String::new();
    }
    let better: Vec<String> = columns
        .of
        .names()
        .into_iter()
        .zip(tests)
        .filter_map(|(group, test)| {
            let test = test?;
            match (test.predicts_better(), test.nearer()) {
                (Some(kind), _) => Some(format!("{group}: the {kind} predicts better")),
                (None, Some(kind)) => {
                    Some(format!("{group}: the {kind} is nearer, with more numbers from each film"))
                }
                (None, None) => None,
            }
        })
        .collect();
    if better.is_empty() { "no significant difference".to_owned() } else { better.join("; ") }
}
