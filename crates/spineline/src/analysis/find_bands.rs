//! The bands of all films that were predicted and not fitted.

use super::Analysis;
use super::bands::{Bands, FilmBands};
use super::comparison::{ComparedFilm, FilmPredictor, FilmRole};
use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::clinical::Regions;
use crate::evaluate::{Band, Baseline, FilmCovariance, FilmShape, PredictedFilm, RotationPrior};
use crate::hypothesis::{Hypothesis, HypothesisFit, Role, ShapePrediction};
use crate::measure::Outline;
use crate::personalize::Base;

/// Mean square of other patients ([`Band`]): means over 15 patients with two bends each, rounded up to a half (decision 0061).
const fn mean_square_of_line(kind: LineKind) -> f64 {
    match kind {
        LineKind::Estimated => 2.0,
        LineKind::Inflection | LineKind::Iliac | LineKind::Given => 6.5,
    }
}

/// As [`mean_square_of_line`], of loads that know T2's tilt.
const MEAN_SQUARE_WITH_TILT: f64 = 8.0;

/// As [`mean_square_of_line`]; `is_learned` where the distribution of rotations was given.
const fn mean_square_of_baseline(baseline: Baseline, is_learned: bool) -> f64 {
    match baseline {
        Baseline::MirroredBend => 5.0,
        Baseline::PublishedMobility | Baseline::OtherPatients => 6.0,
        Baseline::RotationPrior => 1.5,
        Baseline::LearnedWithTilt => 1.0,
        Baseline::RotationPriorWithTilt if is_learned => 1.0,
        Baseline::RotationPriorWithTilt | Baseline::Cubic => 2.5,
    }
}

/// As [`mean_square_of_line`].
fn mean_square_of_load(hypothesis: Hypothesis, role: Role) -> f64 {
    match (role, hypothesis.base) {
        (Role::LeftOutWithTilt, _) => MEAN_SQUARE_WITH_TILT,
        (_, Base::Free) => 34.0,
        (Role::HeldOut | Role::LeftOut, _) if hypothesis.load.components() > 1 => 34.0,
        _ => 6.5,
    }
}

/// What is known of a film before it is predicted.
struct Known {
    posture: Posture,
    /// Vertebrae above the base that it shows.
    shown: Vec<usize>,
    /// By T2's place, with the published distribution of rotations.
    by_place: Option<FilmCovariance>,
    by_place_and_tilt: Option<FilmCovariance>,
    /// By T2's place, with the distribution that was given.
    by_given_and_place: Option<FilmCovariance>,
    by_given_place_and_tilt: Option<FilmCovariance>,
}

impl Known {
    fn of(analysis: &Analysis, film: &Outline) -> Self {
        let movement = &analysis.movement;
        let (erect, levels) = (&movement.erect().outline, movement.levels());
        let published = RotationPrior::published(levels);
        let given = analysis.options.rotation_prior_of(film);
        let covariance = |prior: &RotationPrior, tilt| FilmCovariance::of(prior, erect, film, tilt);
        Self {
            posture: film.posture,
            shown: film.measured().skip(1).map(|(i, _)| i).collect(),
            by_place: covariance(&published, false),
            by_place_and_tilt: covariance(&published, true),
            by_given_and_place: given.as_ref().and_then(|prior| covariance(prior, false)),
            by_given_place_and_tilt: given.as_ref().and_then(|prior| covariance(prior, true)),
        }
    }

    fn predicted<'a>(
        &'a self,
        shape: &'a FilmShape,
        by: FilmPredictor,
    ) -> Option<PredictedFilm<'a>> {
        let covariance = match by {
            FilmPredictor::Baseline(Baseline::RotationPrior) => self.by_given_and_place.as_ref(),
            FilmPredictor::LineWithTilt(_) => self.by_place_and_tilt.as_ref(),
            FilmPredictor::Baseline(Baseline::RotationPriorWithTilt) => {
                self.by_given_place_and_tilt.as_ref().or(self.by_place_and_tilt.as_ref())
            }
            // The errors of a cubic depend on the form of the curve, not on joints; other patients belong to a cohort.
            FilmPredictor::Baseline(Baseline::Cubic | Baseline::LearnedWithTilt) => None,
            FilmPredictor::Line(_)
            | FilmPredictor::Baseline(
                Baseline::MirroredBend | Baseline::PublishedMobility | Baseline::OtherPatients,
            ) => self.by_place.as_ref(),
        };
        Some(self.film(covariance?, shape))
    }

    fn load<'a>(&'a self, found: &'a ShapePrediction) -> Option<PredictedFilm<'a>> {
        let covariance = match found.role {
            Role::LeftOutWithTilt => self.by_place_and_tilt.as_ref(),
            Role::HeldOut | Role::LeftOut | Role::LeftOutWithPrior => self.by_place.as_ref(),
            Role::Fitted | Role::LeftOutLoadFitted => None,
        };
        Some(self.film(covariance?, &found.shape))
    }

    fn film<'a>(
        &'a self,
        covariance: &'a FilmCovariance,
        shape: &'a FilmShape,
    ) -> PredictedFilm<'a> {
        PredictedFilm { covariance, shown: &self.shown, shape }
    }
}

/// The bands of one method on its films, in their order: of those that it predicts.
///
/// `is_left_out` says which of them show how it predicts the others.
fn of_method(
    predicted: &[Option<PredictedFilm<'_>>],
    regions: &Regions,
    of_other_patients: impl Fn(usize) -> f64,
    is_left_out: impl Fn(usize) -> bool,
) -> Vec<Option<Band>> {
    let squares: Vec<Option<f64>> = (0..predicted.len())
        .map(|i| predicted[i].as_ref().filter(|_| is_left_out(i)).map(PredictedFilm::mean_square))
        .collect();
    let band = |(i, film): (usize, &Option<PredictedFilm<'_>>)| {
        let others = squares.iter().enumerate().filter(|(other, _)| *other != i);
        let others: Vec<f64> = others.filter_map(|(_, square)| *square).collect();
        Some(Band::of(film.as_ref()?, regions, of_other_patients(i), &others))
    };
    predicted.iter().enumerate().map(band).collect()
}

impl Analysis {
    /// The 95 % bands of all films that were predicted and not fitted.
    ///
    /// Computed on first use and kept, as [`Analysis::comparison`].
    #[must_use]
    pub fn bands(&self) -> &Bands {
        self.bands.0.get_or_init(|| Box::new(self.find_bands()))
    }

    fn find_bands(&self) -> Bands {
        let moved = self.movement.films.iter().skip(1);
        let known: Vec<Known> = moved.map(|film| Known::of(self, &film.outline)).collect();
        let fits = self.hypotheses.iter();
        Bands {
            films: self.film_bands(&known),
            hypotheses: fits.map(|fit| self.hypothesis_bands(fit, &known)).collect(),
        }
    }

    fn film_bands(&self, known: &[Known]) -> Vec<FilmBands> {
        let compared = self.comparison();
        let known_of = |film: &ComparedFilm| {
            let predicted = film.role != FilmRole::Fitted;
            known.iter().find(|one| predicted && one.posture == film.posture)
        };
        let films: Vec<(&ComparedFilm, Option<&Known>)> =
            compared.films.iter().map(|film| (film, known_of(film))).collect();
        let is_left_out = |i: usize| films[i].0.role == FilmRole::LeftOutBend;
        let regions = &self.movement.regions;
        let none = |(film, _): &(&ComparedFilm, Option<&Known>)| FilmBands {
            role: film.role,
            bands: Vec::new(),
        };
        let mut bands: Vec<FilmBands> = films.iter().map(none).collect();
        for by in compared.predictors() {
            let predicted: Vec<_> = films
                .iter()
                .map(|(film, known)| (*known)?.predicted(compared.shape(film, by)?, by))
                .collect();
            let of_others = |i: usize| match by {
                FilmPredictor::Line(kind) => mean_square_of_line(kind),
                FilmPredictor::LineWithTilt(_) => MEAN_SQUARE_WITH_TILT,
                FilmPredictor::Baseline(one) => {
                    let given = films[i].1.and_then(|known| known.by_given_place_and_tilt.as_ref());
                    mean_square_of_baseline(one, given.is_some())
                }
            };
            let found = of_method(&predicted, regions, of_others, is_left_out);
            for (film, band) in bands.iter_mut().zip(found) {
                film.bands.extend(band.map(|band| (by, band)));
            }
        }
        bands
    }

    fn hypothesis_bands(&self, fit: &HypothesisFit, known: &[Known]) -> Vec<Option<Band>> {
        let mut bands = vec![None; fit.predictions.len()];
        for role in [Role::LeftOut, Role::LeftOutWithPrior, Role::LeftOutWithTilt] {
            // Films that were held out are judged by the bends of the same rule.
            let is_left_out = |i: usize| fit.predictions[i].role != Role::HeldOut;
            let of_role =
                |own: Role| own == role || (role == Role::LeftOut && own == Role::HeldOut);
            let predicted: Vec<_> = fit
                .predictions
                .iter()
                .map(|found| {
                    let known = known.iter().find(|one| one.posture == found.shape.posture)?;
                    of_role(found.role).then(|| known.load(found)).flatten()
                })
                .collect();
            let of_others = |_| mean_square_of_load(fit.hypothesis, role);
            let found = of_method(&predicted, &self.movement.regions, of_others, is_left_out);
            for (band, found) in bands.iter_mut().zip(found) {
                *band = found.or(band.take());
            }
        }
        bands
    }
}
