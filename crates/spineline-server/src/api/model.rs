//! The personalised model in three dimensions.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{LineName, Notice, PostureName};

/// Models of one study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ModelView {
    /// Study.
    pub study: String,
    /// Whether films are made up.
    pub synthetic: bool,
    /// Where the sagittal profile comes from, in words.
    pub profile_text: String,
    /// What forces and stiffness mean, such as `only ratios are known: …`.
    pub gauge_text: String,
    /// What lengths are measured in, such as `patient mm`.
    pub length_unit: String,
    /// Sizes of the vertebral bodies, L4 to T2.
    pub bodies: Vec<BodySize>,
    /// The unloaded spine.
    pub erect: Shape,
    /// The spine as measured on other films; its sagittal places are the erect ones, carried along.
    pub measured: Vec<MeasuredShape>,
    /// One model per line of action; those without result say why in the notices.
    pub lines: Vec<LineModelView>,
    /// The lines compared, in plain words.
    pub verdict: Vec<String>,
    /// Warnings and contradictions, worst first.
    pub notices: Vec<Notice>,
}

/// A vertebral body, to be drawn.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BodySize {
    /// Level.
    pub level: String,
    /// Left to right.
    pub width_mm: f64,
    /// Front to back.
    pub depth_mm: f64,
    /// Caudal to cranial.
    pub height_mm: f64,
}

/// A shape of the spine: one entry per vertebra, L4 to T2.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Shape {
    /// Midpoints of the bodies, `[x, y, z]`.
    pub midpoints_mm: Vec<[f64; 3]>,
    /// Rotation of each body, row by row: columns are its anterior, left and cranial axes in the global frame.
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

/// What is known of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Identified {
    /// Absolutely.
    Identified,
    /// As a ratio to the others.
    RatioOnly,
    /// The fit ended at a bound.
    Bound,
    /// The joints behind it turn against the force: no positive stiffness explains them.
    Contradicted,
    /// The fit did not converge.
    NotConverged,
}

/// The model for one line of action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LineModelView {
    /// Which line.
    pub kind: LineName,
    /// In words.
    pub label: String,
    /// Whether fit and simulations converged.
    pub converged: bool,
    /// How the fit ended, in words.
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
    /// Region or joint in words.
    pub label: String,
    /// Factor on the library's lateral stiffness.
    pub factor: f64,
    /// What is known of it.
    pub identified: Identified,
    /// Why, in words.
    pub text: String,
}

/// A joint.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JointView {
    /// Such as `T12/T11`, the lower vertebra first.
    pub label: String,
    /// Lateral spring against the softest and the stiffest of all models' joints on a logarithmic scale, 0 to 1: for colour.
    pub relative: f64,
    /// Lateral, flexion and axial stiffness in words with their unit and what they mean under the gauge.
    pub text: String,
    /// Films on which it turns against the force.
    pub contradicted_in: Vec<PostureName>,
}

/// A simulated film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SimulatedPosture {
    /// Posture.
    pub posture: PostureName,
    /// Whether stiffness was fitted to this film; else it was held out.
    pub fitted: bool,
    /// Whether the simulation may be shown as a result.
    pub converged: bool,
    /// How it ended, in words with the residual.
    pub status_text: String,
    /// The force in words.
    pub force_text: String,
    /// A point of the line of action.
    pub line_point_mm: [f64; 3],
    /// Along the force, of length 1.
    pub line_direction: [f64; 3],
    /// Shapes under equal parts of the force, from none to all of it: the erect one first, the simulated one last.
    pub path: Vec<Shape>,
    /// Distance between simulated and measured midpoints per level.
    pub errors: Vec<LevelError>,
    /// Their mean.
    pub mean_error_mm: Option<f64>,
    /// Joints that turn against the force, in words.
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

/// A load dragged by hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadRequest {
    /// Which model's springs.
    pub kind: LineName,
    /// Vertebra on whose midpoint the force acts; it moves with it and keeps its direction.
    pub level: String,
    /// Tip of the arrow that is dragged, `[x, y, z]`: from the vertebra's erect midpoint to here, 1 mm for 1 N.
    #[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
    pub tip_mm: [f64; 3],
}

/// The equilibrium under a dragged load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadAnswer {
    /// Whether the shape is an equilibrium.
    pub converged: bool,
    /// How the solver ended, in words.
    pub status_text: String,
    /// The load in words.
    pub load_text: String,
    /// Part of the load up to which there is an equilibrium: 1 where it converged.
    pub part: f64,
    /// The shape under that part of the load.
    pub shape: Shape,
    /// Largest displacement and change of the largest curve in words.
    pub texts: Vec<String>,
}
