//! Lines of action on the same films, with the numbers of their parameters and every bend left out once.

use crate::anatomy::named;
use crate::number::{fixed, mean};
use std::sync::OnceLock;

use super::LineModel;
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::{Baseline, BaselinePrediction, FilmShape, Simulation};
use crate::personalize::{FitTarget, Gauge};
use crate::warning::Warnings;

named! {
    /// Role of a film in the fit.
    pub enum FilmRole {
        /// The stiffness was fitted to it: a small error shows how well the line adapts to the data, not that it is right.
        Fitted = "fitted" as "fitted bends",
        /// A bend, predicted with the stiffness fitted to the other bend alone.
        LeftOutBend = "left_out_bend" as "bends left out",
        /// A neutral or traction film, which takes no part in a fit.
        HeldOut = "held_out" as "neutral, traction",
    }
}

impl FilmRole {
    /// The roles of films that are predicted and not fitted.
    pub const PREDICTED: [Self; 2] = [Self::LeftOutBend, Self::HeldOut];

    /// The films, within a sentence.
    #[must_use]
    pub const fn films_words(self) -> &'static str {
        match self {
            Self::Fitted => "fitted bends",
            Self::LeftOutBend => "bends left out of the fit",
            Self::HeldOut => "neutral and traction films",
        }
    }
}

/// Numbers that a model takes from films.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FreeNumbers {
    /// Stiffness multipliers; one less than there are groups, since their level changes no shape, except with
    /// [`Gauge::FrozenForce`].
    pub multipliers: usize,
    /// Forces, one per fitted film.
    pub forces: usize,
    /// Numbers that place and direct the fitted films' loads beside their force: none for a line that geometry gives, two
    /// per film for a free one.
    pub line: usize,
    /// Numbers that every further film gives before it is predicted: its force, and the place of a free load.
    pub per_predicted_film: usize,
}

impl FreeNumbers {
    /// Of a fitted model.
    #[must_use]
    pub fn of(model: &LineModel, gauge: Gauge) -> Self {
        let level = usize::from(gauge != Gauge::FrozenForce);
        let components = model.fit.loads.iter().map(Vec::len);
        Self {
            multipliers: model.groups.len() - level,
            forces: components.len(),
            line: components.clone().map(|n| n.saturating_sub(1)).sum(),
            per_predicted_film: components.max().unwrap_or(1),
        }
    }

    /// Numbers that were fitted together.
    #[must_use]
    pub const fn fitted(&self) -> usize {
        self.multipliers + self.forces + self.line
    }
}

/// One line of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ComparedLine {
    /// The line.
    pub kind: LineKind,
    /// Numbers that it takes from films.
    pub numbers: FreeNumbers,
    /// Data of its fit: a free load needs the whole shape, also where the others are fitted to Ferguson angles.
    pub target: FitTarget,
}

/// One film under every line.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedFilm {
    /// The posture.
    pub posture: Posture,
    /// Its role in the fit.
    pub role: FilmRole,
    /// By line; `None` where a line has no result on it.
    pub simulations: Vec<Option<Simulation>>,
    /// By line, predicted from T2's location and tilt; `None` where it has no result, and on a fitted film.
    pub with_tilt: Vec<Option<FilmShape>>,
    /// Predictions without mechanics; none for a fitted film.
    pub baselines: Vec<BaselinePrediction>,
}

impl ComparedFilm {
    /// The prediction of a baseline, where it has a result.
    #[must_use]
    pub fn baseline(&self, baseline: Baseline) -> Option<&BaselinePrediction> {
        self.baselines.iter().find(|one| one.baseline == baseline && one.is_usable())
    }
}

/// A predictor of the vertebrae of a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmPredictor {
    /// A line, from T2's location.
    Line(LineKind),
    /// A line, from T2's location and tilt and the distribution of joint rotations (decision 0034).
    LineWithTilt(LineKind),
    /// A prediction without mechanics.
    Baseline(Baseline),
}

impl FilmPredictor {
    /// Its name in files.
    #[must_use]
    pub fn key(self) -> String {
        match self {
            Self::Line(kind) => kind.key().to_owned(),
            Self::LineWithTilt(kind) => format!("{}_with_tilt", kind.key()),
            Self::Baseline(one) => one.key().to_owned(),
        }
    }

    /// Its name, which says whether T2's tilt is known.
    #[must_use]
    pub fn long_name(self) -> String {
        match self {
            Self::Line(kind) => kind.to_string(),
            Self::LineWithTilt(kind) => format!("{kind} with tilt"),
            Self::Baseline(one) => one.long_name(),
        }
    }

    /// Whether it is a line of action.
    #[must_use]
    pub const fn is_line(self) -> bool {
        matches!(self, Self::Line(_) | Self::LineWithTilt(_))
    }

    /// Whether it takes T2's tilt from a film beside its location. Predictors that do are compared with each other.
    #[must_use]
    pub const fn knows_tilt(self) -> bool {
        match self {
            Self::Line(_) => false,
            Self::LineWithTilt(_) => true,
            Self::Baseline(one) => one.knows_tilt(),
        }
    }
}

/// The name where the text says whether T2's tilt is known.
impl std::fmt::Display for FilmPredictor {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Line(kind) | Self::LineWithTilt(kind) => kind.fmt(f),
            Self::Baseline(one) => one.fmt(f),
        }
    }
}

/// Lines of action and joint rotations without mechanics, on the same predicted films of a patient.
///
/// The lines take the fewest numbers from a predicted film. A line without a result on any film of the role is left out, so that it
/// removes no film.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Role of the films in the fit.
    pub role: FilmRole,
    /// Places in [`LinesCompared::films`] of the films that all of these lines predict.
    pub films: Vec<usize>,
    /// The lines with their mean location errors in mm, the smallest error first; at least one.
    pub lines: Vec<(LineKind, f64)>,
    /// The prediction without mechanics with the smallest mean location error in mm on these films, among those that take no more
    /// numbers from a film than a line.
    pub baseline: Option<(Baseline, f64)>,
}

impl Ranking {
    /// A line with a larger mean location error predicts nothing: the limit is about half the height of a vertebral body, so that a
    /// predicted midpoint lies nearer to the end of the body than to its middle.
    pub const MAX_PREDICTED_MM: f64 = 10.0;

    /// The line with the smallest error, and this error in mm.
    #[must_use]
    pub fn best(&self) -> (LineKind, f64) {
        self.lines[0]
    }

    /// Whether the line with the smallest error predicts the films at all ([`Self::MAX_PREDICTED_MM`]).
    #[must_use]
    pub fn is_prediction(&self) -> bool {
        self.best().1 <= Self::MAX_PREDICTED_MM
    }
}

/// A bend, and the models that were fitted to the other one.
#[derive(Debug, Clone, PartialEq)]
pub struct LeftOutBend {
    /// The bend of which these models take only its force and, for a free load, its line.
    pub posture: Posture,
    /// One model per line; its postures are the two bends.
    pub models: Vec<LineModel>,
}

/// The lines of one patient on the same films.
#[derive(Debug, Clone, PartialEq)]
pub struct LinesCompared {
    /// The lines that have a model.
    pub lines: Vec<ComparedLine>,
    /// Every film once per role: fitted, then left out, then held out.
    pub films: Vec<ComparedFilm>,
    /// The fits without one of the bends; empty with only one bend.
    pub left_out: Vec<LeftOutBend>,
    /// Of the fits that did not converge.
    pub warnings: Warnings,
}

/// Mean errors of one line over the films of a role on which it has a result.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeanErrors {
    /// Films.
    pub films: usize,
    /// Mean location error of their vertebrae.
    pub location_mm: f64,
    /// Mean absolute Ferguson error of their regions, in degrees.
    pub ferguson_deg: f64,
}

impl LinesCompared {
    /// The shape that a predictor gives the film; `None` without a result.
    #[must_use]
    pub fn shape<'a>(&self, film: &'a ComparedFilm, by: FilmPredictor) -> Option<&'a FilmShape> {
        let place = |kind| self.lines.iter().position(|line| line.kind == kind);
        match by {
            FilmPredictor::Line(kind) => {
                film.simulations[place(kind)?].as_ref().map(|found| &found.shape)
            }
            FilmPredictor::LineWithTilt(kind) => film.with_tilt[place(kind)?].as_ref(),
            FilmPredictor::Baseline(one) => film.baseline(one).map(|found| &found.shape),
        }
    }

    fn of_role(&self, role: FilmRole) -> impl Iterator<Item = (usize, &ComparedFilm)> {
        self.films.iter().enumerate().filter(move |(_, film)| film.role == role)
    }

    /// Films of a role.
    #[must_use]
    pub fn count(&self, role: FilmRole) -> usize {
        self.of_role(role).count()
    }

    /// Mean errors of a line, by its place, over the films of a role on which it has a result.
    #[must_use]
    pub fn errors(&self, line: usize, role: FilmRole) -> Option<MeanErrors> {
        let found: Vec<&Simulation> =
            self.of_role(role).filter_map(|(_, film)| film.simulations[line].as_ref()).collect();
        let mm = found.iter().flat_map(|s| s.shape.location_errors_mm.iter().copied());
        Some(MeanErrors {
            films: found.len(),
            location_mm: mean(mm)?,
            ferguson_deg: mean(found.iter().flat_map(|s| ferguson_errors_deg(s)))?,
        })
    }

    /// All predictors of films: the lines, the lines with T2's tilt, and predictions without mechanics.
    pub fn predictors(&self) -> impl Iterator<Item = FilmPredictor> {
        let kinds = || self.lines.iter().map(|line| line.kind);
        let lines = kinds().map(FilmPredictor::Line);
        let with_tilt = kinds().map(FilmPredictor::LineWithTilt);
        lines.chain(with_tilt).chain(Baseline::ALL.map(FilmPredictor::Baseline))
    }

    /// Numbers that a predictor takes from a film: of a load its components, of a pattern of rotations its size, and of a distribution or
    /// with the tilt the coordinates of T2 and this tilt.
    #[must_use]
    pub fn per_predicted_film(&self, by: FilmPredictor) -> usize {
        match by {
            FilmPredictor::Line(kind) => {
                let line = self.lines.iter().find(|line| line.kind == kind);
                line.map_or(1, |line| line.numbers.per_predicted_film)
            }
            _ if by.knows_tilt() => 3,
            FilmPredictor::Baseline(Baseline::RotationPrior) => 2,
            _ => 1,
        }
    }

    /// Number of films of a role that are predicted.
    #[must_use]
    pub fn predicted_films(&self, by: FilmPredictor, role: FilmRole) -> usize {
        self.predicted(by, role).len()
    }

    /// Mean location error over all vertebrae of the films of a role that are predicted; `None` without such a film.
    #[must_use]
    pub fn error_mm(&self, by: FilmPredictor, role: FilmRole) -> Option<f64> {
        self.mean_mm(by, &self.predicted(by, role))
    }

    /// Places of the films of a role that have a prediction.
    fn predicted(&self, by: FilmPredictor, role: FilmRole) -> Vec<usize> {
        let films = self.of_role(role).filter(|(_, film)| self.shape(film, by).is_some());
        films.map(|(place, _)| place).collect()
    }

    /// Mean location error in mm over some films; `None` if one is not predicted, or without films.
    fn mean_mm(&self, by: FilmPredictor, films: &[usize]) -> Option<f64> {
        let shapes = films.iter().map(|&film| self.shape(&self.films[film], by));
        let shapes = shapes.collect::<Option<Vec<_>>>()?;
        mean(shapes.into_iter().flat_map(|shape| shape.location_errors_mm.iter().copied()))
    }

    /// The lines that take fewest numbers from a predicted film, by their mean location error on the same films: bends that were left out,
    /// or else neutral and traction films. `None` where no film was predicted.
    #[must_use]
    pub fn ranking(&self) -> Option<Ranking> {
        FilmRole::PREDICTED.into_iter().find_map(|role| self.ranked(role))
    }

    fn ranked(&self, role: FilmRole) -> Option<Ranking> {
        let mut found: Vec<(LineKind, Vec<usize>)> = self
            .fair_lines()
            .map(|kind| (kind, self.predicted(FilmPredictor::Line(kind), role)))
            .filter(|(_, films)| !films.is_empty())
            .collect();
        // Lines that share no film cannot be ranked: the one with fewest films goes first.
        found.sort_by_key(|(_, films)| std::cmp::Reverse(films.len()));
        let films = loop {
            let (_, films) = found.first()?;
            let is_shared =
                |film: &usize| found.iter().all(|(_, predicted)| predicted.contains(film));
            let shared: Vec<usize> = films.iter().copied().filter(is_shared).collect();
            if !shared.is_empty() {
                break shared;
            }
            found.pop();
        };
        let mut lines: Vec<(LineKind, f64)> = found
            .iter()
            .filter_map(|&(kind, _)| Some((kind, self.mean_mm(FilmPredictor::Line(kind), &films)?)))
            .collect();
        lines.sort_by(|a, b| a.1.total_cmp(&b.1));
        let baselines = Baseline::ALL
            .into_iter()
            .filter(|one| !one.knows_tilt())
            .filter_map(|one| Some((one, self.mean_mm(FilmPredictor::Baseline(one), &films)?)));
        let baseline = baselines.min_by(|a, b| a.1.total_cmp(&b.1));
        Some(Ranking { role, films, lines, baseline })
    }

    /// The lines that take fewest numbers from a predicted film.
    fn fair_lines(&self) -> impl Iterator<Item = LineKind> {
        let few = self.lines.iter().map(|line| line.numbers.per_predicted_film).min();
        let is_fair = move |line: &&ComparedLine| Some(line.numbers.per_predicted_film) == few;
        self.lines.iter().filter(is_fair).map(|line| line.kind)
    }

    /// Why the first line of [`Self::ranking`] comes first: its error, the error of the next line, and of the best prediction without
    /// mechanics, in a sentence.
    #[must_use]
    pub fn choice_words(&self) -> Option<String> {
        let ranking = self.ranking()?;
        let films = self.ranked_films_words(&ranking);
        let (kind, mm) = ranking.best();
        let next = ranking.lines.get(1).map_or_else(
            || "no other line can be compared".to_owned(),
            |(kind, mm)| format!("the {kind} follows with {} mm", fixed(*mm, 1)),
        );
        let without = ranking.baseline.map_or_else(
            || "nothing is predicted without mechanics".to_owned(),
            |(baseline, mm)| {
                format!(
                    "the best prediction without mechanics ({baseline}) has {} mm",
                    fixed(mm, 1)
                )
            },
        );
        let limit = if ranking.is_prediction() {
            String::new()
        } else {
            format!(" {}", self.no_prediction_words(&ranking))
        };
        Some(format!(
            "Of the lines that take fewest numbers from a predicted film, the {kind} has the smallest error on {films}: {} mm; {next}; {without}.{limit}",
            fixed(mm, 1)
        ))
    }

    /// Whether all lines were fitted to the same data.
    #[must_use]
    pub fn same_data(&self) -> bool {
        self.lines.windows(2).all(|pair| pair[0].target == pair[1].target)
    }
}

/// Absolute errors of the Ferguson angles.
pub(crate) fn ferguson_errors_deg(simulation: &Simulation) -> Vec<f64> {
    simulation.ferguson_difference.iter().map(|angle| angle.abs().deg()).collect()
}

/// A result that is computed on first use. Analyses are equal whether or not it was computed.
#[derive(Debug, Clone)]
pub(super) struct Remembered<T>(pub(super) OnceLock<Box<T>>);

impl<T> Default for Remembered<T> {
    fn default() -> Self {
        Self(OnceLock::new())
    }
}

impl<T> PartialEq for Remembered<T> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}
