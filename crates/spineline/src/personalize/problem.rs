//! The least squares of every fit: unknowns, residuals and their derivatives.

use nalgebra::DVector;

use super::film::{FilmData, Place};
use super::start::Start;
use super::{Base, FitSettings, FitTarget, Gauge, MULTIPLIER_BOUNDS};
use crate::least_squares::{FitStatus, Minimum, System, minimize};
use crate::multibody::{FilmUnderLoad, FittedSprings, MAX_HINGE_RAD, Wanted};

/// Residuals and derivatives of all films for given unknowns: `ln α` of every group, then per film the components of its load and the
/// angle of a base that may turn.
///
/// With Ferguson angles as data the amplitude determines every force, so that only `ln α` is unknown.
///
/// Rows are of the films, of the prior, and one of the gauge.
pub(crate) struct Problem<'a, F> {
    pub(super) springs: FittedSprings<'a>,
    pub(super) settings: FitSettings<'a>,
    pub films: Vec<FilmData<'a, F>>,
    /// Multipliers that are known already.
    pub(super) held: Option<Vec<f64>>,
    /// The multiplier of the gauge over the square of its weight; zero outside of [`Self::minimize`].
    gauge_shift: f64,
}

impl<'a, F: FilmUnderLoad> Problem<'a, F> {
    pub fn new(
        springs: FittedSprings<'a>,
        mut films: Vec<FilmData<'a, F>>,
        settings: &FitSettings<'a>,
        held: Option<Vec<f64>>,
    ) -> Self {
        let mut next = springs.groups.len();
        for film in &mut films {
            film.first = next;
            next += film.load.len();
        }
        Self { springs, settings: *settings, films, held, gauge_shift: 0.0 }
    }

    /// What is fitted. A load of several numbers needs the whole shape: three angles and an amplitude do not determine it.
    pub fn target(&self) -> FitTarget {
        let several = self.films.iter().any(|film| film.load.len() > 1);
        if several { FitTarget::Shape } else { self.settings.target }
    }

    /// Whether the amplitude determines the force.
    fn holds_amplitude(&self) -> bool {
        self.target() == FitTarget::Ferguson && self.settings.gauge != Gauge::FrozenForce
    }

    /// Whether the mean of `ln α` is held, and not left to frozen forces or known.
    pub fn holds_mean(&self) -> bool {
        self.settings.gauge != Gauge::FrozenForce && self.held.is_none()
    }

    pub fn unknowns(&self) -> usize {
        let loads: usize = self.films.iter().map(|film| film.load.len()).sum();
        self.springs.groups.len() + if self.holds_amplitude() { 0 } else { loads }
    }

    /// Rows of what was measured on a film.
    fn rows_of(&self, film: &FilmData<'a, F>) -> usize {
        match self.target() {
            FitTarget::Ferguson => 3 + usize::from(!self.holds_amplitude()),
            FitTarget::Shape => film.shape_rows(),
        }
    }

    /// Rows of what was measured, which come first.
    pub fn data_rows(&self) -> usize {
        self.films.iter().map(|film| self.rows_of(film)).sum()
    }

    /// Rows of the angles of noisy bases, which no film shows.
    pub fn rows_of_bases(&self) -> usize {
        let shown = |film: &FilmData<'a, F>| film.shape_rows() - film.rows.count();
        match self.target() {
            FitTarget::Ferguson => 0,
            FitTarget::Shape => self.films.iter().map(shown).sum(),
        }
    }

    /// All rows.
    pub fn rows(&self) -> usize {
        let prior = if self.settings.prior.is_some() { self.springs.groups.len() } else { 0 };
        self.data_rows() + prior + 1
    }

    /// Sum of squares of what was measured.
    pub fn data_squares(&self, system: &System) -> f64 {
        system.residuals.rows(0, self.data_rows()).norm_squared()
    }

    /// Root mean square of what was measured.
    pub fn data_rms(&self, system: &System) -> f64 {
        (self.data_squares(system) / self.data_rows() as f64).sqrt()
    }

    /// Measured numbers minus fitted ones, of which one is the gauge's where it holds the mean.
    pub fn freedom(&self, x: &DVector<f64>) -> usize {
        let [lower, upper] = self.bounds(x);
        let free = (0..x.len()).filter(|&i| lower[i] < upper[i]).count();
        self.data_rows().saturating_sub(free - usize::from(self.holds_mean())).max(1)
    }

    /// Sum of squares over the degrees of freedom, and at least 1.
    pub fn variance_factor(&self, minimum: &Minimum) -> f64 {
        (self.data_squares(&minimum.system) / self.freedom(&minimum.x) as f64).max(1.0)
    }

    /// Mean deviation of a location over the films.
    pub fn location_sd_mm(&self) -> f64 {
        let sum: f64 = self.films.iter().map(|film| film.weights.location_sd_mm).sum();
        sum / self.films.len() as f64
    }

    /// Springs of all joints with given multipliers.
    pub fn springs(&self, log_multipliers: &[f64]) -> F::Springs<'a> {
        F::springs(self.springs, log_multipliers, self.settings.support)
    }

    /// Puts a start's loads in place, and gives its unknowns. A base that the start lacks does not turn.
    pub fn begin(&mut self, start: &Start) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns());
        let x_of = x.as_mut_slice();
        x_of[..start.log_multipliers.len()].copy_from_slice(&start.log_multipliers);
        let is_held = self.holds_amplitude();
        for (film, load) in self.films.iter_mut().zip(&start.loads) {
            film.loaded.reset();
            film.load.fill(0.0);
            film.load[..load.len()].copy_from_slice(load);
            if !is_held {
                x_of[film.first..film.first + load.len()].copy_from_slice(load);
            }
        }
        x
    }

    /// The start that belongs to given unknowns.
    pub fn start_at(&mut self, x: &DVector<f64>) -> Start {
        if self.holds_amplitude() {
            let mut system = System::new(self.rows(), self.unknowns());
            self.fill(x, &mut system, Wanted::Shape);
        } else {
            for film in &mut self.films {
                let unknowns = film.first..film.first + film.load.len();
                film.load.copy_from_slice(&x.as_slice()[unknowns]);
            }
        }
        Start {
            log_multipliers: x.as_slice()[..self.springs.groups.len()].to_vec(),
            loads: self.films.iter().map(|film| film.load.clone()).collect(),
        }
    }

    /// Bounds of the unknowns of a fit from a start; multipliers that are known and a frozen force keep their values.
    pub fn bounds(&self, start: &DVector<f64>) -> [DVector<f64>; 2] {
        let g = self.springs.groups.len();
        let frozen = self.settings.gauge == Gauge::FrozenForce;
        let bound = |limit: f64, free: f64| {
            DVector::from_fn(start.len(), |i, _| match (i < g, &self.held) {
                (true, Some(held)) => held[i],
                (true, None) => limit.ln(),
                (false, _) if frozen => start[i],
                (false, _) => free,
            })
        };
        [bound(MULTIPLIER_BOUNDS[0], f64::NEG_INFINITY), bound(MULTIPLIER_BOUNDS[1], f64::INFINITY)]
    }

    /// Fits the unknowns within bounds.
    ///
    /// Residuals move the mean of `ln α` against the gauge where multipliers are at bounds or springs carry a weight. The gauge then moves
    /// the other way, and the fit continues: the method of multipliers [hestenes-1969].
    pub fn minimize(&mut self, x: DVector<f64>, bounds: [&DVector<f64>; 2]) -> Minimum {
        const MAX_SHIFTS: usize = 20;
        let rows = self.rows();
        let fit = |problem: &mut Self, x: DVector<f64>| {
            let [lower, upper] = bounds;
            minimize(x, lower, upper, rows, |x, system| problem.fill(x, system, Wanted::AllRates))
        };
        let mut end = fit(self, x);
        for _ in 0..MAX_SHIFTS {
            let mean = self.mean_off_gauge(&end.x);
            if end.status != FitStatus::Converged || mean.abs() <= Self::ON_GAUGE {
                break;
            }
            self.gauge_shift += mean;
            let iterations = end.iterations;
            end = fit(self, end.x);
            end.iterations += iterations;
        }
        if self.gauge_shift != 0.0 {
            self.gauge_shift = 0.0;
            self.end_on_gauge(&mut end, bounds);
        }
        end
    }

    /// Largest mean of `ln α` from which [`Self::end_on_gauge`] moves it to zero.
    const ON_GAUGE: f64 = 1e-5;

    /// The mean of `ln α`, where the gauge holds it at zero.
    fn mean_off_gauge(&self, x: &DVector<f64>) -> f64 {
        let groups = self.springs.groups.len();
        if self.holds_mean() { x.rows(0, groups).sum() / groups as f64 } else { 0.0 }
    }

    /// Moves the multipliers between their bounds by what remains of the mean. A fit that the gauge does not hold has not converged.
    fn end_on_gauge(&mut self, end: &mut Minimum, [lower, upper]: [&DVector<f64>; 2]) {
        let groups = self.springs.groups.len();
        let rest = self.mean_off_gauge(&end.x);
        let inside = |&i: &usize| lower[i] < end.x[i] && end.x[i] < upper[i];
        let free: Vec<usize> = (0..groups).filter(inside).collect();
        for &i in &free {
            end.x[i] -= rest * groups as f64 / free.len() as f64;
        }
        let is_solved = self.fill(&end.x, &mut end.system, Wanted::AllRates);
        if end.status == FitStatus::Converged && !(is_solved && rest.abs() <= Self::ON_GAUGE) {
            end.status = FitStatus::IterationLimit;
        }
    }

    /// Sum of squares at a start; infinite where a film has no equilibrium that counts.
    pub fn cost(&mut self, start: &Start, system: &mut System) -> f64 {
        let x = self.begin(start);
        if self.fill(&x, system, Wanted::Shape) { system.cost() } else { f64::INFINITY }
    }

    /// A derivative that is zero for one set of unknowns is zero for all, and is left as [`System::new`] made it.
    fn fill(&mut self, x: &DVector<f64>, system: &mut System, wanted: Wanted) -> bool {
        let g = self.springs.groups.len();
        let springs = self.springs(&x.as_slice()[..g]);
        let (target, holds_amplitude) = (self.target(), self.holds_amplitude());
        let mut at = Place { row: 0, groups: g, holds_amplitude };
        for index in 0..self.films.len() {
            let film = &mut self.films[index];
            let solved = if holds_amplitude {
                film.solve_at_amplitude(&springs, wanted)
            } else {
                let unknowns = film.first..film.first + film.load.len();
                film.load.copy_from_slice(&x.as_slice()[unknowns]);
                film.solve_at_load(&springs, wanted)
            };
            let shape = &film.loaded.solution().deformed;
            if !solved || shape.largest_hinge_rad() > MAX_HINGE_RAD {
                return false;
            }
            match target {
                FitTarget::Ferguson => {
                    film.fill_ferguson(&self.settings.regions.bounds, at, system, wanted);
                }
                FitTarget::Shape => film.fill_shape(at, system, wanted),
            }
            at.row += self.rows_of(&self.films[index]);
        }
        self.fill_prior(x, system);
        // The gauge: the mean of ln α is held at zero, unless frozen forces fix the level or it is known.
        let held = if self.holds_mean() { &x.as_slice()[..g] } else { &[] };
        system.hold_mean(held, self.gauge_shift);
        system.residuals.iter().all(|r| r.is_finite())
    }

    /// How far every `ln α` lies from their mean, in standard deviations of the prior: it concerns ratios, as the films do.
    fn fill_prior(&self, x: &DVector<f64>, system: &mut System) {
        let Some(prior) = self.settings.prior else { return };
        let (first, g) = (self.data_rows(), self.springs.groups.len());
        let mean = x.as_slice()[..g].iter().sum::<f64>() / g as f64;
        for i in 0..g {
            system.residuals[first + i] = (x[i] - mean) / prior.log_sd;
            for j in 0..g {
                let own = if i == j { 1.0 } else { 0.0 };
                system.jacobian[(first + i, j)] = (own - 1.0 / g as f64) / prior.log_sd;
            }
        }
    }

    /// Singular values of the data's derivative by `(ln α, ln F)`, so that all unknowns are ratios.
    pub fn singular_values(&self, minimum: &Minimum) -> Vec<f64> {
        let mut scaled = minimum.system.jacobian.rows(0, self.data_rows()).into_owned();
        for i in self.springs.groups.len()..minimum.x.len() {
            scaled.column_mut(i).scale_mut(minimum.x[i].abs());
        }
        let mut values: Vec<f64> = scaled.singular_values().iter().copied().collect();
        values.sort_by(|a, b| b.total_cmp(a));
        values
    }

    /// Whether the base of a film may turn.
    pub(super) fn has_turning_base(&self) -> bool {
        self.films.iter().any(|film| film.base != Base::Fixed)
    }
}
