//! Residuals of a fit and their derivatives, and the starts from which it is refined.

use nalgebra::{DVector, Vector3};

use super::estimate::{EstimatedLoads, JointResponses, estimate_loads};
use super::rows::{FilmData, Wanted, ferguson_rows, shape_rows};
use super::search::FitProblem;
use super::shape_weights::{ShapeRows, ShapeWeights};
use super::start::{Start, closed_form, majority_signs};
use super::{FitFilm, FitSettings, FitTarget, FittedSprings, Gauge, MULTIPLIER_BOUNDS};
use crate::clinical::ferguson_angle;
use crate::least_squares::{Minimum, System};
use crate::multibody::{
    ForceSign, Load, MAX_HINGE_RAD, Parameter, Solution, Statics, match_amplitude,
};
use crate::spatial::Frontal;

/// Rows of what was measured on a film.
fn rows_of(film: &FilmData, settings: &FitSettings<'_>) -> usize {
    match (settings.target, settings.gauge) {
        (FitTarget::Ferguson, Gauge::FrozenForce) => 4,
        (FitTarget::Ferguson, _) => 3,
        (FitTarget::Shape, _) => film.rows.count(),
    }
}

/// Residuals and derivatives of all films for given unknowns: `ln α` of every group, then load components.
///
/// With Ferguson angles as data the amplitude determines every force, so that only `ln α` is unknown.
pub(super) struct Problem<'a> {
    springs: FittedSprings<'a>,
    settings: FitSettings<'a>,
    films: Vec<FilmData>,
}

impl<'a> Problem<'a> {
    pub fn new(
        springs: FittedSprings<'a>,
        films: &[FitFilm<'_>],
        settings: &FitSettings<'a>,
    ) -> Self {
        // A free load needs the whole shape: three angles and an amplitude do not determine it.
        let mut settings = *settings;
        if films.iter().any(|film| film.load.components() > 1) {
            settings.target = FitTarget::Shape;
        }
        let held = settings.target == FitTarget::Ferguson && settings.gauge != Gauge::FrozenForce;
        let groups = springs.groups;
        let mut next = groups.len();
        let films = films
            .iter()
            .map(|film| {
                let locations: Vec<Frontal> = film.outline.locations().collect();
                let components = film.load.components();
                let first = (!held).then_some(next);
                next += if held { 0 } else { components };
                let logs = (0..groups.len()).map(Parameter::LogStiffness);
                let weights = ShapeWeights::of_film(&film.outline.noise);
                FilmData {
                    load: film.load,
                    first,
                    magnitude: vec![0.0; components],
                    ferguson: settings
                        .regions
                        .bounds
                        .each_ref()
                        .map(|b| ferguson_angle(&locations, b)),
                    lateral_tilt: locations[locations.len() - 1].lateral_tilt(),
                    locations,
                    tilts: film.outline.vertebrae.iter().map(|v| v.tilt).collect(),
                    rows: ShapeRows::new(film.outline, None, springs.model),
                    weights,
                    parameters: logs.chain((0..components).map(Parameter::Load)).collect(),
                    solution: Solution::default(),
                }
            })
            .collect();
        Self { springs, settings, films }
    }

    fn unknowns(&self) -> usize {
        let loads = self.films.iter().filter(|film| film.first.is_some());
        self.springs.groups.len() + loads.map(|film| film.load.components()).sum::<usize>()
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

    fn statics(&self, log_multipliers: &[f64]) -> Statics<'a> {
        let FittedSprings { model, library, groups } = self.springs;
        Statics::new(model, library, groups, log_multipliers, self.settings.support)
    }

    /// Starts, the likeliest first: from estimated loads, or in closed form for the majority's signs of force and then
    /// for every other combination; and the hints.
    pub fn starts(&self, films: &[FitFilm<'_>]) -> Vec<Start> {
        if films.is_empty() {
            return Vec::new();
        }
        let mut starts: Vec<Start> = match self.free_depth_mm() {
            Some(depth_mm) => self.free_starts(films, depth_mm),
            None => self.signed_starts(films),
        };
        starts.extend_from_slice(self.settings.hints);
        starts
    }

    /// The starts that can be evaluated, with their costs.
    ///
    /// Where Newton does not get from a force in closed form to the amplitude, the path from zero does.
    pub fn priced(&mut self, starts: &[Start]) -> Vec<(Start, f64)> {
        let mut system = System::new(self.rows(), self.unknowns());
        let mut priced = Vec::new();
        for start in starts {
            let mut start = start.clone();
            let mut cost = self.cost(&start, &mut system);
            if cost.is_infinite() && start.loads.iter().all(|load| load.len() == 1) {
                start = self.at_amplitude(start);
                cost = self.cost(&start, &mut system);
            }
            if cost.is_finite() {
                priced.push((start, cost));
            }
        }
        priced
    }

    /// The starts of a line load with the first forces that reach the amplitudes.
    pub fn starts_at_amplitude(&self, films: &[FitFilm<'_>]) -> Vec<Start> {
        if films.is_empty() || self.free_depth_mm().is_some() {
            return Vec::new();
        }
        self.signed_starts(films).into_iter().map(|start| self.at_amplitude(start)).collect()
    }

    fn at_amplitude(&self, start: Start) -> Start {
        let signs: Vec<f64> = start.loads.iter().map(|load| load[0]).collect();
        Start { loads: self.forces_at_amplitude(&start.log_multipliers, &signs), ..start }
    }

    fn cost(&mut self, start: &Start, system: &mut System) -> f64 {
        let x = self.begin(start);
        if self.fill(&x, system, Wanted::Residuals) { system.cost() } else { f64::INFINITY }
    }

    fn free_depth_mm(&self) -> Option<f64> {
        self.films.iter().find_map(|film| match film.load {
            Load::Frontal { depth_mm } => Some(depth_mm),
            Load::Line { .. } => None,
        })
    }

    fn free_starts(&self, films: &[FitFilm<'_>], depth_mm: f64) -> Vec<Start> {
        let (groups, load) = (self.springs.groups, Load::Frontal { depth_mm });
        let films: Vec<JointResponses<'_>> =
            films.iter().map(|film| JointResponses::to(&load, film.evidence)).collect();
        let EstimatedLoads { loads, log_multipliers } = estimate_loads(&films, groups);
        let nominal = vec![0.0; groups.len()];
        let nominal_loads: Vec<_> = films.iter().map(|film| film.load(groups, &nominal)).collect();
        let start = |log_multipliers, loads: Vec<Vector3<f64>>| Start {
            log_multipliers,
            loads: loads.iter().map(|load| load.as_slice().to_vec()).collect(),
        };
        vec![start(log_multipliers, loads), start(nominal, nominal_loads)]
    }

    fn signed_starts(&self, films: &[FitFilm<'_>]) -> Vec<Start> {
        let majority = majority_signs(films, self.springs.groups);
        let mut starts = Vec::new();
        for flips in 0..1_u32 << films.len() {
            let signs: Vec<f64> = majority
                .iter()
                .enumerate()
                .map(|(film, sign)| if flips >> film & 1 == 1 { -sign } else { *sign })
                .collect();
            let mut start = closed_form(films, self.springs.groups, &signs);
            if self.settings.gauge == Gauge::FrozenForce {
                start.loads =
                    self.forces_at_amplitude(&vec![0.0; self.springs.groups.len()], &signs);
            }
            starts.push(start);
        }
        starts
    }

    /// The first force of a sign with which given springs reach each amplitude.
    fn forces_at_amplitude(&self, log_multipliers: &[f64], signs: &[f64]) -> Vec<Vec<f64>> {
        let statics = self.statics(log_multipliers);
        self.films
            .iter()
            .zip(signs)
            .map(|(film, &sign)| {
                let sign = if sign < 0.0 { ForceSign::Negative } else { ForceSign::Positive };
                vec![match_amplitude(&statics, &film.load, sign, film.lateral_tilt).force_n]
            })
            .collect()
    }

    /// A derivative that is zero for one set of unknowns is zero for all, and is left as [`System::new`] made it.
    fn fill(&mut self, x: &DVector<f64>, system: &mut System, wanted: Wanted) -> bool {
        let g = self.springs.groups.len();
        let statics = self.statics(&x.as_slice()[..g]);
        let Self { films, settings, .. } = self;
        let mut row = 0;
        for film in films.iter_mut() {
            let solved = match film.first {
                None => film.solve_at_amplitude(&statics, wanted),
                Some(first) => {
                    let components = film.magnitude.len();
                    film.magnitude.copy_from_slice(&x.as_slice()[first..first + components]);
                    film.solve_at_magnitude(&statics, wanted)
                }
            };
            if !solved || film.solution.deformed.largest_hinge_rad() > MAX_HINGE_RAD {
                return false;
            }
            match settings.target {
                FitTarget::Ferguson => {
                    ferguson_rows(film, &settings.regions.bounds, g, row, system, wanted)
                }
                FitTarget::Shape => shape_rows(film, g, row, system, wanted),
            }
            row += rows_of(film, settings);
        }
        self.prior_rows(x, system);
        // The gauge: the mean of ln α is held at zero, unless frozen forces fix the level.
        system.hold_mean(if self.holds_mean() { &x.as_slice()[..g] } else { &[] });
        system.residuals.iter().all(|r| r.is_finite())
    }

    /// Whether the mean of `ln α` is held, and not left to frozen forces.
    pub fn holds_mean(&self) -> bool {
        self.settings.gauge != Gauge::FrozenForce
    }

    /// How far every `ln α` lies from their mean, in standard deviations of the prior: it concerns ratios, as the films do.
    fn prior_rows(&self, x: &DVector<f64>, system: &mut System) {
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

    /// Mean deviation of a location over the films.
    pub fn location_sd_mm(&self) -> f64 {
        let sum: f64 = self.films.iter().map(|film| film.weights.location_sd_mm).sum();
        sum / self.films.len() as f64
    }

    /// The data of the fit.
    pub fn target(&self) -> FitTarget {
        self.settings.target
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
}

impl FitProblem for Problem<'_> {
    fn begin(&mut self, start: &Start) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns());
        x.as_mut_slice()[..self.springs.groups.len()].copy_from_slice(&start.log_multipliers);
        for (film, load) in self.films.iter_mut().zip(&start.loads) {
            film.magnitude.copy_from_slice(load);
            if let Some(first) = film.first {
                x.as_mut_slice()[first..first + load.len()].copy_from_slice(load);
            }
        }
        x
    }

    fn start_at(&mut self, x: &DVector<f64>) -> Start {
        if self.films.iter().any(|film| film.first.is_none()) {
            let mut system = System::new(self.rows(), self.unknowns());
            self.fill(x, &mut system, Wanted::Residuals);
        }
        for film in &mut self.films {
            if let Some(first) = film.first {
                let components = film.magnitude.len();
                film.magnitude.copy_from_slice(&x.as_slice()[first..first + components]);
            }
        }
        Start {
            log_multipliers: x.as_slice()[..self.springs.groups.len()].to_vec(),
            loads: self.films.iter().map(|film| film.magnitude.clone()).collect(),
        }
    }

    /// Bounds of the unknowns; a frozen force keeps its value.
    fn bounds(&self, start: &DVector<f64>) -> [DVector<f64>; 2] {
        let g = self.springs.groups.len();
        let frozen = self.settings.gauge == Gauge::FrozenForce;
        let bound = |limit: f64, free: f64| {
            DVector::from_fn(start.len(), |i, _| match i {
                i if i < g => limit.ln(),
                i if frozen => start[i],
                _ => free,
            })
        };
        [bound(MULTIPLIER_BOUNDS[0], f64::NEG_INFINITY), bound(MULTIPLIER_BOUNDS[1], f64::INFINITY)]
    }

    fn data_rows(&self) -> usize {
        self.films.iter().map(|film| rows_of(film, &self.settings)).sum()
    }

    /// Rows of all films, of the prior, and one for the gauge.
    fn rows(&self) -> usize {
        let prior = if self.settings.prior.is_some() { self.springs.groups.len() } else { 0 };
        self.data_rows() + prior + 1
    }

    fn evaluate(&mut self, x: &DVector<f64>, system: &mut System) -> bool {
        self.fill(x, system, Wanted::Derivatives)
    }
}
