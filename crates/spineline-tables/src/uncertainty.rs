use spineline::uncertainty::QuantitySpread;

use crate::Patient;
use crate::define::{Columns, Row, STATED, keyed, rows};
use crate::table::Table;

type SpreadRow<'a> = Row<'a, &'a QuantitySpread>;

/// One row per patient and quantity of the Monte Carlo replicates.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        patient.uncertainty.into_iter().flat_map(|spread| &spread.quantities)
    });
    let row = "patient × quantity, over Monte Carlo replicates with perturbed landmarks";
    keyed("uncertainty", row, &rows, |add| {
        which(add);
        spread(add);
    })
}

fn which(add: &mut Columns<'_, SpreadRow<'_>>) {
    add.text("quantity", "kind of the quantity; the next columns specify it", |row| {
        row.quantity.kind.key()
    });
    add.text("posture", "film", |row| row.quantity.posture.map(|posture| posture.key()));
    add.text("level", "vertebra", |row| row.quantity.level.map(|level| level.to_string()));
    add.text("group", "region, or the joints that share a multiplier", |row| {
        row.quantity.group(row.analysis)
    });
    add.text("end", "`caudal` or `cranial`", |row| row.quantity.end_name());
    add.text("line", "line of action", |row| row.quantity.line.map(|line| line.key()));
    add.text("unit", "`mm`, `px`, `deg`, `segments`, `N`, `relative` or `1`", |row| {
        row.quantity.unit(row.analysis).key()
    });
}

fn spread(add: &mut Columns<'_, SpreadRow<'_>>) {
    add.unit = STATED;
    add.number("value", "value of the unperturbed case", |row| row.nominal.ok());
    add.number("mean", "mean over the replicates", |row| row.spread.map(|spread| spread.mean));
    add.number("sd", "standard deviation over the replicates", |row| row.spread?.sd);
    add.interval(
        ["interval_95_low", "interval_95_high"],
        [
            "2.5 % quantile; empty where fewer than 40 replicates have a value, where it or an end is at a bound of the fit, and for distances, absolute errors and counter-rotating joints, which any noise makes larger",
            "97.5 % quantile, likewise",
        ],
        |row| row.interval_95(),
    );
    add.truth(
        "at_bound",
        "whether bounds of the fit determine the value or an end of its interval, which is then not identified",
        |row| row.at_bound,
    );
    add.count(
        "replicates_at_bound",
        "number of replicates in which bounds of the fit determine it",
        |row| row.replicates_at_bound as usize,
    );
    add.count("replicates", "number of replicates with a value", |row| row.count as usize);
}
