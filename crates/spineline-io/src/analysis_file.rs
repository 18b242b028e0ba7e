use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::action::{Application, LineOfAction};
use spineline::analysis::{Analysis, Grouping, LineModel, PostureAnalysis};
use spineline::anatomy::{Level, Posture, Region};
use spineline::clinical::ClinicalCurve;
use spineline::curve::{CurveForm, OrderRule};
use spineline::evaluate::Simulation;
use spineline::motion::Estimate;
use spineline::multibody::Support;
use spineline::personalize::evidence::ContradictedJoint;
use spineline::personalize::{FitTarget, StiffnessBound};
use spineline::spatial::{Angle, Frontal};

use crate::keys::{LevelKey, PostureKey};

/// Everything that an analysis found. Lengths in mm of the films' plane, angles in degrees, frontal points `[y, z]` with y
/// to the patient's left and z cranial; positive angles lean to the patient's right.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "Spineline analysis, version 1")]
pub struct AnalysisFile {
    format: String,
    version: u32,
    /// Program that wrote it.
    generator: String,
    case_id: String,
    /// Whether the films are made up: then every number here is.
    synthetic: bool,
    /// What the millimetres are: in the patient, on the detector, or not stated.
    length_unit: String,
    options: OptionsRecord,
    chain: ChainRecord,
    /// The two inflections of the erect curve that carry the line; empty where there is no such pair.
    inflections: Vec<InflectionRecord>,
    /// Stretches of the erect curve that turn to one side, caudal first.
    lobes: Vec<LobeRecord>,
    clinical: ClinicalRecord,
    postures: BTreeMap<PostureKey, PostureRecord>,
    /// One model per line of action: `inflection_line`, `iliac_line`, `estimated_line`, `given_line`.
    models: BTreeMap<String, ModelRecord>,
    warnings: Vec<WarningRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct OptionsRecord {
    order_rule: String,
    support: String,
    gauge: String,
    fit: String,
    multipliers: String,
    /// Fewest and most segments of the erect chain.
    segment_window: [u32; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct ChainRecord {
    /// Number of segments on the erect curve: the paper's n.
    segments: usize,
    /// Length of a link: the paper's l.
    segment_mm: f64,
    /// Segments by which the postures differ in sum.
    difference: u32,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct InflectionRecord {
    /// Segment of the chain, from 0.
    segment: usize,
    /// Vertebrae between which it lies, caudal first.
    between: [LevelKey; 2],
    erect_mm: [f64; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct LobeRecord {
    /// Positive where the spine turns to the patient's right as it rises.
    turn_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct ClinicalRecord {
    /// Lenke's curve type as far as frontal films tell it.
    lenke_type: Option<u8>,
    curves: BTreeMap<String, ClinicalCurveRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct ClinicalCurveRecord {
    /// Lower and upper end vertebra, chosen on the erect film.
    ends: [LevelKey; 2],
    apex: LevelKey,
    /// The patient's side to which the erect curve is convex.
    convex: Option<String>,
    cobb_deg: BTreeMap<PostureKey, f64>,
    ferguson_deg: BTreeMap<PostureKey, f64>,
    apical_translation_mm: f64,
    /// Part of the erect Cobb angle that the bend to the convex side takes away.
    flexibility: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct PostureRecord {
    curve: CurveRecord,
    locations_mm: BTreeMap<LevelKey, [f64; 2]>,
    tilts_deg: BTreeMap<LevelKey, f64>,
    /// Lean of the line L4→T2 against the normal of the iliac line, or L4's axis.
    amplitude_deg: f64,
    noise: NoiseRecord,
    /// Mean rotation of the segments from the erect posture.
    mean_rotation_deg: Option<f64>,
    /// Where the two inflection segments lie.
    inflection_mm: Option<[[f64; 2]; 2]>,
    /// The inflection segments against the least-rotating ones, caudal first.
    inflection_estimates: Option<[EstimateRecord; 2]>,
    /// MMS_Mean against the least-rotating ones.
    mean_least_estimates: Option<[EstimateRecord; 2]>,
    /// The load that the measured rotations prefer against the line through the inflections.
    line_comparison: Option<LineComparisonRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct CurveRecord {
    order: usize,
    /// `graph` (y of z) or `parametric`.
    form: String,
    rmse_mm: f64,
    rmse_deg: f64,
    /// Root mean square error on vertebrae left out of the fit, in standard deviations.
    left_out: f64,
}

/// Standard deviation of a measured value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct NoiseRecord {
    location_mm: f64,
    tilt_deg: f64,
    /// From the spread of readings; else assumed for one careful reading.
    measured: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct EstimateRecord {
    segment: usize,
    least_segment: usize,
    distance_segments: usize,
    distance_mm: f64,
    rotation_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct LineComparisonRecord {
    angle_deg: f64,
    distance_mm: f64,
    /// On 2 and `freedom` degrees, of "the moment vanishes at both inflections".
    f_statistic: f64,
    freedom: usize,
    p_value: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct ModelRecord {
    /// Lateral stiffness multipliers by region, or by joint; under `geometric_mean` only their ratios mean anything.
    multipliers: BTreeMap<String, f64>,
    /// Multipliers that ended at a bound, and so are not identified.
    at_bound: Vec<String>,
    /// Factor on springs about all axes; 1 unless a force is known.
    absolute_scale: f64,
    /// Whether forces and stiffness are absolute.
    absolute: bool,
    fit: FitRecord,
    postures: BTreeMap<PostureKey, SimulationRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct FitRecord {
    /// `converged`, `iteration_limit` or `not_evaluable`.
    status: String,
    iterations: u32,
    /// Starts that were refined.
    starts: u32,
    /// Root mean square residual: degrees of Ferguson angles, or standard deviations of a shape.
    residual_rms: Option<f64>,
    /// Of the data by the logarithms of the unknowns: small ones are not identified.
    singular_values: Vec<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct SimulationRecord {
    /// Whether the stiffness was fitted to this film; else it was held out.
    fitted: bool,
    /// `converged`, `unreachable` or `not_converged`; only the first is a result.
    status: String,
    /// Signed force along the line's direction.
    force_n: f64,
    /// Degrees left of the amplitude (bends) or mm left of T2's place.
    residual: f64,
    line: LineRecord,
    /// Other forces that meet the same amplitude.
    alternatives: Vec<AlternativeRecord>,
    /// Absolute error per region; absent where the status is not `converged`.
    ferguson_error_deg: Option<BTreeMap<String, f64>>,
    /// Absent where the status is not `converged`.
    location_error_mm: Option<LocationErrorRecord>,
    simulated_mm: BTreeMap<LevelKey, [f64; 2]>,
    /// Joints that turn against the force: no positive stiffness explains them.
    contradicted_joints: Vec<ContradictedRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct LineRecord {
    point_mm: [f64; 2],
    direction: [f64; 2],
    /// `fixed` in space, or `at_t2`.
    application: String,
    /// Sagittal place of a fixed line.
    depth_mm: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct AlternativeRecord {
    force_n: f64,
    ferguson_rms_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct LocationErrorRecord {
    mean: f64,
    levels: BTreeMap<LevelKey, f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct ContradictedRecord {
    inferior: LevelKey,
    superior: LevelKey,
    rotation_deg: f64,
    lever_arm_mm: f64,
    /// Part in the work of all joints.
    weight: f64,
    /// Whether the rotation is beyond two standard deviations.
    beyond_noise: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
struct WarningRecord {
    code: String,
    step: String,
    posture: Option<PostureKey>,
    level: Option<LevelKey>,
    message: String,
}

impl AnalysisFile {
    /// The file of an analysis.
    #[must_use]
    pub fn new(analysis: &Analysis, generator: &str) -> Self {
        Self {
            format: "spineline-analysis".to_owned(),
            version: 1,
            generator: generator.to_owned(),
            case_id: analysis.case_id.clone(),
            synthetic: analysis.synthetic,
            length_unit: analysis.erect().outline.spacing_plane.unit().to_owned(),
            options: options(analysis),
            chain: ChainRecord {
                segments: analysis.chain.segments,
                segment_mm: analysis.chain.segment_mm,
                difference: analysis.chain.difference,
            },
            inflections: inflections(analysis),
            lobes: analysis
                .inflections
                .lobes
                .iter()
                .map(|lobe| LobeRecord { turn_deg: lobe.turn.deg() })
                .collect(),
            clinical: ClinicalRecord {
                lenke_type: analysis.lenke.map(|lenke| lenke.number),
                curves: analysis.clinical.iter().map(clinical_curve).collect(),
            },
            postures: analysis
                .postures
                .iter()
                .map(|p| (p.outline.posture.into(), posture(p)))
                .collect(),
            models: analysis
                .models
                .iter()
                .map(|m| (m.kind.key().to_owned(), model(m, analysis)))
                .collect(),
            warnings: analysis
                .warnings
                .all()
                .iter()
                .map(|w| WarningRecord {
                    code: w.code.to_owned(),
                    step: w.step.key().to_owned(),
                    posture: w.posture.map(Into::into),
                    level: w.level.map(LevelKey),
                    message: w.message.clone(),
                })
                .collect(),
        }
    }
}

fn point(p: Frontal) -> [f64; 2] {
    [p.y_mm, p.z_mm]
}

fn by_level<T>(values: impl Iterator<Item = T>, levels: &[Level]) -> BTreeMap<LevelKey, T> {
    levels.iter().map(|&level| LevelKey(level)).zip(values).collect()
}

fn by_region(angles: &[Angle; 3]) -> BTreeMap<String, f64> {
    Region::ALL.iter().zip(angles).map(|(r, a)| (r.key().to_owned(), a.abs().deg())).collect()
}

fn options(analysis: &Analysis) -> OptionsRecord {
    let options = &analysis.options;
    OptionsRecord {
        order_rule: match options.order_rule {
            OrderRule::LeaveOneOut => "leave_one_out".to_owned(),
            OrderRule::Paper => "paper".to_owned(),
            OrderRule::Fixed(order) => order.to_string(),
        },
        support: match options.support {
            Support::Free => "free",
            Support::Frontal => "frontal",
        }
        .to_owned(),
        gauge: options.gauge.key().to_owned(),
        fit: match options.target {
            FitTarget::Shape => "shape",
            FitTarget::Ferguson => "ferguson",
        }
        .to_owned(),
        multipliers: match options.grouping {
            Grouping::Regional => "regional",
            Grouping::PerJoint => "per_joint",
        }
        .to_owned(),
        segment_window: [*options.segment_window.start(), *options.segment_window.end()],
    }
}

fn inflections(analysis: &Analysis) -> Vec<InflectionRecord> {
    let pairs = analysis
        .inflections
        .pair
        .iter()
        .flatten()
        .zip(analysis.inflection_segments.iter().flatten());
    pairs
        .map(|(inflection, &segment)| InflectionRecord {
            segment,
            between: [LevelKey(inflection.between.0), LevelKey(inflection.between.1)],
            erect_mm: point(inflection.erect),
        })
        .collect()
}

fn clinical_curve(curve: &ClinicalCurve) -> (String, ClinicalCurveRecord) {
    let angles = |all: &[(Posture, Angle)]| {
        all.iter().map(|(posture, angle)| ((*posture).into(), angle.deg())).collect()
    };
    let record = ClinicalCurveRecord {
        ends: [LevelKey(curve.ends.inferior), LevelKey(curve.ends.superior)],
        apex: LevelKey(curve.apex),
        convex: curve.convex.map(|side| side.to_string()),
        cobb_deg: angles(&curve.cobb),
        ferguson_deg: angles(&curve.ferguson),
        apical_translation_mm: curve.apical_translation_mm,
        flexibility: curve.flexibility,
    };
    (curve.region.key().to_owned(), record)
}

fn posture(p: &PostureAnalysis) -> PostureRecord {
    let vertebrae = &p.outline.vertebrae;
    let estimates = |all: Option<[Estimate; 2]>| {
        all.map(|pair| {
            pair.map(|e| EstimateRecord {
                segment: e.segment,
                least_segment: e.least,
                distance_segments: e.distance_segments,
                distance_mm: e.distance_mm,
                rotation_deg: e.rotation.deg(),
            })
        })
    };
    PostureRecord {
        curve: CurveRecord {
            order: p.fit.order,
            form: match p.fit.curve.form() {
                CurveForm::Graph => "graph",
                CurveForm::Parametric => "parametric",
            }
            .to_owned(),
            rmse_mm: p.fit.rmse_mm,
            rmse_deg: p.fit.rmse_tilt.deg(),
            left_out: p.fit.left_out,
        },
        locations_mm: by_level(vertebrae.iter().map(|v| point(v.location)), &Level::MODEL),
        tilts_deg: by_level(vertebrae.iter().map(|v| v.tilt.deg()), &Level::MODEL),
        amplitude_deg: p.outline.amplitude().deg(),
        noise: NoiseRecord {
            location_mm: p.outline.noise.location_mm,
            tilt_deg: p.outline.noise.tilt.deg(),
            measured: p.outline.noise.measured,
        },
        mean_rotation_deg: p.mean_rotation().map(Angle::deg),
        inflection_mm: p.inflection_points.map(|points| points.map(point)),
        inflection_estimates: estimates(p.inflection_estimates),
        mean_least_estimates: estimates(p.mean_least_estimates),
        line_comparison: p.line_comparison.map(|c| LineComparisonRecord {
            angle_deg: c.angle.deg(),
            distance_mm: c.distance_mm,
            f_statistic: c.f_statistic,
            freedom: c.freedom,
            p_value: c.p_value,
        }),
    }
}

fn model(m: &LineModel, analysis: &Analysis) -> ModelRecord {
    let names = m.groups.names();
    ModelRecord {
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
            residual_rms: Some(m.fit.residual_rms).filter(|rms| rms.is_finite()),
            singular_values: m.fit.singular_values.clone(),
        },
        postures: m.postures.iter().map(|s| (s.posture.into(), simulation(s))).collect(),
    }
}

fn simulation(s: &Simulation) -> SimulationRecord {
    let mobile = Simulation::mobile_levels();
    SimulationRecord {
        fitted: s.fitted,
        status: s.status.key().to_owned(),
        force_n: s.force_n,
        // Bends leave an angle, the others a distance.
        residual: if s.posture.bend().is_some() {
            Angle::from_rad(s.residual).deg()
        } else {
            s.residual
        },
        line: line(&s.line, s.depth_mm),
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
            mean: s.mean_location_error_mm(),
            levels: by_level(s.location_errors_mm.iter().copied(), mobile),
        }),
        simulated_mm: by_level(s.locations.iter().map(|&p| point(p)), &Level::MODEL),
        contradicted_joints: s.contradicted.iter().map(contradicted).collect(),
    }
}

fn line(line: &LineOfAction, depth_mm: f64) -> LineRecord {
    LineRecord {
        point_mm: point(line.point),
        direction: point(line.direction),
        application: match line.application {
            Application::Fixed => "fixed",
            Application::AtT2 => "at_t2",
        }
        .to_owned(),
        depth_mm,
    }
}

fn contradicted(joint: &ContradictedJoint) -> ContradictedRecord {
    ContradictedRecord {
        inferior: LevelKey(joint.inferior),
        superior: LevelKey(joint.superior),
        rotation_deg: joint.rotation.deg(),
        lever_arm_mm: joint.lever_arm_mm,
        weight: joint.weight,
        beyond_noise: joint.beyond_noise,
    }
}
