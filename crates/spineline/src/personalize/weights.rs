//! Weights of rotations: by their noise, and by the joints' random effects.

use nalgebra::{DMatrix, DVector, Dyn, Vector2};

use super::evidence::FilmEvidence;

/// The inverse of the noise's covariance.
///
/// Neighbouring joints share a vertebra on every film alike, and all films share the erect one at every joint alike: the
/// covariance is the product of one over films and one over joints, and so is its inverse.
pub(super) struct Precision {
    pub films: DMatrix<f64>,
    pub joints: DMatrix<f64>,
}

impl Precision {
    pub fn new(films: &[&FilmEvidence], joints: usize) -> Option<Self> {
        let over_films = DMatrix::from_fn(films.len(), films.len(), |a, b| {
            let own = if a == b { films[a].tilt_sd.rad().powi(2) } else { 0.0 };
            own + films[a].erect_tilt_sd.rad().powi(2)
        });
        // Of the matrix with 2 on its diagonal and -1 beside it.
        let over_joints = DMatrix::from_fn(joints, joints, |a, b| {
            ((a.min(b) + 1) * (joints - a.max(b))) as f64 / (joints + 1) as f64
        });
        Some(Self { films: over_films.cholesky()?.inverse(), joints: over_joints })
    }

    /// Times columns of rotations of all films below one another.
    pub fn times(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let mut product = DMatrix::zeros(columns.nrows(), columns.ncols());
        for (from, mut to) in columns.column_iter().zip(product.column_iter_mut()) {
            let from = from.reshape_generic(Dyn(self.joints.nrows()), Dyn(self.films.nrows()));
            let weighed = &self.joints * (from * &self.films);
            to.copy_from_slice(weighed.as_slice());
        }
        product
    }
}

/// The joints' random effects: what each has of its own on all films, beside the noise.
pub(super) struct RandomEffects {
    /// Rotations per unit of every joint's own stiffness, and of its own centre: joints by films.
    pub rotations: [DMatrix<f64>; 2],
    /// Its covariance once the rotations are known.
    pub covariance: DMatrix<f64>,
}

impl RandomEffects {
    pub fn new(
        rotations: [DMatrix<f64>; 2],
        precision: &Precision,
        variances: Vector2<f64>,
    ) -> Option<Self> {
        let joints = precision.joints.nrows();
        let mut known = DMatrix::zeros(2 * joints, 2 * joints);
        let weighed = rotations.each_ref().map(|part| part * &precision.films);
        for (a, part) in rotations.iter().enumerate() {
            for (b, weighed) in weighed.iter().enumerate() {
                let block = (part * weighed.transpose()).component_mul(&precision.joints);
                known.view_mut((a * joints, b * joints), (joints, joints)).copy_from(&block);
            }
        }
        for i in 0..2 * joints {
            known[(i, i)] += 1.0 / variances[i / joints];
        }
        Some(Self { covariance: known.cholesky()?.inverse(), rotations })
    }

    /// Weighted columns of rotations projected on the effects.
    fn gather(&self, weighed: &DMatrix<f64>) -> DMatrix<f64> {
        let (joints, films) = self.rotations[0].shape();
        DMatrix::from_fn(2 * joints, weighed.ncols(), |own, column| {
            let (part, joint) = (&self.rotations[own / joints], own % joints);
            (0..films).map(|a| part[(joint, a)] * weighed[(a * joints + joint, column)]).sum()
        })
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
    pub fn new(
        columns: &DMatrix<f64>,
        residual: &DMatrix<f64>,
        precision: &Precision,
        own: Option<&RandomEffects>,
    ) -> Self {
        let (by_columns, by_residual) = (precision.times(columns), precision.times(residual));
        let (mut matrix, mut right) = (columns.tr_mul(&by_columns), columns.tr_mul(&by_residual));
        let (mut effects_by_columns, mut effects_by_residual) = Default::default();
        if let Some(own) = own {
            // Woodbury's identity.
            let (columns, residual) = (own.gather(&by_columns), own.gather(&by_residual));
            effects_by_columns = &own.covariance * &columns;
            effects_by_residual = &own.covariance * &residual;
            matrix -= columns.tr_mul(&effects_by_columns);
            right -= columns.tr_mul(&effects_by_residual);
        }
        Self { matrix, right, effects_by_columns, effects_by_residual }
    }
}

/// Divides every column by its largest entry, and answers with those: newtons and newton millimetres differ by hundreds.
pub(super) fn scale_columns(matrix: &mut DMatrix<f64>) -> DVector<f64> {
    let largest = matrix.column_iter().map(|column| column.amax().max(f64::MIN_POSITIVE));
    let scales = DVector::from_iterator(matrix.ncols(), largest);
    for (mut column, scale) in matrix.column_iter_mut().zip(scales.iter()) {
        column /= *scale;
    }
    scales
}
