//! Single parts of a patient's report, for pages that show one of them.

use spineline::analysis::Analysis;
use spineline::personalize::Identifiability;

use super::short::Intervals;
use super::{measured, model, short, space, uncertainty};
use crate::document::Section;
use crate::hypotheses;

/// The lines of action beside predictions without mechanics, and the line of best fit of every film.
#[must_use]
pub fn lines(analysis: &Analysis) -> Vec<Section> {
    vec![
        short::short(analysis, Intervals::default()),
        model::comparison(analysis),
        measured::line(analysis),
    ]
}

/// The erect and the lateral film together, and axial rotations; each only where the case has it.
#[must_use]
pub fn space(analysis: &Analysis) -> Vec<Section> {
    [space::both_films(analysis), space::axial(analysis)].into_iter().flatten().collect()
}

/// Identifiability of every multiplier, by model.
#[must_use]
pub fn identifiability(analysis: &Analysis, found: &[Option<Identifiability>]) -> Section {
    let mut section = Section::new("identifiability", "Identifiability of the multipliers");
    uncertainty::identifiability(&mut section, analysis, found);
    uncertainty::profiles(&mut section, analysis, found);
    section
}

/// Other loads and bases beside the lines; `None` where the analysis has none.
#[must_use]
pub fn models(analysis: &Analysis) -> Option<Section> {
    hypotheses::of_patient(analysis)
}
