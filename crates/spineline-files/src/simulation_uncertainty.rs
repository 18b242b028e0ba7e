use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::anatomy::{Posture, Region};
use spineline::uncertainty::{LoadedSpread, LoadedUncertainty};

use crate::analysis_file::NoiseRecord;

/// Results of replicates with perturbed landmarks under the same loads. The intervals cover landmark noise and the scales of the
/// films against the erect one; they do not cover the errors of the model, of the loads and of the erect film's scale, and no bias
/// that all observers share.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct SimulationUncertainty {
    /// Replicates requested.
    replicates: u64,
    /// Replicates that were run.
    done: u64,
    /// Replicates with a result under the loads; the numbers are theirs.
    usable: u64,
    seed: u64,
    noise: BTreeMap<Posture, NoiseRecord>,
    /// Number of replicates without a result, by code: of the error that stopped an analysis; `no_inflections`, `not_measured` or
    /// `fit_not_converged` without a model; or the `status` of the simulation.
    endings: BTreeMap<String, u64>,
    numbers: Vec<LoadedSpreadRecord>,
}

/// Distribution of one number.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LoadedSpreadRecord {
    /// `cobb`, `tilt_range`, `ferguson`, `lateral_tilt`, `top_tilt`, `top_offset`, `coronal_balance` or `factor`. Angles of curves are
    /// positive where convex to the left, tilts to the right, distances to the left.
    quantity: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<Region>,
    /// `erect`, `loaded`, or `change`: loaded minus erect.
    state: String,
    /// `deg`, `mm` or `1`.
    unit: String,
    /// In the model itself; `null` where that has no result.
    value: Option<f64>,
    mean: Option<f64>,
    sd: Option<f64>,
    /// The central 95 %; `null` where fewer than 40 replicates have it.
    interval_95: Option<[f64; 2]>,
    /// The 25, 50 and 75 % quantiles.
    quartiles: Option<[f64; 3]>,
    /// Replicates that have it.
    count: u64,
}

impl From<&LoadedUncertainty> for SimulationUncertainty {
    fn from(found: &LoadedUncertainty) -> Self {
        let endings = found.endings.iter();
        Self {
            replicates: found.requested,
            done: found.done,
            usable: found.usable,
            seed: found.seed,
            noise: NoiseRecord::of(&found.noise),
            endings: endings.map(|(code, count)| (code.to_string(), *count)).collect(),
            numbers: found.numbers.iter().map(LoadedSpreadRecord::from).collect(),
        }
    }
}

impl From<&LoadedSpread> for LoadedSpreadRecord {
    fn from(found: &LoadedSpread) -> Self {
        let (quantity, spread) = (found.quantity, found.spread);
        Self {
            quantity: quantity.key().to_owned(),
            region: quantity.region(),
            state: found.state.key().to_owned(),
            unit: quantity.unit_key().to_owned(),
            value: found.nominal,
            mean: spread.map(|s| s.mean),
            sd: spread.and_then(|s| s.sd),
            interval_95: found.interval_95(),
            quartiles: spread.map(|s| [s.quantiles[1], s.quantiles[2], s.quantiles[3]]),
            count: found.count,
        }
    }
}
