use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::multibody::JointGroups;
use spineline::personalize::{
    Identifiability, MULTIPLIER_COVERAGE, MultiplierInformation, ProfileEnd, STIFFNESS_COVERAGE,
    StiffnessDirection,
};

use crate::text::finite;

/// Identifiability of a model's multipliers from the bending films, in natural logarithms, at the scales of the films that were
/// found before the fit.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct IdentifiabilityRecord {
    /// How often `interval_95` holds the true mean stiffness.
    interval_coverage: String,
    /// How often `interval_95_if_exact` holds the true multiplier.
    interval_if_exact_coverage: String,
    /// By region or joint, under the gauge.
    multipliers: BTreeMap<String, InformationRecord>,
    /// Joint directions of change, the least identified first; from the films alone, without gauge and prior.
    directions: Vec<DirectionRecord>,
    /// Sum of squares over the degrees of freedom, and at least 1; deviations and limits are widened by it.
    variance_factor: f64,
    /// Measured numbers minus fitted ones.
    degrees_of_freedom: usize,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct InformationRecord {
    /// `interval`, `only_lower`, `only_upper`, `not_identified` or `unknown`, by `interval_95`; `disputed` where the multiplier lies outside of it and differs from
    /// `stiffness` by more than a factor of 1.5.
    verdict: String,
    /// Geometric mean of its joints' stiffness over the table's, by the mixed model; `null` where the joint rotations do not determine it.
    stiffness: Option<f64>,
    /// Ends of its 95 % interval; `null` where the films allow every value up to the bound of multipliers.
    interval_95: [Option<f64>; 2],
    /// Ends of the multiplier's 95 % interval if the model is exact; `null` where the films allow every value up to its bound.
    interval_95_if_exact: [Option<f64>; 2],
    /// From the films alone; `null` where they do not fix it.
    log_sd: Option<f64>,
    /// With the prior; absent without a prior.
    #[serde(skip_serializing_if = "Option::is_none")]
    log_sd_with_prior: Option<f64>,
    profile: ProfileRecord,
}

/// The best fit with this multiplier held at one value after another.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ProfileRecord {
    log_multiplier: Vec<f64>,
    /// Rise of the sum of squares, over `variance_factor`; the interval ends at 3.84.
    rise: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct DirectionRecord {
    /// Its part in every multiplier's logarithm.
    log_multipliers: BTreeMap<String, f64>,
    /// `null` where the films give no information.
    log_sd: Option<f64>,
    /// 1 for the direction that changes no ratio, which the gauge fixes; 0 for a ratio.
    gauge_share: f64,
}

impl IdentifiabilityRecord {
    pub fn new(found: &Identifiability, groups: &JointGroups) -> Self {
        let names = || groups.names().iter().cloned();
        Self {
            interval_coverage: STIFFNESS_COVERAGE.to_owned(),
            interval_if_exact_coverage: MULTIPLIER_COVERAGE.to_owned(),
            multipliers: names().zip(found.multipliers.iter().map(information)).collect(),
            directions: found
                .directions
                .iter()
                .map(|StiffnessDirection { log_multipliers, log_sd, gauge_share }| {
                    DirectionRecord {
                        log_multipliers: names().zip(log_multipliers.iter().copied()).collect(),
                        log_sd: finite(*log_sd),
                        gauge_share: *gauge_share,
                    }
                })
                .collect(),
            variance_factor: found.variance_factor,
            degrees_of_freedom: found.freedom,
        }
    }
}

fn information(one: &MultiplierInformation) -> InformationRecord {
    InformationRecord {
        verdict: one.verdict().key().to_owned(),
        stiffness: one.stiffness.map(|found| found.log_mean.exp()),
        interval_95: one.interval_95().map_or([None; 2], |ends| ends.map(ProfileEnd::multiplier)),
        interval_95_if_exact: [one.profile.lower, one.profile.upper].map(ProfileEnd::multiplier),
        log_sd: finite(one.log_sd),
        log_sd_with_prior: one.log_sd_with_prior.and_then(finite),
        profile: ProfileRecord {
            log_multiplier: one.profile.points.iter().map(|point| point.log_multiplier).collect(),
            rise: one.profile.points.iter().map(|point| point.rise).collect(),
        },
    }
}
