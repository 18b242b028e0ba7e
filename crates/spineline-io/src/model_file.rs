use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::action::Application;
use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::Level;
use spineline::multibody::{SpineModel, Support};
use spineline::spatial::{Mat3, Vec3};

use crate::FileError;
use crate::json::parse;
use crate::keys::{LevelKey, PostureKey};

const FORMAT: &str = "spineline-model";
const VERSION: u32 = 1;

/// A personalised model alone: vertebrae, joints, springs, and the loads that were found. `G`: x anterior, y left, z
/// cranial, origin at L4's midpoint; mm, N, N·mm/rad.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline model, version 1")]
pub struct ModelFile {
    /// `spineline-model`.
    format: String,
    /// 1.
    version: u32,
    /// Program that wrote it.
    generator: String,
    /// Case that it was made from.
    case_id: String,
    /// Whether that case is made up.
    synthetic: bool,
    /// Line of action that the stiffness was fitted with.
    line: String,
    /// `free` or `frontal` (flexion and axial hinges locked).
    support: SupportKey,
    /// What fixes the level of stiffness and force.
    gauge: String,
    /// Whether forces and springs are absolute; else only their ratios mean anything.
    absolute: bool,
    /// From the fixed L4 to T2, erect and unloaded.
    vertebrae: Vec<VertebraRecord>,
    /// Caudal first.
    joints: Vec<JointRecord>,
    /// One load per simulated posture.
    loads: Vec<LoadRecord>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
enum SupportKey {
    Free,
    Frontal,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct VertebraRecord {
    level: LevelKey,
    midpoint_mm: [f64; 3],
    /// Unit vectors in `G`: anterior, left, cranial axis of the vertebra.
    axes: [[f64; 3]; 3],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct JointRecord {
    inferior: LevelKey,
    superior: LevelKey,
    /// Centre in `G`, erect.
    centre_mm: [f64; 3],
    /// Three hinges in series about the inferior vertebra's x, y and z: lateral, flexion, axial.
    stiffness_nmm_per_rad: [f64; 3],
    /// Before personalisation.
    nominal_nmm_per_rad: [f64; 3],
    /// Source of the nominal values.
    source: String,
}

/// A force on T2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadRecord {
    /// Posture that it simulates.
    pub posture: PostureKey,
    /// How the search for it ended.
    pub status: String,
    /// Signed force along the direction.
    pub force_n: f64,
    /// Point of the line; x is its sagittal place.
    pub point_mm: [f64; 3],
    /// Unit vector.
    pub direction: [f64; 3],
    /// `fixed` in space, or `at_t2`: through T2's midpoint wherever that goes.
    pub application: ApplicationKey,
}

/// How a force is applied.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ApplicationKey {
    /// Along a line fixed in space.
    Fixed,
    /// At T2's midpoint.
    AtT2,
}

/// A model as read back: what a simulation needs.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredModel {
    /// Case that it was made from.
    pub case_id: String,
    /// Whether that case is made up.
    pub synthetic: bool,
    /// Line of action that the stiffness was fitted with.
    pub line: String,
    /// Whether forces and springs are absolute; else only their ratios mean anything.
    pub absolute: bool,
    /// The vertebrae by name, as many as the spine has.
    pub levels: Vec<Level>,
    /// Vertebrae and joints.
    pub spine: SpineModel,
    /// Springs of every joint about x, y and z.
    pub stiffness_nmm_per_rad: Vec<[f64; 3]>,
    /// What holds the patient.
    pub support: Support,
    /// Loads that were found.
    pub loads: Vec<LoadRecord>,
}

impl ModelFile {
    /// The file of one personalised model of an analysis.
    #[must_use]
    pub fn new(analysis: &Analysis, model: &LineModel, generator: &str) -> Self {
        let spine = &analysis.spine;
        let vector = |v: &Vec3| [v.x, v.y, v.z];
        let column = |m: &Mat3, i: usize| [m[(0, i)], m[(1, i)], m[(2, i)]];
        let levels = &Level::MODEL;
        let vertebrae = (0..levels.len())
            .map(|i| VertebraRecord {
                level: LevelKey(levels[i]),
                midpoint_mm: vector(&spine.midpoints_mm[i]),
                axes: [0, 1, 2].map(|axis| column(&spine.axes[i], axis)),
            })
            .collect();
        let joints = model
            .stiffness_nmm_per_rad(&analysis.options.library)
            .into_iter()
            .zip(analysis.options.library.rows())
            .enumerate()
            .map(|(j, (stiffness_nmm_per_rad, row))| JointRecord {
                inferior: LevelKey(row.inferior),
                superior: LevelKey(row.superior),
                centre_mm: vector(
                    &(spine.midpoints_mm[j]
                        + spine.axes[j] * spine.joints[j].centre_in_inferior_mm),
                ),
                stiffness_nmm_per_rad,
                nominal_nmm_per_rad: row.nmm_per_rad,
                source: row.source.clone(),
            })
            .collect();
        let top_x_mm = spine.midpoints_mm[levels.len() - 1].x;
        let loads = model
            .postures
            .iter()
            .map(|s| LoadRecord {
                posture: s.posture.into(),
                status: s.status.key().to_owned(),
                force_n: s.force_n,
                point_mm: match s.line.application {
                    Application::Fixed => [s.depth_mm, s.line.point.y_mm, s.line.point.z_mm],
                    Application::AtT2 => [top_x_mm, s.line.point.y_mm, s.line.point.z_mm],
                },
                direction: [0.0, s.line.direction.y_mm, s.line.direction.z_mm],
                application: match s.line.application {
                    Application::Fixed => ApplicationKey::Fixed,
                    Application::AtT2 => ApplicationKey::AtT2,
                },
            })
            .collect();
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            generator: generator.to_owned(),
            case_id: analysis.case_id.clone(),
            synthetic: analysis.synthetic,
            line: model.kind.key().to_owned(),
            support: match analysis.options.support {
                Support::Free => SupportKey::Free,
                Support::Frontal => SupportKey::Frontal,
            },
            gauge: analysis.options.gauge.key().to_owned(),
            absolute: model.is_absolute(analysis.options.gauge),
            vertebrae,
            joints,
            loads,
        }
    }
}

/// Reads a model from the text of its file.
///
/// # Errors
/// [`FileError`].
pub fn parse_model(text: &str) -> Result<StoredModel, FileError> {
    let file: ModelFile = parse(text, FORMAT, VERSION)?;
    if file.vertebrae.len() != file.joints.len() + 1 {
        let (vertebrae, joints) = (file.vertebrae.len(), file.joints.len());
        return Err(FileError::ModelShape { vertebrae, joints });
    }
    let midpoints_mm: Vec<Vec3> =
        file.vertebrae.iter().map(|v| Vec3::from(v.midpoint_mm)).collect();
    let axes: Vec<Mat3> =
        file.vertebrae.iter().map(|v| Mat3::from_columns(&v.axes.map(Vec3::from))).collect();
    let centres: Vec<Vec3> = file
        .joints
        .iter()
        .enumerate()
        .map(|(j, joint)| axes[j].transpose() * (Vec3::from(joint.centre_mm) - midpoints_mm[j]))
        .collect();
    Ok(StoredModel {
        case_id: file.case_id,
        synthetic: file.synthetic,
        line: file.line,
        absolute: file.absolute,
        levels: file.vertebrae.iter().map(|v| v.level.0).collect(),
        spine: SpineModel::from_poses(midpoints_mm, axes, &centres),
        stiffness_nmm_per_rad: file
            .joints
            .iter()
            .map(|joint| joint.stiffness_nmm_per_rad)
            .collect(),
        support: match file.support {
            SupportKey::Free => Support::Free,
            SupportKey::Frontal => Support::Frontal,
        },
        loads: file.loads,
    })
}
