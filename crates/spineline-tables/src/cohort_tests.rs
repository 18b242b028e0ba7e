//! `analyze --cohort` as CSV: the tests of the cohort.

use spineline::analysis::FilmRole;
use spineline::cohort::{
    BaselineTest, Cohort, ComparisonOutcome, ErrorKind, LinePairTest, PairedComparison,
};

use crate::define::{Columns, ENDS_95, ONE, STATED, table};
use crate::table::Table;

/// A test of one prediction against another, and whether its patients are synthetic.
pub(crate) struct Test<'a> {
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
        .map(|test| Test::against_baseline(test, test.predictor().key(), cohort.synthetic));
    let hypotheses = cohort.baselines.hypothesis_tests.iter();
    let hypotheses =
        hypotheses.map(|test| Test::against_baseline(test, test.model.key(), cohort.synthetic));
    of_tests(&lines.chain(baselines).chain(hypotheses).collect::<Vec<_>>())
}

pub(crate) fn of_tests(tests: &[Test<'_>]) -> Table {
    let row = "pair of lines, or line or other load and prediction without mechanics × role of films × error";
    table("cohort_tests", row, tests, |add| {
        compared(add);
        difference(add);
        probabilities(add);
    })
}

fn compared(add: &mut Columns<'_, Test<'_>>) {
    add.text("first_line", "line of action, or name of another load and base", |row| {
        row.compared[0].clone()
    });
    add.text(
        "second_line",
        "line or prediction without mechanics that it is compared with",
        |row| row.compared[1].clone(),
    );
    add.truth("synthetic", "whether the films of some patient are synthetic", |row| row.synthetic);
    add.text("films", "role of the films: `fitted`, `left_out_bend` or `held_out`", |row| {
        row.role.key()
    });
    add.text("error", "error that is compared: `location_mm` or `ferguson_deg`", |row| {
        row.error.key()
    });
    add.text("unit", "unit of the difference and its interval: `mm` or `deg`", |row| {
        match row.error {
            ErrorKind::Location => "mm",
            ErrorKind::Ferguson => "deg",
        }
    });
    add.count("patients", "number of patients", |row| row.comparison.patients());
    add.count("films_compared", "films on which both have a result", |row| row.films);
    add.count(
        "films_not_compared",
        "films on which one of two lines lacks a result; empty beside predictions without mechanics",
        |row| row.films_not_compared,
    );
}

fn difference(add: &mut Columns<'_, Test<'_>>) {
    add.unit = STATED;
    add.number(
        "mean_difference",
        "mean over patients of the first line's error minus the second's",
        |row| row.comparison.mean_difference,
    );
    add.interval(["interval_95_low", "interval_95_high"], ENDS_95, |row| row.comparison.bootstrap);
    add.unit = ONE;
    add.number(
        "effect_d",
        "effect size: the mean difference over the standard deviation of the patients' differences",
        |row| row.comparison.effect.map(|effect| effect.d),
    );
    add.interval(["effect_95_low", "effect_95_high"], ENDS_95, |row| {
        Some(row.comparison.effect?.interval)
    });
}

fn probabilities(add: &mut Columns<'_, Test<'_>>) {
    add.number("sign_flip_p", "p value of the sign-flip test over patients", |row| {
        row.comparison.sign_flip.map(|test| test.p_two_sided)
    });
    add.number(
        "holm_p",
        "the same, corrected by Holm over all tests of its family: pairs of lines, lines against predictions without mechanics, or other loads against these; empty where patients are too few for any significant difference",
        |row| row.holm_p,
    );
    add.number("patient_t_p", "p value of the paired t-test over patients", |row| {
        row.comparison.patients.map(|test| test.p_two_sided)
    });
    add.number(
        "pooled_t_p",
        "p value of the paired t-test over all vertebrae or angles, as in the paper; far too small, since the errors of one patient are not independent",
        |row| row.comparison.pooled.map(|test| test.p_two_sided),
    );
    add.text(
        "predicts_better",
        "which of the two predicts better; empty where neither does",
        |row| row.predicts_better.clone(),
    );
}
