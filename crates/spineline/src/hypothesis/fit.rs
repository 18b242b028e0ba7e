//! A hypothesis fitted to the bends of a patient, and its predictions of films that were not fitted.

use serde::{Deserialize, Serialize};

use super::prediction::{FoundLoad, Predicted, Predictor, Role, ShapePrediction};
use super::{Criteria, Hypothesis, HypothesisFilm, Spine};
use crate::anatomy::Posture;
use crate::least_squares::FitStatus;
use crate::multibody::{FilmUnderLoad, LoadedFilm, PathEnding, Wanted};
use crate::number::mean;
use crate::personalize::{Base, FilmData, Personalization, Problem, fit};
use crate::spatial::Angle;

/// A hypothesis fitted to one patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HypothesisFit {
    /// Which.
    pub hypothesis: Hypothesis,
    /// How the search of the fit to all bends ended.
    pub status: FitStatus,
    /// `ln α` per group.
    pub log_multipliers: Vec<f64>,
    /// Quality of the fit.
    pub criteria: Criteria,
    /// Fitted films, films held out, and bends left out, in this order.
    pub predictions: Vec<ShapePrediction>,
    /// Films and roles without a prediction.
    pub lost: Vec<LostPrediction>,
}

/// A film without a prediction.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct LostPrediction {
    /// The posture.
    pub posture: Posture,
    /// Role of the film.
    pub role: Role,
    /// Why it is missing: the fit or the search for its load did not converge, or the shape is beyond the human range of motion.
    pub reason: PathEnding,
}

impl HypothesisFit {
    /// Whether the fit to all bends converged to a shape that may be shown as a result.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.status == FitStatus::Converged && !self.is_beyond_human_range()
    }

    /// Whether the shape of a fitted film is beyond the human range of motion.
    #[must_use]
    pub fn is_beyond_human_range(&self) -> bool {
        let beyond = |lost: &LostPrediction| {
            lost.role == Role::Fitted && lost.reason == PathEnding::BeyondHumanRange
        };
        self.lost.iter().any(beyond)
    }

    /// How the fit to all bends ended: the name used in files.
    #[must_use]
    pub fn ending_key(&self) -> &'static str {
        if self.is_beyond_human_range() {
            PathEnding::BeyondHumanRange.key()
        } else {
            self.status.key()
        }
    }

    /// Predictions of one role.
    pub fn of_role(&self, role: Role) -> impl Iterator<Item = &ShapePrediction> {
        self.predictions.iter().filter(move |p| p.role == role)
    }

    /// Mean location error over the films of a role; `None` without such a film.
    #[must_use]
    pub fn mean_location_error_mm(&self, role: Role) -> Option<f64> {
        mean(self.of_role(role).map(|p| p.shape.mean_location_error_mm()))
    }

    /// Mean over the films of a role of the rotations' errors.
    #[must_use]
    pub fn mean_rotation_rms(&self, role: Role) -> Option<Angle> {
        mean(self.of_role(role).map(|p| p.rotation_rms.rad())).map(Angle::from_rad)
    }
}

/// Fits a hypothesis to the bends among some films, and predicts every film: fitted, held out, and each bend from the other.
///
/// `None` if no bend has this line.
#[must_use]
pub fn fit_hypothesis(
    hypothesis: Hypothesis,
    spine: &Spine<'_>,
    films: &[HypothesisFilm<'_>],
) -> Option<HypothesisFit> {
    let has_line = |film: &&HypothesisFilm<'_>| film.under(hypothesis.load, spine).is_some();
    let (bends, others): (Vec<&HypothesisFilm<'_>>, Vec<_>) =
        films.iter().filter(has_line).partition(|film| film.outline.posture.bend().is_some());
    let mut all = fit_to(hypothesis, spine, &bends, None)?;
    let mut fit = HypothesisFit {
        hypothesis,
        status: all.found.status,
        log_multipliers: all.found.log_multipliers.clone(),
        criteria: all.criteria(),
        predictions: Vec::new(),
        lost: Vec::new(),
    };
    let mut record = |film: &HypothesisFilm<'_>, role, prediction: Predicted| match prediction {
        Ok(prediction) => fit.predictions.push(prediction),
        Err(reason) => {
            fit.lost.push(LostPrediction { posture: film.outline.posture, role, reason });
        }
    };
    for (i, film) in bends.iter().enumerate() {
        record(film, Role::Fitted, all.prediction(i, film, spine, Role::Fitted));
    }
    let predictor = all.predictor(spine, Role::HeldOut);
    for film in &others {
        record(film, Role::HeldOut, predictor.and_then(|predictor| predictor.near_t2(film)));
    }
    if let [a, b] = bends[..] {
        for (known, left) in [(b, a), (a, b)] {
            let other = fit_to(hypothesis, spine, &[known], None);
            let predictor =
                |role| other.as_ref().ok_or(PathEnding::NotConverged)?.predictor(spine, role);
            record(left, Role::LeftOut, predictor(Role::LeftOut).and_then(|one| one.near_t2(left)));
            for role in [Role::LeftOutWithPrior, Role::LeftOutWithTilt] {
                record(left, role, predictor(role).and_then(|one| one.by_prior(left)));
            }
            let role = Role::LeftOutLoadFitted;
            let own = predictor(role).and_then(|known| {
                let own = fit_to(hypothesis, spine, &[left], Some(known.log_multipliers));
                own.ok_or(PathEnding::NotConverged)?.prediction(0, left, spine, role)
            });
            record(left, role, own);
        }
    }
    Some(fit)
}

/// A fit of a hypothesis to some films.
struct FittedHypothesis<'a> {
    problem: Problem<'a, LoadedFilm>,
    hypothesis: Hypothesis,
    found: Personalization,
}

/// Fits multipliers, unless they are known, and loads to some films; `None` if a film lacks the line, or without films.
fn fit_to<'a>(
    hypothesis: Hypothesis,
    spine: &Spine<'a>,
    films: &[&'a HypothesisFilm<'a>],
    held: Option<&[f64]>,
) -> Option<FittedHypothesis<'a>> {
    let Hypothesis { load, base } = hypothesis;
    let hints = if base == Base::Fixed {
        Vec::new()
    } else {
        // A free base is never worse than a fixed one.
        let still = fit_to(Hypothesis::of(load), spine, films, held)?;
        still.is_evaluable().then(|| still.found.as_start()).into_iter().collect()
    };
    let film = |film: &&'a HypothesisFilm<'a>| {
        let loaded = film.under(load, spine)?;
        let measured = film.responses_to(&loaded.units);
        let regions = spine.settings.regions;
        Some(FilmData::new(spine.springs, film.outline, measured, regions, loaded, base))
    };
    let films: Vec<FilmData<'a, LoadedFilm>> = films.iter().map(film).collect::<Option<_>>()?;
    if films.is_empty() {
        return None;
    }
    let mut problem =
        Problem::new(spine.springs, films, &spine.settings, held.map(<[f64]>::to_vec));
    let found = fit(&mut problem, &hints, None);
    Some(FittedHypothesis { problem, hypothesis, found })
}

impl FittedHypothesis<'_> {
    fn is_evaluable(&self) -> bool {
        self.found.status != FitStatus::NotEvaluable
    }

    /// Why nothing that follows from this fit is a result, if so.
    const fn check(&self) -> Result<(), PathEnding> {
        match self.found.status {
            FitStatus::Converged => Ok(()),
            FitStatus::IterationLimit | FitStatus::Stalled => Err(PathEnding::FitNotConverged),
            FitStatus::NotEvaluable => Err(PathEnding::NotConverged),
        }
    }

    /// Predicts other films with this stiffness; an error if it was not found.
    fn predictor<'s, 'b>(
        &'s self,
        spine: &'s Spine<'b>,
        role: Role,
    ) -> Result<Predictor<'s, 'b>, PathEnding> {
        self.check()?;
        let log_multipliers = &self.found.log_multipliers;
        Ok(Predictor { hypothesis: self.hypothesis, spine, log_multipliers, role })
    }

    fn criteria(&self) -> Criteria {
        let (films, groups) = (self.found.loads.len(), self.found.log_multipliers.len());
        let rows = self.problem.data_rows();
        let chi_squared = self.found.residual_rms.powi(2) * rows as f64;
        let measured = rows - self.problem.rows_of_bases();
        Criteria::new(chi_squared, measured, self.hypothesis.free_numbers(films, groups))
    }

    /// A fitted film.
    fn prediction(
        &mut self,
        index: usize,
        film: &HypothesisFilm<'_>,
        spine: &Spine<'_>,
        role: Role,
    ) -> Predicted {
        if !self.is_evaluable() {
            return Err(PathEnding::NotConverged);
        }
        let springs = self.problem.springs(&self.found.log_multipliers);
        let fitted = &mut self.problem.films[index];
        fitted.load.copy_from_slice(&self.found.loads[index]);
        if !fitted.solve_at_load(&springs, Wanted::Shape) {
            return Err(PathEnding::NotConverged);
        }
        let (components, base) = fitted.loaded.split(&fitted.load);
        let found = FoundLoad { components: components.to_vec(), base };
        let shape = found.shape(&fitted.loaded, film, role, spine)?;
        self.check().map(|()| shape)
    }
}
