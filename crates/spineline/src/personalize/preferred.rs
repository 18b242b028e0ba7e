//! The loads that rotations of films prefer, with all that is unsure about them.
//!
//! # Model
//! The rotation of joint `j` on a film is `(a_j · w) / α e^(δ_j)` and noise: `w` is the planar load, `a_j` its nominal
//! response about the joint's centre and `α` the multiplier of the joint's group. What a joint has of its own is the same on
//! every film: `δ_j` of its stiffness, and a centre that lies higher up the spine than the model has it, by a part that all
//! joints share and a part of its own. Noise is that of the tilts: neighbouring joints share a vertebra and all films share
//! the erect one, so that the rotations of all films have one covariance.
//!
//! Loads, multipliers and the shared part of the centres are fitted by generalised least squares; the deviations of what
//! joints have of their own by restricted maximum likelihood (scoring), penalised so that none is zero. So the films tell themselves how far joints of one
//! group differ, and a load is as unsure as they do.
//!
//! # References
//! [harville-1977] for the restricted likelihood, [chung-2013] for its penalty.

use nalgebra::allocator::Allocator;
use nalgebra::{Cholesky, DMatrix, DVector, DefaultAllocator, Dim, Dyn, Matrix2, OMatrix, Vector2};

use super::MULTIPLIER_BOUNDS;
use super::evidence::{FilmEvidence, JointEvidence};
use crate::multibody::{JointGroups, Load};

/// Loads of several films that share springs.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferredLoads {
    /// `(fy, fz, mx)` about the origin of `G` per film, in N and N·mm, up to the level of stiffness.
    pub components: Vec<[f64; 3]>,
    /// `ln α` of the lateral springs per group.
    pub log_multipliers: Vec<f64>,
    /// How much further up the spine the joints turn than the model has their centres, on all films.
    pub centres_higher_mm: f64,
    /// Deviation of `ln` stiffness among the joints of a group.
    pub joint_log_sd: f64,
    /// Deviation of the joints' centres along the spine, about that.
    pub centre_sd_mm: f64,
    /// Covariance of all components, film by film, with multipliers free.
    pub(super) covariance: DMatrix<f64>,
}

/// Variances beyond these are none of springs (of `ln`) and of centres (mm²).
const MOST_VARIANCES: Vector2<f64> = Vector2::new(1.0, 100.0);
/// Centres of rotation lie within the vertebrae.
const MOST_HIGHER_MM: f64 = 15.0;
const ROUNDS: usize = 60;

impl PreferredLoads {
    /// Fits them; `None` without films, or where the films' joints do not determine the loads.
    ///
    /// `depth_mm` is the sagittal place of the forces.
    #[must_use]
    pub fn estimate(films: &[&FilmEvidence], depth_mm: f64, groups: &JointGroups) -> Option<Self> {
        if films.is_empty() {
            return None;
        }
        let mut fit = Fit::new(films, depth_mm, groups)?;
        fit.solve_loads(&Own::nothing(fit.rotations.len()))?;
        let mut variances = MOST_VARIANCES * 1e-2;
        let mut state = fit.weigh(variances)?;
        for _ in 0..ROUNDS {
            let next = state.better(variances);
            let change = (next - variances).component_div(&variances).amax();
            let moved = fit.step(&state)?;
            variances = next;
            state = fit.weigh(variances)?;
            if change < 1e-4 && moved < 1e-7 {
                break;
            }
        }
        Some(fit.finish(variances, &state))
    }
}

/// Rotations of all films below one another, and what is fitted to them; in deviations of the noise, where that is said.
struct Fit<'a> {
    films: usize,
    joints: usize,
    group_of: &'a [usize],
    /// Nominal responses to the components of every film's own load.
    responses: Vec<Vec<[f64; 3]>>,
    /// By how much they grow per millimetre that a joint turns higher up the spine.
    higher: Vec<Vec<[f64; 3]>>,
    centres_higher_mm: f64,
    rotations: DVector<f64>,
    /// What carries rotations into deviations of the noise, and back.
    noise: Cholesky<f64, Dyn>,
    loads: DVector<f64>,
    logs: Vec<f64>,
}

/// The fit at some variances of what joints have of their own.
struct Weighed {
    /// By the loads, the free multipliers and the centres, in scaled columns.
    scales: DVector<f64>,
    /// Derivative of the likelihood by these.
    slope: DVector<f64>,
    /// Their covariance.
    covariance: DMatrix<f64>,
    own: Own,
    /// Of the restricted likelihood by the variances.
    score: Vector2<f64>,
    information: Matrix2<f64>,
    ways: DMatrix<f64>,
}

/// What joints have of their own, beside noise of one deviation everywhere.
struct Own {
    /// Per unit of every joint's own stiffness, and then of its own centre; in deviations of the noise.
    columns: DMatrix<f64>,
    /// By how much they are known from the rotations.
    inner: DMatrix<f64>,
}

impl Own {
    fn nothing(rows: usize) -> Self {
        Self { columns: DMatrix::zeros(rows, 0), inner: DMatrix::zeros(0, 0) }
    }

    fn new(columns: DMatrix<f64>, variances: Vector2<f64>) -> Option<Self> {
        let joints = columns.ncols() / 2;
        let mut inner = columns.tr_mul(&columns);
        for i in 0..2 * joints {
            inner[(i, i)] += 1.0 / variances[i / joints];
        }
        Some(Self { inner: inner.cholesky()?.inverse(), columns })
    }

    /// The inverse of the covariance, times a matrix (Woodbury's identity).
    fn weigh(&self, matrix: &DMatrix<f64>) -> DMatrix<f64> {
        matrix - &self.columns * (&self.inner * self.columns.tr_mul(matrix))
    }
}

impl Weighed {
    /// One scoring step of the variances' logarithms. A penalty of `ln` of every deviation keeps them off zero, where nothing would be
    /// known of them.
    fn better(&self, variances: Vector2<f64>) -> Vector2<f64> {
        const STRIDE: f64 = 2.0;
        let score = variances.component_mul(&self.score) + Vector2::repeat(0.5);
        let scaled = Matrix2::from_diagonal(&variances);
        // The penalty has no curvature in logarithms; this much keeps a step finite where films say nothing.
        let information = scaled * self.information * scaled + Matrix2::identity() * 0.25;
        let step = information.try_inverse().map_or(score, |inverse| inverse * score);
        let next = variances.zip_map(&step, |v, step| v * step.clamp(-STRIDE, STRIDE).exp());
        next.zip_map(&MOST_VARIANCES, |v, most| v.clamp(1e-9 * most, most))
    }
}

impl<'a> Fit<'a> {
    fn new(films: &[&FilmEvidence], depth_mm: f64, groups: &'a JointGroups) -> Option<Self> {
        let joints = groups.of_joint().len();
        let all = films.iter().flat_map(|film| &film.joints).map(|joint| joint.rotation.rad());
        let rows = films.len() * joints;
        let noise = DMatrix::from_fn(rows, rows, |a, b| {
            let shared = match (a % joints).abs_diff(b % joints) {
                0 => 2.0,
                1 => -1.0,
                _ => return 0.0,
            };
            let film = &films[a / joints];
            let own = if a / joints == b / joints { film.tilt_sd.rad().powi(2) } else { 0.0 };
            shared * (own + film.erect_tilt_sd.rad().powi(2))
        });
        Some(Self {
            films: films.len(),
            joints,
            group_of: groups.of_joint(),
            responses: films
                .iter()
                .map(|film| film.responses(&Load::Frontal { depth_mm }))
                .collect(),
            higher: films.iter().map(|film| film.joints.iter().map(higher).collect()).collect(),
            centres_higher_mm: 0.0,
            rotations: DVector::from_iterator(rows, all),
            noise: noise.cholesky()?,
            loads: DVector::zeros(3 * films.len()),
            logs: vec![0.0; groups.len()],
        })
    }

    /// Rotations by the loads' components at the multipliers of now.
    fn by_loads(&self) -> DMatrix<f64> {
        self.matrix_of(|film, joint, part| {
            self.responses[film][joint][part]
                + self.centres_higher_mm * self.higher[film][joint][part]
        })
    }

    /// Responses of all films' joints, softened by the multipliers of now.
    fn matrix_of(&self, response: impl Fn(usize, usize, usize) -> f64) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(self.rotations.len(), 3 * self.films);
        for film in 0..self.films {
            for joint in 0..self.joints {
                let softness = (-self.logs[self.group_of[joint]]).exp();
                for part in 0..3 {
                    matrix[(film * self.joints + joint, 3 * film + part)] =
                        softness * response(film, joint, part);
                }
            }
        }
        matrix
    }

    /// Directions among the `ln α` that keep their mean and leave those at a bound where they are.
    fn ways(&self) -> DMatrix<f64> {
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

    fn weigh(&self, variances: Vector2<f64>) -> Option<Weighed> {
        let by_loads = self.by_loads();
        let predicted = &by_loads * &self.loads;
        let ways = self.ways();
        let (rows, loads) = (self.rotations.len(), 3 * self.films);
        let higher =
            self.matrix_of(|film, joint, part| self.higher[film][joint][part]) * &self.loads;
        let mut jacobian = DMatrix::zeros(rows, loads + ways.ncols() + 1);
        jacobian.column_mut(loads + ways.ncols()).copy_from(&higher);
        jacobian.columns_mut(0, loads).copy_from(&by_loads);
        for row in 0..rows {
            let group = self.group_of[row % self.joints];
            for way in 0..ways.ncols() {
                jacobian[(row, loads + way)] = -predicted[row] * ways[(group, way)];
            }
        }
        let scales = scale_columns(&mut jacobian);
        let mut columns = DMatrix::zeros(rows, 2 * self.joints);
        for row in 0..rows {
            let joint = row % self.joints;
            columns[(row, joint)] = predicted[row];
            columns[(row, self.joints + joint)] = higher[row];
        }
        let own = Own::new(self.in_deviations(columns), variances)?;
        let jacobian = self.in_deviations(jacobian);
        let residual = self.in_deviations(&self.rotations - predicted);
        let weighted = own.weigh(&jacobian);
        let covariance = jacobian.tr_mul(&weighted).cholesky()?.inverse();
        // Weighed, and less what the unknowns can make up for.
        let seen =
            own.weigh(&own.columns) - &weighted * (&covariance * weighted.tr_mul(&own.columns));
        let (of_residual, of_own) = (seen.tr_mul(&residual), own.columns.tr_mul(&seen));
        let part = |i: usize, j: usize| {
            let size = (self.joints, self.joints);
            of_own.view((i * self.joints, j * self.joints), size)
        };
        let score = |i: usize| {
            let squares = of_residual.rows(i * self.joints, self.joints).norm_squared();
            0.5 * (squares - part(i, i).trace())
        };
        Some(Weighed {
            score: Vector2::new(score(0), score(1)),
            information: Matrix2::from_fn(|i, j| 0.5 * part(i, j).norm_squared()),
            slope: weighted.tr_mul(&residual),
            scales,
            covariance,
            own,
            ways,
        })
    }

    /// Carries rotations into deviations of the noise, so that they scatter alike and each by itself.
    fn in_deviations<C: Dim>(&self, rotations: OMatrix<f64, Dyn, C>) -> OMatrix<f64, Dyn, C>
    where
        DefaultAllocator: Allocator<Dyn, C>,
    {
        let mut carried = rotations;
        self.noise.l_dirty().solve_lower_triangular_mut(&mut carried);
        carried
    }

    /// One Gauss-Newton step of loads and multipliers; answers with the change of a multiplier.
    fn step(&mut self, at: &Weighed) -> Option<f64> {
        let step = (&at.covariance * &at.slope).component_div(&at.scales);
        // A long stride leaves what the linear theory knows.
        const STRIDE: f64 = 0.5;
        let change = &at.ways * step.rows(3 * self.films, at.ways.ncols());
        let longest = change.amax();
        let part = if longest > STRIDE { STRIDE / longest } else { 1.0 };
        let limit = MULTIPLIER_BOUNDS[1].ln();
        for (log, change) in self.logs.iter_mut().zip(change.iter()) {
            *log = (*log + part * change).clamp(-limit, limit);
        }
        let shift = step[3 * self.films + at.ways.ncols()];
        self.centres_higher_mm =
            (self.centres_higher_mm + part * shift).clamp(-MOST_HIGHER_MM, MOST_HIGHER_MM);
        self.solve_loads(&at.own)?;
        Some(longest)
    }

    /// The best loads at the multipliers of now, which is linear.
    fn solve_loads(&mut self, own: &Own) -> Option<()> {
        let mut by_loads = self.by_loads();
        let scales = scale_columns(&mut by_loads);
        let by_loads = self.in_deviations(by_loads);
        let weighted = own.weigh(&by_loads);
        let rotations = self.in_deviations(self.rotations.clone());
        let solved = by_loads.tr_mul(&weighted).cholesky()?.solve(&weighted.tr_mul(&rotations));
        self.loads = solved.component_div(&scales);
        Some(())
    }

    fn finish(&self, variances: Vector2<f64>, at: &Weighed) -> PreferredLoads {
        let loads = 3 * self.films;
        let covariance = DMatrix::from_fn(loads, loads, |i, j| {
            at.covariance[(i, j)] / (at.scales[i] * at.scales[j])
        });
        PreferredLoads {
            components: (0..self.films)
                .map(|film| [0, 1, 2].map(|part| self.loads[3 * film + part]))
                .collect(),
            log_multipliers: self.logs.clone(),
            centres_higher_mm: self.centres_higher_mm,
            joint_log_sd: variances[0].sqrt(),
            centre_sd_mm: variances[1].sqrt(),
            covariance,
        }
    }
}

/// Divides every column by its largest entry, and answers with those: newtons and newton millimetres differ by hundreds.
fn scale_columns(matrix: &mut DMatrix<f64>) -> DVector<f64> {
    let largest = matrix.column_iter().map(|column| column.amax().max(f64::MIN_POSITIVE));
    let scales = DVector::from_iterator(matrix.ncols(), largest);
    for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
        column /= *scale;
    }
    scales
}

fn higher(joint: &JointEvidence) -> [f64; 3] {
    // The moment about a point falls with fz to the left and grows with fy upwards.
    [joint.along.z_mm, -joint.along.y_mm, 0.0].map(|part| part * joint.compliance_rad_per_nmm)
}
