use spineline::reliability::{Design, Statistic};

use crate::Patient;
use crate::define::{Columns, Row, Unit, keyed};
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

type ReliabilityRow<'a> = Row<'a, StatisticRow>;

/// One row per patient, quantity, design and statistic; empty where every film was read once.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let mut rows: Vec<ReliabilityRow<'_>> = Vec::new();
    for patient in patients {
        for found in patient.analysis.reliability() {
            for design in &found.designs {
                rows.extend(design.statistics.iter().map(|&statistic| {
                    patient.row(StatisticRow {
                        quantity: found.key.clone(),
                        unit: found.unit.clone(),
                        design: design.design.clone(),
                        subjects: design.subjects,
                        statistic,
                    })
                }));
            }
        }
    }
    let row = "patient × quantity × design × statistic";
    keyed("reliability", row, &rows, columns_of_statistics)
}

fn columns_of_statistics(add: &mut Columns<'_, ReliabilityRow<'_>>) {
    columns_of_design(add, |row| &row.item.quantity, |row| &row.item.design);
    add.count(
        "repeat",
        "for `inter_observer_single`: the repeat that is compared",
        |row| match row.item.design {
            Design::InterObserverSingle { repeat } => Some(i64::from(repeat)),
            Design::InterObserverMeans | Design::IntraObserver { .. } => None,
        },
    );
    add.count("subjects", "number of subjects that all raters rated", |row| {
        row.item.subjects as i64
    });
    add.text("statistic", "key of the statistic", |row| row.item.statistic.kind.key());
    add.text("unit", "unit of the value; empty for a coefficient", |row| {
        let kind = row.item.statistic.kind;
        kind.has_unit().then(|| row.item.unit.clone())
    });
    add.number("value", Unit::Stated, "value of the statistic", |row| {
        row.item.statistic.outcome.ok().map(|estimate| estimate.value)
    });
    add.number("interval_95_low", Unit::Stated, "lower end of its 95 % interval", |row| {
        row.item.statistic.outcome.ok()?.interval.ok().map(|ends| ends[0])
    });
    add.number("interval_95_high", Unit::Stated, "upper end of its 95 % interval", |row| {
        row.item.statistic.outcome.ok()?.interval.ok().map(|ends| ends[1])
    });
    add.text("undefined", "reason why the value is missing", |row| {
        row.item.statistic.outcome.err().map(|why| why.key())
    });
}
