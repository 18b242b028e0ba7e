//! The personalised model in 3D.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{LineKindName, Notice, PitchSourceName, PostureName};

/// Models of one study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ModelView {
    /// Study.
    pub study: String,
    /// Whether films are synthetic.
    pub synthetic: bool,
    /// Source of the sagittal profile as text.
    pub profile_text: String,
    /// Meaning of forces and stiffness, such as `only ratios are known: …`.
    pub gauge_text: String,
    /// Model options that differ from the defaults; absent where none does.
    pub options_text: Option<String>,
    /// Unit and plane of lengths, such as `mm (patient)`.
    pub length_unit: String,
    /// Sizes of the vertebral bodies, L4 to T2.
    pub bodies: Vec<BodySize>,
    /// Where pitch and depth of each vertebra come from, L4 to T2.
    pub pitch_from: Vec<PitchSourceName>,
    /// The unloaded spine.
    pub erect: Shape,
    /// The spine as measured on other films; sagittal coordinates are from the erect film.
    pub measured: Vec<MeasuredShape>,
    /// One model per line of action; the notices explain a missing result.
    pub lines: Vec<LineModelView>,
    /// Unit of a load's force: `N` where a force was measured, else `rel. units`.
    pub force_symbol: String,
    /// One of this unit, in words.
    pub force_unit_text: String,
    /// The line that predicts unfitted films best, or else the first one with a result.
    pub automatic: Option<LineKindName>,
    /// Why, as text.
    pub automatic_text: Option<String>,
    /// Comparison of the lines as text.
    pub verdict: Vec<String>,
    /// Warnings and contradictions, worst first.
    pub notices: Vec<Notice>,
}

/// Size of a vertebral body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BodySize {
    /// Level.
    pub level: String,
    /// Width, left to right.
    pub width_mm: f64,
    /// Depth, anterior to posterior.
    pub depth_mm: f64,
    /// Height, caudal to cranial.
    pub height_mm: f64,
}

/// A shape of the spine: one entry per vertebra, L4 to T2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Shape {
    /// Midpoints of the bodies, `[x, y, z]`.
    pub midpoints_mm: Vec<[f64; 3]>,
    /// Rotation matrix of each body by rows; its columns are its anterior, left and cranial axes in the global frame.
    pub rotations: Vec<[f64; 9]>,
    /// Joint centres, from L4/L3 to T3/T2.
    pub joints_mm: Vec<[f64; 3]>,
}

/// A measured shape.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MeasuredShape {
    /// Posture.
    pub posture: PostureName,
    /// Shape.
    pub shape: Shape,
}

/// How the fit of a multiplier ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Identified {
    /// An absolute value.
    Absolute,
    /// A ratio to the others.
    RatioOnly,
    /// It ended at a bound, or all others did.
    Bound,
    /// Its joints are counter-rotating: no positive stiffness explains them.
    Contradicted,
    /// The fit did not converge.
    NotConverged,
}

/// The model for one line of action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LineModelView {
    /// Which line.
    pub kind: LineKindName,
    /// Name as text.
    pub label: String,
    /// Whether fit and simulations converged.
    pub converged: bool,
    /// Status of the fit as text.
    pub status_text: String,
    /// Multipliers of the lateral springs.
    pub multipliers: Vec<MultiplierView>,
    /// Springs, from L4/L3 to T3/T2.
    pub joints: Vec<JointView>,
    /// Simulated films.
    pub postures: Vec<SimulatedPosture>,
    /// Mean location error over the fitted films.
    pub fitted_error_mm: Option<f64>,
    /// Mean location error over the held-out films.
    pub held_out_error_mm: Option<f64>,
}

/// A stiffness multiplier.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MultiplierView {
    /// Name of the region or joint.
    pub label: String,
    /// Factor on the nominal lateral stiffness.
    pub factor: f64,
    /// How its fit ended.
    pub identified: Identified,
    /// Reason as text.
    pub text: String,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JointView {
    /// Such as `T12/T11`, the lower vertebra first.
    pub label: String,
    /// Lateral stiffness for the colour scale: 0 for the softest and 1 for the stiffest joint of all models, logarithmic.
    pub relative: f64,
    /// Lateral, flexion and axial stiffness as text, with unit and scale constraint.
    pub text: String,
    /// Films on which it is counter-rotating.
    pub contradicted_in: Vec<PostureName>,
}

/// A simulated film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SimulatedPosture {
    /// Posture.
    pub posture: PostureName,
    /// Whether the film is fitted; else it is held out.
    pub fitted: bool,
    /// Whether the simulation may be shown as a result.
    pub converged: bool,
    /// Status and residual as text.
    pub status_text: String,
    /// The force as text.
    pub force_text: String,
    /// A point of the line of action.
    pub line_point_mm: [f64; 3],
    /// Unit vector along the force.
    pub line_direction: [f64; 3],
    /// Shapes at equal steps of the load factor from 0 to 1: the erect shape first, the simulated one last.
    pub path: Vec<Shape>,
    /// Distance between simulated and measured midpoints per level.
    pub errors: Vec<LevelError>,
    /// Mean of these distances.
    pub mean_error_mm: Option<f64>,
    /// Counter-rotating joints as text.
    pub contradictions: Vec<String>,
}

/// A location error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LevelError {
    /// Level.
    pub level: String,
    /// Distance.
    pub error_mm: f64,
}

/// A load by hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadRequest {
    /// Line of action whose springs are used.
    pub kind: LineKindName,
    /// Vertebra at whose midpoint the force acts; the force keeps its direction.
    pub level: String,
    /// Tip of the dragged arrow, `[x, y, z]`: from the vertebra's erect midpoint to here, 1 mm for 1 N.
    #[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
    pub tip_mm: [f64; 3],
}

/// Response to a load by hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadAnswer {
    /// Whether the shape is an equilibrium.
    pub converged: bool,
    /// Status of the solver as text.
    pub status_text: String,
    /// The load as text.
    pub load_text: String,
    /// Largest load factor with an equilibrium: 1 if it converged.
    pub part: f64,
    /// The shape at that load factor.
    pub shape: Shape,
    /// Largest displacement and change of the largest curve as text.
    pub texts: Vec<String>,
}
