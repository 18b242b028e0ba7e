//! The equations of the mixed model about unknowns, and the iteration that solves them.

use nalgebra::{DMatrix, DVector, Matrix3, RowDVector, RowVector3, Vector3};

use super::super::MULTIPLIER_BOUNDS;
use super::super::evidence::FilmEvidence;
use super::bases::{contrasts, random_walk};
use super::extrapolation::{Step, anderson};
use super::proposed_line::ProposedLine;
use crate::clinical::JointShares;
use crate::multibody::Load;
use crate::number::scientific;

/// Why films give no loads.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoLoads {
    /// No film has joint rotations in millimetres.
    #[error("no film has joint rotations in millimetres")]
    NoFilms,
    /// The rotations do not determine the loads.
    #[error("the joint rotations do not determine the loads")]
    Undetermined,
    /// The iteration reached its limit with a step of this size, in `ln` of stiffness, discs or parts of a load.
    #[error("the fit of loads to the joint rotations did not converge (last step {})", scientific(*last_step, 1))]
    NotConverged {
        /// Largest change of an unknown.
        last_step: f64,
    },
}

/// Upper bounds of the variances: of `ln` stiffness by joint, of centres in discs, and of `ln` stiffness along the spine.
const MAX_VARIANCES: Vector3<f64> = Vector3::new(1.0, 4.0, 1.0);
/// The least variance as a part of the upper bound: in effect zero.
const MIN_OF_MAX_VARIANCE: f64 = 1e-9;
const START_OF_MAX_VARIANCE: f64 = 1e-2;
/// Standard deviation of the shift of all centres: loads and this shift are hard to tell apart.
const SHIFT_SD_DISCS: f64 = 1.0;
/// From 0, a hinge, to 1, a rod.
const EVENNESS_MEAN: f64 = 0.5;
const EVENNESS_SD: f64 = 0.289;
/// Uniform priors of standard deviations, per `ln` of a variance.
const PRIOR_SCORE: f64 = 0.5;
/// This curvature keeps a step of `ln` of a variance finite where films say nothing about it.
const PRIOR_INFORMATION: f64 = 0.25;

const ROUNDS: usize = 150;
/// A step that is longer than the one before is shortened by this factor, and those before are not extrapolated: some fits oscillate.
const DAMPING: f64 = 0.6;
/// Steps at a limit have the same length up to rounding, which does not count as longer.
const LONGER: f64 = 1.0 + 1e-9;
/// Steps that are extrapolated.
const MEMORY: usize = 6;
/// The iteration has converged when no unknown moves by more than this.
const CONVERGED_STEP: f64 = 1e-4;
/// A longer step of `ln` of stiffness or of a centre leaves the range of the linear theory.
const MAX_STEP: f64 = 1.0;
const MAX_LOG_VARIANCE_STEP: f64 = 2.0;
/// Standard deviation of the moment about a point that is known exactly, as a part of the load.
const EXACT_LINE: f64 = 1e-3;

/// What the films show, and the priors.
///
/// Unknowns are, in this order: three load components per film, `ln alpha` in directions that keep their mean, shift, evenness; random
/// effects of stiffness in a cosine basis along the spine, then of centres by joint; `ln` of the three variances.
pub(super) struct Model<'a> {
    films: usize,
    joints: usize,
    shares: &'a JointShares,
    /// Directions of `ln alpha` with a mean of zero, orthonormal.
    contrasts: DMatrix<f64>,
    /// `a`, `h` and `m` per rotation, film by film.
    responses: Vec<[RowVector3<f64>; 3]>,
    rotations: DVector<f64>,
    /// Inverse of the rotations' covariance.
    precision: DMatrix<f64>,
    prior_mean: DVector<f64>,
    prior_precision: DVector<f64>,
    cosines: DMatrix<f64>,
    /// Derivatives of the variance of every random effect by the three variances.
    variance_rates: Vec<Vector3<f64>>,
    /// Sizes of the unknowns, by which steps are measured.
    sizes: DVector<f64>,
    /// The line of every film's force, where it is given.
    lines: Vec<Option<ProposedLine>>,
}

/// The mixed model equations at some unknowns.
pub(super) struct Equations {
    /// Covariance of fixed and random effects.
    pub inverse: DMatrix<f64>,
    right: DVector<f64>,
    /// Derivatives of the rotations by the effects, times the precision; effects by rotations.
    pub weighed: DMatrix<f64>,
}

impl<'a> Model<'a> {
    pub fn new(
        films: &[&FilmEvidence],
        depth_mm: f64,
        shares: &'a JointShares,
    ) -> Result<Self, NoLoads> {
        if films.is_empty() {
            return Err(NoLoads::NoFilms);
        }
        let (joints, groups) = shares.0.shape();
        let of_film = |film: &&FilmEvidence| {
            let all = [
                film.responses(&Load::Frontal { depth_mm }),
                film.shifted_responses(|joint| joint.disc_mm),
                film.shifted_responses(|joint| joint.to_evener_mm),
            ];
            (0..joints)
                .map(|joint| all.each_ref().map(|of| RowVector3::from(of[joint])))
                .collect::<Vec<_>>()
        };
        let rotations =
            films.iter().flat_map(|film| &film.joints).map(|j| j.rotation_by_load().rad());
        let rotations = DVector::from_iterator(films.len() * joints, rotations);
        let responses: Vec<_> = films.iter().flat_map(of_film).collect();
        let precision = noise_covariance(films).cholesky().ok_or(NoLoads::Undetermined)?.inverse();
        let (loads, fixed) = (3 * films.len(), 3 * films.len() + groups + 1);
        let mut prior_mean = DVector::zeros(fixed);
        prior_mean[fixed - 1] = EVENNESS_MEAN;
        // Of a uniform distribution between the bounds of `ln alpha`.
        let log_sd = MULTIPLIER_BOUNDS[1].ln() / f64::sqrt(3.0);
        let mut prior_precision = DVector::from_element(fixed, log_sd.powi(-2));
        prior_precision.rows_mut(0, loads).fill(0.0);
        prior_precision[fixed - 2] = SHIFT_SD_DISCS.powi(-2);
        prior_precision[fixed - 1] = EVENNESS_SD.powi(-2);
        let mut sizes = DVector::from_element(fixed + 2 * joints + 3, 1.0);
        for load in 0..loads {
            let rows = load / 3 * joints..(load / 3 + 1) * joints;
            let response: f64 = rows.clone().map(|row| responses[row][0][load % 3].powi(2)).sum();
            let rotation = rotations.rows_range(rows).norm_squared();
            sizes[load] = (rotation / response).sqrt().max(f64::MIN_POSITIVE);
        }
        let (cosines, walk) = random_walk(joints);
        let of_stiffness = walk.iter().map(|&walk| Vector3::new(1.0, 0.0, walk));
        let of_centres = (0..joints).map(|_| Vector3::y());
        Ok(Self {
            films: films.len(),
            joints,
            shares,
            contrasts: contrasts(groups),
            responses,
            rotations,
            precision,
            prior_mean,
            prior_precision,
            cosines,
            variance_rates: of_stiffness.chain(of_centres).collect(),
            sizes,
            lines: vec![None; films.len()],
        })
    }

    /// The same model with forces along lines.
    pub fn on_lines(self, lines: Vec<Option<ProposedLine>>) -> Self {
        Self { lines, ..self }
    }

    /// Number of fixed and random effects.
    pub fn effects(&self) -> usize {
        self.prior_mean.len() + self.variance_rates.len()
    }

    /// `ln` stiffness of every joint over its nominal spring, and its derivatives by the effects.
    pub fn log_stiffness(&self, x: &DVector<f64>) -> Vec<(f64, RowDVector<f64>)> {
        let (loads, fixed) = (3 * self.films, self.prior_mean.len());
        let logs = &self.contrasts * x.rows(loads, self.contrasts.ncols());
        let deltas = &self.cosines * x.rows(fixed, self.joints);
        let of_joint = |joint: usize| {
            let by_group = DVector::from_fn(logs.len(), |group, _| {
                self.shares.0[(joint, group)] * (-logs[group]).exp()
            });
            let softness = by_group.sum();
            let mut slope = RowDVector::zeros(self.effects());
            let by_logs = by_group.tr_mul(&self.contrasts) / softness;
            slope.columns_mut(loads, by_logs.len()).copy_from(&by_logs);
            slope.columns_mut(fixed, self.joints).copy_from(&-self.cosines.row(joint));
            (-deltas[joint] - softness.ln(), slope)
        };
        (0..self.joints).map(of_joint).collect()
    }

    /// Derivatives of the covariance of some linear numbers of the effects by `ln` of the three variances, and the covariance of these.
    pub fn by_variances(
        &self,
        x: &DVector<f64>,
        at: &Equations,
        numbers: &DMatrix<f64>,
    ) -> ([DMatrix<f64>; 3], Matrix3<f64>) {
        let fixed = self.prior_mean.len();
        let variances = self.variances(x);
        let mut by_effects = numbers * at.inverse.columns(fixed, self.variance_rates.len());
        for (mut column, rates) in by_effects.column_iter_mut().zip(&self.variance_rates) {
            column /= rates.dot(&variances);
        }
        let by_variance = |i: usize| {
            let rates = self.variance_rates.iter().map(|rates| rates[i] * variances[i]);
            let rates =
                DMatrix::from_diagonal(&DVector::from_iterator(self.variance_rates.len(), rates));
            &by_effects * rates * by_effects.transpose()
        };
        let (_, information) = self.score_and_information(x, at);
        let covariance =
            information.try_inverse().unwrap_or_else(|| Matrix3::identity() / PRIOR_INFORMATION);
        ([0, 1, 2].map(by_variance), covariance)
    }

    /// Adds the moments about points of given lines, which are zero, to the equations of the loads.
    fn add_lines(
        &self,
        x: &DVector<f64>,
        matrix: &mut DMatrix<f64>,
        right: &mut DVector<f64>,
    ) -> Option<()> {
        for (film, line) in self.lines.iter().enumerate() {
            let Some(line) = line else { continue };
            let load = x.fixed_rows::<3>(3 * film);
            let (rows, mut covariance) = line.restrictions([load[0], load[1], load[2]]);
            let sizes = self.sizes.fixed_rows::<3>(3 * film);
            let restrict = DMatrix::from_fn(rows.len(), 3, |i, j| rows[i][j]);
            for (i, row) in rows.iter().enumerate() {
                let size = row.transpose().component_mul(&sizes).amax();
                covariance[(i, i)] += (EXACT_LINE * size).powi(2);
            }
            let weighed = restrict.transpose() * covariance.cholesky()?.inverse();
            let mut own = matrix.view_mut((3 * film, 3 * film), (3, 3));
            own += &weighed * &restrict;
            let mut own = right.rows_mut(3 * film, 3);
            own -= &weighed * (&restrict * load);
        }
        Some(())
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.sizes.len()
    }

    /// Without load and random effects, of small variances.
    pub fn start(&self) -> DVector<f64> {
        let mut start = DVector::zeros(self.unknowns());
        start.rows_mut(0, self.prior_mean.len()).copy_from(&self.prior_mean);
        let variances = MAX_VARIANCES.map(|most| (most * START_OF_MAX_VARIANCE).ln());
        start.rows_mut(self.unknowns() - 3, 3).copy_from(&variances);
        start
    }

    /// Iterates from some unknowns until no step moves them; the unknowns there, and the equations at them.
    pub fn converge(&self, mut x: DVector<f64>) -> Result<(DVector<f64>, Equations), NoLoads> {
        let mut steps: Vec<Step> = Vec::new();
        let mut last_step = f64::INFINITY;
        for _ in 0..ROUNDS {
            let at = self.equations(&x).ok_or(NoLoads::Undetermined)?;
            let step = (self.step(&x, &at) - &x).component_div(&self.sizes);
            let is_longer = step.amax() > LONGER * last_step;
            last_step = step.amax();
            if last_step < CONVERGED_STEP {
                return Ok((x, at));
            }
            let from = x.component_div(&self.sizes);
            let to = if is_longer {
                steps.clear();
                from + step * DAMPING
            } else {
                steps.insert(0, Step { from, step });
                steps.truncate(MEMORY);
                anderson(&steps)
            };
            x = to.component_mul(&self.sizes);
            self.limit_variances(&mut x);
        }
        Err(NoLoads::NotConverged { last_step })
    }

    /// The mixed model equations, linearised about unknowns; `None` where they are singular.
    fn equations(&self, x: &DVector<f64>) -> Option<Equations> {
        let (n, loads, fixed) = (self.joints, 3 * self.films, self.prior_mean.len());
        let effects = fixed + 2 * n;
        let logs = &self.contrasts * x.rows(loads, self.contrasts.ncols());
        let deltas = &self.cosines * x.rows(fixed, n);
        let [shift, evenness] = [x[fixed - 2], x[fixed - 1]];
        let mut jacobian = DMatrix::zeros(self.rotations.len(), effects);
        let mut residual = self.rotations.clone();
        let mut by_group = DVector::zeros(logs.len());
        let mut by_logs = DVector::zeros(self.contrasts.ncols());
        for (row, [hinge, higher, even]) in self.responses.iter().enumerate() {
            let (film, joint) = (row / n, row % n);
            for (group, softness) in by_group.iter_mut().enumerate() {
                *softness = self.shares.0[(joint, group)] * (deltas[joint] - logs[group]).exp();
            }
            let softness = by_group.sum();
            let load = x.fixed_rows::<3>(3 * film);
            let centre = shift + x[fixed + n + joint];
            let response = (hinge + higher * centre + even * evenness) * softness;
            let turn = response.tr_dot(&load);
            let by_centre = softness * higher.tr_dot(&load);
            residual[row] -= turn;
            jacobian.fixed_view_mut::<1, 3>(row, 3 * film).copy_from(&response);
            by_logs.gemv_tr(-turn / softness, &self.contrasts, &by_group, 0.0);
            jacobian.view_mut((row, loads), (1, by_logs.len())).tr_copy_from(&by_logs);
            jacobian[(row, fixed - 2)] = by_centre;
            jacobian[(row, fixed - 1)] = softness * even.tr_dot(&load);
            let cosines = self.cosines.row(joint);
            jacobian.view_mut((row, fixed), (1, n)).zip_apply(&cosines, |to, by| *to = by * turn);
            jacobian[(row, fixed + n + joint)] = by_centre;
        }
        let weighed = (&self.precision * &jacobian).transpose();
        let mut matrix = &weighed * jacobian;
        let mut right = &weighed * residual;
        let variances = self.variances(x);
        for i in 0..effects {
            let (mean, precision) = match i.checked_sub(fixed) {
                None => (self.prior_mean[i], self.prior_precision[i]),
                Some(effect) => (0.0, self.variance_rates[effect].dot(&variances).recip()),
            };
            matrix[(i, i)] += precision;
            right[i] -= precision * (x[i] - mean);
        }
        self.add_lines(x, &mut matrix, &mut right)?;
        Some(Equations { inverse: inverse_of(matrix)?, right, weighed })
    }

    fn variances(&self, x: &DVector<f64>) -> Vector3<f64> {
        x.fixed_rows::<3>(x.len() - 3).map(f64::exp)
    }

    /// Where one step of all unknowns leads.
    fn step(&self, x: &DVector<f64>, at: &Equations) -> DVector<f64> {
        let loads = 3 * self.films;
        let mut step = &at.inverse * &at.right;
        let longest = step.rows(loads, step.len() - loads).amax();
        step *= (MAX_STEP / longest).min(1.0);
        let mut to = x.clone();
        let mut effects = to.rows_mut(0, step.len());
        effects += &step;
        let by_scoring = self.scoring_step(x, at);
        let mut variances = to.fixed_rows_mut::<3>(step.len());
        variances += by_scoring;
        self.limit_variances(&mut to);
        to
    }

    /// One scoring step of `ln` of the variances.
    fn scoring_step(&self, x: &DVector<f64>, at: &Equations) -> Vector3<f64> {
        let (score, information) = self.score_and_information(x, at);
        let step = information.try_inverse().map_or(score, |inverse| inverse * score);
        step.map(|step| step.clamp(-MAX_LOG_VARIANCE_STEP, MAX_LOG_VARIANCE_STEP))
    }

    /// Score and information of `ln` of the variances, from the predicted random effects and their covariance.
    fn score_and_information(
        &self,
        x: &DVector<f64>,
        at: &Equations,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let fixed = self.prior_mean.len();
        let variances = self.variances(x);
        let (mut score, mut information) = (Vector3::zeros(), Matrix3::zeros());
        let predicted =
            x.rows(fixed, 2 * self.joints) + at.inverse.rows(fixed, 2 * self.joints) * &at.right;
        let rates = &self.variance_rates;
        let prior: Vec<f64> = rates.iter().map(|rates| rates.dot(&variances).recip()).collect();
        for j in 0..rates.len() {
            let m = |i: usize| -prior[i] * at.inverse[(fixed + i, fixed + j)] * prior[j];
            let own = prior[j] + m(j);
            score += rates[j] * (0.5 * ((prior[j] * predicted[j]).powi(2) - own));
            let mut sum = rates[j] * (0.25 * own * own);
            (0..j).for_each(|i| sum += rates[i] * (0.5 * m(i).powi(2)));
            information += sum * rates[j].transpose() + rates[j] * sum.transpose();
        }
        let scaled = Matrix3::from_diagonal(&variances);
        let score = (scaled * score).add_scalar(PRIOR_SCORE);
        let information = scaled * information * scaled + Matrix3::identity() * PRIOR_INFORMATION;
        (score, information)
    }

    fn limit_variances(&self, x: &mut DVector<f64>) {
        let logs = x.fixed_rows_mut::<3>(self.unknowns() - 3);
        for (log, most) in logs.into_iter().zip(&MAX_VARIANCES.map(f64::ln)) {
            *log = log.clamp(most + MIN_OF_MAX_VARIANCE.ln(), *most);
        }
    }
}

/// Covariance of the rotations of all films, film by film.
fn noise_covariance(films: &[&FilmEvidence]) -> DMatrix<f64> {
    let joints = films[0].joints.len();
    // All films share the erect film.
    let shared = of_rotations(&films[0].erect_tilts.covariance);
    let mut covariance = DMatrix::zeros(films.len() * joints, films.len() * joints);
    for (i, film) in films.iter().enumerate() {
        for k in 0..films.len() {
            covariance.view_mut((i * joints, k * joints), (joints, joints)).copy_from(&shared);
        }
        let mut own = covariance.view_mut((i * joints, i * joints), (joints, joints));
        own += of_rotations(&film.tilts.covariance);
    }
    covariance
}

/// Covariance of the differences of neighbouring tilts.
pub(super) fn of_rotations(tilts: &DMatrix<f64>) -> DMatrix<f64> {
    let joints = tilts.nrows() - 1;
    DMatrix::from_fn(joints, joints, |a, b| {
        tilts[(a, b)] - tilts[(a, b + 1)] - tilts[(a + 1, b)] + tilts[(a + 1, b + 1)]
    })
}

/// Inverse of a positive definite matrix by the inverse of its triangular factor, in fewer steps than solving by the factor twice.
fn inverse_of(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    let factor = matrix.cholesky()?.unpack_dirty();
    let mut inverse = DMatrix::zeros(size, size);
    // Above its diagonal a column of the factor's inverse is zero.
    for (first, column) in inverse.as_mut_slice().chunks_exact_mut(size).enumerate() {
        column[first] = 1.0;
        for (row, by) in factor.as_slice().chunks_exact(size).enumerate().skip(first) {
            let (solved, rest) = column[row..].split_first_mut().expect("a row of the matrix");
            *solved /= by[row];
            rest.iter_mut().zip(&by[row + 1..]).for_each(|(left, by)| *left -= *solved * by);
        }
    }
    Some(inverse.transpose() * inverse)
}

#[cfg(test)]
mod tests {
    use super::super::super::evidence::{JointEvidence, TiltErrors};
    use super::*;
    use crate::anatomy::Levels;
    use crate::spatial::{Angle, Frontal, Vec3};

    #[test]
    fn rotations_that_a_load_adds_are_all_its_own() {
        // Oracle: generalised least squares are unbiased, so rotations by one load component change that component alone, by one.
        let joint = |k: usize| JointEvidence {
            unloading: Angle::ZERO,
            rotation: Angle::from_deg(2.0 - (k as f64 * 1.7).cos()),
            centre_mm: Vec3::new(3.0, 5.0 * (k as f64).sin(), 30.0 * k as f64),
            disc_mm: Frontal::new(0.3, 6.0),
            to_evener_mm: Frontal::new(1.0, 0.2),
            hinge: Vec3::new(1.0, 0.0, 0.0),
            compliance_rad_per_nmm: 1e-5,
        };
        let film = |sign: f64| FilmEvidence {
            joints: (0..14)
                .map(joint)
                .map(|joint| JointEvidence { rotation: joint.rotation * sign, ..joint })
                .collect(),
            levels: Levels::COMPLETE,
            midpoints_mm: Vec::new(),
            tilts: TiltErrors::alike(15, Angle::from_deg(0.5), Some(15)),
            erect_tilts: TiltErrors::alike(15, Angle::from_deg(0.3), Some(15)),
            repeated_variances: Vec::new(),
        };
        let films = [film(1.0), film(-0.6)];
        let films: Vec<&FilmEvidence> = films.iter().collect();
        let shares = JointShares(DMatrix::from_fn(14, 3, |joint, group| {
            f64::from(u8::from(joint / 5 == group))
        }));
        let model = Model::new(&films, 0.0, &shares).expect("films");
        let start = model.start();
        let x = model.step(&start, &model.equations(&start).expect("equations"));
        let at = model.equations(&x).expect("equations");
        let jacobian = noise_covariance(&films) * at.weighed.transpose();
        let own = at.inverse.rows(0, 6) * &at.weighed * jacobian.columns(0, 6);
        assert!((own - DMatrix::identity(6, 6)).amax() < 1e-6);
    }
}
