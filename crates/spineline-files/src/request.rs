//! What is asked of a case.

use spineline::analysis::AnalysisOptions;
use spineline::uncertainty::LandmarkNoise;

/// Everything beside a case that its analysis file depends on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    /// Choices of the analysis.
    pub options: AnalysisOptions,
    /// Analyses on moved landmarks.
    pub replicates: Option<Replicates>,
    /// Whether to tell which multipliers the films identify.
    pub identifiability: bool,
}

/// Landmarks moved at random, so many times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicates {
    /// How many.
    pub count: u64,
    /// How far.
    pub noise: LandmarkNoise,
    /// Seed of all of them.
    pub seed: u64,
}
