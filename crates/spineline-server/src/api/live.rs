//! Results from landmarks: drawn over the film, and beside it.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{LineKindName, Notice, PostureName, SideName};

/// Which results the landmarks allow.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum LiveStatus {
    /// Vertebrae are missing: no curve.
    Partial,
    /// The film is measured; the study has the results that its films allow.
    Complete,
    /// Landmarks contradict each other.
    Refused,
}

/// Results from the current reading and the other films of its study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LiveView {
    /// Which results the landmarks allow.
    pub status: LiveStatus,
    /// Text, such as `12 of 15 vertebrae; T4, T3 and T2 are missing`.
    pub status_text: String,
    /// Drawing over this film.
    pub overlay: Option<FilmOverlay>,
    /// Heights of the vertebrae of the other one of the erect and the lateral film on this film; empty on other films,
    /// and while fewer than two vertebrae are marked on both.
    pub heights: Vec<HeightView>,
    /// Results of the whole study; absent while its erect film is not complete.
    pub study: Option<StudyFindings>,
    /// Model options that differ from the defaults; absent where none does.
    pub options_text: Option<String>,
    /// Warnings and contradictions, worst first.
    pub notices: Vec<Notice>,
}

/// The line on a film on which the midpoint of a vertebra of another film must lie.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct HeightView {
    /// Level, such as `T12`.
    pub level: String,
    /// End of the line at the first column.
    pub from_px: [f64; 2],
    /// End at the last column.
    pub to_px: [f64; 2],
    /// Standard deviation along the rows.
    pub sd_px: f64,
    /// Text, such as `T12 by the lateral film, ± 3.1 pixels`.
    pub text: String,
}

/// Lines and points over one film, in its pixels.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmOverlay {
    /// Posture of the film.
    pub posture: PostureName,
    /// Fitted curve, caudal end first.
    pub curve_px: Vec<[f64; 2]>,
    /// Order and residuals as text, such as `polynomial of order 7, RMSE 0.31 mm and 0.8°`.
    pub curve_text: String,
    /// Inflections of the erect curve; in other postures, the places of the same segments.
    pub inflections: Vec<LabelledPoint>,
    /// Places where inflections can be picked by hand, caudal first; only on the erect film.
    pub sites: Vec<SitePoint>,
    /// From each measured midpoint to the curve.
    pub residuals: Vec<Residual>,
    /// End vertebrae of the curves, with extended endplates and their angle.
    pub cobb: Vec<CobbOverlay>,
    /// Lines of action on this film.
    pub lines: Vec<LineOverlay>,
    /// Least-rotating segments of this posture.
    pub least_rotating: Vec<LabelledPoint>,
}

/// A place on the erect curve where an inflection can be picked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SitePoint {
    /// A vertebra, such as `T6`, or the disc between two, such as `L1/T12`, as the option `inflections` spells it.
    pub site: String,
    /// Place.
    pub px: [f64; 2],
}

/// A point with a name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LabelledPoint {
    /// Place.
    pub px: [f64; 2],
    /// Short label.
    pub label: String,
    /// Description, such as `inflection between L1 and T12`.
    pub text: String,
}

/// Distance of a vertebra from the curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Residual {
    /// Level.
    pub level: String,
    /// Measured midpoint.
    pub from_px: [f64; 2],
    /// Nearest point of the curve.
    pub to_px: [f64; 2],
    /// Distance with its unit as text.
    pub text: String,
    /// Whether the distance exceeds three standard deviations.
    pub is_outlier: bool,
}

/// A Cobb angle over a film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CobbOverlay {
    /// Name of the region.
    pub region: String,
    /// Line along the upper end vertebra.
    pub upper_px: [[f64; 2]; 2],
    /// Line along the lower end vertebra.
    pub lower_px: [[f64; 2]; 2],
    /// Place of the label.
    pub label_px: [f64; 2],
    /// Such as `48.2°`.
    pub label: String,
    /// Such as `main thoracic, T5–T12, Cobb angle 48.2°, convex to the patient's right`.
    pub text: String,
}

/// A line of action over a film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LineOverlay {
    /// Which line.
    pub kind: LineKindName,
    /// One end, on the edge of the film.
    pub from_px: [f64; 2],
    /// Other end.
    pub to_px: [f64; 2],
    /// Name and status as text.
    pub text: String,
    /// Whether its model converged on this film.
    pub converged: bool,
}

/// Clinical angles and rotations of the whole study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudyFindings {
    /// Curves with their angles per posture.
    pub curves: Vec<CurveFinding>,
    /// Lenke type as text, with missing films.
    pub lenke_text: String,
    /// Coronal balance as text.
    pub balance_text: String,
    /// Scales of the films against the erect film as text, where they are not fixed.
    pub film_scales_text: Option<String>,
    /// Rotations from the erect posture.
    pub rotations: Vec<RotationFinding>,
    /// Inflections of the erect curve as text.
    pub inflections_text: String,
    /// Unit and plane of lengths, such as `mm (patient)`.
    pub length_unit: String,
}

/// A clinical curve.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveFinding {
    /// Name of the region.
    pub region: String,
    /// Lower end vertebra, apex and upper end vertebra as text, such as `T12 – T8/T9 – T5`.
    pub levels_text: String,
    /// The patient's side to which it is convex.
    pub convex: Option<SideName>,
    /// Angles per posture.
    pub angles: Vec<CurveAnglesFinding>,
    /// Kind of the sizes: `Cobb angle` or `tilt range`.
    pub size_name: String,
    /// Flexibility as text, if there are bending films.
    pub flexibility_text: Option<String>,
}

/// Angles of a curve in one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveAnglesFinding {
    /// Posture.
    pub posture: PostureName,
    /// Cobb angle, or tilt range where corners are not known; none where this film lacks vertebrae of the erect film.
    pub size_deg: Option<f64>,
    /// Ferguson angle.
    pub ferguson_deg: f64,
}

/// Rotations of segments from erect to one posture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct RotationFinding {
    /// Posture.
    pub posture: PostureName,
    /// Mean over all segments.
    pub mean_deg: f64,
    /// Places along the erect chain from L4 in cranial direction, one per drawn segment; about 200 at most.
    pub along_mm: Vec<f64>,
    /// Rotation of each segment in 0.001°.
    pub rotation_mdeg: Vec<f64>,
    /// Least-rotating segments and the inflections beside them as text.
    pub texts: Vec<String>,
    /// Places of the inflection segments along the chain.
    pub inflections_mm: Vec<f64>,
    /// Places of the least-rotating segments along the chain.
    pub least_mm: Vec<f64>,
}
