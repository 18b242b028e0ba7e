use spineline::reliability::{Design, Statistic};

use crate::Patient;
use crate::define::{Columns, ENDS_95, Row, STATED, keyed, rows};
use crate::statistics::columns_of_design;
use crate::table::Table;

/// A statistic of one quantity in one design.
pub(crate) struct StatisticRow {
    quantity: String,
    unit: String,
    design: Design,
    subjects: usize,
    statistic: Statistic,
}

/// One row per patient, quantity, design and statistic; empty where every film was read once.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let mut all = Vec::new();
        for found in patient.analysis.reliability() {
            for design in &found.designs {
                all.extend(design.statistics.iter().map(|&statistic| StatisticRow {
                    quantity: found.key.clone(),
                    unit: found.unit.clone(),
                    design: design.design.clone(),
                    subjects: design.subjects,
                    statistic,
                }));
            }
        }
        all
    });
    let row = "patient × quantity × design × statistic";
    keyed("reliability", row, &rows, columns_of_statistics)
}

fn columns_of_statistics(add: &mut Columns<'_, Row<'_, StatisticRow>>) {
    add.unit = STATED;
    columns_of_design(add, |row| &row.quantity, |row| &row.design);
    add.count(
        "repeat",
        "for `inter_observer_single`: the repeat that is compared",
        |row| match row.design {
            Design::InterObserverSingle { repeat } => Some(repeat as usize),
            Design::InterObserverMeans | Design::IntraObserver { .. } => None,
        },
    );
    add.count("subjects", "number of subjects that all raters rated", |row| row.subjects);
    add.text("statistic", "key of the statistic", |row| row.statistic.kind.key());
    add.text("unit", "unit of the value; empty for a coefficient", |row| {
        let kind = row.statistic.kind;
        kind.has_unit().then(|| row.unit.clone())
    });
    add.number("value", "value of the statistic", |row| {
        row.statistic.outcome.ok().map(|estimate| estimate.value)
    });
    add.interval(["interval_95_low", "interval_95_high"], ENDS_95, |row| {
        row.statistic.outcome.ok()?.interval.ok()
    });
    add.text("undefined", "reason why the value is missing", |row| {
        row.statistic.outcome.err().map(|why| why.key())
    });
}
