use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::action::LineOfAction;
use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::{Level, Levels, Posture, Region};
use spineline::evaluate::Simulation;
use spineline::personalize::StiffnessBound;
use spineline::personalize::evidence::ContradictedJoint;
use spineline::spatial::Angle;

use super::identifiability::IdentifiabilityRecord;
use super::points::{by_level, point};
use super::posture::ScaleRecord;
use crate::text::finite;

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct ModelRecord {
    /// Lateral stiffness multipliers by region, or by joint; under `geometric_mean` only their ratios are meaningful.
    multipliers: BTreeMap<String, f64>,
    /// Multipliers that ended at a bound, and so are not identified.
    at_bound: Vec<String>,
    /// Factor on springs about all axes; 1 unless a force is known.
    absolute_scale: f64,
    /// Whether forces are in newtons, because a force was measured; else they are relative to the nominal stiffness.
    absolute: bool,
    fit: FitRecord,
    /// Identifiability of the multipliers; absent if not requested or if the fit did not converge.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) identifiability: Option<IdentifiabilityRecord>,
    postures: BTreeMap<Posture, SimulationRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct FitRecord {
    /// `converged`, `iteration_limit`, `stalled` or `not_evaluable`.
    status: String,
    iterations: u32,
    /// Starts that were refined.
    starts: u32,
    /// Root mean square residual: degrees of Ferguson angles, or standard deviations of a shape.
    residual_rms: Option<f64>,
    /// Of the data by the logarithms of the unknowns: small ones are not identified.
    singular_values: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct SimulationRecord {
    /// Whether the stiffness was fitted to this film; else it was held out.
    fitted: bool,
    /// `converged`, `unreachable`, `beyond_human_range`, `not_converged` or `fit_not_converged`; only the first is a result.
    status: String,
    /// Scale of the film against the erect film, from T2 for a film that was not fitted.
    #[serde(skip_serializing_if = "Option::is_none")]
    film_scale: Option<ScaleRecord>,
    /// Signed force along the line's direction: newtons where the model is `absolute`, else relative to the nominal stiffness.
    #[serde(rename = "force")]
    force_n: f64,
    /// Lateral tilt of the line L4→T2 beyond the film's, where an amplitude was sought.
    #[serde(skip_serializing_if = "Option::is_none")]
    residual_deg: Option<f64>,
    /// Distance of T2 from its place on the film, where that was sought.
    #[serde(skip_serializing_if = "Option::is_none")]
    residual_mm: Option<f64>,
    line: LineRecord,
    /// Why this force was chosen: `fitted`, `only_one`, `least_ferguson_error`, `smallest_near_t2`, or `nearest_miss`.
    choice: String,
    /// Number of failed starts of the search for forces; there may be more alternatives.
    lost_forces: usize,
    /// Other forces that meet the same amplitude.
    alternatives: Vec<AlternativeRecord>,
    /// Absolute error per region; absent where the status is not `converged`.
    ferguson_error_deg: Option<BTreeMap<String, f64>>,
    /// Absent where the status is not `converged`.
    location_error_mm: Option<LocationErrorRecord>,
    simulated_mm: BTreeMap<Level, [f64; 2]>,
    /// Counter-rotating joints, which no positive stiffness explains.
    contradicted_joints: Vec<ContradictedRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LineRecord {
    point_mm: [f64; 2],
    direction: [f64; 2],
    /// `fixed` in space, or `at_t2`.
    application: String,
    /// Sagittal place of a fixed line.
    depth_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct AlternativeRecord {
    /// As `force` of the simulation.
    #[serde(rename = "force")]
    force_n: f64,
    ferguson_rms_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LocationErrorRecord {
    mean: f64,
    levels: BTreeMap<Level, f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ContradictedRecord {
    inferior: Level,
    superior: Level,
    rotation_deg: f64,
    lever_arm_mm: f64,
    /// Part in the work of all joints.
    weight: f64,
    /// Whether the rotation is beyond two standard deviations.
    beyond_noise: bool,
}

impl ModelRecord {
    pub fn new(m: &LineModel, analysis: &Analysis) -> Self {
        let names = m.groups.names();
        Self {
            multipliers: names.iter().cloned().zip(m.multipliers()).collect(),
            at_bound: names
                .iter()
                .zip(&m.fit.bounds)
                .filter(|(_, bound)| **bound != StiffnessBound::Inside)
                .map(|(name, _)| name.clone())
                .collect(),
            absolute_scale: m.fit.absolute_scale,
            absolute: m.is_absolute(analysis.options.gauge),
            fit: FitRecord {
                status: m.fit.status.key().to_owned(),
                iterations: m.fit.iterations,
                starts: m.fit.starts,
                residual_rms: finite(m.fit.residual_rms),
                singular_values: m.fit.singular_values.clone(),
            },
            identifiability: None,
            postures: m
                .simulations
                .iter()
                .map(|s| (s.shape.posture, simulation(s, analysis.movement.levels())))
                .collect(),
        }
    }
}

fn by_region(angles: &[Angle; 3]) -> BTreeMap<String, f64> {
    Region::ALL.iter().zip(angles).map(|(r, a)| (r.key().to_owned(), a.abs().deg())).collect()
}

fn simulation(s: &Simulation, levels: Levels) -> SimulationRecord {
    SimulationRecord {
        fitted: s.fitted,
        status: s.status.key().to_owned(),
        film_scale: Some(s.shape.scale.into()),
        force_n: s.force_n,
        residual_deg: s.residual.tilt().map(Angle::deg),
        residual_mm: s.residual.distance_mm(),
        line: line(&s.line, s.depth_mm),
        choice: s.choice.key().to_owned(),
        lost_forces: s.lost_forces,
        alternatives: s
            .alternatives
            .iter()
            .map(|a| AlternativeRecord {
                force_n: a.force_n,
                ferguson_rms_deg: a.ferguson_rms.deg(),
            })
            .collect(),
        ferguson_error_deg: s.is_usable().then(|| by_region(&s.ferguson_difference)),
        location_error_mm: s.is_usable().then(|| LocationErrorRecord {
            mean: s.shape.mean_location_error_mm(),
            levels: by_level(s.shape.location_errors_mm.iter().copied(), &s.shape.compared),
        }),
        simulated_mm: by_level(s.shape.locations.iter().map(|&p| point(p)), levels.as_slice()),
        contradicted_joints: s.contradicted.iter().map(contradicted).collect(),
    }
}

fn line(line: &LineOfAction, depth_mm: f64) -> LineRecord {
    LineRecord {
        point_mm: point(line.point),
        direction: point(line.direction),
        application: line.application.key().to_owned(),
        depth_mm,
    }
}

fn contradicted(joint: &ContradictedJoint) -> ContradictedRecord {
    ContradictedRecord {
        inferior: joint.inferior,
        superior: joint.superior,
        rotation_deg: joint.rotation.deg(),
        lever_arm_mm: joint.lever_arm_mm,
        weight: joint.weight,
        beyond_noise: joint.beyond_noise,
    }
}
