//! `reliability --csv`: the statistics of readings, and the limits of agreement of every pair.

use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Statistic,
};

use crate::define::{Columns, ENDS_95, STATED, table};
use crate::table::Table;

struct StatisticRow<'a> {
    synthetic: bool,
    quantity: &'a QuantityReliability,
    design: &'a DesignReliability,
    number: Number,
}

/// A statistic of a design, or the bias of a pair of raters, or one of the pair's limits of agreement.
struct Number {
    key: String,
    name: String,
    value: Option<f64>,
    sd: Option<f64>,
    interval: Option<[f64; 2]>,
    has_unit: bool,
    undefined: Option<&'static str>,
}

impl Number {
    fn of(statistic: &Statistic) -> Self {
        let (kind, estimate) = (statistic.kind, statistic.outcome.ok());
        Self {
            key: kind.key().to_owned(),
            name: kind.to_string(),
            value: estimate.map(|found| found.value),
            sd: estimate.and_then(|found| found.sd),
            interval: estimate.and_then(|found| found.interval.ok()),
            has_unit: kind.has_unit(),
            undefined: statistic.outcome.err().map(|why| why.key()),
        }
    }

    fn limits(pair: &BlandAltman) -> [Self; 3] {
        pair.named_limits().map(|(name, value, interval)| Self {
            key: format!("bland_altman_{}", name.replace(' ', "_")),
            name: format!("{1} minus {0}", pair.raters[0], pair.raters[1]),
            value: Some(value),
            sd: (name == "bias").then_some(pair.sd),
            interval,
            has_unit: true,
            undefined: None,
        })
    }
}

/// One row per statistic, and per bias and limit of every pair.
#[must_use]
pub fn statistics_table(found: &[QuantityReliability], synthetic: bool) -> Table {
    let mut rows = Vec::new();
    for quantity in found {
        for design in &quantity.designs {
            let limits = design.bland_altman.iter().flat_map(Number::limits);
            let numbers = design.statistics.iter().map(Number::of).chain(limits);
            rows.extend(numbers.map(|number| StatisticRow { synthetic, quantity, design, number }));
        }
    }
    let row = "quantity × design × statistic, or quantity × design × pair of raters × bias or limit of agreement";
    table("statistics", row, &rows, |add| {
        which(add);
        values(add);
    })
}

/// Who is compared on which quantity.
pub(crate) fn columns_of_design<R>(
    add: &mut Columns<'_, R>,
    quantity: impl Fn(&R) -> &str,
    design: impl Fn(&R) -> &Design,
) {
    add.text("quantity", "quantity that was read", |row| quantity(row).to_owned());
    add.text(
        "design",
        "`inter_observer_means`, `inter_observer_single` or `intra_observer`",
        |row| design(row).key(),
    );
    add.text("observer", "for `intra_observer`: the observer whose repeats are compared", |row| {
        match design(row) {
            Design::IntraObserver { observer } => Some(observer.clone()),
            Design::InterObserverMeans | Design::InterObserverSingle { .. } => None,
        }
    });
}

fn which(add: &mut Columns<'_, StatisticRow<'_>>) {
    add.truth("synthetic", "whether the films of some case are synthetic", |row| row.synthetic);
    columns_of_design(add, |row| &row.quantity.key, |row| &row.design.design);
    add.count("raters", "number of raters", |row| row.design.raters.len());
    add.text(
        "repeats",
        "number of readings in a value of each rater, with spaces between them",
        |row| {
            let repeats: Vec<_> = row.design.repeats.iter().map(usize::to_string).collect();
            Some(repeats.join(" "))
        },
    );
    add.count("subjects", "number of subjects that all raters rated", |row| row.design.subjects);
    add.count("dropped", "subjects that are left out, since some rater did not rate them", |row| {
        row.design.dropped
    });
}

fn values(add: &mut Columns<'_, StatisticRow<'_>>) {
    add.unit = STATED;
    add.text("statistic", "key of the statistic", |row| row.number.key.clone());
    add.text("name", "its name; of a bias or limit of agreement, the two raters", |row| {
        row.number.name.clone()
    });
    add.number("value", "its value", |row| row.number.value);
    add.number(
        "sd",
        "standard deviation over pairs of raters; of a bias, over the differences",
        |row| row.number.sd,
    );
    add.interval(["ci95_low", "ci95_high"], ENDS_95, |row| row.number.interval);
    add.text("unit", "unit of the value; empty for a coefficient", |row| {
        row.number.has_unit.then(|| row.quantity.unit.clone())
    });
    add.text("undefined", "reason why the value is missing", |row| row.number.undefined);
}
