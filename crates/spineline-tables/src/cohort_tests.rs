//! `analyze --cohort` as CSV: the tests of the cohort.

use spineline::analysis::FilmRole;
use spineline::cohort::{
    BaselineTest, Cohort, ComparisonOutcome, ErrorKind, LinePairTest, PairedComparison,
};

use crate::define::{Column, Definition, Unit, count, element, grouped, number, text, truth};
use crate::table::Table;

/// A test of one prediction against another, and whether its patients are synthetic.
struct Test<'a> {
    synthetic: bool,
    /// Keys of the first line, and of the prediction that it is compared with.
    compared: [String; 2],
    role: FilmRole,
    error: ErrorKind,
    films: usize,
    films_not_compared: Option<usize>,
    comparison: &'a PairedComparison,
    holm_p: Option<f64>,
    predicts_better: Option<String>,
}

impl<'a> Test<'a> {
    fn of_lines(test: &'a LinePairTest, synthetic: bool) -> Self {
        Self {
            synthetic,
            compared: test.lines.map(|line| line.key().to_owned()),
            role: test.role,
            error: test.error,
            films: test.films,
            films_not_compared: Some(test.without_result),
            comparison: &test.comparison,
            holm_p: test.holm_p,
            predicts_better: test.predicts_better().map(|line| line.key().to_owned()),
        }
    }

    fn against_baseline<M>(test: &'a BaselineTest<M>, model: String, synthetic: bool) -> Self {
        let compared = [model, test.baseline.key().to_owned()];
        let better = compared[usize::from(!test.is_better())].clone();
        Self {
            synthetic,
            compared,
            role: test.role,
            error: ErrorKind::Location,
            films: test.films,
            films_not_compared: None,
            comparison: &test.comparison,
            holm_p: test.holm_p,
            predicts_better: matches!(
                test.outcome(),
                ComparisonOutcome::Better | ComparisonOutcome::Worse
            )
            .then_some(better),
        }
    }
}

/// One row per pair of lines, role of the films and error, then one per line or other load, prediction without mechanics and
/// role.
#[must_use]
pub fn cohort_tests_table(cohort: &Cohort) -> Table {
    let lines = cohort.compared.tests.iter();
    let lines = lines.map(|test| Test::of_lines(test, cohort.synthetic));
    let baselines = cohort.baselines.tests.iter();
    let baselines = baselines
        .map(|test| Test::against_baseline(test, test.model.key().to_owned(), cohort.synthetic));
    let hypotheses = cohort.baselines.hypothesis_tests.iter();
    let hypotheses =
        hypotheses.map(|test| Test::against_baseline(test, test.model.key(), cohort.synthetic));
    definition().fill(&lines.chain(baselines).chain(hypotheses).collect::<Vec<_>>())
}

/// The table without rows.
pub(crate) fn cohort_tests_columns() -> Table {
    definition().fill(&[])
}

fn definition<'a>() -> Definition<Test<'a>> {
    let row = "pair of lines, or line or other load and prediction without mechanics × role of films × error";
    grouped("cohort_tests", row, [compared(), difference(), probabilities()])
}

fn compared<'a>() -> Vec<Column<Test<'a>>> {
    vec![
        text("first_line", "line of action, or name of another load and base", |row| {
            Some(row.compared[0].clone())
        }),
        text(
            "second_line",
            "line or prediction without mechanics that it is compared with",
            |row| Some(row.compared[1].clone()),
        ),
        truth("synthetic", "whether the films of some patient are synthetic", |row| {
            Some(row.synthetic)
        }),
        text("films", "role of the films: `fitted`, `left_out_bend` or `held_out`", |row| {
            Some(row.role.key().to_owned())
        }),
        text("error", "error that is compared: `location_mm` or `ferguson_deg`", |row| {
            Some(row.error.key().to_owned())
        }),
        text("unit", "unit of the difference and its interval: `mm` or `deg`", |row| {
            Some(
                match row.error {
                    ErrorKind::Location => "mm",
                    ErrorKind::Ferguson => "deg",
                }
                .to_owned(),
            )
        }),
        count("patients", "number of patients", |row| Some(row.comparison.patients() as i64)),
        count("films_compared", "films on which both have a result", |row| Some(row.films as i64)),
        count(
            "films_not_compared",
            "films on which one of two lines lacks a result; empty beside predictions without mechanics",
            |row| row.films_not_compared.map(|films| films as i64),
        ),
    ]
}

fn difference<'a>() -> Vec<Column<Test<'a>>> {
    type End<'a> = fn(&Test<'a>, usize) -> Option<f64>;
    let of_mean: End<'a> = |row, end| row.comparison.bootstrap.map(|ends| ends[end]);
    let of_effect: End<'a> = |row, end| row.comparison.effect.map(|effect| effect.interval[end]);
    vec![
        number(
            "mean_difference",
            Unit::Stated,
            "mean over patients of the first line's error minus the second's",
            |row| Some(row.comparison.mean_difference),
        ),
        element("interval_95_low", Unit::Stated, "lower end of its 95 % interval", 0, of_mean),
        element("interval_95_high", Unit::Stated, "upper end of its 95 % interval", 1, of_mean),
        number(
            "effect_d",
            Unit::One,
            "effect size: the mean difference over the standard deviation of the patients' differences",
            |row| row.comparison.effect.map(|effect| effect.d),
        ),
        element("effect_95_low", Unit::One, "lower end of its 95 % interval", 0, of_effect),
        element("effect_95_high", Unit::One, "upper end of its 95 % interval", 1, of_effect),
    ]
}

fn probabilities<'a>() -> Vec<Column<Test<'a>>> {
    vec![
        number("sign_flip_p", Unit::One, "p value of the sign-flip test over patients", |row| {
            row.comparison.sign_flip.map(|test| test.p_two_sided)
        }),
        number(
            "holm_p",
            Unit::One,
            "the same, corrected by Holm over all tests of its family: pairs of lines, lines against predictions without mechanics, or other loads against these",
            |row| row.holm_p,
        ),
        number("patient_t_p", Unit::One, "p value of the paired t-test over patients", |row| {
            row.comparison.patients.map(|test| test.p_two_sided)
        }),
        number(
            "pooled_t_p",
            Unit::One,
            "p value of the paired t-test over all vertebrae or angles, as in the paper; far too small, since the errors of one patient are not independent",
            |row| row.comparison.pooled.map(|test| test.p_two_sided),
        ),
        text(
            "predicts_better",
            "which of the two predicts better; empty where neither does",
            |row| row.predicts_better.clone(),
        ),
    ]
}
