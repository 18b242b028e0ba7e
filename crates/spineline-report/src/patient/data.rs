//! Data for a report.

use spineline::analysis::{Analysis, Case};
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;

use crate::figures::FilmPicture;

/// Data for a report.
#[derive(Debug, Clone, Copy)]
pub struct Patient<'a> {
    /// The films.
    pub case: &'a Case,
    /// The results.
    pub analysis: &'a Analysis,
    /// Images of the films, where available; [`summary`](super::summary()) shows none.
    pub pictures: &'a [FilmPicture],
    /// Identifiability of every model's multipliers, in the order of the models; `None` where it was not requested.
    pub identifiability: Option<&'a [Option<Identifiability>]>,
    /// The effect of landmark noise on the numbers; `None` where it was not requested.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Program that makes the report.
    pub generator: &'a str,
    /// The analysis as JSON, to be embedded; [`summary`](super::summary()) does not show it.
    pub json: &'a str,
}
