//! Random effects of the joints on all films, of their stiffness and of their centres.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::weights::{Precision, inverse_of};

/// Cosine basis along the spine for the random effects of stiffness: in it, an independent part and a random walk over the joints
/// both have a diagonal covariance.
///
/// # Equations
/// For `n` joints, `j` from 0, the levels of a random walk with a mean of zero have the covariance `U diag(walk) U'` with
///
/// ```text
/// U[j,0] = sqrt(1/n),  U[j,k] = sqrt(2/n) cos(pi k (j + 1/2) / n),  walk_0 = 0,  walk_k ~ 1 / (4 sin^2(pi k / 2n))
/// ```
///
/// since its inverse is the matrix of second differences, whose eigenvectors these cosines are [strang-1999]; the variances are scaled
/// so that their mean over the joints is one. The independent part has the identity as its covariance, in any such basis.
pub(super) struct Waves {
    /// Joints by cosines.
    shapes: DMatrix<f64>,
    /// Cosines by joints.
    across: DMatrix<f64>,
    /// Variance of the walk, by cosine.
    walk: DVector<f64>,
}

impl Waves {
    pub fn new(joints: usize) -> Self {
        use std::f64::consts::PI;
        let n = joints as f64;
        let shapes = DMatrix::from_fn(joints, joints, |joint, wave| match wave {
            0 => (1.0 / n).sqrt(),
            _ => (2.0 / n).sqrt() * (PI * wave as f64 * (joint as f64 + 0.5) / n).cos(),
        });
        let mut walk = DVector::from_fn(joints, |wave, _| match wave {
            0 => 0.0,
            _ => (0.5 / (0.5 * PI * wave as f64 / n).sin()).powi(2),
        });
        walk *= n / walk.sum();
        Self { across: shapes.transpose(), shapes, walk }
    }
}

/// Random effects of one joint, on all films alike.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct OwnParts {
    /// `ln` of its compliance relative to its group.
    pub log_softness: f64,
    /// Shift of its centre up its disc relative to all joints.
    pub higher_discs: f64,
}

/// The joints' random effects: stiffness in the cosine basis, then centres by joint.
pub(super) struct RandomEffects<'a> {
    waves: &'a Waves,
    /// Rotations per unit of the effects on stiffness, and per unit of the effects on centres: joints by films.
    rotations: [DMatrix<f64>; 2],
    /// Inverse of every effect's variance before the rotations are known.
    prior: DVector<f64>,
    /// Their covariance once the rotations are known.
    pub covariance: DMatrix<f64>,
}

/// Number of variances: of stiffness by joint, of centres, and of stiffness along the spine, in this order.
pub(super) const VARIANCES: usize = 3;

impl<'a> RandomEffects<'a> {
    /// Of stiffness and of centres, with the variances that [`VARIANCES`] counts.
    pub fn new(
        waves: &'a Waves,
        rotations: [DMatrix<f64>; 2],
        precision: &Precision,
        variances: Vector3<f64>,
    ) -> Option<Self> {
        let joints = waves.walk.len();
        let prior = DVector::from_fn(2 * joints, |effect, _| {
            1.0 / match effect.checked_sub(joints) {
                None => variances[0] + variances[2] * waves.walk[effect],
                Some(_) => variances[1],
            }
        });
        let [stiffness, centres] = &rotations;
        let mut known = DMatrix::from_diagonal(&prior);
        let both = &waves.across * precision.between([stiffness, stiffness]) * &waves.shapes;
        let mixed = &waves.across * precision.between([stiffness, centres]);
        known.view_mut((0, 0), (joints, joints)).zip_apply(&both, |sum, part| *sum += part);
        known.view_mut((joints, 0), (joints, joints)).copy_from(&mixed.transpose());
        known.view_mut((0, joints), (joints, joints)).copy_from(&mixed);
        let own = precision.between([centres, centres]);
        known
            .view_mut((joints, joints), (joints, joints))
            .zip_apply(&own, |sum, part| *sum += part);
        Some(Self { waves, rotations, prior, covariance: inverse_of(known)? })
    }

    /// Weighted columns of rotations projected on the effects.
    pub fn gather(&self, weighed: &DMatrix<f64>) -> DMatrix<f64> {
        let (joints, films) = self.rotations[0].shape();
        let by_joints = |rotations: &DMatrix<f64>| {
            let mut sums = DMatrix::zeros(joints, weighed.ncols());
            for (mut sum, column) in sums.column_iter_mut().zip(weighed.column_iter()) {
                for film in 0..films {
                    let own = column.rows(film * joints, joints);
                    sum.zip_zip_apply(&rotations.column(film), &own, |s, r, w| *s += r * w);
                }
            }
            sums
        };
        let [stiffness, centres] = self.rotations.each_ref().map(by_joints);
        let mut gathered = DMatrix::zeros(2 * joints, weighed.ncols());
        gathered.rows_mut(0, joints).copy_from(&(&self.waves.across * stiffness));
        gathered.rows_mut(joints, joints).copy_from(&centres);
        gathered
    }

    /// Rotations of all films by columns of effects.
    pub fn rotations(&self, effects: &DMatrix<f64>) -> DMatrix<f64> {
        let (joints, films) = self.rotations[0].shape();
        let log_softness = &self.waves.shapes * effects.rows(0, joints);
        let centres = effects.rows(joints, joints);
        let [by_stiffness, by_centres] = &self.rotations;
        DMatrix::from_fn(joints * films, effects.ncols(), |row, column| {
            let (film, joint) = (row / joints, row % joints);
            by_stiffness[(joint, film)] * log_softness[(joint, column)]
                + by_centres[(joint, film)] * centres[(joint, column)]
        })
    }

    /// Effects as parts of the joints.
    pub fn by_joint(&self, effects: &DMatrix<f64>) -> Vec<OwnParts> {
        let joints = self.waves.walk.len();
        let log_softness = &self.waves.shapes * effects.rows(0, joints);
        let centres = effects.rows(joints, joints);
        let parts = log_softness.iter().zip(centres.iter());
        parts
            .map(|(&log_softness, &higher_discs)| OwnParts { log_softness, higher_discs })
            .collect()
    }

    /// Slope of the restricted likelihood by the variances, and its expected curvature, from the predicted effects and their covariance
    /// with the fitted numbers unknown.
    ///
    /// # Equations
    /// With the effects' variances `D = sum_i s_i D_i`, which are diagonal, predicted effects `u` and their covariance `C`:
    ///
    /// ```text
    /// w = D^-1 u,   M = D^-1 - D^-1 C D^-1,   dl_R/ds_i = 1/2 (w' D_i w - tr(M D_i)),   I_ij = 1/2 tr(M D_i M D_j)
    /// ```
    pub fn scoring(
        &self,
        predicted: &DMatrix<f64>,
        covariance: &DMatrix<f64>,
    ) -> (Vector3<f64>, Matrix3<f64>) {
        let count = self.prior.len();
        let rates: Vec<Vector3<f64>> = (0..count).map(|effect| self.rates(effect)).collect();
        let (mut score, mut information) = (Vector3::zeros(), Matrix3::zeros());
        for j in 0..count {
            let prior = self.prior[j];
            // Sum over the effects of their rates times M².
            let mut sum = Vector3::zeros();
            for i in 0..j {
                sum += rates[i] * (prior * covariance[(i, j)] * self.prior[i]).powi(2);
            }
            let own = prior - prior * covariance[(j, j)] * prior;
            score += rates[j] * (0.5 * ((prior * predicted[j]).powi(2) - own));
            sum += rates[j] * (0.5 * own * own);
            information += 0.5 * (sum * rates[j].transpose() + rates[j] * sum.transpose());
        }
        (score, information)
    }

    /// Derivatives of the variance of an effect by every variance.
    fn rates(&self, effect: usize) -> Vector3<f64> {
        match effect.checked_sub(self.waves.walk.len()) {
            None => Vector3::new(1.0, 0.0, self.waves.walk[effect]),
            Some(_) => Vector3::new(0.0, 1.0, 0.0),
        }
    }
}

/// The normal equations of columns and a residual, weighted by noise and by the random effects.
pub(super) struct Normal {
    pub matrix: DMatrix<f64>,
    pub right: DMatrix<f64>,
    /// Predicted random effects, per column and for the residual.
    pub effects_by_columns: DMatrix<f64>,
    pub effects_by_residual: DMatrix<f64>,
}

impl Normal {
    /// Of columns and a residual, each also times the noise's precision.
    pub fn new(
        [columns, by_columns]: [&DMatrix<f64>; 2],
        [residual, by_residual]: [&DMatrix<f64>; 2],
        own: Option<&RandomEffects<'_>>,
    ) -> Self {
        let across = by_columns.transpose();
        let (mut matrix, mut right) = (&across * columns, across * residual);
        let (mut effects_by_columns, mut effects_by_residual) = Default::default();
        if let Some(own) = own {
            // Woodbury's identity.
            let (columns, residual) = (own.gather(by_columns), own.gather(by_residual));
            effects_by_columns = &own.covariance * &columns;
            effects_by_residual = &own.covariance * &residual;
            let across = columns.transpose();
            matrix -= &across * &effects_by_columns;
            right -= across * &effects_by_residual;
        }
        Self { matrix, right, effects_by_columns, effects_by_residual }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::RowDVector;

    use super::*;

    #[test]
    fn the_basis_has_the_covariance_of_a_random_walk() {
        // Oracle: the walk itself, step by step, its mean over the joints taken away.
        let joints = 14;
        let mut walk = DMatrix::from_fn(joints, joints - 1, |joint, step| f64::from(joint > step));
        let mean: RowDVector<f64> = walk.row_mean();
        walk.row_iter_mut().for_each(|mut row| row -= &mean);
        walk /= (walk.norm_squared() / joints as f64).sqrt();
        let waves = Waves::new(joints);
        let by_waves =
            &waves.shapes * DMatrix::from_diagonal(&waves.walk) * waves.shapes.transpose();
        assert!((by_waves - &walk * walk.transpose()).amax() < 1e-12);
        let alike = &waves.shapes * waves.shapes.transpose();
        assert!((alike - DMatrix::identity(joints, joints)).amax() < 1e-12);
    }
}
