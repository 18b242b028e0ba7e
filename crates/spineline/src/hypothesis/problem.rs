//! Equilibria of a film under a hypothesis, and the residuals of a fit with their derivatives.

use nalgebra::DVector;

use super::loads::{UnitLoad, unit_loads};
use super::{Base, Hypothesis, HypothesisFilm, Spine};
use crate::least_squares::System;
use crate::measure::Outline;
use crate::multibody::{
    GeneralStatics, LoadItem, Loading, MAX_HINGE_RAD, NewtonWork, ShapeParameter, Solution,
    SpineModel, coupled_matrix,
};
use crate::personalize::{
    FitProblem, MULTIPLIER_BOUNDS, ROWS_PER_VERTEBRA, ShapeRows, ShapeWeights, Start,
};
use crate::spatial::{Angle, Frontal, Vec3};

/// Steps in which loads grow from zero if Newton does not converge at once.
const GROWTH_STEPS: u32 = 12;

/// Springs of the spine with given multipliers.
pub(super) fn statics<'a>(spine: &Spine<'a>, log_multipliers: &[f64]) -> GeneralStatics<'a> {
    let springs = spine.library.rows().iter().zip(spine.groups.of_joint()).map(|(row, &group)| {
        let [lateral, flexion, axial] = row.nmm_per_rad;
        let springs = [lateral * log_multipliers[group].exp(), flexion, axial];
        coupled_matrix(springs, row.axial_per_lateral)
    });
    GeneralStatics::new(spine.model, springs, spine.support).expect(
        "a library has one positive spring per joint and axis, and multipliers are positive",
    )
}

/// One film under its loads.
pub(super) struct LoadedFilm {
    pub units: Vec<Vec<UnitLoad>>,
    work: NewtonWork,
    solution: Solution,
    base: Angle,
    /// Joints of every group.
    landmarks: Vec<Vec<bool>>,
}

impl LoadedFilm {
    /// `None` if the film lacks the line.
    pub fn new(
        hypothesis: Hypothesis,
        film: &HypothesisFilm<'_>,
        spine: &Spine<'_>,
    ) -> Option<Self> {
        let units = unit_loads(hypothesis.load, film, spine)?;
        let joints = spine.groups.of_joint();
        let nominal = statics(spine, &vec![0.0; spine.groups.len()]);
        let work = nominal.work(&Loading::default()).expect("no load can be wrong");
        Some(Self {
            units,
            work,
            solution: Solution::default(),
            base: Angle::ZERO,
            landmarks: (0..spine.groups.len())
                .map(|group| joints.iter().map(|of| *of == group).collect())
                .collect(),
        })
    }

    /// Forgets the last shape, from which the search for the next one starts.
    pub fn reset(&mut self) {
        self.work.hinges_mut().fill(Vec3::zeros());
    }

    /// Equilibrium with its derivatives by `ln α` of every group, by the components, and by the base's angle.
    pub fn solve(&mut self, statics: &GeneralStatics<'_>, components: &[f64], base: Angle) -> bool {
        self.base = base;
        let items = self.items(components);
        let loading = Loading { items, rods: Vec::new() };
        let found = self.solves(statics, &loading, 1.0, MAX_HINGE_RAD)
            || self.grows(statics, &loading, MAX_HINGE_RAD);
        if !found {
            return false;
        }
        let by_component: Vec<Vec<LoadItem>> = self
            .units
            .iter()
            .map(|units| units.iter().map(|unit| unit.item(1.0, base)).collect())
            .collect();
        let by_base: Vec<LoadItem> = self
            .units
            .iter()
            .zip(components)
            .flat_map(|(units, &times)| units.iter().flat_map(move |u| u.turned_items(times, base)))
            .collect();
        let parameters: Vec<ShapeParameter<'_>> = self
            .landmarks
            .iter()
            .map(|landmarks| ShapeParameter::LogLateral(landmarks))
            .chain(by_component.iter().map(|items| ShapeParameter::Loads(items)))
            .chain([ShapeParameter::Loads(&by_base)])
            .collect();
        statics.differentiate(&loading, &mut self.work, &parameters, &mut self.solution);
        self.solution.converged
    }

    /// Equilibrium under one component on a base that does not turn, with its derivative by that component, from the shape in
    /// `solution` or else from the unloaded spine. Hinges may turn without limit.
    pub fn solve_one(
        &mut self,
        statics: &GeneralStatics<'_>,
        component: f64,
        solution: &mut Solution,
    ) {
        self.base = Angle::ZERO;
        self.start_from(solution);
        let loading = Loading { items: self.items(&[component]), rods: Vec::new() };
        solution.converged = self.solves(statics, &loading, 1.0, f64::INFINITY)
            || self.grows(statics, &loading, f64::INFINITY);
        if solution.converged {
            let unit = self.items(&[1.0]);
            let parameters = [ShapeParameter::Loads(&unit)];
            statics.differentiate(&loading, &mut self.work, &parameters, solution);
        }
    }

    /// Starts the next search from a shape, or else from the unloaded spine.
    pub fn start_from(&mut self, solution: &Solution) {
        self.reset();
        for (hinge, turns) in self.work.hinges_mut().iter_mut().zip(&solution.deformed.hinges_rad) {
            *hinge = Vec3::from(*turns);
        }
    }

    fn items(&self, components: &[f64]) -> Vec<LoadItem> {
        let base = self.base;
        let all = self.units.iter().zip(components);
        all.flat_map(|(units, &times)| units.iter().map(move |unit| unit.item(times, base)))
            .collect()
    }

    fn solves(
        &mut self,
        statics: &GeneralStatics<'_>,
        loading: &Loading,
        part: f64,
        limit_rad: f64,
    ) -> bool {
        let converged = statics.solve_near(loading, part, &mut self.work).converged;
        let hinges = self.work.hinges_mut().iter();
        converged && hinges.fold(0.0, |most: f64, turns| most.max(turns.amax())) <= limit_rad
    }

    /// Lets the loads grow from zero.
    fn grows(&mut self, statics: &GeneralStatics<'_>, loading: &Loading, limit_rad: f64) -> bool {
        self.reset();
        let parts = (1..=GROWTH_STEPS).map(|step| f64::from(step) / f64::from(GROWTH_STEPS));
        let grown = parts.into_iter().all(|part| self.solves(statics, loading, part, limit_rad));
        if !grown {
            self.reset();
        }
        grown
    }

    /// A location as the film shows it, on the turned base.
    pub fn location(&self, vertebra: usize) -> Frontal {
        self.solution.deformed.location(vertebra).rotated(self.base)
    }

    /// Whether the shape is beyond the human range of motion; the base's own turn does not count.
    pub fn is_beyond_human_range(&self, erect: &SpineModel) -> bool {
        self.solution.deformed.beyond_human_range(erect).is_some()
    }

    /// A tilt as the film shows it.
    pub fn tilt(&self, vertebra: usize) -> Angle {
        (self.solution.deformed.tilt(vertebra) + self.base).wrapped()
    }

    fn base_parameter(&self) -> usize {
        self.landmarks.len() + self.units.len()
    }

    /// Derivative of a location.
    pub fn location_rate(&self, parameter: usize, vertebra: usize) -> Frontal {
        let rate = self.solution.location_rate(parameter, vertebra).rotated(self.base);
        if parameter < self.base_parameter() {
            return rate;
        }
        let place = self.location(vertebra);
        rate + Frontal::new(-place.z_mm, place.y_mm)
    }

    /// Derivative of a tilt.
    pub fn tilt_rate(&self, parameter: usize, vertebra: usize) -> f64 {
        let own = if parameter < self.base_parameter() { 0.0 } else { 1.0 };
        self.solution.tilt_rate(parameter, vertebra) + own
    }

    /// Turn of a joint per unit of a component.
    pub fn joint_rate(&self, component: usize, joint: usize) -> Vec3 {
        let turns = &self.solution.turn_rates[self.landmarks.len() + component];
        turns[joint + 1] - turns[joint]
    }
}

/// One film of a fit.
pub(super) struct FittedFilm<'a> {
    pub outline: &'a Outline,
    pub loaded: LoadedFilm,
    /// Place of its components among the unknowns; the base's angle follows them.
    pub first: usize,
    weights: ShapeWeights,
    /// The vertebrae that have rows.
    rows: ShapeRows,
}

/// Residuals of all films for given unknowns: `ln α` of every group, then per film the components and perhaps the base's angle.
///
/// Rows are locations and tilts of the vertebrae above the base that the film shows, over the deviation of their difference from the erect film's, then per film the
/// base's angle over its deviation where that is known, then the gauge.
pub(super) struct ShapeProblem<'a> {
    spine: Spine<'a>,
    hypothesis: Hypothesis,
    pub films: Vec<FittedFilm<'a>>,
    /// Multipliers that are known already.
    held: Option<Vec<f64>>,
}

impl<'a> ShapeProblem<'a> {
    /// `None` if a film lacks the line, or without films.
    pub fn new(
        hypothesis: Hypothesis,
        films: &[HypothesisFilm<'a>],
        spine: &Spine<'a>,
        held: Option<Vec<f64>>,
    ) -> Option<Self> {
        let per_film = hypothesis.load.components() + hypothesis.base.angles();
        let films: Vec<FittedFilm<'a>> = films
            .iter()
            .enumerate()
            .map(|(i, film)| {
                let weights = ShapeWeights::of_difference(&film.outline.noise, &spine.erect.noise);
                Some(FittedFilm {
                    outline: film.outline,
                    loaded: LoadedFilm::new(hypothesis, film, spine)?,
                    first: spine.groups.len() + i * per_film,
                    rows: ShapeRows::new(film.outline, Some(spine.erect), spine.model),
                    weights,
                })
            })
            .collect::<Option<_>>()?;
        (!films.is_empty()).then_some(Self { spine: *spine, hypothesis, films, held })
    }

    pub fn unknowns(&self) -> usize {
        self.spine.groups.len()
            + self.films.len() * (self.hypothesis.load.components() + self.hypothesis.base.angles())
    }

    /// Rows of the shapes of all films.
    fn shape_rows(&self) -> usize {
        self.films.iter().map(|film| film.rows.count()).sum()
    }

    /// Components and base's angle of a film among the unknowns.
    pub fn of_film<'x>(&self, film: usize, x: &'x [f64]) -> (&'x [f64], Angle) {
        let components = self.hypothesis.load.components();
        let first = self.films[film].first;
        let base = match self.hypothesis.base {
            Base::Fixed => 0.0,
            Base::Noisy | Base::Free => x[first + components],
        };
        (&x[first..first + components], Angle::from_rad(base))
    }

    fn film_rows(&self, index: usize, row: usize, system: &mut System) {
        let g = self.spine.groups.len();
        let film = &self.films[index];
        let free = g + self.hypothesis.load.components() + self.hypothesis.base.angles();
        for (place, &(i, weights)) in film.rows.vertebrae.iter().enumerate() {
            let vertebra = &film.outline.vertebrae[i];
            let row = row + ROWS_PER_VERTEBRA * place;
            let off = film.loaded.location(i) - vertebra.location;
            let turn = film.loaded.tilt(i) - vertebra.tilt;
            for (k, residual) in weights.residuals(off, turn).into_iter().enumerate() {
                system.residuals[row + k] = residual;
            }
            for p in 0..free {
                let column = if p < g { p } else { film.first + p - g };
                let (location, tilt) =
                    (film.loaded.location_rate(p, i), film.loaded.tilt_rate(p, i));
                let rates = weights.derivatives(location, tilt);
                for (k, rate) in rates.into_iter().enumerate() {
                    system.jacobian[(row + k, column)] = rate;
                }
            }
        }
        film.rows.whiten_system(row, system);
    }
}

impl FitProblem for ShapeProblem<'_> {
    /// Every search starts at the unloaded spine. A base that the start lacks does not turn.
    fn begin(&mut self, start: &Start) -> DVector<f64> {
        let mut x = DVector::zeros(self.unknowns());
        x.as_mut_slice()[..start.log_multipliers.len()].copy_from_slice(&start.log_multipliers);
        for (film, load) in self.films.iter_mut().zip(&start.loads) {
            film.loaded.reset();
            x.as_mut_slice()[film.first..film.first + load.len()].copy_from_slice(load);
        }
        x
    }

    fn start_at(&mut self, x: &DVector<f64>) -> Start {
        let per_film = self.hypothesis.load.components() + self.hypothesis.base.angles();
        let load = |film: &FittedFilm<'_>| x.as_slice()[film.first..film.first + per_film].to_vec();
        Start {
            log_multipliers: x.as_slice()[..self.spine.groups.len()].to_vec(),
            loads: self.films.iter().map(load).collect(),
        }
    }

    fn bounds(&self, _: &DVector<f64>) -> [DVector<f64>; 2] {
        let g = self.spine.groups.len();
        let bound = |limit: f64, free: f64| {
            DVector::from_fn(self.unknowns(), |i, _| match &self.held {
                Some(held) if i < g => held[i],
                None if i < g => limit.ln(),
                _ => free,
            })
        };
        [bound(MULTIPLIER_BOUNDS[0], f64::NEG_INFINITY), bound(MULTIPLIER_BOUNDS[1], f64::INFINITY)]
    }

    /// Rows of what was measured: a base of known deviation counts as one measured number per film.
    fn data_rows(&self) -> usize {
        let prior = usize::from(self.hypothesis.base == Base::Noisy);
        self.shape_rows() + self.films.len() * prior
    }

    fn rows(&self) -> usize {
        self.data_rows() + 1
    }

    fn evaluate(&mut self, x: &DVector<f64>, system: &mut System) -> bool {
        let g = self.spine.groups.len();
        let statics = statics(&self.spine, &x.as_slice()[..g]);
        let mut row = 0;
        system.jacobian.fill(0.0);
        for index in 0..self.films.len() {
            let (components, base) = self.of_film(index, x.as_slice());
            if !self.films[index].loaded.solve(&statics, components, base) {
                return false;
            }
            self.film_rows(index, row, system);
            row += self.films[index].rows.count();
        }
        if self.hypothesis.base == Base::Noisy {
            let first = self.shape_rows();
            for (i, film) in self.films.iter().enumerate() {
                let column = film.first + self.hypothesis.load.components();
                system.residuals[first + i] = x[column] / film.weights.tilt_sd_rad;
                system.jacobian[(first + i, column)] = 1.0 / film.weights.tilt_sd_rad;
            }
        }
        // Multipliers that are known already need no gauge.
        system.hold_mean(if self.held.is_none() { &x.as_slice()[..g] } else { &[] });
        system.residuals.iter().all(|r| r.is_finite())
    }
}
