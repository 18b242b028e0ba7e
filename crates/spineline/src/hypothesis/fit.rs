//! A hypothesis fitted to the bends of a patient, and its predictions of films that were not fitted.

use nalgebra::{DVector, Vector3};

use super::from_top::predict_from_top;
use super::prediction::{Predicted, Role, ShapePrediction, predict, prediction};
use super::problem::{LoadedFilm, ShapeProblem, statics};
use super::start::responses_to;
use super::{Base, Criteria, Hypothesis, HypothesisFilm, Spine};
use crate::anatomy::Posture;
use crate::least_squares::{FitStatus, System};
use crate::multibody::PathEnding;
use crate::personalize::estimate::{EstimatedLoads, JointResponses, estimate_loads};
use crate::personalize::evidence::FilmEvidence;
use crate::personalize::{Best, FitProblem, Start};
use crate::spatial::Angle;

/// A hypothesis fitted to one patient.
#[derive(Debug, Clone, PartialEq)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LostPrediction {
    /// The posture.
    pub posture: Posture,
    /// Role of the film.
    pub role: Role,
    /// Why it is missing: the search for its load did not converge, or the shape is beyond the human range of motion.
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
        mean(self.of_role(role).map(ShapePrediction::mean_location_error_mm))
    }

    /// Mean over the films of a role of the rotations' errors.
    #[must_use]
    pub fn mean_rotation_rms(&self, role: Role) -> Option<Angle> {
        mean(self.of_role(role).map(|p| p.rotation_rms.rad())).map(Angle::from_rad)
    }
}

fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / f64::from(count))
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
    let has_line = |film: &&HypothesisFilm<'_>| LoadedFilm::new(hypothesis, film, spine).is_some();
    let (bends, others): (Vec<HypothesisFilm<'_>>, Vec<_>) =
        films.iter().filter(has_line).partition(|film| film.outline.posture.bend().is_some());
    let mut found = fit_to(hypothesis, spine, &bends, None)?;
    let mut fit = HypothesisFit {
        hypothesis,
        status: found.status,
        log_multipliers: found.log_multipliers(spine),
        criteria: found.criteria(spine),
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
        record(film, Role::Fitted, found.prediction(i, film, spine, Role::Fitted));
    }
    let usable = found.status != FitStatus::NotEvaluable;
    let logs = found.log_multipliers(spine);
    for film in &others {
        let near = if usable {
            predict(hypothesis, spine, film, &logs, Role::HeldOut)
        } else {
            Err(PathEnding::NotConverged)
        };
        record(film, Role::HeldOut, near);
    }
    if let [a, b] = bends[..] {
        for (known, left) in [(b, a), (a, b)] {
            let other = fit_to(hypothesis, spine, &[known], None);
            let logs = other
                .filter(|other| other.status != FitStatus::NotEvaluable)
                .map(|other| other.log_multipliers(spine));
            let predictions: [(Role, PredictLeftOut); 3] = [
                (Role::LeftOut, predict),
                (Role::LeftOutWithPrior, predict_from_top),
                (Role::LeftOutWithTilt, predict_from_top),
            ];
            for (role, predict) in predictions {
                let known = logs.as_ref().ok_or(PathEnding::NotConverged);
                let found = known.and_then(|logs| predict(hypothesis, spine, &left, logs, role));
                record(&left, role, found);
            }
            let role = Role::LeftOutLoadFitted;
            let own = logs
                .and_then(|logs| fit_to(hypothesis, spine, &[left], Some(logs)))
                .ok_or(PathEnding::NotConverged)
                .and_then(|mut own| own.prediction(0, &left, spine, role));
            record(&left, role, own);
        }
    }
    Some(fit)
}

/// How a bend is predicted with the stiffness of the other one.
type PredictLeftOut = fn(Hypothesis, &Spine<'_>, &HypothesisFilm<'_>, &[f64], Role) -> Predicted;

/// A fit that has ended.
struct Ended<'a> {
    problem: ShapeProblem<'a>,
    hypothesis: Hypothesis,
    films: usize,
    status: FitStatus,
    x: DVector<f64>,
    chi_squared: f64,
}

/// If the residuals are within the noise, no other start is tried.
const ENOUGH_RMS: f64 = 1.0;
/// How often the loads of a start without an equilibrium are halved.
const HALVINGS: u32 = 4;

/// Fits multipliers, unless they are known, and loads to some films.
fn fit_to<'a>(
    hypothesis: Hypothesis,
    spine: &Spine<'a>,
    films: &[HypothesisFilm<'a>],
    held: Option<Vec<f64>>,
) -> Option<Ended<'a>> {
    let mut problem = ShapeProblem::new(hypothesis, films, spine, held.clone())?;
    let mut starts = starts(hypothesis, &problem, films, spine, held.as_deref());
    if hypothesis.base != Base::Fixed {
        // A free base is never worse than a fixed one.
        let mut fixed = fit_to(Hypothesis::of(hypothesis.load), spine, films, held)?;
        if fixed.status != FitStatus::NotEvaluable {
            starts.insert(0, fixed.problem.start_at(&fixed.x));
        }
    }
    let mut best = Best::default();
    for start in starts {
        if best.satisfies(&problem, ENOUGH_RMS) {
            break;
        }
        if let Some(start) = evaluable(&mut problem, start) {
            best.improve(&mut problem, &start);
        }
    }
    let (chi_squared, status, x) = match best.minimum {
        Some((end, _)) => (problem.data_squares(&end.system), end.status, end.x),
        None => (f64::NAN, FitStatus::NotEvaluable, DVector::zeros(problem.unknowns())),
    };
    Some(Ended { problem, hypothesis, films: films.len(), status, x, chi_squared })
}

/// The start with its loads halved until an equilibrium exists.
fn evaluable(problem: &mut ShapeProblem<'_>, mut start: Start) -> Option<Start> {
    let mut system = System::new(problem.rows(), problem.unknowns());
    for _ in 0..=HALVINGS {
        let x = problem.begin(&start);
        if problem.evaluate(&x, &mut system) {
            return Some(start);
        }
        start.loads.iter_mut().flatten().for_each(|load| *load *= 0.5);
    }
    None
}

/// Starts in closed form: multipliers and loads together; loads for the multipliers given, or else nominal ones; and the
/// latter with the load of every film the other way round.
fn starts(
    hypothesis: Hypothesis,
    problem: &ShapeProblem<'_>,
    films: &[HypothesisFilm<'_>],
    spine: &Spine<'_>,
    held: Option<&[f64]>,
) -> Vec<Start> {
    let evidence: Vec<FilmEvidence> = films.iter().map(|film| film.evidence(spine)).collect();
    let both = problem.films.iter().zip(films).zip(&evidence);
    let measured: Vec<JointResponses<'_>> = both
        .map(|((own, film), evidence)| responses_to(&own.loaded.units, film, evidence, spine))
        .collect();
    let components = |load: &Vector3<f64>| load.as_slice()[..hypothesis.load.components()].to_vec();
    let start = |logs: &[f64], loads: &[Vector3<f64>]| Start {
        log_multipliers: logs.to_vec(),
        loads: loads.iter().map(components).collect(),
    };
    let nominal = vec![0.0; spine.groups.len()];
    let known = held.unwrap_or(&nominal);
    let mut starts = Vec::new();
    if held.is_none() {
        let EstimatedLoads { loads, log_multipliers } = estimate_loads(&measured, spine.groups);
        starts.push(start(&log_multipliers, &loads));
    }
    let loads: Vec<Vector3<f64>> =
        measured.iter().map(|film| film.load(spine.groups, known)).collect();
    for flips in 0..1_u32 << films.len() {
        let sign = |film: usize| if flips >> film & 1 == 1 { -1.0 } else { 1.0 };
        let flipped: Vec<_> = (0..).zip(&loads).map(|(film, load)| load * sign(film)).collect();
        starts.push(start(known, &flipped));
    }
    starts
}

impl Ended<'_> {
    fn log_multipliers(&self, spine: &Spine<'_>) -> Vec<f64> {
        self.x.as_slice()[..spine.groups.len()].to_vec()
    }

    fn criteria(&self, spine: &Spine<'_>) -> Criteria {
        let free = self.hypothesis.free_numbers(self.films, spine.groups.len());
        Criteria::new(self.chi_squared, self.problem.data_rows(), free)
    }

    fn prediction(
        &mut self,
        index: usize,
        film: &HypothesisFilm<'_>,
        spine: &Spine<'_>,
        role: Role,
    ) -> Predicted {
        if self.status == FitStatus::NotEvaluable {
            return Err(PathEnding::NotConverged);
        }
        let statics = statics(spine, &self.log_multipliers(spine));
        let (components, base) = self.problem.of_film(index, self.x.as_slice());
        let components = components.to_vec();
        let loaded = &mut self.problem.films[index].loaded;
        if !loaded.solve(&statics, &components, base) {
            return Err(PathEnding::NotConverged);
        }
        prediction(loaded, film, role, spine, components, base)
    }
}
