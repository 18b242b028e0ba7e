//! Data for the tables.

use spineline::analysis::{Analysis, Subject};
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;

/// Data of one patient for the tables.
#[derive(Debug, Clone, Copy)]
pub struct Patient<'a> {
    /// Result of the analysis.
    pub analysis: &'a Analysis,
    /// Data of the patient.
    pub subject: &'a Subject,
    /// Identifiability of every model's multipliers, in the order of the models, where requested.
    pub identifiability: Option<&'a [Option<Identifiability>]>,
    /// Monte Carlo replicates with perturbed landmarks, where requested.
    pub uncertainty: Option<&'a Uncertainty>,
}
