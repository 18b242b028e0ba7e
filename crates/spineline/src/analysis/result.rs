//! The result of an analysis.

use super::bands::Bands;
use super::comparison::{LinesCompared, Remembered};
use super::measured::is_read_once;
use super::{AnalysisOptions, LineModel, Movement};
use crate::action::LineKind;
use crate::hypothesis::HypothesisFit;
use crate::reliability::{QuantityReliability, assess, film_quantities};
use crate::warning::{Warning, Warnings};

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
    pub(super) comparison: Remembered<LinesCompared>,
    /// Result of [`Analysis::bands`].
    pub(super) bands: Remembered<Bands>,
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

    /// The warnings of this analysis, and of its fits without one of the bends ([`Analysis::comparison`]).
    pub fn all_warnings(&self) -> impl Iterator<Item = &Warning> {
        let of_comparison = (!self.models.is_empty()).then(|| self.comparison().warnings.all());
        self.warnings.all().iter().chain(of_comparison.into_iter().flatten())
    }

    /// Whether every fit and every simulation has a usable result.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.models.iter().all(LineModel::is_converged)
            && self.hypotheses.iter().all(|fit| fit.is_converged() && fit.lost.is_empty())
    }

    /// Whether what was asked for has a result: the model with the inflection line, with lines that were given, and with loads to
    /// compare. Models with other lines are fitted in addition, for comparison; they count without such a model.
    #[must_use]
    pub fn has_what_was_asked(&self) -> bool {
        let asked =
            |model: &&LineModel| matches!(model.kind, LineKind::Inflection | LineKind::Given);
        let is_any_asked = self.models.iter().any(|model| asked(&model));
        let mut counting = self.models.iter().filter(|model| !is_any_asked || asked(model));
        let are_models_usable = if is_any_asked {
            counting.all(LineModel::is_converged)
        } else {
            self.models.is_empty() || counting.any(LineModel::is_converged)
        };
        are_models_usable
            && self.hypotheses.iter().all(|fit| fit.is_converged() && fit.lost.is_empty())
    }
}
