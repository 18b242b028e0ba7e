//! `reproduce`: the numbers of the paper beside the our numbers.

use serde::Serialize;

use crate::define::{Columns, STATED, table};
use crate::table::{NumberFormat, Table};

/// One number of the paper beside the number of one group of patients.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReproducedNumber {
    /// Part of the paper.
    pub section: String,
    /// Support of the patient in the models; `None` where it does not matter.
    pub support: Option<&'static str>,
    /// What the number measures.
    pub quantity: String,
    /// Unit; empty without one.
    pub unit: &'static str,
    /// The paper's number as text; `None` where the paper does not give it.
    pub paper: Option<String>,
    /// Group of patients: a loading scenario, or the films that were given.
    pub group: &'static str,
    /// Mean, share or p value.
    pub mean: Option<f64>,
    /// Standard deviation.
    pub sd: Option<f64>,
    /// Number of values.
    pub n: usize,
    /// The number as it is printed.
    pub text: String,
    /// Comparison of all groups with the paper.
    pub verdict: String,
}

/// One row per number of the paper and group of patients.
#[must_use]
pub fn reproduction_table(numbers: &[ReproducedNumber]) -> Table {
    let row = "section × support × quantity × group";
    table("summary", row, numbers, columns)
}

fn columns(add: &mut Columns<'_, ReproducedNumber>) {
    add.unit = STATED;
    add.text("section", "part of the paper", |row| row.section.clone());
    add.text("support", "`free`, `frontal`, or empty where it does not matter", |row| row.support);
    add.text("quantity", "what the number measures", |row| row.quantity.clone());
    add.text("unit", "unit of `mean` and `sd`; empty without one", |row| row.unit);
    add.text("paper", "the number of the paper; empty where it gives none", |row| {
        row.paper.clone()
    });
    add.text(
        "group",
        "loading scenario (`rod`, `bend` or `pull`), or `films` for cases that were given",
        |row| row.group,
    );
    add.number("mean", "mean, share or p value; empty without one", |row| row.mean).format =
        NumberFormat::ShortestDecimal;
    add.number("sd", "standard deviation; empty without one", |row| row.sd).format =
        NumberFormat::ShortestDecimal;
    add.count("n", "number of values", |row| row.n);
    add.text("text", "the number as it is printed", |row| row.text.clone());
    add.text("verdict", "comparison of all groups with the paper", |row| row.verdict.clone());
}
