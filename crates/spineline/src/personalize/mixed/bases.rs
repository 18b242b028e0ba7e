//! Bases in which the effects of groups and joints are written.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};

/// An orthonormal basis of the vectors with a mean of zero.
pub(super) fn contrasts(groups: usize) -> DMatrix<f64> {
    DMatrix::from_fn(groups, groups.saturating_sub(1), |group, column| {
        let before = (column + 1) as f64;
        let of_group = match group.cmp(&(column + 1)) {
            std::cmp::Ordering::Less => 1.0,
            std::cmp::Ordering::Equal => -before,
            std::cmp::Ordering::Greater => 0.0,
        };
        of_group / (before * (before + 1.0)).sqrt()
    })
}

/// Cosines along the joints, by columns, in which a random walk with a mean of zero has a diagonal covariance, and this diagonal, with a
/// mean over the joints of one. The inverse of that covariance is the matrix of second differences [strang-1999].
pub(super) fn random_walk(joints: usize) -> (DMatrix<f64>, DVector<f64>) {
    let n = joints as f64;
    let cosines = DMatrix::from_fn(joints, joints, |joint, wave| match wave {
        0 => (1.0 / n).sqrt(),
        _ => (2.0 / n).sqrt() * (PI * wave as f64 * (joint as f64 + 0.5) / n).cos(),
    });
    let mut variances = DVector::from_fn(joints, |wave, _| match wave {
        0 => 0.0,
        _ => (0.5 / (0.5 * PI * wave as f64 / n).sin()).powi(2),
    });
    variances *= n / variances.sum();
    (cosines, variances)
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
        let (cosines, variances) = random_walk(joints);
        let by_cosines = &cosines * DMatrix::from_diagonal(&variances) * cosines.transpose();
        assert!((by_cosines - &walk * walk.transpose()).amax() < 1e-12);
        let alike = &cosines * cosines.transpose();
        assert!((alike - DMatrix::identity(joints, joints)).amax() < 1e-12);
    }
}
