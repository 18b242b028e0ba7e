//! Computations in the background, and parts of the report.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// A computation in the background.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ComputationName {
    /// Intervals by landmark noise.
    Replicates,
    /// How well the films determine each multiplier.
    Identifiability,
    /// Other loads and base supports beside the lines.
    Models,
}

impl ComputationName {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Replicates, Self::Identifiability, Self::Models];
}

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

/// A computation of the current results of a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComputationView {
    /// What is computed.
    pub name: ComputationName,
    /// State.
    pub state: ComputationState,
    /// Steps that are done.
    pub done: u64,
    /// Number of steps.
    pub asked: u64,
    /// Values with their intervals, where replicates are done.
    pub intervals: Vec<IntervalView>,
    /// Parts of the report, where it is done.
    pub sections: Vec<SectionView>,
    /// Results and failures as text.
    pub texts: Vec<String>,
}

/// A part of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SectionView {
    /// Name, the same in every report.
    pub id: String,
    /// Heading.
    pub title: String,
    /// Content.
    pub blocks: Vec<BlockView>,
}

/// A block of a part of the report.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum BlockView {
    /// A heading within the part.
    Heading {
        /// Text.
        text: String,
    },
    /// Running text.
    Paragraph {
        /// Text.
        text: String,
    },
    /// A notice.
    Notice {
        /// Such as `Warning`.
        word: String,
        /// Text.
        text: String,
    },
    /// A table.
    Table {
        /// What it shows.
        caption: String,
        /// Columns.
        columns: Vec<ColumnView>,
        /// Rows, with one cell per column.
        rows: Vec<Vec<String>>,
        /// Note; may be empty.
        note: String,
    },
    /// A picture.
    Figure {
        /// Name.
        name: String,
        /// What it shows.
        caption: String,
        /// The picture.
        svg: String,
    },
}

/// A column of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ColumnView {
    /// Heading with its unit.
    pub head: String,
    /// Whether it holds numbers.
    pub numeric: bool,
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
