//! The search of every fit: starts are refined one after another, and the best end counts.

use super::problem::Problem;
use super::start::Start;
use super::{FitSettings, FitTarget, MULTIPLIER_BOUNDS, Personalization, StiffnessBound};
use crate::least_squares::{FitStatus, Minimum, System};
use crate::multibody::FilmUnderLoad;

/// A start is refined when its sum of squares is within this factor of the best start's: a force of the wrong sign bends
/// the spine the wrong way, and is further off by far.
const PROMISING: f64 = 10.0;
/// Residuals larger than these, in millimetres of a shape or degrees of a Ferguson angle, call for more starts: a fit with
/// a wrong line leaves less.
const POOR_MM: f64 = 12.0;
const POOR_DEG: f64 = 12.0;

/// Residuals at which no other start is tried: half a degree is the effect of a careful reading of 0.25 mm on a Ferguson angle, and
/// one is the standard deviation of a location or tilt.
const fn satisfied_rms(target: FitTarget) -> f64 {
    match target {
        FitTarget::Ferguson => 0.5,
        FitTarget::Shape => 1.0,
    }
}

/// The best fit of a problem. `hints` are starts beside those in closed form, and `start` is the fit to other readings of its films.
pub(crate) fn fit<F: FilmUnderLoad>(
    problem: &mut Problem<'_, F>,
    hints: &[Start],
    start: Option<&Personalization>,
) -> Personalization {
    // The prior becomes stronger with the variance of the films about the model, which a fit without the prior estimates.
    let settings = problem.settings;
    let free = settings.prior.map(|_| {
        problem.settings = FitSettings { prior: None, ..settings };
        fit(problem, hints, start)
    });
    if let Some(free) = &free {
        problem.settings = settings.weighed(free.variance_factor);
    }
    let mut best = Best::default();
    if !best.follows(problem, start) {
        best.search_all(problem, hints, free.as_ref());
    }
    let found = best.result(problem, free.as_ref());
    problem.settings = settings;
    found
}

/// The best of the starts that were refined.
#[derive(Default)]
struct Best {
    /// With its end as a start.
    minimum: Option<(Minimum, Start)>,
    starts: u32,
    /// Where starts ended, with their sums of squares.
    ends: Vec<(Start, f64)>,
}

impl Best {
    /// Follows the minima of the fit to other readings, the one that fits these readings best first; whether the end fits about as
    /// well as there.
    fn follows<F: FilmUnderLoad>(
        &mut self,
        problem: &mut Problem<'_, F>,
        start: Option<&Personalization>,
    ) -> bool {
        /// A fit whose error is larger by this factor than for the other readings has ended in another minimum.
        const WORSE: f64 = 1.5;
        let Some(start) = start.filter(|start| !start.minima.is_empty()) else { return false };
        if !start.minima.iter().all(|minimum| problem.takes(minimum)) {
            return false;
        }
        let enough = satisfied_rms(problem.target());
        let priced = problem.priced(&start.minima);
        self.improve_from(problem, &priced, enough);
        self.satisfies(problem, enough.max(WORSE * start.residual_rms))
    }

    /// Refines starts of all kinds; `free` is the fit without a prior.
    fn search_all<F: FilmUnderLoad>(
        &mut self,
        problem: &mut Problem<'_, F>,
        hints: &[Start],
        free: Option<&Personalization>,
    ) {
        let enough = satisfied_rms(problem.target());
        let mut starts = problem.starts(hints);
        if let Some(free) = free {
            starts.insert(0, free.as_start());
        }
        // The likeliest start alone satisfies most films.
        if let Some(first) = starts.first() {
            self.improve(problem, first);
        }
        if self.satisfies(problem, enough) {
            return;
        }
        starts.extend(problem.further_starts());
        self.improve_further(problem, &starts, enough);
        // Three angles per bend have more wrong minima than the whole shape: that fit is one more start.
        if problem.target() == FitTarget::Ferguson && !self.satisfies(problem, enough) {
            let settings = problem.settings;
            problem.settings = FitSettings { target: FitTarget::Shape, ..settings };
            let shape = fit(problem, hints, None);
            problem.settings = settings;
            self.improve(problem, &shape.as_start());
        }
    }

    /// Refines the promising ones of the starts beside the first, and every start where the residuals are large.
    fn improve_further<F: FilmUnderLoad>(
        &mut self,
        problem: &mut Problem<'_, F>,
        starts: &[Start],
        enough: f64,
    ) {
        let mut priced = problem.priced(starts);
        // No start knows by how much a base turns.
        let factor = if problem.has_turning_base() { f64::INFINITY } else { PROMISING };
        let promising = factor * priced.first().map_or(0.0, |(_, cost)| *cost);
        priced.retain(|(start, _)| starts.first() != Some(start));
        let (likely, rest): (Vec<_>, Vec<_>) =
            priced.into_iter().partition(|(_, cost)| *cost <= promising);
        self.improve_from(problem, &likely, enough);
        // A fit with large residuals may be a local minimum.
        let poor = match problem.target() {
            FitTarget::Ferguson => POOR_DEG,
            FitTarget::Shape => POOR_MM / problem.location_sd_mm(),
        };
        self.improve_from(problem, &rest, poor);
        if !self.satisfies(problem, poor) {
            let others = problem.starts_at_amplitude();
            let others = problem.priced(&others);
            self.improve_from(problem, &others, poor);
        }
    }

    /// Refines starts, which have their sums of squares, in their order until the residuals are small enough.
    fn improve_from<F: FilmUnderLoad>(
        &mut self,
        problem: &mut Problem<'_, F>,
        starts: &[(Start, f64)],
        enough_rms: f64,
    ) {
        for (start, _) in starts {
            if self.satisfies(problem, enough_rms) {
                return;
            }
            self.improve(problem, start);
        }
    }

    fn improve<F: FilmUnderLoad>(&mut self, problem: &mut Problem<'_, F>, start: &Start) {
        self.starts += 1;
        let x = problem.begin(start);
        let [lower, upper] = problem.bounds(&x);
        let end = problem.minimize(x, [&lower, &upper]);
        if end.status == FitStatus::NotEvaluable {
            return;
        }
        let (at, cost) = (problem.start_at(&end.x), end.system.cost());
        self.ends.push((at.clone(), cost));
        if self.minimum.as_ref().is_none_or(|(best, _)| cost < best.system.cost()) {
            self.minimum = Some((end, at));
        }
    }

    /// Whether the root mean square of what was measured is below a limit.
    fn satisfies<F: FilmUnderLoad>(&self, problem: &Problem<'_, F>, enough_rms: f64) -> bool {
        self.minimum.as_ref().is_some_and(|(best, _)| problem.data_rms(&best.system) < enough_rms)
    }

    /// Distinct ends that other readings of the films can make the best one, which is first.
    fn minima(&self, target: FitTarget) -> Vec<Start> {
        /// Ends whose sums of squares agree like this are one.
        const SAME: f64 = 1e-4;
        /// Other readings move the difference between the roots of two sums of squares by about the noise of one residual.
        const REACH: f64 = 10.0;
        let mut ends: Vec<&(Start, f64)> = self.ends.iter().collect();
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        ends.dedup_by(|b, a| b.1 - a.1 <= SAME * a.1);
        let farthest = REACH * satisfied_rms(target) + ends.first().map_or(0.0, |end| end.1.sqrt());
        ends.into_iter().filter(|end| end.1.sqrt() <= farthest).map(|end| end.0.clone()).collect()
    }

    /// The best end; nominal stiffness if no start could be evaluated.
    fn result<F: FilmUnderLoad>(
        self,
        problem: &Problem<'_, F>,
        free: Option<&Personalization>,
    ) -> Personalization {
        let minima = self.minima(problem.target());
        let Some((minimum, Start { log_multipliers, loads })) = self.minimum else {
            let groups = problem.springs.groups.len();
            return Personalization {
                log_multipliers: vec![0.0; groups],
                bounds: vec![StiffnessBound::Inside; groups],
                absolute_scale: 1.0,
                loads: problem.films.iter().map(|film| vec![0.0; film.load.len()]).collect(),
                status: FitStatus::NotEvaluable,
                iterations: 0,
                starts: self.starts,
                residual_rms: f64::NAN,
                variance_factor: f64::NAN,
                singular_values: Vec::new(),
                minima,
            };
        };
        Personalization {
            bounds: log_multipliers.iter().map(|&value| bound_of(value)).collect(),
            log_multipliers,
            absolute_scale: 1.0,
            loads,
            status: minimum.status,
            iterations: minimum.iterations,
            starts: self.starts,
            residual_rms: problem.data_rms(&minimum.system),
            variance_factor: match free {
                Some(free) => free.variance_factor,
                None => problem.variance_factor(&minimum),
            },
            singular_values: problem.singular_values(&minimum),
            minima,
        }
    }
}

fn bound_of(log_multiplier: f64) -> StiffnessBound {
    let near = |bound: f64| (log_multiplier - bound.ln()).abs() < 1e-6;
    match MULTIPLIER_BOUNDS {
        [lower, _] if near(lower) => StiffnessBound::Lower,
        [_, upper] if near(upper) => StiffnessBound::Upper,
        _ => StiffnessBound::Inside,
    }
}

impl<F: FilmUnderLoad> Problem<'_, F> {
    /// The starts that can be evaluated, with their sums of squares, the least first.
    fn priced(&mut self, starts: &[Start]) -> Vec<(Start, f64)> {
        let mut priced: Vec<(Start, f64)> =
            starts.iter().filter_map(|start| self.evaluable(start)).collect();
        priced.sort_by(|a, b| a.1.total_cmp(&b.1));
        priced
    }

    /// The start with its sum of squares. Where it has no equilibrium, forces along lines are those at the amplitudes, to which the
    /// path from zero leads; other loads are halved.
    fn evaluable(&mut self, start: &Start) -> Option<(Start, f64)> {
        const HALVINGS: i32 = 4;
        let mut system = System::new(self.rows(), self.unknowns());
        let mut cost_of = |problem: &mut Self, start: Start| {
            let cost = problem.cost(&start, &mut system);
            cost.is_finite().then_some((start, cost))
        };
        if let Some(found) = cost_of(self, start.clone()) {
            return Some(found);
        }
        if let Some(other) = self.at_amplitude(start) {
            return cost_of(self, other);
        }
        (1..=HALVINGS).find_map(|times| cost_of(self, start.smaller(0.5_f64.powi(times))))
    }
}
