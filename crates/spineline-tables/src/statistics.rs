//! `reliability --csv`: the statistics of readings, and the limits of agreement of every pair.

use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Statistic, StatisticEstimate,
};

use crate::define::{Columns, ENDS_95, STATED, table};
use crate::table::Table;

/// A statistic of a design, or one of the limits of a pair.
struct StatisticRow<'a> {
    synthetic: bool,
    quantity: &'a QuantityReliability,
    design: &'a DesignReliability,
    value: Value<'a>,
}

enum Value<'a> {
    Statistic(&'a Statistic),
    /// The bias of a pair of raters or one of its limits of agreement, with its 95 % interval.
    Limit {
        pair: &'a BlandAltman,
        name: &'static str,
        value: f64,
        interval: Option<[f64; 2]>,
    },
}

impl Value<'_> {
    fn estimate(&self) -> Option<StatisticEstimate> {
        match self {
            Self::Statistic(statistic) => statistic.outcome.ok(),
            Self::Limit { .. } => None,
        }
    }

    fn interval(&self) -> Option<[f64; 2]> {
        match self {
            Self::Statistic(_) => self.estimate()?.interval.ok(),
            Self::Limit { interval, .. } => *interval,
        }
    }
}

/// One row per statistic, and per bias and limit of every pair.
#[must_use]
pub fn statistics_table(found: &[QuantityReliability], synthetic: bool) -> Table {
    let mut rows = Vec::new();
    for quantity in found {
        for design in &quantity.designs {
            let statistics = design.statistics.iter().map(Value::Statistic);
            let limits = design.bland_altman.iter().flat_map(|pair| {
                let limits = pair.named_limits().into_iter();
                limits.map(|(name, value, interval)| Value::Limit { pair, name, value, interval })
            });
            let values = statistics.chain(limits);
            rows.extend(values.map(|value| StatisticRow { synthetic, quantity, design, value }));
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
    add.text("statistic", "key of the statistic", |row| match &row.value {
        Value::Statistic(statistic) => statistic.kind.key().to_owned(),
        Value::Limit { name, .. } => format!("bland_altman_{}", name.replace(' ', "_")),
    });
    add.text("name", "its name; of a bias or limit of agreement, the two raters", |row| match &row
        .value
    {
        Value::Statistic(statistic) => statistic.kind.to_string(),
        Value::Limit { pair, .. } => {
            format!("{1} minus {0}", pair.raters[0], pair.raters[1])
        }
    });
    add.number("value", "its value", |row| match row.value {
        Value::Statistic(_) => Some(row.value.estimate()?.value),
        Value::Limit { value, .. } => Some(value),
    });
    add.number(
        "sd",
        "standard deviation over pairs of raters; of a bias, over the differences",
        |row| match row.value {
            Value::Statistic(_) => row.value.estimate()?.sd,
            Value::Limit { pair, name, .. } => (name == "bias").then_some(pair.sd),
        },
    );
    add.interval(["ci95_low", "ci95_high"], ENDS_95, |row| row.value.interval());
    add.text("unit", "unit of the value; empty for a coefficient", |row| {
        let has_unit = match row.value {
            Value::Statistic(statistic) => statistic.kind.has_unit(),
            Value::Limit { .. } => true,
        };
        has_unit.then(|| row.quantity.unit.clone())
    });
    add.text("undefined", "reason why the value is missing", |row| match row.value {
        Value::Statistic(statistic) => Some(statistic.outcome.err()?.key()),
        Value::Limit { .. } => None,
    });
}
