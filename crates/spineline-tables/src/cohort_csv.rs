//! The tests of a cohort as CSV.

use spineline::cohort::{Cohort, ErrorKind, LinePairTest};
use spineline::evaluate::statistics::PairedT;

use crate::error::TableError;
use crate::records::rows_to_csv;

const HEADING: [&str; 20] = [
    "first_line",
    "second_line",
    "synthetic",
    "films",
    "error",
    "unit",
    "patients",
    "films_compared",
    "films_not_compared",
    "mean_difference",
    "interval_95_low",
    "interval_95_high",
    "effect_d",
    "effect_95_low",
    "effect_95_high",
    "sign_flip_p",
    "holm_p",
    "patient_t_p",
    "pooled_t_p",
    "predicts_better",
];

/// One row per test, with the unit in the name of every column that has one.
///
/// # Errors
/// [`TableError::Csv`], though every row has a cell per column.
pub fn cohort_csv(cohort: &Cohort) -> Result<String, TableError> {
    rows_to_csv("cohort", HEADING, cohort.compared.tests.iter().map(|test| row(cohort, test)))
}

fn row(cohort: &Cohort, test: &LinePairTest) -> [String; 20] {
    let number = |value: Option<f64>| {
        value.filter(|v| v.is_finite()).map_or_else(String::new, |v| v.to_string())
    };
    let c = &test.comparison;
    let p = |t: Option<PairedT>| number(t.map(|t| t.p_two_sided));
    let end = |ends: Option<[f64; 2]>, i: usize| number(ends.map(|e| e[i]));
    let effect = c.effect.map(|e| e.interval);
    [
        test.lines[0].key().to_owned(),
        test.lines[1].key().to_owned(),
        cohort.synthetic.to_string(),
        test.role.key().to_owned(),
        test.error.key().to_owned(),
        match test.error {
            ErrorKind::Location => "mm",
            ErrorKind::Ferguson => "deg",
        }
        .to_owned(),
        c.patients().to_string(),
        test.films.to_string(),
        test.left_out.to_string(),
        number(Some(c.mean_difference)),
        end(c.bootstrap, 0),
        end(c.bootstrap, 1),
        number(c.effect.map(|e| e.d)),
        end(effect, 0),
        end(effect, 1),
        number(c.sign_flip.map(|t| t.p_two_sided)),
        number(test.holm_p),
        p(c.patients),
        p(c.pooled),
        test.predicts_better().map_or_else(String::new, |kind| kind.key().to_owned()),
    ]
}
