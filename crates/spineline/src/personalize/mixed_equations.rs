//! The equations of the loads of best fit to the rotations, linearised about unknowns (`preferred.rs` has the model).

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::MULTIPLIER_BOUNDS;
use super::acceleration::IterationStep;
use super::evidence::FilmEvidence;
use super::preferred_loads::PreferredLoads;
use super::random_effects::{Normal, OwnParts, RandomEffects, VARIANCES, Waves};
use super::tilt_errors::TiltErrors;
use super::weights::{Precision, inverse_of, scale_columns};
use crate::clinical::JointShares;
use crate::multibody::Load;

/// Upper bounds of the variances: of springs (of `ln`, by joint), of centres (in discs) and of springs along the spine (of `ln`).
pub(super) const MAX_VARIANCES: Vector3<f64> = Vector3::new(1.0, 4.0, 1.0);
/// Centres of rotation lie between the middles of the vertebrae.
const MAX_HIGHER_DISCS: f64 = 3.0;
/// Deviation of the shared shift of the centres before films are seen: loads and this shift are hard to tell apart.
const HIGHER_SD_DISCS: f64 = 1.0;
/// The least variance as a part of the upper bound: in effect zero.
const MIN_OF_MAX_VARIANCE: f64 = 1e-9;
/// Mean and standard deviation of the prior of the evenness with which joints turn: from 0, a hinge, to 1, a rod.
const EVENNESS: f64 = 0.5;
const EVENNESS_SD: f64 = 0.289;
/// Gamma priors of the deviations, flat but near zero where they vanish: shape 2 [chung-2013]. Per `ln` of a variance, half of the shape
/// beyond one.
const PRIOR: f64 = 0.5;
/// A longer step of multipliers leaves the range of the linear theory.
const MAX_LOG_STEP: f64 = 0.5;

/// Rotations of all films below one another, and the numbers fitted to them.
pub(super) struct Fit<'a> {
    films: usize,
    joints: usize,
    shares: &'a JointShares,
    /// Nominal responses to the components of every film's own load.
    responses: Vec<Vec<[f64; 3]>>,
    /// Their change per disc by which a joint's centre lies higher.
    higher: Vec<Vec<[f64; 3]>>,
    centres_higher_discs: f64,
    /// Their change from hinges to joints that bend uniformly.
    evener: Vec<Vec<[f64; 3]>>,
    /// From 0 for hinges to 1 for joints that bend uniformly.
    evenness: f64,
    rotations: DMatrix<f64>,
    precision: Precision,
    waves: &'a Waves,
    pub loads: DVector<f64>,
    logs: Vec<f64>,
    /// Random effects of the joints, about which the equations are linear.
    own: Vec<OwnParts>,
    /// Compliance of every joint over the nominal one, by group: the parts of a joint in several groups act in series.
    softness_by_group: DMatrix<f64>,
    /// Its sum over the groups.
    softness: DVector<f64>,
    by_loads: LoadColumns,
}

/// Rotations by the loads' components at the present unknowns, in scaled columns.
#[derive(Default)]
struct LoadColumns {
    columns: DMatrix<f64>,
    scales: DVector<f64>,
    /// The same columns times the precision.
    weighed: DMatrix<f64>,
}

/// The linearised fit at given variances of the random effects.
pub(super) struct Linearized<'a> {
    /// By the loads, the free multipliers and the centres, in scaled columns.
    scales: DVector<f64>,
    /// Derivatives of the rotations by these, and of the random effects that follow them.
    jacobian: DMatrix<f64>,
    own_by_fitted: DMatrix<f64>,
    /// Derivative of the likelihood by the fitted numbers.
    slope: DVector<f64>,
    /// Their covariance.
    covariance: DMatrix<f64>,
    own: RandomEffects<'a>,
    /// Predicted random effects, joint by joint.
    pub expected: Vec<OwnParts>,
    /// Rotations by the random effects about which the equations are linear.
    by_own: DMatrix<f64>,
    /// Of the restricted likelihood by the variances.
    score: Vector3<f64>,
    information: Matrix3<f64>,
    ways: DMatrix<f64>,
}

impl Linearized<'_> {
    /// Of the loads, the free multipliers and the centres.
    fn gauss_newton_step(&self) -> DVector<f64> {
        (&self.covariance * &self.slope).component_div(&self.scales)
    }

    /// One scoring step of the variances' logarithms. Their priors keep them above zero, where the films would not determine them.
    fn scoring_step(&self, variances: Vector3<f64>) -> Vector3<f64> {
        const MAX_LOG_SCORING_STEP: f64 = 2.0;
        let score = variances.component_mul(&self.score).add_scalar(PRIOR);
        let scaled = Matrix3::from_diagonal(&variances);
        // The priors lack curvature in logarithms; this much keeps a step finite where films say nothing.
        let information = scaled * self.information * scaled + Matrix3::identity() * 0.25;
        let step = information.try_inverse().map_or(score, |inverse| inverse * score);
        variances.zip_map(&step, |v, step| {
            v * step.clamp(-MAX_LOG_SCORING_STEP, MAX_LOG_SCORING_STEP).exp()
        })
    }
}

impl<'a> Fit<'a> {
    pub fn new(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &'a JointShares,
        waves: &'a Waves,
    ) -> Option<Self> {
        if films.is_empty() {
            return None;
        }
        let joints = shares.0.nrows();
        let all = films.iter().flat_map(|film| &film.joints).map(|joint| joint.rotation.rad());
        let rotations = DMatrix::from_iterator(films.len() * joints, 1, all);
        let precision = Precision::new(films, joints)?;
        let by_film = |responses: &dyn Fn(&FilmEvidence) -> Vec<[f64; 3]>| {
            films.iter().map(|film| responses(film)).collect()
        };
        let mut fit = Self {
            films: films.len(),
            joints,
            shares,
            responses: by_film(&|film| film.responses(&Load::Frontal { depth_mm })),
            higher: by_film(&|film| film.shifted_responses(|joint| joint.disc_mm)),
            centres_higher_discs: 0.0,
            evener: by_film(&|film| film.shifted_responses(|joint| joint.to_evener_mm)),
            evenness: EVENNESS,
            rotations,
            precision,
            waves,
            loads: DVector::zeros(3 * films.len()),
            logs: vec![0.0; shares.0.ncols()],
            own: vec![OwnParts::default(); joints],
            softness_by_group: DMatrix::default(),
            softness: DVector::default(),
            by_loads: LoadColumns::default(),
        };
        fit.update_derived();
        Some(fit)
    }

    /// Sets multipliers, centres and evenness.
    pub fn begin(&mut self, logs: &[f64], centres_higher_discs: f64, evenness: f64) {
        self.logs.copy_from_slice(logs);
        (self.centres_higher_discs, self.evenness) = (centres_higher_discs, evenness);
        self.update_derived();
    }

    /// Damped update of the random effects; returns the largest change. [`Fit::set_unknowns`] or [`Fit::begin`] has to follow.
    pub fn take_own(&mut self, expected: &[OwnParts], part: f64) -> f64 {
        let mut most = 0.0_f64;
        for (own, expected) in self.own.iter_mut().zip(expected) {
            let softer = part * (expected.log_softness - own.log_softness);
            let higher = part * (expected.higher_discs - own.higher_discs);
            own.log_softness += softer;
            own.higher_discs += higher;
            most = most.max(softer.abs()).max(higher.abs());
        }
        most
    }

    /// Updates the values that depend on multipliers, centres, evenness and random effects.
    fn update_derived(&mut self) {
        let softness_of_group: Vec<f64> = self.logs.iter().map(|log| (-log).exp()).collect();
        let softer: Vec<f64> = self.own.iter().map(|own| own.log_softness.exp()).collect();
        self.softness_by_group = DMatrix::from_fn(self.joints, self.logs.len(), |joint, group| {
            self.shares.0[(joint, group)] * softness_of_group[group] * softer[joint]
        });
        self.softness = self.softness_by_group.column_sum();
        self.by_loads = self.load_columns();
    }

    fn load_columns(&self) -> LoadColumns {
        let mut columns = DMatrix::zeros(self.rotations.len(), 3 * self.films);
        for joint in 0..self.joints {
            let softness = self.softness[joint];
            let centre_higher = self.centres_higher_discs + self.own[joint].higher_discs;
            for film in 0..self.films {
                let nominal = self.responses[film][joint];
                let (higher, evener) = (self.higher[film][joint], self.evener[film][joint]);
                for part in 0..3 {
                    columns[(film * self.joints + joint, 3 * film + part)] = softness
                        * (nominal[part]
                            + centre_higher * higher[part]
                            + self.evenness * evener[part]);
                }
            }
        }
        let scales = scale_columns(&mut columns);
        LoadColumns { weighed: self.precision.times_of_films(&columns), columns, scales }
    }

    /// Rotations of all films' joints by the present loads, with these responses.
    fn rotations_by(&self, responses: &[Vec<[f64; 3]>]) -> DMatrix<f64> {
        DMatrix::from_fn(self.joints, self.films, |joint, film| {
            let load = &self.loads.as_slice()[3 * film..3 * film + 3];
            let turn = responses[film][joint].iter().zip(load).map(|(by, part)| by * part);
            self.softness[joint] * turn.sum::<f64>()
        })
    }

    /// Directions among the `ln α` that keep their mean without those at a bound.
    fn free_directions(&self) -> DMatrix<f64> {
        let g = self.logs.len();
        let limit = MULTIPLIER_BOUNDS[1].ln();
        let free: Vec<usize> = (0..g).filter(|&i| self.logs[i].abs() < limit).collect();
        let Some((&last, others)) = free.split_last() else { return DMatrix::zeros(g, 0) };
        let mut ways = DMatrix::zeros(g, others.len());
        for (column, &group) in others.iter().enumerate() {
            (ways[(group, column)], ways[(last, column)]) = (1.0, -1.0);
        }
        ways
    }

    pub fn linearize(&self, variances: Vector3<f64>) -> Option<Linearized<'a>> {
        let by_loads = &self.by_loads;
        let ways = self.free_directions();
        let (rows, loads, others) = (self.rotations.len(), 3 * self.films, ways.ncols() + 2);
        let predicted = &by_loads.columns * self.loads.component_mul(&by_loads.scales);
        let higher = self.rotations_by(&self.higher);
        let evener = self.rotations_by(&self.evener);
        let softer = DMatrix::from_fn(self.joints, self.logs.len(), |joint, group| {
            self.softness_by_group[(joint, group)] / self.softness[joint]
        }) * &ways;
        let mut further = DMatrix::from_fn(rows, others, |row, column| match column {
            way if way < ways.ncols() => -predicted[row] * softer[(row % self.joints, way)],
            centres if centres == ways.ncols() => higher[row],
            _ => evener[row],
        });
        let scales = DVector::from_iterator(
            loads + others,
            by_loads.scales.iter().chain(scale_columns(&mut further).iter()).copied(),
        );
        let by_films = DMatrix::from_column_slice(self.joints, self.films, predicted.as_slice());
        let by_own = self.rotations_by_own(&by_films, &higher);
        let predicted = DMatrix::from_column_slice(rows, 1, predicted.as_slice());
        let residual = &self.rotations - &predicted + &by_own;
        let weighed_residual = self.precision.times(&residual);
        let jacobian = beside(&by_loads.columns, &further);
        let weighed = beside(&by_loads.weighed, &self.precision.times(&further));
        let own = RandomEffects::new(self.waves, [by_films, higher], &self.precision, variances)?;
        let mut found =
            Normal::new([&jacobian, &weighed], [&residual, &weighed_residual], Some(&own));
        let (last, scale) = (loads + others - 1, scales[loads + others - 1]);
        found.matrix[(last, last)] += 1.0 / (EVENNESS_SD.powi(2) * scale * scale);
        found.right[last] += (EVENNESS - self.evenness) / (EVENNESS_SD.powi(2) * scale);
        let (higher, scale) = (last - 1, scales[last - 1]);
        found.matrix[(higher, higher)] += 1.0 / (HIGHER_SD_DISCS.powi(2) * scale * scale);
        found.right[higher] -= self.centres_higher_discs / (HIGHER_SD_DISCS.powi(2) * scale);
        let covariance = inverse_of(found.matrix)?;
        let slope = found.right.column(0).into_owned();
        // The predicted random effects of the joints, and their covariance given the rotations, with the unknowns free.
        let expected =
            &found.effects_by_residual - &found.effects_by_columns * (&covariance * &found.right);
        let unsure = &own.covariance
            + &found.effects_by_columns * &covariance * found.effects_by_columns.transpose();
        let (score, information) = own.scoring(&expected, &unsure);
        let expected = own.by_joint(&expected);
        Some(Linearized {
            scales,
            jacobian,
            own_by_fitted: found.effects_by_columns,
            slope,
            covariance,
            own,
            expected,
            by_own,
            score,
            information,
            ways,
        })
    }

    /// Rotations by the random effects, from the rotations by the loads and by centres a disc higher; joints by films.
    fn rotations_by_own(&self, by_loads: &DMatrix<f64>, higher: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(self.rotations.len(), 1, |row, _| {
            let own = &self.own[row % self.joints];
            by_loads[row] * own.log_softness + higher[row] * own.higher_discs
        })
    }

    /// One scoring step of the variances, and one Gauss-Newton step of multipliers and centres. Alone they converge slowly:
    /// residuals are large, and scoring knows the expected curvature only.
    pub fn iterate(&self, at: &Linearized<'_>, variances: Vector3<f64>) -> IterationStep {
        self.iterate_by(&at.gauss_newton_step(), at, variances)
    }

    fn iterate_by(
        &self,
        step: &DVector<f64>,
        at: &Linearized<'_>,
        variances: Vector3<f64>,
    ) -> IterationStep {
        let mut change = &at.ways * step.rows(3 * self.films, at.ways.ncols());
        let longest = change.amax();
        let part = if longest > MAX_LOG_STEP { MAX_LOG_STEP / longest } else { 1.0 };
        change *= part;
        let shifts = step.rows(3 * self.films + at.ways.ncols(), 2) * part;
        let from = self.place(variances);
        let mut to = from.clone();
        to.rows_mut(0, VARIANCES).copy_from(&at.scoring_step(variances).map(f64::ln));
        to.rows_range_mut(VARIANCES..VARIANCES + self.logs.len()).add_assign(&change);
        to[VARIANCES + self.logs.len()] += shifts[0] / MAX_HIGHER_DISCS;
        to[VARIANCES + 1 + self.logs.len()] += shifts[1];
        self.clamp(&mut to);
        IterationStep { from, to }
    }

    /// All nonlinear unknowns: `ln` of the variances, `ln α`, the shift of the centres as a part of its maximum, and the evenness.
    pub fn place(&self, variances: Vector3<f64>) -> DVector<f64> {
        let variances = variances.map(f64::ln);
        let all = variances.iter().chain(&self.logs).copied();
        let higher = self.centres_higher_discs / MAX_HIGHER_DISCS;
        DVector::from_iterator(VARIANCES + 2 + self.logs.len(), all.chain([higher, self.evenness]))
    }

    /// The same, and then the loads in parts of some sizes.
    pub fn place_with_loads(&self, variances: Vector3<f64>, sizes: &DVector<f64>) -> DVector<f64> {
        beside_each_other(&self.place(variances), &self.loads.component_div(sizes))
    }

    /// Sets all unknowns of such a place, and returns its variances.
    pub fn set_place_with_loads(
        &mut self,
        place: &DVector<f64>,
        sizes: &DVector<f64>,
    ) -> Vector3<f64> {
        self.loads = place.rows(place.len() - sizes.len(), sizes.len()).component_mul(sizes);
        self.set_unknowns(place)
    }

    /// One round for such a place: as [`Fit::iterate`], and the loads by the same Gauss-Newton step.
    pub fn step_with_loads(
        &self,
        at: &Linearized<'_>,
        variances: Vector3<f64>,
        sizes: &DVector<f64>,
    ) -> DVector<f64> {
        let step = at.gauss_newton_step();
        let loads = step.rows(0, sizes.len()).component_div(sizes);
        beside_each_other(&self.iterate_by(&step, at, variances).step(), &loads)
    }

    /// Groups of joints that share a multiplier.
    pub fn groups(&self) -> usize {
        self.logs.len()
    }

    /// Whether a multiplier would be put on its bound.
    pub fn is_bounded(&self, place: &DVector<f64>) -> bool {
        let limit = MULTIPLIER_BOUNDS[1].ln();
        place
            .rows_range(VARIANCES..VARIANCES + self.logs.len())
            .iter()
            .any(|log| log.is_nan() || log.abs() > limit)
    }

    pub fn within(&self, mut place: DVector<f64>) -> DVector<f64> {
        self.clamp(&mut place);
        place
    }

    /// Size of the force and moment of every load component, by which changes are measured.
    pub fn load_sizes(&self) -> DVector<f64> {
        /// Least distance of a force.
        const LEAST_ARM_MM: f64 = 100.0;
        let sizes = self.loads.as_slice().chunks_exact(3).flat_map(|load| {
            let force = load[0].hypot(load[1]).max(f64::MIN_POSITIVE);
            [force, force, load[2].abs().max(LEAST_ARM_MM * force)]
        });
        DVector::from_iterator(self.loads.len(), sizes)
    }

    fn clamp(&self, place: &mut DVector<f64>) {
        for (i, most) in MAX_VARIANCES.map(f64::ln).iter().enumerate() {
            place[i] = place[i].clamp(most + MIN_OF_MAX_VARIANCE.ln(), *most);
        }
        let limit = MULTIPLIER_BOUNDS[1].ln();
        for log in place.rows_range_mut(VARIANCES..VARIANCES + self.logs.len()).iter_mut() {
            *log = log.clamp(-limit, limit);
        }
        let higher = &mut place[VARIANCES + self.logs.len()];
        *higher = higher.clamp(-1.0, 1.0);
    }

    /// Sets multipliers, centres and evenness of a place, and returns its variances.
    pub fn set_unknowns(&mut self, place: &DVector<f64>) -> Vector3<f64> {
        let groups = self.logs.len();
        self.logs.copy_from_slice(&place.as_slice()[VARIANCES..VARIANCES + groups]);
        self.centres_higher_discs = place[VARIANCES + groups] * MAX_HIGHER_DISCS;
        self.evenness = place[VARIANCES + 1 + groups];
        self.update_derived();
        Vector3::from_fn(|i, _| place[i].exp())
    }

    /// The best loads at the present multipliers, which is linear; the random effects come from an earlier step.
    pub fn solve_loads(&mut self, at: Option<&Linearized<'_>>) -> Option<()> {
        let by_loads = &self.by_loads;
        let no_own = || self.rotations.clone();
        let rotations = at.map_or_else(no_own, |at| &self.rotations + &at.by_own);
        let found = Normal::new(
            [&by_loads.columns, &by_loads.weighed],
            [&rotations, &self.precision.times(&rotations)],
            at.map(|at| &at.own),
        );
        let solved = found.matrix.cholesky()?.solve(&found.right);
        self.loads = solved.column(0).component_div(&by_loads.scales);
        Some(())
    }

    /// Derivatives of every load component by the error of every rotation, components by rotations: `(X' V^-1 X)^-1 X' V^-1`.
    fn loads_by_errors(&self, at: &Linearized<'_>) -> DMatrix<f64> {
        let loads = 3 * self.films;
        let fitted = &at.covariance.columns(0, loads);
        let own = at.own.rotations(&(&at.own_by_fitted * fitted));
        let mut weights = self.precision.times(&(&at.jacobian * fitted - own));
        for (mut column, scale) in weights.column_iter_mut().zip(&at.scales) {
            column /= *scale;
        }
        weights.transpose()
    }

    pub fn finish(
        &self,
        films: &[&FilmEvidence],
        variances: Vector3<f64>,
        at: &Linearized<'_>,
    ) -> PreferredLoads {
        let loads = 3 * self.films;
        let covariance = DMatrix::from_fn(loads, loads, |i, j| {
            at.covariance[(i, j)] / (at.scales[i] * at.scales[j])
        });
        PreferredLoads {
            components: (0..self.films)
                .map(|film| [0, 1, 2].map(|part| self.loads[3 * film + part]))
                .collect(),
            log_multipliers: self.logs.clone(),
            centres_higher_discs: self.centres_higher_discs,
            evenness: self.evenness,
            joint_log_sd: variances[0].sqrt(),
            centre_sd_discs: variances[1].sqrt(),
            trend_log_sd: variances[2].sqrt(),
            own: self.own.clone(),
            covariance,
            from_tilts: TiltErrors::of_films(films, &self.loads_by_errors(at)),
        }
    }
}

fn beside_each_other(first: &DVector<f64>, then: &DVector<f64>) -> DVector<f64> {
    DVector::from_iterator(first.len() + then.len(), first.iter().chain(then).copied())
}

/// A matrix with further columns.
fn beside(matrix: &DMatrix<f64>, further: &DMatrix<f64>) -> DMatrix<f64> {
    let all = [matrix.as_slice(), further.as_slice()].concat();
    DMatrix::from_vec(matrix.nrows(), matrix.ncols() + further.ncols(), all)
}

#[cfg(test)]
mod tests;
