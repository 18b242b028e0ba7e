//! Many studies together.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{Notice, StudyStatus};

/// All studies that the one who asks may see.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortView {
    /// Whether any of the films are made up.
    pub synthetic: bool,
    /// One row per study.
    pub rows: Vec<CohortRow>,
    /// Box charts, ready to be drawn.
    pub charts: Vec<BoxChart>,
    /// Comparisons of lines.
    pub comparisons: Vec<ComparisonView>,
    /// How well readers agree.
    pub reliability: Vec<ReliabilityView>,
    /// What was found, in plain words.
    pub verdict: Vec<String>,
    /// Warnings.
    pub notices: Vec<Notice>,
}

/// A study of the cohort.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortRow {
    /// Study.
    pub study: String,
    /// Whether its films are made up.
    pub synthetic: bool,
    /// How far it has come.
    pub status: StudyStatus,
    /// Whether it is part of the statistics; if not, why.
    pub excluded: Option<String>,
    /// Cells, the same headings for every study.
    pub cells: Vec<CohortCell>,
}

/// A cell of the cohort's table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CohortCell {
    /// Heading with its unit, such as `main Cobb (°)`.
    pub heading: String,
    /// The value in words; `–` where there is none.
    pub text: String,
    /// For sorting.
    pub value: Option<f64>,
}

/// Boxes side by side.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct BoxChart {
    /// Title.
    pub title: String,
    /// Label of the axis with its unit.
    pub axis: String,
    /// The rule of the whiskers in words.
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

/// Two things compared over the cohort: the paper's way and by patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ComparisonView {
    /// What is compared with what.
    pub label: String,
    /// The paper's pooled test in words.
    pub pooled_text: String,
    /// By patient in words.
    pub by_patient_text: String,
}

/// Agreement of readers on one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReliabilityView {
    /// Quantity with its unit.
    pub quantity: String,
    /// Study, or all of them together.
    pub scope: String,
    /// Named statistics in words, such as `ICC(2,1)` and `0.98 (0.96–0.99)`.
    pub statistics: Vec<NamedText>,
    /// A Bland–Altman plot, where two can be compared.
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

/// Differences against means.
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
