//! The loads that fit the measured rotations best, with their uncertainty.
//!
//! # Model
//! The rotation of joint `j` on a film is `(a_j · w) / α e^(δ_j)` and noise: `w` is the planar load, `a_j` its nominal
//! response about the joint's centre and `α` the multiplier of the joint's group. What a joint has of its own is the same on
//! every film: `δ_j` of its stiffness, which is a part of its own and a random walk along the spine, since stiffness need not
//! step where regions end; and a centre that lies higher up the disc than the model has it, by a part of the
//! disc that all joints share and a part of its own. A joint in which a region ends has springs of both. A hinge's centre
//! lies where tangents meet; the more evenly joints turn over their length, the nearer it is to the chord. Noise is that of
//! the tilts: neighbouring joints share a vertebra and all films share the erect one, so that the rotations of all films
//! have one covariance.
//!
//! Loads, multipliers, the shared part of the centres and the evenness are fitted by generalised least squares; the deviations of what
//! joints have of their own by restricted maximum likelihood (scoring), with priors by which none is zero. So the films
//! themselves give how far joints of one group differ, and the uncertainty of a load follows from it.
//!
//! # Equations
//! With the rotations of all films in one vector `y`, the fitted numbers `b` (loads `w`, multipliers `ln alpha`, shared shift
//! of the centres, evenness), what joints have of their own `u = (delta, centres, steps of the walk)` and the noise `e`:
//!
//! ```text
//! y = f(b) + Z u + e,    u ~ N(0, D),  D = diag(s_1 I, s_2 I, s_3 I),    e ~ N(0, S),  S = S_films (x) S_joints
//! S_films[a,b]  = delta_ab sd_a^2 + sd_erect^2            tilts of a film, and of the erect film that all share
//! S_joints[i,j] = 2 on the diagonal, -1 beside it         neighbouring joints share a vertebra
//! ```
//!
//! With `X = df/db`, `r = y - f(b)` and `V = S + Z D Z'`, generalised least squares solve `X' V^-1 X db = X' V^-1 r`, and the
//! covariance of `b` is `(X' V^-1 X)^-1`; `V^-1` is applied by Woodbury's identity. The variances `s_1` (of `ln` stiffness),
//! `s_2` (of centres, in discs) and `s_3` (of `ln` stiffness along the spine, mean over the joints) maximise the restricted likelihood
//!
//! ```text
//! l_R(s) = -1/2 (ln|V| + ln|X' V^-1 X| + r' V^-1 r) + sum_i p_i ln s_i
//! ```
//!
//! where the last term is the prior. With the prediction `u_i` of the own part `i` for `q` joints, and `C` the covariance of
//! `u - predicted u` with `b` unknown, Fisher scoring on `ln s_i` uses
//!
//! ```text
//! dl_R/ds_i = 1/2 (|u_i|^2 / s_i - (q - tr C_ii / s_i)) / s_i
//! I_ij      = 1/2 |delta_ij I / s_i - C_ij / (s_i s_j)|_F^2
//! ```
//!
//! One scoring step of the variances and one Gauss-Newton step of `b` alternate until nothing moves. Evenness and the shared shift of
//! the centres have normal priors.
//!
//! # References
//! [harville-1977] for the restricted likelihood, [chung-2013] for the priors.

use std::ops::AddAssign;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::MULTIPLIER_BOUNDS;
use super::acceleration::{IterationStep, anderson_step};
use super::evidence::{FilmEvidence, JointEvidence};
use super::weights::{Normal, Precision, RandomEffects, scale_columns};
use crate::clinical::JointShares;
use crate::multibody::Load;
use crate::spatial::Frontal;

/// Loads of several films that share springs.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferredLoads {
    /// `(fy, fz, mx)` about the origin of `G` per film, in N and N·mm, up to the level of stiffness.
    pub components: Vec<[f64; 3]>,
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
    /// How much further up their discs the joints turn than the model has their centres, in thicknesses of the disc.
    pub centres_higher_discs: f64,
    /// How evenly joints turn over their length: 0 for hinges, 1 for a rod.
    pub evenness: f64,
    /// Deviation of `ln` stiffness among the joints of a group, of every joint by itself.
    pub joint_log_sd: f64,
    /// Deviation of `ln` stiffness by what changes slowly along the spine.
    pub trend_log_sd: f64,
    /// Deviation of the joints' centres along the spine about that, in thicknesses of the disc.
    pub centre_sd_discs: f64,
    /// Covariance of all components, film by film, with multipliers free.
    pub(super) covariance: DMatrix<f64>,
}

/// Variances beyond these are none of springs (of `ln`, by joint), of centres (in discs) and of springs along the spine (of `ln`).
const MAX_VARIANCES: Vector3<f64> = Vector3::new(1.0, 4.0, 1.0);
/// Centres of rotation lie between the middles of the vertebrae.
const MAX_HIGHER_DISCS: f64 = 3.0;
/// Deviation of the shared shift of the centres before films are seen: loads and this shift are hard to tell apart.
const HIGHER_SD_DISCS: f64 = 1.0;
/// Variances below this part of the most are none.
const MIN_OF_MAX_VARIANCE: f64 = 1e-9;
/// How evenly joints turn is not known: anywhere between a hinge, 0, and a rod, 1. Mean and deviation of that.
const EVENNESS: f64 = 0.5;
const EVENNESS_SD: f64 = 0.289;
/// Gamma priors of the deviations, flat but near zero where they vanish: shapes 2, 3/2 and 4, the latter two of centres and of
/// what changes slowly along the spine, chosen by how often regions hold the true line (`docs/decisions/0024`). Per `ln` of a
/// variance, half of the shape beyond one.
const PRIORS: Vector3<f64> = Vector3::new(0.5, 0.25, 1.5);
/// Number of the variances.
const VARIANCES: usize = 3;
const ROUNDS: usize = 150;
/// From this round on steps are shortened and not extrapolated: some fits go to and fro.
const DAMPED_FROM: usize = 30;
const DAMPING: f64 = 0.35;
/// A longer step of multipliers leaves what the linear theory knows.
const MAX_LOG_STEP: f64 = 0.5;
/// The iteration has converged when no unknown moves by more than this.
const CONVERGED_STEP: f64 = 1e-4;

impl PreferredLoads {
    /// Fits them; `None` without films, where the films' joints do not determine the loads, or where the fit does not converge.
    ///
    /// `depth_mm` is the sagittal place of the forces. `near` is a fit that is thought to end nearby, such as that of other
    /// readings of the same films.
    #[must_use]
    pub fn estimate(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &JointShares,
        near: Option<&Self>,
    ) -> Option<Self> {
        if films.is_empty() {
            return None;
        }
        let mut fit = Fit::new(films, depth_mm, shares)?;
        let mut variances = MAX_VARIANCES * 1e-2;
        if let Some(near) = near.filter(|near| near.log_multipliers.len() == shares.0.ncols()) {
            fit.logs.clone_from(&near.log_multipliers);
            (fit.centres_higher_discs, fit.evenness) = (near.centres_higher_discs, near.evenness);
            let sds = [near.joint_log_sd, near.centre_sd_discs, near.trend_log_sd];
            variances = Vector3::from(sds.map(|sd| sd.powi(2)));
        }
        fit.solve_loads(None)?;
        let mut state = fit.linearize(variances)?;
        let mut steps: Vec<IterationStep> = Vec::new();
        for round in 0..ROUNDS {
            let mut step = fit.iterate(&state, variances);
            let converged = (&step.to - &step.from).amax() < CONVERGED_STEP;
            let damping = if round < DAMPED_FROM { 1.0 } else { DAMPING };
            if !converged {
                step.to = &step.from + (&step.to - &step.from) * damping;
            }
            steps.insert(0, step);
            steps.truncate(3);
            // At the end, and where the extrapolation would put a multiplier on its bound, the last step counts alone.
            let extrapolated = anderson_step(&steps);
            let mut within = extrapolated.clone();
            fit.clamp(&mut within);
            let logs = VARIANCES..VARIANCES + fit.logs.len();
            let alone = converged
                || round >= DAMPED_FROM
                || within.rows_range(logs.clone()) != extrapolated.rows_range(logs.clone());
            variances = fit.set_unknowns(if alone { &steps[0].to } else { &within });
            let before = fit.loads.clone();
            fit.solve_loads(Some(&state.own))?;
            if !converged {
                fit.loads = &before + (&fit.loads - &before) * damping;
            }
            state = fit.linearize(variances)?;
            if converged {
                return Some(fit.finish(variances, &state));
            }
        }
        None
    }
}

/// Rotations of all films below one another, and what is fitted to them.
struct Fit<'a> {
    films: usize,
    joints: usize,
    shares: &'a JointShares,
    /// Nominal responses to the components of every film's own load.
    responses: Vec<Vec<[f64; 3]>>,
    /// By how much they grow per disc that a joint turns higher up the spine.
    higher: Vec<Vec<[f64; 3]>>,
    centres_higher_discs: f64,
    /// By how much they grow from hinges to joints that turn evenly over their length.
    evener: Vec<Vec<[f64; 3]>>,
    /// How far joints are from hinges, which is 0, to such ones, which is 1.
    evenness: f64,
    rotations: DVector<f64>,
    precision: Precision,
    loads: DVector<f64>,
    logs: Vec<f64>,
}

/// The linearised fit at given variances of the random effects.
struct Linearized {
    /// By the loads, the free multipliers and the centres, in scaled columns.
    scales: DVector<f64>,
    /// Derivative of the likelihood by these.
    slope: DVector<f64>,
    /// Their covariance.
    covariance: DMatrix<f64>,
    own: RandomEffects,
    /// Of the restricted likelihood by the variances.
    score: Vector3<f64>,
    information: Matrix3<f64>,
    ways: DMatrix<f64>,
}

impl Linearized {
    /// One scoring step of the variances' logarithms. Their priors keep them off zero, where nothing would be known of them.
    fn scoring_step(&self, variances: Vector3<f64>) -> Vector3<f64> {
        const MAX_LOG_SCORING_STEP: f64 = 2.0;
        let score = variances.component_mul(&self.score) + PRIORS;
        let scaled = Matrix3::from_diagonal(&variances);
        // The priors have no curvature in logarithms; this much keeps a step finite where films say nothing.
        let information = scaled * self.information * scaled + Matrix3::identity() * 0.25;
        let step = information.try_inverse().map_or(score, |inverse| inverse * score);
        variances.zip_map(&step, |v, step| {
            v * step.clamp(-MAX_LOG_SCORING_STEP, MAX_LOG_SCORING_STEP).exp()
        })
    }
}

impl<'a> Fit<'a> {
    fn new(films: &[&FilmEvidence], depth_mm: f64, shares: &'a JointShares) -> Option<Self> {
        let joints = shares.0.nrows();
        let all = films.iter().flat_map(|film| &film.joints).map(|joint| joint.rotation.rad());
        Some(Self {
            films: films.len(),
            joints,
            shares,
            responses: films
                .iter()
                .map(|film| film.responses(&Load::Frontal { depth_mm }))
                .collect(),
            higher: shifted(films, |joint| joint.disc_mm),
            centres_higher_discs: 0.0,
            evener: shifted(films, |joint| joint.to_evener_mm),
            evenness: EVENNESS,
            rotations: DVector::from_iterator(films.len() * joints, all),
            precision: Precision::new(films, joints)?,
            loads: DVector::zeros(3 * films.len()),
            logs: vec![0.0; shares.0.ncols()],
        })
    }

    /// Rotations by the loads' components at the multipliers of now.
    fn by_loads(&self) -> DMatrix<f64> {
        self.matrix_of(|film, joint, part| {
            self.responses[film][joint][part]
                + self.centres_higher_discs * self.higher[film][joint][part]
                + self.evenness * self.evener[film][joint][part]
        })
    }

    /// Responses of all films' joints, softened by the multipliers of now.
    fn matrix_of(&self, response: impl Fn(usize, usize, usize) -> f64) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rotations.len(), 3 * self.films);
        for joint in 0..self.joints {
            let softness = self.softness(joint);
            for film in 0..self.films {
                for part in 0..3 {
                    matrix[(film * self.joints + joint, 3 * film + part)] =
                        softness * response(film, joint, part);
                }
            }
        }
        matrix
    }

    /// By what a joint turns more than with nominal springs: its parts in several groups turn one after the other.
    fn softness(&self, joint: usize) -> f64 {
        self.shares
            .0
            .row(joint)
            .iter()
            .zip(&self.logs)
            .map(|(share, log)| share * (-log).exp())
            .sum()
    }

    /// Directions among the `ln α` that keep their mean and leave those at a bound where they are.
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

    fn linearize(&self, variances: Vector3<f64>) -> Option<Linearized> {
        let by_loads = self.by_loads();
        let predicted = &by_loads * &self.loads;
        let ways = self.free_directions();
        let (rows, loads) = (self.rotations.len(), 3 * self.films);
        let higher =
            self.matrix_of(|film, joint, part| self.higher[film][joint][part]) * &self.loads;
        let evener =
            self.matrix_of(|film, joint, part| self.evener[film][joint][part]) * &self.loads;
        let mut jacobian = DMatrix::zeros(rows, loads + ways.ncols() + 2);
        jacobian.column_mut(loads + ways.ncols()).copy_from(&higher);
        jacobian.column_mut(loads + ways.ncols() + 1).copy_from(&evener);
        jacobian.columns_mut(0, loads).copy_from(&by_loads);
        let softer = DMatrix::from_fn(self.joints, self.logs.len(), |joint, group| {
            self.shares.0[(joint, group)] * (-self.logs[group]).exp() / self.softness(joint)
        }) * &ways;
        for row in 0..rows {
            for way in 0..ways.ncols() {
                jacobian[(row, loads + way)] = -predicted[row] * softer[(row % self.joints, way)];
            }
        }
        let scales = scale_columns(&mut jacobian);
        let residual =
            DMatrix::from_column_slice(rows, 1, (&self.rotations - &predicted).as_slice());
        let by_films = |rotations: &DVector<f64>| {
            DMatrix::from_column_slice(self.joints, self.films, rotations.as_slice())
        };
        let own = RandomEffects::new(
            [by_films(&predicted), by_films(&higher), by_films(&predicted)],
            &self.precision,
            variances,
        )?;
        let mut found = Normal::new(&jacobian, &residual, &self.precision, Some(&own));
        let (last, scale) = (jacobian.ncols() - 1, scales[jacobian.ncols() - 1]);
        found.matrix[(last, last)] += 1.0 / (EVENNESS_SD.powi(2) * scale * scale);
        found.right[last] += (EVENNESS - self.evenness) / (EVENNESS_SD.powi(2) * scale);
        let (higher, scale) = (last - 1, scales[last - 1]);
        found.matrix[(higher, higher)] += 1.0 / (HIGHER_SD_DISCS.powi(2) * scale * scale);
        found.right[higher] -= self.centres_higher_discs / (HIGHER_SD_DISCS.powi(2) * scale);
        let covariance = found.matrix.cholesky()?.inverse();
        let slope = found.right.column(0).into_owned();
        // The predicted random effects of the joints, and their covariance given the rotations, with the unknowns free.
        let expected =
            &found.effects_by_residual - &found.effects_by_columns * (&covariance * &found.right);
        let unsure = &own.covariance
            + &found.effects_by_columns * &covariance * found.effects_by_columns.transpose();
        let score = Vector3::from_fn(|i, _| {
            let (first, count) = own.block(i);
            let squares = expected.rows(first, count).norm_squared() / variances[i];
            let known = unsure.view((first, first), (count, count)).trace() / variances[i];
            0.5 * (squares - (count as f64 - known)) / variances[i]
        });
        let information = Matrix3::from_fn(|i, j| {
            let ((row, rows), (column, columns)) = (own.block(i), own.block(j));
            let unsure = unsure.view((row, column), (rows, columns));
            let known = if i == j { 1.0 / variances[i] } else { 0.0 };
            let part =
                DMatrix::identity(rows, columns) * known - unsure / (variances[i] * variances[j]);
            0.5 * part.norm_squared()
        });
        Some(Linearized { score, information, slope, scales, covariance, own, ways })
    }

    /// One scoring step of the variances, and one Gauss-Newton step of multipliers and centres. Alone they converge slowly:
    /// residuals are large, and scoring knows the expected curvature only.
    fn iterate(&self, at: &Linearized, variances: Vector3<f64>) -> IterationStep {
        let step = (&at.covariance * &at.slope).component_div(&at.scales);
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

    /// All that is not linear: `ln` of the variances, `ln α`, and of centres how much higher they lie, as a part of the most, and
    /// how evenly joints turn.
    fn place(&self, variances: Vector3<f64>) -> DVector<f64> {
        let variances = variances.map(f64::ln);
        let all = variances.iter().chain(&self.logs).copied();
        let higher = self.centres_higher_discs / MAX_HIGHER_DISCS;
        DVector::from_iterator(VARIANCES + 2 + self.logs.len(), all.chain([higher, self.evenness]))
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

    /// Takes multipliers, centres and evenness of a place, and answers with its variances.
    fn set_unknowns(&mut self, place: &DVector<f64>) -> Vector3<f64> {
        let groups = self.logs.len();
        self.logs.copy_from_slice(&place.as_slice()[VARIANCES..VARIANCES + groups]);
        self.centres_higher_discs = place[VARIANCES + groups] * MAX_HIGHER_DISCS;
        self.evenness = place[VARIANCES + 1 + groups];
        Vector3::from_fn(|i, _| place[i].exp())
    }

    /// The best loads at the multipliers of now, which is linear.
    fn solve_loads(&mut self, own: Option<&RandomEffects>) -> Option<()> {
        let mut by_loads = self.by_loads();
        let scales = scale_columns(&mut by_loads);
        let rotations = DMatrix::from_column_slice(by_loads.nrows(), 1, self.rotations.as_slice());
        let found = Normal::new(&by_loads, &rotations, &self.precision, own);
        let solved = found.matrix.cholesky()?.solve(&found.right);
        self.loads = solved.column(0).component_div(&scales);
        Some(())
    }

    fn finish(&self, variances: Vector3<f64>, at: &Linearized) -> PreferredLoads {
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
            covariance,
        }
    }
}

/// By how much the responses grow where every joint's centre is shifted.
fn shifted(
    films: &[&FilmEvidence],
    shift_mm: impl Fn(&JointEvidence) -> Frontal,
) -> Vec<Vec<[f64; 3]>> {
    let of_joint = |joint: &JointEvidence| {
        // The moment about a point falls with fz to the left and grows with fy upwards.
        let shift = shift_mm(joint);
        let turn_rad_per_nmm = joint.compliance_rad_per_nmm * joint.hinge.x;
        [shift.z_mm, -shift.y_mm, 0.0].map(|part| part * turn_rad_per_nmm)
    };
    films.iter().map(|film| film.joints.iter().map(of_joint).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::anatomy::{Level, Levels};
    use crate::spatial::{Angle, Vec3};

    #[test]
    fn a_shifted_centre_changes_responses_as_a_shifted_centre_does() {
        // Oracle: the responses with the centre moved; a hinge that is pitched out of the film.
        let shift = Frontal::new(0.7, -1.3);
        let joint = JointEvidence {
            rotation: Angle::ZERO,
            centre_mm: Vec3::new(5.0, 20.0, 150.0),
            disc_mm: shift,
            to_evener_mm: Frontal::default(),
            hinge: Vec3::new(0.8, 0.0, 0.6),
            compliance_rad_per_nmm: 1e-5,
        };
        let film = |joint| FilmEvidence {
            joints: vec![joint],
            tilt_sd: Angle::from_deg(0.5),
            erect_tilt_sd: Angle::from_deg(0.5),
            levels: Levels::between(Level::L4, Level::L3).expect("neighbours"),
            tilt_covariances: None,
        };
        let load = Load::Frontal { depth_mm: 0.0 };
        let before = film(joint).responses(&load)[0];
        let centre_mm = joint.centre_mm + Vec3::new(0.0, shift.y_mm, shift.z_mm);
        let after = film(JointEvidence { centre_mm, ..joint }).responses(&load)[0];
        let predicted = shifted(&[&film(joint)], |joint| joint.disc_mm)[0][0];
        for part in 0..3 {
            assert!((after[part] - before[part] - predicted[part]).abs() < 1e-15, "{part}");
        }
    }
}
