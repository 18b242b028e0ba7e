//! The erect spine in space.

use spineline::anatomy::Level;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::analysis::{Analysis, TemplateError};
use spineline::clinical::SpatialNumber;
use spineline::measure::{
    AxialRotation, FilmAlignment, LengthScale, SpatialOutline, SpatialVertebra,
};
use spineline::spatial::Angle;

/// The erect spine from the erect and the lateral film together. `2d` is as a film shows it, `3d` is in space.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct SpaceRecord {
    alignment: AlignmentRecord,
    /// Standard deviation of a coordinate of a corner on the lateral film; absent where the erect film has no spacing.
    corner_sd_mm: Option<f64>,
    /// Where it comes from: how `readings` differ, or `assumed` for one careful reading.
    corner_sd_from: String,
    /// Vertebrae on both films.
    vertebrae: BTreeMap<Level, VertebraRecord>,
    /// Kyphosis, lordosis, planes of maximum curvature and length, each named 2-D (one film) or 3-D (in space).
    measures: Vec<MeasureRecord>,
    /// The profile that a model without the lateral film has, against the measured one.
    #[serde(skip_serializing_if = "Option::is_none")]
    template: Option<TemplateRecord>,
}

/// The profile of a population less the measured one, over the vertebrae of the model that the lateral film shows.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct TemplateRecord {
    /// Joints between two such vertebrae.
    joints: usize,
    /// Root mean square of the differences of turn at these joints.
    joint_rms_deg: f64,
    /// Root mean square of the differences of pitch.
    vertebra_rms_deg: f64,
    /// Root mean square of the differences of depth; absent where the erect film has no spacing.
    depth_rms_mm: Option<f64>,
    /// Pitch of every vertebra by the profile of the population; flexion positive.
    pitch_deg: BTreeMap<Level, f64>,
}

impl TemplateRecord {
    fn new(found: &TemplateError, scale: &LengthScale) -> Self {
        let vertebrae = found.vertebrae.iter();
        Self {
            joints: found.joints,
            joint_rms_deg: found.joint_rms.deg(),
            vertebra_rms_deg: found.vertebra_rms.deg(),
            depth_rms_mm: scale.mm(found.depth_rms_mm),
            pitch_deg: vertebrae.map(|v| (v.level, v.template.deg())).collect(),
        }
    }
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct MeasureRecord {
    /// Such as `kyphosis_t5_t12_axes`, `curve_largest` or `spinal_length`.
    quantity: String,
    /// Vertebrae between which it is measured, the upper one first.
    between: String,
    /// Region of a curve.
    #[serde(skip_serializing_if = "Option::is_none")]
    region: Option<String>,
    /// `2-D` or `3-D`.
    dimension: String,
    /// `deg`, `mm`, or `px` where the erect film has no spacing.
    unit: String,
    value: f64,
    sd: f64,
    interval_95: [f64; 2],
}

impl MeasureRecord {
    fn new(number: &SpatialNumber) -> Self {
        Self {
            quantity: number.key.to_owned(),
            between: number.between.clone(),
            region: number.region.map(|region| region.key().to_owned()),
            dimension: number.dimension.key().to_owned(),
            unit: number.unit.to_owned(),
            value: number.value,
            sd: number.sd,
            interval_95: number.interval_95(),
        }
    }
}

/// The lateral film against the erect one, from the heights of the vertebrae on both.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct AlignmentRecord {
    /// Whether both films were exposed together, so that nothing but a missing scale was estimated.
    simultaneous: bool,
    /// Length unit of the erect film for one of the lateral film.
    scale: f64,
    scale_relative_sd: f64,
    /// Turn of the lateral film in its plane; positive where the spine looks more flexed than it is.
    turn_deg: f64,
    turn_sd_deg: f64,
    /// Root mean square of the remaining differences of height; absent where the erect film has no spacing.
    residual_mm: Option<f64>,
    /// Its expected value by the noise of the landmarks.
    expected_mm: Option<f64>,
    vertebrae: usize,
}

/// One vertebra by the line through the centres of both endplates.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct VertebraRecord {
    /// From the lowest vertebra on both films: anterior, left, cranial by the vertical of the films; absent where the erect film has no
    /// spacing.
    place_mm: Option<[f64; 3]>,
    /// Against the vertical of the erect film; positive to the patient's right.
    tilt_2d_deg: f64,
    tilt_2d_sd_deg: f64,
    /// On the lateral film, corrected for its turn; flexion positive.
    pitch_2d_deg: f64,
    /// In space; flexion positive.
    pitch_3d_deg: f64,
    pitch_3d_sd_deg: f64,
}

impl SpaceRecord {
    /// `None` without a lateral film.
    pub fn new(analysis: &Analysis) -> Option<Self> {
        let movement = &analysis.movement;
        let found = movement.space.as_ref()?;
        let mm = |mm: f64| movement.scale().mm(mm);
        let vertebrae = found.vertebrae.iter();
        let record = |vertebra: &SpatialVertebra| {
            let place_mm = mm(0.0).map(|_| vertebra.place_mm.into());
            (vertebra.level, VertebraRecord::new(found, vertebra, place_mm))
        };
        Some(Self {
            alignment: AlignmentRecord::new(&found.alignment, mm),
            corner_sd_mm: mm(found.corner_sd_mm),
            corner_sd_from: if found.is_measured { "readings" } else { "assumed" }.to_owned(),
            vertebrae: vertebrae.map(record).collect(),
            measures: movement
                .spatial_measures()?
                .numbers(movement.scale())
                .iter()
                .map(MeasureRecord::new)
                .collect(),
            template: analysis
                .template_error()
                .map(|error| TemplateRecord::new(&error, movement.scale())),
        })
    }
}

impl AlignmentRecord {
    fn new(found: &FilmAlignment, mm: impl Fn(f64) -> Option<f64>) -> Self {
        Self {
            simultaneous: found.simultaneous,
            scale: found.scale,
            scale_relative_sd: found.relative_scale_sd(),
            turn_deg: found.turn.deg(),
            turn_sd_deg: found.turn_sd().deg(),
            residual_mm: mm(found.residual_mm),
            expected_mm: mm(found.expected_mm),
            vertebrae: found.vertebrae,
        }
    }
}

impl VertebraRecord {
    fn new(space: &SpatialOutline, vertebra: &SpatialVertebra, place_mm: Option<[f64; 3]>) -> Self {
        Self {
            place_mm,
            tilt_2d_deg: vertebra.orientation.tilt.deg(),
            tilt_2d_sd_deg: vertebra.tilt_sd.deg(),
            pitch_2d_deg: vertebra.lateral_pitch.deg(),
            pitch_3d_deg: vertebra.orientation.pitch.deg(),
            pitch_3d_sd_deg: space.pitch_sd(vertebra).deg(),
        }
    }
}

/// Axial rotation of a vertebra from its pedicles on the erect film.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct AxialRecord {
    /// After Stokes; positive where its front turns to the patient's left.
    axial_3d_deg: f64,
    axial_3d_sd_deg: f64,
    /// After Drerup.
    drerup_deg: Option<f64>,
    /// Grade of Nash and Moe: `0` to `IV`.
    nash_moe: String,
    readings: usize,
}

impl AxialRecord {
    pub fn new(found: &AxialRotation) -> (Level, Self) {
        let record = Self {
            axial_3d_deg: found.stokes.deg(),
            axial_3d_sd_deg: found.sd.deg(),
            drerup_deg: found.drerup.map(Angle::deg),
            nash_moe: found.grade.key().to_owned(),
            readings: found.readings,
        };
        (found.level, record)
    }
}
