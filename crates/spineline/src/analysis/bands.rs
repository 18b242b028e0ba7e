//! 95 % bands of predicted films, by method.

use super::comparison::FilmRole;
use crate::action::LineKind;
use crate::evaluate::{Band, Baseline};
use crate::number::mean;

/// The bands of a film, by method.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmBands {
    /// Role of the film for lines and predictions without mechanics.
    pub role: FilmRole,
    /// Lines that predict it.
    pub lines: Vec<(LineKind, Band)>,
    /// Predictions without mechanics.
    pub baselines: Vec<(Baseline, Band)>,
}

/// How often the bands hold the measured film (decision 0061).
pub const BAND_COVERAGE: &str = "95 % bands of predicted films hold 90 to 99 % of vertebrae on 30 left-out bends of 15 real patients, and all vertebrae of a film on 87 to 100 % of them, by method. On synthetic films of three constructions: 95 to 100 % and 89 to 100 %.";

/// The bands of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct Bands {
    /// In the order of [`super::LinesCompared::films`]; fitted films have none.
    pub films: Vec<FilmBands>,
    /// By other load and base, in the order of its predictions; `None` for films to which the load was fitted.
    pub hypotheses: Vec<Vec<Option<Band>>>,
}

impl Bands {
    /// Mean radius over the films of a role that a line predicts, in mm.
    #[must_use]
    pub fn mean_of_line(&self, kind: LineKind, role: FilmRole) -> Option<f64> {
        self.mean_mm(role, |film| film.line(kind))
    }

    /// Mean radius over the films of a role that a baseline predicts, in mm.
    #[must_use]
    pub fn mean_of_baseline(&self, baseline: Baseline, role: FilmRole) -> Option<f64> {
        self.mean_mm(role, |film| film.baseline(baseline))
    }

    fn mean_mm(&self, role: FilmRole, band: impl Fn(&FilmBands) -> Option<&Band>) -> Option<f64> {
        let films = self.films.iter().filter(|film| film.role == role);
        mean(films.filter_map(band).map(Band::mean_radius_mm))
    }
}

impl FilmBands {
    /// The band of a line; `None` where it has no result.
    #[must_use]
    pub fn line(&self, kind: LineKind) -> Option<&Band> {
        self.lines.iter().find(|(own, _)| *own == kind).map(|(_, band)| band)
    }

    /// The band of a prediction without mechanics.
    #[must_use]
    pub fn baseline(&self, baseline: Baseline) -> Option<&Band> {
        self.baselines.iter().find(|(own, _)| *own == baseline).map(|(_, band)| band)
    }
}
