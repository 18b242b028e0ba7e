//! Results as text for a terminal.

pub mod cohort;
pub mod hypotheses;
pub mod identifiability;
pub mod lines;
pub mod patient;
pub mod reliability;
pub mod table;
pub mod uncertainty;

use spineline::analysis::Analysis;

use crate::analysis::confidence::Confidence;

/// The confidence of one patient's numbers, as far as it was asked for.
pub fn confidence_texts(
    analysis: &Analysis,
    confidence: &Confidence,
) -> impl Iterator<Item = String> {
    let identifiability = confidence.identifiability.as_ref();
    let uncertainty = confidence.uncertainty.as_ref();
    let identifiability = identifiability.map(|found| identifiability::text(analysis, found));
    let uncertainty = uncertainty.map(|found| uncertainty::text(analysis, found));
    identifiability.into_iter().chain(uncertainty)
}
