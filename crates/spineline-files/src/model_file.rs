use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::action::LineKind;
use spineline::analysis::{
    Analysis, AxialSource, FilmLoad, LineModel, Movement, PersonalisedModel, PitchSource,
    is_case_id,
};
use spineline::anatomy::{Level, Region};
use spineline::clinical::{CurvePlaces, RegionBounds};
use spineline::multibody::{JointStiffness, SpineModel, Support};
use spineline::spatial::{Angle, Mat3, Vec3};

use crate::error::NEIGHBOURS_MM;
use crate::json::parse;
use crate::{FileError, Provenance};

const FORMAT: &str = "spineline-model";
const VERSION: u32 = 1;
/// The scale constraint that makes a model absolute.
const KNOWN_FORCE: &str = "known_force";
/// Tolerance of a vertebra's axes as a rotation.
const AXES_TOLERANCE: f64 = 1e-6;

/// A personalised model alone: vertebrae, joints, springs, and the loads that were found. `G`: x anterior, y left, z
/// cranial, origin at L4's midpoint; mm. Forces and springs are in N and N·mm/rad where `absolute`, else relative.
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
    /// Whether that case is synthetic.
    synthetic: bool,
    /// Line of action that the stiffness was fitted with.
    line: LineKind,
    /// `free` or `frontal` (flexion and axial hinges locked).
    support: Support,
    /// Scale constraint of stiffness and force.
    gauge: String,
    /// Whether forces and springs are absolute; else only their ratios are meaningful.
    absolute: bool,
    /// Mass of the body whose trunk the springs carry in the erect shape; absent where they carry nothing.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    carried_body_mass_kg: Option<f64>,
    /// From the fixed L4 to T2, erect.
    vertebrae: Vec<VertebraRecord>,
    /// Caudal first.
    joints: Vec<JointRecord>,
    /// One load per simulated posture.
    loads: Vec<FilmLoad>,
    /// What the films say against the model, in sentences; absent without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    doubts: Vec<String>,
    /// Where Cobb and Ferguson angles are measured, caudal first; the usual places if not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    regions: Option<Vec<RegionRecord>>,
    /// Provenance.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    provenance: Option<Provenance>,
}

/// Between which vertebrae a curve is measured, chosen on the erect film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct RegionRecord {
    region: Region,
    /// Lower end of the Ferguson angle.
    inferior: Level,
    apex: Level,
    /// Upper end of the Ferguson angle.
    superior: Level,
    /// Lower end vertebra of the Cobb angle.
    cobb_inferior: Level,
    /// Upper end vertebra of the Cobb angle.
    cobb_superior: Level,
    /// Cobb angle between endplates minus the difference of the end vertebrae's tilts, which rigid vertebrae keep; absent, and
    /// Cobb angles with it, where the endplates are not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    endplate_difference_deg: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct VertebraRecord {
    level: Level,
    midpoint_mm: [f64; 3],
    /// Unit vectors in `G`: anterior, left, cranial axis of the vertebra.
    axes: [[f64; 3]; 3],
    /// Where pitch and depth come from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pitch_from: Option<PitchSource>,
    /// Where the axial rotation comes from.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    axial_rotation_from: Option<AxialSource>,
    /// Width of the body between its corners on the erect film, for drawing it; absent where no person placed them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    width_mm: Option<f64>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct JointRecord {
    inferior: Level,
    superior: Level,
    /// Centre in `G`, erect.
    centre_mm: [f64; 3],
    /// Three hinges in series about the inferior vertebra's x, y and z: lateral, flexion, axial. N·mm/rad where the model is
    /// `absolute`; else at the level of the nominal values, and only the ratios are meaningful.
    #[serde(rename = "stiffness")]
    stiffness_nmm_per_rad: [f64; 3],
    /// Symmetric, positive definite matrix about the same hinges that couples them; where given, it is used instead by
    /// `simulate`.
    #[serde(rename = "stiffness_matrix", default, skip_serializing_if = "Option::is_none")]
    stiffness_matrix_nmm_per_rad: Option<[[f64; 3]; 3]>,
    /// Before personalisation, in N·mm/rad.
    nominal_nmm_per_rad: [f64; 3],
    /// Source of the nominal values.
    source: String,
}

impl JointRecord {
    fn stiffness(&self) -> Mat3 {
        let diagonal = || Mat3::from_diagonal(&Vec3::from(self.stiffness_nmm_per_rad));
        self.stiffness_matrix_nmm_per_rad
            .map_or_else(diagonal, |rows| Mat3::from_columns(&rows.map(Vec3::from)).transpose())
    }
}

/// A model read from its file.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredModel {
    /// The model.
    pub model: PersonalisedModel,
    /// Provenance, with the options of the analysis.
    pub provenance: Option<Provenance>,
}

impl ModelFile {
    /// The file of the personalised model of a line of action, with its provenance.
    #[must_use]
    pub fn new(
        analysis: &Analysis,
        line: &LineModel,
        generator: &str,
        provenance: Option<Provenance>,
    ) -> Self {
        let model = analysis.personalised_model(line);
        Self {
            format: FORMAT.to_owned(),
            version: VERSION,
            generator: generator.to_owned(),
            line: model.line,
            support: model.support,
            gauge: analysis.options.gauge.key().to_owned(),
            absolute: model.absolute,
            carried_body_mass_kg: model.carried_body_mass_kg,
            vertebrae: vertebrae(&model),
            joints: joints(&model, &analysis.movement),
            loads: model.loads,
            doubts: model.doubts,
            regions: model.curves.as_deref().map(|curves| regions(curves, &model.levels)),
            provenance,
            case_id: model.case_id,
            synthetic: model.synthetic,
        }
    }
}

fn vertebrae(model: &PersonalisedModel) -> Vec<VertebraRecord> {
    let spine = &model.spine;
    let record = |(i, &level): (usize, &Level)| VertebraRecord {
        level,
        midpoint_mm: spine.midpoints_mm[i].into(),
        axes: [0, 1, 2].map(|axis| spine.axes[i].column(axis).into_owned().into()),
        pitch_from: model.pitch_from[i],
        axial_rotation_from: model.axial_from[i],
        width_mm: model.widths_mm[i],
    };
    model.levels.iter().enumerate().map(record).collect()
}

fn joints(model: &PersonalisedModel, movement: &Movement) -> Vec<JointRecord> {
    let spine = &movement.spine;
    let record = |(j, row): (usize, &JointStiffness)| JointRecord {
        inferior: row.inferior,
        superior: row.superior,
        centre_mm: (spine.midpoints_mm[j] + spine.axes[j] * spine.joints[j].centre_in_inferior_mm)
            .into(),
        stiffness_nmm_per_rad: model.stiffness_nmm_per_rad[j],
        stiffness_matrix_nmm_per_rad: (row.axial_per_lateral != 0.0).then(|| {
            let matrix = &model.stiffness[j];
            [0, 1, 2].map(|i| [0, 1, 2].map(|k| matrix[(i, k)]))
        }),
        nominal_nmm_per_rad: row.nmm_per_rad,
        source: row.source.clone(),
    };
    movement.library.rows().iter().enumerate().map(record).collect()
}

/// The places of curves by the names of their vertebrae.
fn regions(curves: &[CurvePlaces], levels: &[Level]) -> Vec<RegionRecord> {
    let level = |place: usize| levels[place];
    let record =
        |CurvePlaces { bounds, cobb_ends, endplate_difference }: &CurvePlaces| RegionRecord {
            region: bounds.region,
            inferior: level(bounds.inferior),
            apex: level(bounds.apex),
            superior: level(bounds.superior),
            cobb_inferior: level(cobb_ends[0]),
            cobb_superior: level(cobb_ends[1]),
            endplate_difference_deg: endplate_difference.map(Angle::deg),
        };
    curves.iter().map(record).collect()
}

/// Regions as places among the vertebrae of a file.
fn places(records: &[RegionRecord], levels: &[Level]) -> Result<Vec<CurvePlaces>, FileError> {
    let find = |level: Level, record: &RegionRecord| {
        let found = levels.iter().position(|other| *other == level);
        found.ok_or(FileError::Region { region: record.region, level })
    };
    let place = |record: &RegionRecord| {
        let [inferior, apex, superior, low, high] = [
            find(record.inferior, record)?,
            find(record.apex, record)?,
            find(record.superior, record)?,
            find(record.cobb_inferior, record)?,
            find(record.cobb_superior, record)?,
        ];
        let region = record.region;
        if inferior < apex && apex < superior && low < high {
            let bounds = RegionBounds { region, inferior, apex, superior };
            let endplate_difference = record.endplate_difference_deg.map(Angle::from_deg);
            Ok(CurvePlaces { bounds, cobb_ends: [low, high], endplate_difference })
        } else {
            Err(FileError::RegionOrder { region })
        }
    };
    records.iter().map(place).collect()
}

/// Reads a model from the text of its file.
pub fn parse_model(text: &str) -> Result<StoredModel, FileError> {
    parse::<ModelFile>(text, FORMAT, VERSION)?.stored()
}

impl ModelFile {
    /// Its content, for a simulation.
    fn stored(self) -> Result<StoredModel, FileError> {
        if !is_case_id(&self.case_id) {
            return Err(FileError::CaseId { found: self.case_id });
        }
        if self.absolute && self.gauge != KNOWN_FORCE {
            return Err(FileError::ModelAbsolute { gauge: self.gauge });
        }
        if self.joints.is_empty() || self.vertebrae.len() != self.joints.len() + 1 {
            let (vertebrae, joints) = (self.vertebrae.len(), self.joints.len());
            return Err(FileError::ModelShape { vertebrae, joints });
        }
        let levels: Vec<Level> = self.vertebrae.iter().map(|v| v.level).collect();
        if let Some(pair) = levels.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(FileError::ModelOrder { below: pair[0], above: pair[1] });
        }
        for (joint, pair) in self.joints.iter().zip(levels.windows(2)) {
            let (inferior, superior) = (joint.inferior, joint.superior);
            if [inferior, superior] != pair {
                let (lower, upper) = (pair[0], pair[1]);
                return Err(FileError::ModelJoint { inferior, superior, lower, upper });
            }
        }
        let curves = self.regions.as_deref().map(|records| places(records, &levels)).transpose()?;
        let midpoints_mm: Vec<Vec3> =
            self.vertebrae.iter().map(|v| Vec3::from(v.midpoint_mm)).collect();
        let axes: Vec<Mat3> =
            self.vertebrae.iter().map(|v| Mat3::from_columns(&v.axes.map(Vec3::from))).collect();
        for (&level, axes) in levels.iter().zip(&axes) {
            let departure = (axes.transpose() * axes - Mat3::identity()).abs().max();
            let right_handed = axes.determinant() > 0.0;
            if departure > AXES_TOLERANCE || !right_handed {
                return Err(FileError::ModelAxes { level, departure, right_handed });
            }
        }
        check_places(&levels, &midpoints_mm, &axes)?;
        let centres: Vec<Vec3> = self
            .joints
            .iter()
            .enumerate()
            .map(|(j, joint)| axes[j].transpose() * (Vec3::from(joint.centre_mm) - midpoints_mm[j]))
            .collect();
        let model = PersonalisedModel {
            case_id: self.case_id,
            synthetic: self.synthetic,
            line: self.line,
            absolute: self.absolute,
            carried_body_mass_kg: self.carried_body_mass_kg,
            levels,
            pitch_from: self.vertebrae.iter().map(|v| v.pitch_from).collect(),
            axial_from: self.vertebrae.iter().map(|v| v.axial_rotation_from).collect(),
            widths_mm: self.vertebrae.iter().map(|v| v.width_mm).collect(),
            spine: SpineModel::from_poses(midpoints_mm, axes, &centres),
            stiffness_nmm_per_rad: self
                .joints
                .iter()
                .map(|joint| joint.stiffness_nmm_per_rad)
                .collect(),
            stiffness: self.joints.iter().map(JointRecord::stiffness).collect(),
            curves,
            support: self.support,
            loads: self.loads,
            doubts: self.doubts,
        };
        Ok(StoredModel { model, provenance: self.provenance })
    }
}

/// Refuses vertebrae that do not lie cranial to each other, or at distances that no body has.
fn check_places(levels: &[Level], midpoints_mm: &[Vec3], axes: &[Mat3]) -> Result<(), FileError> {
    for i in 1..levels.len() {
        let (below, above) = (levels[i - 1], levels[i]);
        let cranial_mm = (midpoints_mm[i] - midpoints_mm[i - 1]).dot(&axes[i - 1].column(2));
        let way = Level::ALL.iter().filter(|level| (below..above).contains(level)).count();
        let [least_mm, most_mm] = NEIGHBOURS_MM.map(|mm| mm * way as f64);
        if !(least_mm..=most_mm).contains(&cranial_mm) {
            return Err(FileError::ModelPlace { below, above, cranial_mm });
        }
    }
    Ok(())
}
