//! Loads that users put on a model.

use serde::{Deserialize, Serialize};
use spineline_report::document::Table;
use utoipa::ToSchema;

use super::{FileLoad, LevelError, Notice, PostureName, ProgressView, Shape, SideName};

/// Loads that are possible on the model of one line of action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadMenu {
    /// Unit of forces: `N`, or a text that warns where only ratios are known.
    pub force_unit: String,
    /// The same in short, for fields.
    pub force_symbol: String,
    /// Levels that carry loads, the lowest one first; the base below them is fixed.
    pub levels: Vec<String>,
    /// Kinds of loads, with an example of each.
    pub kinds: Vec<LoadKind>,
    /// Forces that the analysis found for films.
    pub films: Vec<FilmForce>,
    /// Directions in the patient's terms.
    pub directions: Vec<NamedDirection>,
    /// Purpose of the numbers, and parts that the model lacks.
    pub limits: Vec<String>,
}

/// A kind of load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadKind {
    /// Its name for people.
    pub label: String,
    /// What it does.
    pub text: String,
    /// An example to start from.
    pub example: FileLoad,
}

/// The force of a film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmForce {
    /// Posture.
    pub posture: PostureName,
    /// It as a load.
    pub load: FileLoad,
    /// Why it is doubtful, where it is.
    pub doubt: Option<String>,
}

/// A direction.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NamedDirection {
    /// Such as `left`: the patient's.
    pub name: String,
    /// Unit vector.
    #[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
    pub vector: [f64; 3],
}

/// The model under loads.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct LoadedModel {
    /// Each load as text.
    pub loads: Vec<String>,
    /// Why loads cannot be applied; then nothing is simulated.
    pub faults: Vec<LoadFaultView>,
    /// The simulation.
    pub simulation: Option<LoadedView>,
}

/// Why a load cannot be applied.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LoadFaultView {
    /// Which load, from 0.
    pub load: usize,
    /// Why, and what to do.
    pub text: String,
}

/// A model under loads.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct LoadedView {
    /// Whether there is a result.
    pub converged: bool,
    /// The ending by name with its meaning, the shape nearest to the target if the loads have no result, and events on
    /// the path.
    pub texts: Vec<String>,
    /// Angles before and after; without rows if the loads have no result.
    pub angles: Table,
    /// Forces and moments on the vertebrae.
    pub forces: Table,
    /// Other numbers of the result.
    pub numbers: Table,
    /// Every shape that meets the target, where several exist or the loads have no result.
    pub solutions: Table,
    /// Warnings.
    pub notices: Vec<Notice>,
    /// Shapes on the path, the erect one first; the last one is the result, if any.
    pub steps: Vec<LoadStep>,
    /// The result beside other films; empty without a result.
    pub films: Vec<FilmComparison>,
}

/// A shape on the path of the loads.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadStep {
    /// Part of the loads, such as `45 % of the proportional loads`.
    pub label: String,
    /// The largest curve and the lateral tilt.
    pub text: String,
    /// The spine.
    pub shape: Shape,
    /// Forces on it.
    pub arrows: Vec<LoadArrow>,
}

/// A force or moment in space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LoadArrow {
    /// Which load, from 0.
    pub load: usize,
    /// Where it acts.
    #[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
    pub point_mm: [f64; 3],
    /// Force, or moment.
    #[schema(value_type = Vec<f64>, min_items = 3, max_items = 3)]
    pub vector: [f64; 3],
    /// Whether it is a moment.
    pub is_moment: bool,
    /// Length of the drawn arrow over the length of the strongest one; 0 for moments.
    pub part: f64,
}

/// A result beside another film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmComparison {
    /// The film.
    pub posture: PostureName,
    /// Mean distance of the midpoints.
    pub mean_mm: f64,
    /// Distance per level.
    pub errors: Vec<LevelError>,
}

/// Pads to be tried.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PadMapRequest {
    /// Largest force, in the units of the model.
    pub largest_force: f64,
    /// Stiffness of the pads, in these units per mm.
    #[serde(rename = "force_per_mm")]
    pub n_per_mm: f64,
    /// The other loads on the spine during each trial.
    #[serde(default)]
    pub beside: Vec<FileLoad>,
}

/// Request for intervals of a model under loads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadIntervalRequest {
    /// Number of replicates, 1 to 2000.
    pub count: u64,
    /// The text of the load file.
    pub file: String,
}

/// 95 % intervals of a model under loads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LoadIntervalsView {
    /// Its steps are replicates; the texts give their number, failures, and coverage of the intervals.
    #[serde(flatten)]
    pub progress: ProgressView,
    /// The text of their load file, as it was sent: they are not valid for other loads.
    pub file: String,
    /// Intervals of the table of angles, where they are done.
    pub rows: Vec<LoadIntervalRow>,
}

/// Intervals of one row of the table of angles.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct LoadIntervalRow {
    /// First cell of the row in the table.
    pub label: String,
    /// Interval for each other cell; may be empty.
    pub intervals: Vec<String>,
}

/// Effect of one pad at every level and towards both sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PadMapView {
    /// Its steps are pads; the texts are a summary, and failures.
    #[serde(flatten)]
    pub progress: ProgressView,
    /// Largest requested force.
    pub largest_force: Option<f64>,
    /// Columns, where it is done.
    pub columns: Vec<PadMapColumn>,
    /// Rows, the uppermost level first.
    pub rows: Vec<PadMapRow>,
}

/// Direction and force of a column.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PadMapColumn {
    /// Side to which the pads push.
    pub towards: SideName,
    /// Force as text.
    pub force: String,
}

/// A level.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PadMapRow {
    /// Level.
    pub level: String,
    /// One cell per column.
    pub cells: Vec<PadMapCell>,
}

/// What one pad does.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PadMapCell {
    /// Change of the largest curve, or the name of the ending without a result.
    pub text: String,
    /// The pad and both angles, or why the pad has no result.
    pub title: String,
    /// Change over the largest change of the map, from -1 (correction) to 1; `None` without a result.
    pub part: Option<f64>,
    /// The pad as a load.
    pub load: Option<FileLoad>,
}
