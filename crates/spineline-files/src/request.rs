//! The request for a case.

use spineline::analysis::AnalysisOptions;
use spineline::uncertainty::LandmarkNoise;

/// Everything on which an analysis file depends, except for the case.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Request {
    /// Options of the analysis.
    pub options: AnalysisOptions,
    /// Monte Carlo replicates.
    pub replicates: Option<Replicates>,
    /// Whether identifiability is requested.
    pub identifiability: bool,
}

/// Monte Carlo replicates with perturbed landmarks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Replicates {
    /// Number of replicates.
    pub count: u64,
    /// Size of the noise.
    pub noise: LandmarkNoise,
    /// Seed of all of them.
    pub seed: u64,
}
