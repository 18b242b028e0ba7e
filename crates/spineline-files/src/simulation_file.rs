use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::anatomy::{Level, Region};
use spineline::multibody::{Deformed, Goal, PathPoint, Timing};
use spineline::response::{GoalEquilibrium, SignedPath, SpineAngles, erect_shape, measure_angles};
use spineline::spatial::{Mat3, Vec3};
use spineline::uncertainty::LoadedUncertainty;

use crate::keys::{ByLevel, JointKey};
use crate::simulation_uncertainty::SimulationUncertainty;
use crate::{AppliedLoad, Provenance, Simulated, SimulationWarning};

/// The response of a personalised model to loads. `G`: x anterior, y left, z cranial, origin at L4's midpoint; mm,
/// rad, angles for people in degrees. A positive lateral tilt is to the patient's right, positive Cobb and Ferguson angles are
/// convex to the left. Numbers have ten significant digits.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "Spineline simulation, version 1")]
pub struct SimulationFile {
    /// `spineline-simulation`.
    format: String,
    /// 1.
    version: u32,
    /// Program that wrote it.
    generator: String,
    /// Provenance.
    #[serde(skip_serializing_if = "Option::is_none")]
    provenance: Option<Provenance>,
    case_id: String,
    /// Whether the films of the model, and so all results, are synthetic.
    synthetic: bool,
    /// Whether forces are in newtons; else they are relative, and only their ratios mean anything.
    absolute: bool,
    /// `N`, or `relative`: to the nominal stiffness. The unit of every force here; moments are force × mm, stiffness force / mm.
    force_unit: String,
    /// `converged`, `several_equilibria`, `limit_point`, `branch_point`, `beyond_human_range`, `unreachable`, `not_converged` or `interrupted`.
    /// Only the first two have a result.
    status: String,
    /// The target of the search.
    goal: GoalRecord,
    /// Limit of the load factor in the search.
    largest_factor: f64,
    loads: Vec<AppliedLoad>,
    erect: AnglesRecord,
    /// Every equilibrium that meets the target, the reached one first.
    equilibria: Vec<EquilibriumRecord>,
    /// Singular points, in the order of the path.
    events: Vec<EventRecord>,
    /// Every equilibrium on the path.
    path: Vec<PathRecord>,
    warnings: Vec<SimulationWarning>,
    /// Effect of landmark noise on the numbers before and under the loads; absent if no replicates were requested.
    #[serde(skip_serializing_if = "Option::is_none")]
    uncertainty: Option<SimulationUncertainty>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
enum GoalRecord {
    /// The loads as they are given: a factor of one.
    FullLoad,
    /// A lateral tilt of the line from L4 to T2 against L4's axis.
    LateralTilt { lateral_tilt_right_deg: f64 },
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct AnglesRecord {
    /// Lateral tilt of the line from L4 to T2 against L4's axis; positive to the patient's right.
    lateral_tilt_right_deg: f64,
    /// Between endplates, positive where convex to the left; empty where the model file has no endplates.
    cobb_deg: BTreeMap<Region, f64>,
    /// Tilt of the upper minus tilt of the lower end vertebra; positive where convex to the left.
    tilt_range_deg: BTreeMap<Region, f64>,
    /// Positive where convex to the left.
    ferguson_deg: BTreeMap<Region, f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct EquilibriumRecord {
    /// `along` or `against` the loads.
    direction: String,
    /// Load factor of the proportional loads; negative where they are reversed.
    factor: f64,
    /// `reached`, `later`, `beyond_limit_point`, `beyond_branch_point` or `beyond_human_range`.
    verdict: String,
    on_erect_branch: bool,
    limit_points: usize,
    branch_points: usize,
    /// Largest difference of a hinge's angle from the angle of its moment.
    residual_rad: f64,
    /// Of the scaled tangent: one for the unloaded spine, zero at limit and branch points.
    smallest_singular_value: f64,
    midpoints_mm: ByLevel<[f64; 3]>,
    /// Unit vectors in `G`: anterior, left, cranial axis of the vertebra.
    axes: ByLevel<[[f64; 3]; 3]>,
    /// Lateral, flexion and axial hinge of every joint.
    hinges_rad: BTreeMap<JointKey, [f64; 3]>,
    spring_forces: Vec<SpringForceRecord>,
    rod_reactions: Vec<RodReactionRecord>,
    #[serde(flatten)]
    angles: AnglesRecord,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct SpringForceRecord {
    /// Which load, from 1.
    load: usize,
    level: Level,
    /// Negative for a pad that pulls or a strap that pushes.
    #[serde(rename = "force")]
    force_n: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct RodReactionRecord {
    /// Which load, from 1.
    load: usize,
    /// On the upper vertebra, at its midpoint; the opposite acts on the lower one.
    #[serde(rename = "force")]
    force_n: [f64; 3],
    /// Force × mm.
    #[serde(rename = "moment")]
    moment_nmm: [f64; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct EventRecord {
    /// `limit_point` or `branch_point`.
    kind: String,
    direction: String,
    timing: Timing,
    factor: f64,
    arc_rad: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct PathRecord {
    direction: String,
    /// Which loads are varied here.
    timing: Timing,
    factor: f64,
    /// Length of the path up to here: hinges in rad, and a factor of one as much as it turns the unloaded hinges. Lengths
    /// of paths with different loads do not compare.
    arc_rad: f64,
    limit_points: usize,
    branch_points: usize,
    residual_rad: f64,
    iterations: u32,
    largest_hinge_rad: f64,
    #[serde(flatten)]
    angles: AnglesRecord,
}

impl SimulationFile {
    /// The same file with the results of replicates under the loads.
    #[must_use]
    pub fn with_uncertainty(mut self, found: &LoadedUncertainty) -> Self {
        self.uncertainty = Some(SimulationUncertainty::from(found));
        self
    }

    /// The same file with its provenance.
    #[must_use]
    pub fn with_provenance(mut self, provenance: Provenance) -> Self {
        self.provenance = Some(provenance);
        self
    }
}

fn events(signed: &SignedPath) -> impl Iterator<Item = EventRecord> {
    signed.path.events.iter().map(|event| EventRecord {
        kind: event.kind.key().to_owned(),
        direction: signed.sign.key().to_owned(),
        timing: event.timing,
        factor: event.factor,
        arc_rad: event.arc_rad,
    })
}

impl Simulated {
    /// The simulation as a file.
    #[must_use]
    pub fn file(&self, generator: &str) -> SimulationFile {
        let (model, response) = (&self.model, &self.response);
        let goal = match response.goal {
            Goal::FullLoad => GoalRecord::FullLoad,
            Goal::LateralTilt(tilt) => {
                GoalRecord::LateralTilt { lateral_tilt_right_deg: tilt.deg() }
            }
        };
        SimulationFile {
            format: "spineline-simulation".to_owned(),
            version: 1,
            generator: generator.to_owned(),
            provenance: None,
            case_id: model.case_id.clone(),
            synthetic: model.synthetic,
            absolute: model.absolute,
            force_unit: if model.absolute { "N" } else { "relative" }.to_owned(),
            status: response.ending.key().to_owned(),
            goal,
            largest_factor: response.largest_factor,
            loads: self.loads.loads.clone(),
            erect: self.angles(&erect_shape(&model.spine)),
            equilibria: response.equilibria.iter().map(|met| self.equilibrium(met)).collect(),
            events: response.paths.iter().flat_map(events).collect(),
            path: response.paths.iter().flat_map(|signed| self.path(signed)).collect(),
            warnings: self.warnings.clone(),
            uncertainty: None,
        }
    }

    fn angles(&self, shape: &Deformed) -> AnglesRecord {
        let SpineAngles { lateral_tilt: tilt, curves, .. } = measure_angles(shape, &self.places);
        AnglesRecord {
            lateral_tilt_right_deg: tilt.deg(),
            cobb_deg: curves.iter().filter_map(|c| Some((c.region, c.ends.cobb?.deg()))).collect(),
            tilt_range_deg: curves.iter().map(|c| (c.region, c.ends.tilt_range.deg())).collect(),
            ferguson_deg: curves.iter().map(|c| (c.region, c.ferguson.deg())).collect(),
        }
    }

    fn equilibrium(&self, met: &GoalEquilibrium) -> EquilibriumRecord {
        let equilibrium = &met.equilibrium;
        let shape = &equilibrium.deformed;
        let levels = self.model.levels.iter().copied();
        let joints = self.model.levels.windows(2).map(|pair| JointKey(pair[0], pair[1]));
        let vector = |v: &Vec3| [v.x, v.y, v.z];
        let columns = |m: &Mat3| [0, 1, 2].map(|i| [m[(0, i)], m[(1, i)], m[(2, i)]]);
        let spring_forces = equilibrium.spring_forces_n.iter().map(|&(item, force_n)| {
            let vertebra = self.placed.loading.items[item].vertebra;
            let level = self.model.levels[vertebra];
            SpringForceRecord { load: self.placed.load_of_item[item] + 1, level, force_n }
        });
        let reactions = equilibrium.rod_reactions.iter().zip(&self.placed.load_of_rod);
        EquilibriumRecord {
            direction: met.sign.key().to_owned(),
            factor: equilibrium.factor,
            verdict: met.verdict.key().to_owned(),
            on_erect_branch: equilibrium.is_on_erect_branch(),
            limit_points: equilibrium.limit_points,
            branch_points: equilibrium.branch_points,
            residual_rad: equilibrium.residual_rad,
            smallest_singular_value: equilibrium.smallest_singular_value,
            midpoints_mm: ByLevel(
                levels.clone().zip(shape.midpoints_mm.iter().map(vector)).collect(),
            ),
            axes: ByLevel(levels.zip(shape.axes.iter().map(columns)).collect()),
            hinges_rad: joints.zip(shape.hinges_rad.iter().copied()).collect(),
            spring_forces: spring_forces.collect(),
            rod_reactions: reactions
                .map(|((force, moment), load)| RodReactionRecord {
                    load: load + 1,
                    force_n: vector(force),
                    moment_nmm: vector(moment),
                })
                .collect(),
            angles: self.angles(shape),
        }
    }

    fn path(&self, signed: &SignedPath) -> impl Iterator<Item = PathRecord> {
        let direction = signed.sign.key();
        signed.path.points.iter().map(move |point: &PathPoint| PathRecord {
            direction: direction.to_owned(),
            timing: point.timing,
            factor: point.factor,
            arc_rad: point.arc_rad,
            limit_points: point.limit_points,
            branch_points: point.branch_points,
            residual_rad: point.residual_rad,
            iterations: point.iterations,
            largest_hinge_rad: point.deformed.largest_hinge_rad(),
            angles: self.angles(&point.deformed),
        })
    }
}
