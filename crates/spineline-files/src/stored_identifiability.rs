//! Identifiability of the multipliers as a study store keeps it.

use serde::{Deserialize, Serialize};
use spineline::personalize::{
    GroupStiffness, Identifiability, MultiplierInformation, Profile, ProfileEnd, ProfilePoint,
    StiffnessDirection,
};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    variance_factor: f64,
    freedom: usize,
    directions: Vec<StoredDirection>,
    multipliers: Vec<StoredMultiplier>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredDirection {
    log_multipliers: Vec<f64>,
    log_sd: Limit,
    gauge_share: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredMultiplier {
    log_sd: Limit,
    log_sd_with_prior: Option<Limit>,
    /// `ln α` and the rise there.
    points: Vec<(f64, f64)>,
    lower: StoredEnd,
    upper: StoredEnd,
    /// Mean, deviation and half of the interval of `ln` stiffness.
    stiffness: Option<[f64; 3]>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum StoredEnd {
    At(f64),
    Open,
    Lost(f64),
}

/// A number that may be infinite, which JSON cannot say.
#[derive(Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct Limit(Option<f64>);

impl From<f64> for Limit {
    fn from(value: f64) -> Self {
        Self(value.is_finite().then_some(value))
    }
}

impl From<Limit> for f64 {
    fn from(limit: Limit) -> Self {
        limit.0.unwrap_or(f64::INFINITY)
    }
}

impl From<ProfileEnd> for StoredEnd {
    fn from(end: ProfileEnd) -> Self {
        match end {
            ProfileEnd::At(value) => Self::At(value),
            ProfileEnd::Open => Self::Open,
            ProfileEnd::Lost(value) => Self::Lost(value),
        }
    }
}

impl From<StoredEnd> for ProfileEnd {
    fn from(end: StoredEnd) -> Self {
        match end {
            StoredEnd::At(value) => Self::At(value),
            StoredEnd::Open => Self::Open,
            StoredEnd::Lost(value) => Self::Lost(value),
        }
    }
}

/// Identifiability of the multipliers of every model as text, `None` for a model whose fit did not converge.
///
/// Standard deviations may be infinite. Another number that is not finite makes a text that [`parse_identifiability`] refuses.
#[must_use]
pub fn identifiability_text(found: &[Option<Identifiability>]) -> String {
    let all: Vec<Option<Stored>> = found.iter().map(|one| one.as_ref().map(stored)).collect();
    crate::to_line(&all)
}

/// Reads what [`identifiability_text`] wrote; `None` where it is something else.
#[must_use]
pub fn parse_identifiability(text: &str) -> Option<Vec<Option<Identifiability>>> {
    let all: Vec<Option<Stored>> = serde_json::from_str(text).ok()?;
    Some(all.into_iter().map(|one| one.map(found)).collect())
}

fn stored(found: &Identifiability) -> Stored {
    let direction = |one: &StiffnessDirection| StoredDirection {
        log_multipliers: one.log_multipliers.clone(),
        log_sd: one.log_sd.into(),
        gauge_share: one.gauge_share,
    };
    let multiplier = |one: &MultiplierInformation| StoredMultiplier {
        log_sd: one.log_sd.into(),
        log_sd_with_prior: one.log_sd_with_prior.map(Limit::from),
        points: one.profile.points.iter().map(|at| (at.log_multiplier, at.rise)).collect(),
        lower: one.profile.lower.into(),
        upper: one.profile.upper.into(),
        stiffness: one.stiffness.map(|found| [found.log_mean, found.log_sd, found.log_reach]),
    };
    Stored {
        variance_factor: found.variance_factor,
        freedom: found.freedom,
        directions: found.directions.iter().map(direction).collect(),
        multipliers: found.multipliers.iter().map(multiplier).collect(),
    }
}

fn found(stored: Stored) -> Identifiability {
    let direction = |one: StoredDirection| StiffnessDirection {
        log_multipliers: one.log_multipliers,
        log_sd: one.log_sd.into(),
        gauge_share: one.gauge_share,
    };
    let point = |(log_multiplier, rise): (f64, f64)| ProfilePoint { log_multiplier, rise };
    let multiplier = |one: StoredMultiplier| MultiplierInformation {
        log_sd: one.log_sd.into(),
        log_sd_with_prior: one.log_sd_with_prior.map(f64::from),
        profile: Profile {
            points: one.points.into_iter().map(point).collect(),
            lower: one.lower.into(),
            upper: one.upper.into(),
        },
        stiffness: one.stiffness.map(|[log_mean, log_sd, log_reach]| GroupStiffness {
            log_mean,
            log_sd,
            log_reach,
        }),
    };
    Identifiability {
        variance_factor: stored.variance_factor,
        freedom: stored.freedom,
        directions: stored.directions.into_iter().map(direction).collect(),
        multipliers: stored.multipliers.into_iter().map(multiplier).collect(),
    }
}
