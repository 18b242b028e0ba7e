//! `analyze --cohort` as CSV: the tests of the cohort.

use spineline::cohort::{Cohort, ErrorKind, LinePairTest};

use crate::define::{Column, Definition, Unit, count, element, grouped, number, text, truth};
use crate::table::Table;

/// A test, and whether its patients are synthetic.
struct Test<'a> {
    synthetic: bool,
    test: &'a LinePairTest,
}

/// One row per pair of lines, role of the films and error.
#[must_use]
pub fn cohort_tests_table(cohort: &Cohort) -> Table {
    let synthetic = cohort.synthetic;
    let tests = cohort.compared.tests.iter();
    definition().fill(&tests.map(|test| Test { synthetic, test }).collect::<Vec<_>>())
}

/// The table without rows.
pub(crate) fn cohort_tests_columns() -> Table {
    definition().fill(&[])
}

fn definition<'a>() -> Definition<Test<'a>> {
    let row = "pair of lines × role of films × error";
    grouped("cohort_tests", row, [compared(), difference(), probabilities()])
}

fn compared<'a>() -> Vec<Column<Test<'a>>> {
    vec![
        text("first_line", "line of action", |row| Some(row.test.lines[0].key().to_owned())),
        text("second_line", "line that it is compared with", |row| {
            Some(row.test.lines[1].key().to_owned())
        }),
        truth("synthetic", "whether the films of some patient are synthetic", |row| {
            Some(row.synthetic)
        }),
        text("films", "role of the films: `fitted`, `left_out_bend` or `held_out`", |row| {
            Some(row.test.role.key().to_owned())
        }),
        text("error", "error that is compared: `location_mm` or `ferguson_deg`", |row| {
            Some(row.test.error.key().to_owned())
        }),
        text("unit", "unit of the difference and its interval: `mm` or `deg`", |row| {
            Some(
                match row.test.error {
                    ErrorKind::Location => "mm",
                    ErrorKind::Ferguson => "deg",
                }
                .to_owned(),
            )
        }),
        count("patients", "number of patients", |row| Some(row.test.comparison.patients() as i64)),
        count("films_compared", "films on which both lines have a result", |row| {
            Some(row.test.films as i64)
        }),
        count("films_not_compared", "films on which one of the two has no result", |row| {
            Some(row.test.left_out as i64)
        }),
    ]
}

fn difference<'a>() -> Vec<Column<Test<'a>>> {
    type End<'a> = fn(&Test<'a>, usize) -> Option<f64>;
    let of_mean: End<'a> = |row, end| row.test.comparison.bootstrap.map(|ends| ends[end]);
    let of_effect: End<'a> =
        |row, end| row.test.comparison.effect.map(|effect| effect.interval[end]);
    vec![
        number(
            "mean_difference",
            Unit::Stated,
            "mean over patients of the first line's error minus the second's",
            |row| Some(row.test.comparison.mean_difference),
        ),
        element("interval_95_low", Unit::Stated, "lower end of its 95 % interval", 0, of_mean),
        element("interval_95_high", Unit::Stated, "upper end of its 95 % interval", 1, of_mean),
        number(
            "effect_d",
            Unit::One,
            "effect size: the mean difference over the standard deviation of the patients' differences",
            |row| row.test.comparison.effect.map(|effect| effect.d),
        ),
        element("effect_95_low", Unit::One, "lower end of its 95 % interval", 0, of_effect),
        element("effect_95_high", Unit::One, "upper end of its 95 % interval", 1, of_effect),
    ]
}

fn probabilities<'a>() -> Vec<Column<Test<'a>>> {
    vec![
        number("sign_flip_p", Unit::One, "p value of the sign-flip test over patients", |row| {
            row.test.comparison.sign_flip.map(|test| test.p_two_sided)
        }),
        number("holm_p", Unit::One, "the same, corrected by Holm over all tests", |row| {
            row.test.holm_p
        }),
        number("patient_t_p", Unit::One, "p value of the paired t-test over patients", |row| {
            row.test.comparison.patients.map(|test| test.p_two_sided)
        }),
        number(
            "pooled_t_p",
            Unit::One,
            "p value of the paired t-test over all vertebrae or angles, as in the paper; far too small, since those of one patient are not independent",
            |row| row.test.comparison.pooled.map(|test| test.p_two_sided),
        ),
        text("predicts_better", "line that predicts better; empty where neither does", |row| {
            row.test.predicts_better().map(|line| line.key().to_owned())
        }),
    ]
}
