//! Statistics over many studies.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Notice, StudyStatus};

/// All studies that the requester may see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortView {
    /// Whether any of the films are synthetic.
    pub synthetic: bool,
    /// Whether some are synthetic and some real.
    pub mixed: bool,
    /// One row per study.
    pub rows: Vec<CohortRow>,
    /// Box charts, ready to be drawn.
    pub charts: Vec<BoxChart>,
    /// Comparisons of lines.
    pub comparisons: Vec<ComparisonView>,
    /// Agreement of observers.
    pub reliability: Vec<ReliabilityView>,
    /// Main findings as text.
    pub verdict: Vec<String>,
    /// Warnings.
    pub notices: Vec<Notice>,
}

/// A study of the cohort.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortRow {
    /// Study.
    pub study: String,
    /// Whether its films are synthetic.
    pub synthetic: bool,
    /// Status.
    pub status: StudyStatus,
    /// Reason for its exclusion from the statistics; null if it is included.
    pub excluded: Option<String>,
    /// Model options that differ from the defaults; absent where none does.
    pub options_text: Option<String>,
    /// Cells, with the same headings for every study.
    pub cells: Vec<CohortCell>,
}

/// A cell of the cohort's table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortCell {
    /// Heading with its unit, such as `main Cobb (°)`.
    pub heading: String,
    /// The value as text; `–` if it is missing.
    pub text: String,
    /// The value as a number, for sorting.
    pub value: Option<f64>,
}

/// A chart of boxes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoxChart {
    /// Title.
    pub title: String,
    /// Label of the axis with its unit.
    pub axis: String,
    /// Text with the rule of the whiskers.
    pub whiskers_text: String,
    /// Boxes.
    pub boxes: Vec<BoxView>,
}

/// A box with whiskers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoxView {
    /// Label.
    pub label: String,
    /// Number of values.
    pub count: usize,
    /// Lower whisker, lower quartile, median, upper quartile, upper whisker.
    pub five: [f64; 5],
    /// Values beyond the whiskers.
    pub outliers: Vec<f64>,
}

/// Two models compared over the cohort: with the paper's pooled test, and with the patient as unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparisonView {
    /// Names of the compared models and of the quantity.
    pub label: String,
    /// Text of the paper's pooled test.
    pub pooled_text: String,
    /// Text of the test with the patient as unit.
    pub by_patient_text: String,
}

/// Agreement of observers on one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReliabilityView {
    /// Quantity with its unit.
    pub quantity: String,
    /// Study, or all studies.
    pub scope: String,
    /// Statistics with their values as text, such as `ICC(2,1)` and `0.98 (0.96–0.99)`.
    pub statistics: Vec<NamedText>,
    /// A Bland–Altman plot, where pairs of readings exist.
    pub bland_altman: Option<BlandAltmanView>,
}

/// A statistic and its value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct NamedText {
    /// Name.
    pub name: String,
    /// Value with unit and interval.
    pub text: String,
}

/// Data of a Bland–Altman plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BlandAltmanView {
    /// Means.
    pub means: Vec<f64>,
    /// Differences.
    pub differences: Vec<f64>,
    /// Mean difference.
    pub bias: f64,
    /// Limits of agreement.
    pub limits: [f64; 2],
    /// Unit.
    pub unit: String,
}
