use super::comparison::Remembered;
use super::measured::is_read_once;
use super::{AnalysisOptions, LineModel, Movement};
use crate::hypothesis::HypothesisFit;
use crate::reliability::{QuantityReliability, assess, film_quantities};
use crate::warning::Warnings;

/// The results of all steps for one patient; a result that a film or an option does not allow is `None` or empty, with a warning.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Identifier of the case.
    pub case_id: String,
    /// Whether the films are synthetic.
    pub synthetic: bool,
    /// Results before any force.
    pub movement: Movement,
    /// One personalised model per line of action.
    pub models: Vec<LineModel>,
    /// Other loads and bases that were requested.
    pub hypotheses: Vec<HypothesisFit>,
    /// Choices.
    pub options: AnalysisOptions,
    /// Problems that do not stop the analysis.
    pub warnings: Warnings,
    /// Result of [`Analysis::comparison`].
    pub(super) comparison: Remembered,
}

impl Analysis {
    /// How well the readings repeat, by quantity; empty where every film was read once.
    ///
    /// Computed on request, because no other result depends on it.
    #[must_use]
    pub fn reliability(&self) -> Vec<QuantityReliability> {
        let readings = &self.movement.readings;
        if is_read_once(readings) {
            return Vec::new();
        }
        film_quantities(&[(&self.case_id, readings)]).iter().map(assess).collect()
    }
}
