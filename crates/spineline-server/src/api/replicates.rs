//! Replicates of a study with perturbed landmarks.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// How many replicates are computed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReplicatesRequest {
    /// Number of replicates, 1 to 2000.
    pub count: u64,
}

/// Where the computation stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ReplicatesState {
    /// Nobody has asked for the current landmarks.
    None,
    /// It runs, or waits for that of another study.
    Running,
    /// All replicates are computed.
    Done,
    /// It was cancelled.
    Cancelled,
    /// It failed; the texts say why.
    Failed,
}

/// Replicates of the current results of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReplicatesView {
    /// State.
    pub state: ReplicatesState,
    /// Replicates that are computed.
    pub done: u64,
    /// Replicates that were asked for.
    pub asked: u64,
    /// Values with their intervals, where it is done.
    pub intervals: Vec<IntervalView>,
    /// What was perturbed, and what failed.
    pub texts: Vec<String>,
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
