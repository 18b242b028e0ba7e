//! Computations in the background.

use serde::{Deserialize, Serialize};
use spineline_report::document::Section;
use utoipa::ToSchema;

use super::Wire;

spineline::named! {
    /// A computation in the background.
    pub enum Computation {
        /// Intervals by landmark noise.
        Replicates = "replicates",
        /// How well the films determine each multiplier.
        Identifiability = "identifiability",
        /// Other loads and base supports beside the lines.
        Models = "models",
    }
}

/// A computation in the background.
pub type ComputationName = Wire<Computation>;

/// What is computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ComputationRequest {
    /// Number of replicates, 1 to 2000; only for replicates.
    pub count: Option<u64>,
}

/// Where a computation stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ComputationState {
    /// Not requested for the current results.
    None,
    /// It runs, or waits for another one.
    Running,
    /// All steps are done.
    Done,
    /// It was cancelled.
    Cancelled,
    /// It failed; the texts say why.
    Failed,
}

/// State and steps of a computation.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ProgressView {
    /// State.
    pub state: ComputationState,
    /// Steps that are done.
    pub done: u64,
    /// Number of steps.
    pub asked: u64,
    /// Results and failures as text.
    pub texts: Vec<String>,
}

/// A computation of the current results of a study.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ComputationView {
    /// What is computed.
    pub name: ComputationName,
    /// Its state, steps and texts.
    #[serde(flatten)]
    pub progress: ProgressView,
    /// Values with their intervals, where replicates are done.
    pub intervals: Vec<IntervalView>,
    /// Parts of the report, where it is done.
    pub sections: Vec<Section>,
}

/// A number of the analysis with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct IntervalView {
    /// What.
    pub label: String,
    /// Its value in the study itself.
    pub value: String,
    /// The central 95 % of the replicates.
    pub interval: String,
}
