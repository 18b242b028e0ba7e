use spineline::uncertainty::QuantitySpread;

use crate::Patient;
use crate::define::{Column, Row, Unit, count, keyed, number, text, truth};
use crate::table::Table;

type SpreadRow<'a> = Row<'a, &'a QuantitySpread>;

/// One row per patient and quantity of the Monte Carlo replicates.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows: Vec<SpreadRow<'_>> = patients
        .iter()
        .flat_map(|patient| {
            let found = patient.spread.iter().flat_map(|spread| &spread.quantities);
            found.map(|item| patient.row(item))
        })
        .collect();
    let row = "patient × quantity, over Monte Carlo replicates with perturbed landmarks";
    keyed("uncertainty", row, [which(), spread()]).fill(&rows)
}

fn which<'a>() -> Vec<Column<SpreadRow<'a>>> {
    vec![
        text("quantity", "kind of the quantity; the next columns specify it", |row| {
            Some(row.item.quantity.key().to_owned())
        }),
        text("posture", "film", |row| {
            row.item.quantity.posture().map(|posture| posture.key().to_owned())
        }),
        text("level", "vertebra", |row| row.item.quantity.level().map(|level| level.to_string())),
        text("group", "region, or the joints that share a multiplier", |row| {
            row.item.quantity.group(row.analysis)
        }),
        text("end", "`caudal` or `cranial`", |row| row.item.quantity.end().map(str::to_owned)),
        text("line", "line of action", |row| {
            row.item.quantity.line().map(|line| line.key().to_owned())
        }),
        text("unit", "`mm`, `px`, `deg`, `segments`, `N`, `relative` or `1`", |row| {
            Some(row.item.quantity.unit(row.analysis).key().to_owned())
        }),
    ]
}

fn spread<'a>() -> Vec<Column<SpreadRow<'a>>> {
    vec![
        number("value", Unit::Stated, "value of the unperturbed case", |row| row.item.nominal.ok()),
        number("mean", Unit::Stated, "mean over the replicates", |row| {
            row.item.spread.map(|spread| spread.mean)
        }),
        number("sd", Unit::Stated, "standard deviation over the replicates", |row| {
            row.item.spread.map(|spread| spread.sd)
        }),
        number(
            "interval_95_low",
            Unit::Stated,
            "2.5 % quantile; empty at a bound of the fit, and for distances and absolute errors, which any noise makes larger",
            |row| row.item.interval_95().map(|interval| interval[0]),
        ),
        number("interval_95_high", Unit::Stated, "97.5 % quantile, likewise", |row| {
            row.item.interval_95().map(|interval| interval[1])
        }),
        truth(
            "at_bound",
            "whether the value is at a bound of the fit, and so not identified",
            |row| Some(row.item.at_bound),
        ),
        count("replicates", "number of replicates with a value", |row| Some(row.item.count as i64)),
    ]
}
