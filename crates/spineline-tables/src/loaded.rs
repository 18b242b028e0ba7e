//! `simulate --measures`: measures before and under loads.

use spineline::response::{LoadedMeasure, LoadedState};
use spineline::uncertainty::{LoadedSpread, LoadedUncertainty};
use spineline_files::Simulated;

use crate::define::{Columns, STATED, table};
use crate::table::Table;

pub(crate) struct Number<'a> {
    simulated: &'a Simulated,
    uncertainty: Option<&'a LoadedUncertainty>,
    measure: LoadedMeasure,
    state: LoadedState,
    spread: Option<&'a LoadedSpread>,
}

/// One row per number of a spine before and under loads, with the replicates under the same loads where there are any.
#[must_use]
pub fn loaded_measures_table(
    simulated: &Simulated,
    measures: &[LoadedMeasure],
    uncertainty: Option<&LoadedUncertainty>,
) -> Table {
    let numbers = measures.iter().flat_map(|&measure| {
        LoadedState::ALL.into_iter().map(move |state| {
            let spread = uncertainty.and_then(|found| found.of(measure.quantity, state));
            Number { simulated, uncertainty, measure, state, spread }
        })
    });
    let exists = |row: &Number<'_>| row.measure.value(row.state).is_some() || row.spread.is_some();
    of_numbers(&numbers.filter(exists).collect::<Vec<_>>())
}

pub(crate) fn of_numbers(all: &[Number<'_>]) -> Table {
    table("loaded_measures", "number of a spine before and under loads", all, |add| {
        which(add);
        numbers(add);
    })
}

fn which(add: &mut Columns<'_, Number<'_>>) {
    add.text("case_id", "patient", |row| row.simulated.model.case_id.clone());
    add.truth("synthetic", "whether the patient of the model is synthetic", |row| {
        row.simulated.model.synthetic
    });
    add.text("status", "how the search ended; the same in every row", |row| {
        row.simulated.response.ending.key()
    });
    add.text(
        "quantity",
        "`cobb`, `tilt_range` or `ferguson` of a curve, positive where convex to the patient's left; `lateral_tilt` and `top_tilt`, positive to the right; `top_offset` and `coronal_balance`, positive to the left; or the `factor` of a search",
        |row| row.measure.quantity.key(),
    );
    add.text("region", "region of a curve", |row| {
        row.measure.quantity.region().map(|region| region.key())
    });
    add.text("state", "`erect`, `loaded`, or `change`: loaded minus erect", |row| row.state.key());
    add.text("unit", "`deg`, `mm` or `1`", |row| row.measure.quantity.unit_key());
}

fn numbers(add: &mut Columns<'_, Number<'_>>) {
    add.unit = STATED;
    add.number("value", "value of the model itself", |row| row.measure.value(row.state));
    add.number("mean", "mean over the replicates with a result", |row| {
        Some(row.spread?.spread?.mean)
    });
    add.number("sd", "standard deviation over the replicates", |row| row.spread?.spread?.sd);
    add.interval(
        ["interval_95_low", "interval_95_high"],
        [
            "2.5 % quantile over the replicates: by landmark noise and scales of the films, without errors of the model; empty where fewer than 40 have a value",
            "97.5 % quantile, likewise",
        ],
        |row| row.spread?.interval_95(),
    );
    add.count("replicates", "number of replicates with a value", |row| {
        Some(row.spread?.count as usize)
    });
    add.count("replicates_done", "number of replicates; the others have no result", |row| {
        Some(row.uncertainty?.done as usize)
    });
}
