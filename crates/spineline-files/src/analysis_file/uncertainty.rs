use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::analysis::Analysis;
use spineline::anatomy::{Level, Posture};
use spineline::spatial::Angle;
use spineline::uncertainty::{FilmNoise, QuantitySpread, Uncertainty, VertebraNoise};

/// Uncertainty of every number from landmark noise: Monte Carlo replicates with perturbed landmarks.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct UncertaintyRecord {
    /// Replicates requested.
    replicates: u64,
    /// Replicates that were run.
    done: u64,
    /// Replicates whose analysis stopped with an error.
    failed: u64,
    seed: u64,
    noise: BTreeMap<Posture, NoiseRecord>,
    /// Failures by code, line and film.
    failures: Vec<FailureRecord>,
    quantities: Vec<SpreadRecord>,
}

/// Standard deviation of one reading of a film.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct NoiseRecord {
    /// `readings` (their standard deviation), `assumed` (no repeated reading) or `given`.
    source: String,
    /// Of a corner's column and row.
    corner_sd_px: Option<[f64; 2]>,
    corner_sd_mm: Option<[f64; 2]>,
    /// Of an axis set by hand; `null` where it follows from the corners.
    axis_sd_deg: Option<f64>,
    /// Of a coordinate, for films that give locations and tilts.
    location_sd_mm: Option<f64>,
    tilt_sd_deg: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct FailureRecord {
    /// Of the error that stopped an analysis, or `fit_not_converged` or `force_not_found`.
    code: String,
    line: Option<String>,
    posture: Option<Posture>,
    count: u64,
}

/// Distribution of one number.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct SpreadRecord {
    /// Its kind; the keys after `unit` say which one.
    quantity: String,
    /// In words.
    label: String,
    /// `mm`, `px`, `deg`, `segments`, `N`, `relative` (a force relative to the nominal stiffness) or `1`.
    unit: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    posture: Option<Posture>,
    #[serde(skip_serializing_if = "Option::is_none")]
    level: Option<Level>,
    /// Region, or the joints that share a multiplier.
    #[serde(skip_serializing_if = "Option::is_none")]
    group: Option<String>,
    /// `caudal` or `cranial`: which inflection or window.
    #[serde(skip_serializing_if = "Option::is_none")]
    end: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<String>,
    /// In the case itself.
    value: Option<f64>,
    mean: Option<f64>,
    sd: Option<f64>,
    /// `null` where fewer than 40 replicates have it, where it or an end is at a bound of the fit, and for distances, absolute errors and counter-rotating joints, which any noise makes larger.
    interval_95: Option<[f64; 2]>,
    /// How often the interval of a multiplier holds the true one; absent for other numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    interval_coverage: Option<String>,
    /// Whether bounds of the fit determine the value or an end of its interval, so that the films do not identify it.
    at_bound: bool,
    /// Replicates in which bounds of the fit determine it; of more than 2.5 %, the interval has no end.
    replicates_at_bound: u64,
    /// The 25, 50 and 75 % quantiles.
    quartiles: Option<[f64; 3]>,
    /// Replicates that have it.
    count: u64,
    /// Replicates that were analysed and do not have it, by reason.
    absent: BTreeMap<String, u64>,
}

impl UncertaintyRecord {
    pub fn new(found: &Uncertainty, analysis: &Analysis) -> Self {
        Self {
            replicates: found.requested,
            done: found.done,
            failed: found.failed,
            seed: found.seed,
            noise: NoiseRecord::of(&found.noise),
            failures: found
                .failures
                .iter()
                .map(|failure| FailureRecord {
                    code: failure.code.to_string(),
                    line: failure.line.map(|line| line.key().to_owned()),
                    posture: failure.posture,
                    count: failure.count,
                })
                .collect(),
            quantities: found.quantities.iter().map(|spread| record(spread, analysis)).collect(),
        }
    }
}

impl NoiseRecord {
    /// Of every film.
    pub fn of(noise: &[FilmNoise]) -> BTreeMap<Posture, Self> {
        noise.iter().map(|film| (film.posture, Self::from(film))).collect()
    }
}

impl From<&FilmNoise> for NoiseRecord {
    fn from(film: &FilmNoise) -> Self {
        let source = film.source.key().to_owned();
        match film.landmarks {
            VertebraNoise::Corners { sd_px, sd_mm, axis_sd } => Self {
                source,
                corner_sd_px: Some(sd_px),
                corner_sd_mm: sd_mm,
                axis_sd_deg: axis_sd.map(Angle::deg),
                location_sd_mm: None,
                tilt_sd_deg: None,
            },
            VertebraNoise::Placements { location_sd_mm, tilt_sd } => Self {
                source,
                corner_sd_px: None,
                corner_sd_mm: None,
                axis_sd_deg: None,
                location_sd_mm: Some(location_sd_mm),
                tilt_sd_deg: Some(tilt_sd.deg()),
            },
        }
    }
}

fn record(found: &QuantitySpread, analysis: &Analysis) -> SpreadRecord {
    let quantity = found.quantity;
    let spread = found.spread;
    let absent = found.absent.iter().map(|(why, count)| (why.key().to_owned(), *count));
    SpreadRecord {
        quantity: quantity.kind.key().to_owned(),
        label: quantity.label(analysis),
        unit: quantity.unit(analysis).key().to_owned(),
        posture: quantity.posture,
        level: quantity.level,
        group: quantity.group(analysis),
        end: quantity.end_name().map(str::to_owned),
        line: quantity.line.map(|line| line.key().to_owned()),
        value: found.nominal.ok(),
        mean: spread.map(|s| s.mean),
        sd: spread.and_then(|s| s.sd),
        interval_95: found.interval_95(),
        interval_coverage: quantity.interval_caveat().map(str::to_owned),
        at_bound: found.at_bound,
        replicates_at_bound: found.replicates_at_bound,
        quartiles: spread.map(|s| [s.quantiles[1], s.quantiles[2], s.quantiles[3]]),
        count: found.count,
        absent: absent.collect(),
    }
}
