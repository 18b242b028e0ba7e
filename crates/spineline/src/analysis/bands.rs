//! 95 % bands of predicted films, by method.

use super::comparison::{FilmPredictor, FilmRole};
use crate::evaluate::Band;
use crate::number::mean;

/// The bands of a film.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmBands {
    /// Role of the film for lines and predictions without mechanics.
    pub role: FilmRole,
    /// By predictor with a result: lines, then predictions without mechanics.
    pub bands: Vec<(FilmPredictor, Band)>,
}

/// How often the bands hold the measured film (decision 0061).
pub const BAND_COVERAGE: &str = "On 30 left-out bends of 15 real patients, 95 % bands hold, by method, 90 to 100 % of vertebrae, and all vertebrae on 87 to 100 % of the films. On synthetic films of three constructions: 95 to 100 % and 89 to 100 %.";

/// The bands of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// In the order of [`super::LinesCompared::films`]; fitted films have none.
    pub films: Vec<FilmBands>,
    /// By other load and base, in the order of its predictions; `None` for films to which the load was fitted.
    pub hypotheses: Vec<Vec<Option<Band>>>,
}

impl Bands {
    /// Mean radius over the films of a role on which a predictor has a result, in mm.
    #[must_use]
    pub fn mean_radius_mm(&self, by: FilmPredictor, role: FilmRole) -> Option<f64> {
        let films = self.films.iter().filter(|film| film.role == role);
        mean(films.filter_map(|film| film.band(by)).map(Band::mean_radius_mm))
    }
}

impl FilmBands {
    /// The band of a predictor; `None` where it has no result.
    #[must_use]
    pub fn band(&self, by: FilmPredictor) -> Option<&Band> {
        self.bands.iter().find(|(own, _)| *own == by).map(|(_, band)| band)
    }
}
