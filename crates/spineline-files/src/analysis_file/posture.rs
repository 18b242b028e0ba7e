use spineline::anatomy::Level;
use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::Serialize;
use spineline::analysis::{BestFitLine, FilmMovement, LineComparison};
use spineline::curve::CurveFit;
use spineline::measure::{
    FilmLength, FilmScale, Interpolation, LengthScale, MeasuredVertebra, Origin, SpacingSource,
    VertebraOrigin,
};
use spineline::motion::SegmentEstimate;
use spineline::personalize::{Crossing, LineTest};
use spineline::spatial::{Angle, Frontal};

use super::points::{by_level, point_mm, point_px};
use crate::text::finite;

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(super) struct PostureRecord {
    lengths: LengthsRecord,
    curve: CurveRecord,
    /// Segments of the chain on this curve: the paper's n_i.
    segments: usize,
    /// Length of the curve above the last joint.
    leftover_mm: Option<f64>,
    /// Absent where the film has no spacing.
    locations_mm: Option<BTreeMap<Level, [f64; 2]>>,
    /// From L4's midpoint in the same directions, where the film has no spacing.
    locations_px: Option<BTreeMap<Level, [f64; 2]>>,
    tilts_deg: BTreeMap<Level, f64>,
    /// Vertebrae that this film does not show: their locations and tilts are interpolated, and take no part in fits and
    /// location errors. Absent where all are marked.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    interpolated: BTreeMap<Level, InterpolatedRecord>,
    /// How the corners of vertebrae came about that a person did not click in all readings: `completed`, `detected`, `accepted`,
    /// `adjusted`, or `mixed` where corners or readings differ; the case has the origin of each corner. Absent where all were
    /// clicked.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    origins: BTreeMap<Level, String>,
    /// Lateral tilt of the line between two vertebrae against the normal of the iliac line, or L4's axis.
    amplitude_deg: f64,
    /// These vertebrae, the lower one first.
    amplitude_between: [Level; 2],
    noise: NoiseRecord,
    /// Mean rotation of the segments from the erect posture.
    mean_rotation_deg: Option<f64>,
    /// Where the two inflection segments lie.
    inflection_mm: Option<[[f64; 2]; 2]>,
    /// The same in pixels, where the film has no spacing.
    inflection_px: Option<[[f64; 2]; 2]>,
    /// The inflection segments against the least-rotating ones, caudal first.
    inflection_estimates: Option<[EstimateRecord; 2]>,
    /// MMS_Mean against the least-rotating ones.
    mean_least_estimates: Option<[EstimateRecord; 2]>,
    /// The line of best fit to the rotations, with tests of the line through the inflections.
    best_fit_line: Option<BestFitLineRecord>,
}

/// Scale of a film's lengths. An error of scale changes all of them by the same factor, and no angle.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LengthsRecord {
    /// `patient`, `detector`, `unknown` (millimetres of an unknown plane) or `pixels`.
    plane: String,
    /// Source of the spacing.
    source: Option<SpacingSource>,
    /// Standard deviation of the scale, as a part of it.
    relative_sd: Option<f64>,
    /// This film against the erect one; absent for the erect film, and where one of the two has no spacing.
    #[serde(skip_serializing_if = "Option::is_none")]
    against_erect: Option<FilmLengthRecord>,
    /// Length of the line through the midpoints L4 to T2, and its standard deviation from the scale alone.
    spine_mm: Option<f64>,
    spine_scale_sd_mm: Option<f64>,
}

/// The length of the spine on a film over its length on the erect film. Locations of the film are divided by `scale`.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct FilmLengthRecord {
    /// From the locations alone.
    measured: f64,
    /// Standard deviation of its logarithm before the film is measured; 0 where the scale is fixed at 1.
    prior_log_sd: f64,
    #[serde(flatten)]
    scale: ScaleRecord,
}

/// A film's scale against the erect film.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct ScaleRecord {
    scale: f64,
    /// Its 95 % interval; absent where the scale is fixed.
    #[serde(skip_serializing_if = "Option::is_none")]
    scale_interval_95: Option<[f64; 2]>,
}

impl From<FilmScale> for ScaleRecord {
    fn from(found: FilmScale) -> Self {
        let interval = found.interval_95();
        Self { scale: found.factor, scale_interval_95: (found.log_sd > 0.0).then_some(interval) }
    }
}

/// From what a vertebra was interpolated, and its standard deviations.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct InterpolatedRecord {
    /// The next marked vertebrae below and above.
    between: [Level; 2],
    /// Of a coordinate of the location.
    location_sd_mm: Option<f64>,
    location_sd_px: Option<f64>,
    tilt_sd_deg: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct CurveRecord {
    order: usize,
    /// `graph` (y of z) or `parametric`.
    form: String,
    rmse_mm: Option<f64>,
    rmse_px: Option<f64>,
    rmse_deg: f64,
    /// Root mean square error on vertebrae left out of the fit, in standard deviations.
    left_out: f64,
}

/// Standard deviation of a measured value.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct NoiseRecord {
    location_mm: Option<f64>,
    location_px: Option<f64>,
    tilt_deg: f64,
    /// From the standard deviation of readings; else assumed for one careful reading.
    measured: bool,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct EstimateRecord {
    segment: usize,
    least_segment: usize,
    distance_segments: usize,
    distance_mm: Option<f64>,
    rotation_deg: f64,
}

/// The line of best fit to the film's rotations.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BestFitLineRecord {
    point_mm: [f64; 2],
    /// Cranial.
    direction: [f64; 2],
    /// At the heights of the inflections; without inflections, of L4 and T2.
    crossings: [CrossingRecord; 2],
    /// Against the line through the inflections.
    inflection_line: Option<LineComparisonRecord>,
    /// Of "it is parallel to the iliac line"; `null` where no crests are marked.
    parallel_to_iliac_line: Option<LineTest>,
    /// Against the line that was given for this film.
    given_line: Option<LineComparisonRecord>,
    /// Deviation of ln stiffness among the joints of a region, from all films together.
    joint_log_sd: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct CrossingRecord {
    z_mm: f64,
    /// To the patient's left.
    y_mm: Option<f64>,
    /// With 95 % confidence; `null` where the line may cross anywhere.
    interval_95_mm: Option<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct LineComparisonRecord {
    angle_deg: f64,
    /// From the middle of the two inflections, or from the point of a given line nearest to it.
    distance_mm: f64,
    /// Of "it runs through both inflections", or "it is the given line".
    test: LineTest,
}

impl BestFitLineRecord {
    fn new(found: &BestFitLine) -> Self {
        Self {
            point_mm: [found.line.point.y_mm, found.line.point.z_mm],
            direction: [found.line.direction.y_mm, found.line.direction.z_mm],
            crossings: found.crossings.map(|at| CrossingRecord {
                z_mm: at.z_mm,
                y_mm: finite(at.y_mm),
                interval_95_mm: match at.within {
                    Crossing::Between(ends) => Some(ends),
                    Crossing::Open => None,
                },
            }),
            inflection_line: found.inflection.map(LineComparisonRecord::new),
            parallel_to_iliac_line: found.iliac.map(|c| c.test),
            given_line: found.given.map(LineComparisonRecord::new),
            joint_log_sd: found.joint_log_sd,
        }
    }
}

fn against_erect(length: &FilmLength) -> FilmLengthRecord {
    FilmLengthRecord {
        measured: length.measured.factor,
        prior_log_sd: length.prior_log_sd,
        scale: length.scale.into(),
    }
}

impl LineComparisonRecord {
    fn new(found: LineComparison) -> Self {
        Self { angle_deg: found.angle.deg(), distance_mm: found.distance_mm, test: found.test }
    }
}

impl CurveRecord {
    fn new(fit: &CurveFit, scale: &LengthScale) -> Self {
        Self {
            order: fit.order,
            form: fit.curve.form().key().to_owned(),
            rmse_mm: scale.mm(fit.rmse_mm),
            rmse_px: scale.px(fit.rmse_mm),
            rmse_deg: fit.rmse_tilt.deg(),
            left_out: fit.left_out,
        }
    }
}

impl InterpolatedRecord {
    fn new(found: &Interpolation, scale: &LengthScale) -> Self {
        Self {
            between: found.between,
            location_sd_mm: scale.mm(found.location_sd_mm),
            location_sd_px: scale.px(found.location_sd_mm),
            tilt_sd_deg: found.tilt_sd.deg(),
        }
    }
}

impl EstimateRecord {
    fn new(estimate: &SegmentEstimate, erect: &LengthScale) -> Self {
        Self {
            segment: estimate.segment,
            least_segment: estimate.least,
            distance_segments: estimate.distance_segments,
            distance_mm: erect.mm(estimate.distance_mm),
            rotation_deg: estimate.rotation.deg(),
        }
    }
}

/// The origin of a vertebra that was not clicked.
fn origin(vertebra: &MeasuredVertebra) -> Option<(Level, String)> {
    let origin = vertebra.origin?;
    let is_clicked = origin == VertebraOrigin::Alike(Origin::Clicked);
    (!is_clicked).then(|| (vertebra.level, origin.key().to_owned()))
}

impl PostureRecord {
    /// The record of a posture; distances between segments are measured on the erect film, in its scale.
    pub fn new(p: &FilmMovement, erect: &LengthScale) -> Self {
        let scale = &p.outline.scale;
        let spine_mm = p.outline.polygon_mm();
        let levels = p.outline.levels().as_slice();
        let points = |convert: fn(&LengthScale, Frontal) -> Option<[f64; 2]>| {
            let points: Option<Vec<_>> = p.outline.locations().map(|l| convert(scale, l)).collect();
            points.map(|points| by_level(points.into_iter(), levels))
        };
        let inflections = |convert: fn(&LengthScale, Frontal) -> Option<[f64; 2]>| {
            let [caudal, cranial] = p.inflection_points?;
            Some([convert(scale, caudal)?, convert(scale, cranial)?])
        };
        let vertebrae = &p.outline.vertebrae;
        let interpolated = |(vertebra, found): (&MeasuredVertebra, &Interpolation)| {
            (vertebra.level, InterpolatedRecord::new(found, scale))
        };
        let estimates = |all: Option<[SegmentEstimate; 2]>| {
            all.map(|pair| pair.map(|estimate| EstimateRecord::new(&estimate, erect)))
        };
        Self {
            lengths: LengthsRecord {
                plane: scale.plane.key().to_owned(),
                source: scale.source,
                relative_sd: scale.relative_sd,
                against_erect: (p.motion.is_some()
                    && scale.has_millimetres()
                    && erect.has_millimetres())
                .then(|| against_erect(&p.outline.length)),
                spine_mm: scale.mm(spine_mm),
                spine_scale_sd_mm: scale.sd_mm(spine_mm),
            },
            curve: CurveRecord::new(&p.fit, scale),
            segments: p.pose.segments(),
            leftover_mm: scale.mm(p.pose.leftover_mm),
            locations_mm: points(point_mm),
            locations_px: points(point_px),
            tilts_deg: by_level(vertebrae.iter().map(|v| v.tilt.deg()), levels),
            interpolated: p.outline.interpolated().map(interpolated).collect(),
            origins: vertebrae.iter().filter_map(origin).collect(),
            amplitude_deg: p.outline.amplitude().deg(),
            amplitude_between: p.outline.amplitude_levels(),
            noise: NoiseRecord {
                location_mm: scale.mm(p.outline.noise.location_mm),
                location_px: scale.px(p.outline.noise.location_mm),
                tilt_deg: p.outline.noise.tilt.deg(),
                measured: p.outline.noise.is_measured(),
            },
            mean_rotation_deg: p.mean_rotation().map(Angle::deg),
            inflection_mm: inflections(point_mm),
            inflection_px: inflections(point_px),
            inflection_estimates: estimates(p.inflection_estimates),
            mean_least_estimates: estimates(p.mean_least_estimates),
            best_fit_line: p.best_fit_line.as_ref().map(BestFitLineRecord::new),
        }
    }
}
