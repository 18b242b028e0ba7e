//! Weights of rotations: by their noise, and by the joints' random effects.

use nalgebra::{DMatrix, DVector, Dyn, Vector3};

use super::evidence::FilmEvidence;
use crate::spatial::Angle;

/// The inverse of the noise's covariance.
pub(super) enum Precision {
    /// Neighbouring joints share a vertebra on every film alike, and all films share the erect one at every joint alike: the
    /// covariance is the product of one over films and one over joints, and so is its inverse.
    Product { films: DMatrix<f64>, joints: DMatrix<f64> },
    /// Some vertebra is interpolated on some film, and its tilt is less certain than the others', or vertebrae share errors of
    /// completed corners: the whole matrix, over the joints of the first film, then over those of the next one.
    Whole { matrix: DMatrix<f64>, films: usize, joints: usize },
}

impl Precision {
    pub fn new(films: &[&FilmEvidence], joints: usize) -> Option<Self> {
        if films.iter().any(|film| film.tilt_covariances.is_some()) {
            let matrix = whole_covariance(films, joints).cholesky()?.inverse();
            return Some(Self::Whole { matrix, films: films.len(), joints });
        }
        let over_films = DMatrix::from_fn(films.len(), films.len(), |a, b| {
            let own = if a == b { films[a].tilt_sd.rad().powi(2) } else { 0.0 };
            own + films[a].erect_tilt_sd.rad().powi(2)
        });
        // Of the matrix with 2 on its diagonal and -1 beside it.
        let over_joints = DMatrix::from_fn(joints, joints, |a, b| {
            ((a.min(b) + 1) * (joints - a.max(b))) as f64 / (joints + 1) as f64
        });
        Some(Self::Product { films: over_films.cholesky()?.inverse(), joints: over_joints })
    }

    /// Times columns of rotations of all films below one another.
    pub fn times(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let (films, joints) = match self {
            Self::Product { films, joints } => (films, joints),
            Self::Whole { matrix, .. } => return matrix * columns,
        };
        let mut product = DMatrix::zeros(columns.nrows(), columns.ncols());
        for (from, mut to) in columns.column_iter().zip(product.column_iter_mut()) {
            let from = from.reshape_generic(Dyn(joints.nrows()), Dyn(films.nrows()));
            let weighed = joints * (from * films);
            to.copy_from_slice(weighed.as_slice());
        }
        product
    }

    fn joints(&self) -> usize {
        match self {
            Self::Product { joints, .. } => joints.nrows(),
            Self::Whole { joints, .. } => *joints,
        }
    }

    /// Per pair of joints: the sum over pairs of films of their precision times a rotation of either joint's own part.
    fn between(&self, [a, b]: [&DMatrix<f64>; 2]) -> DMatrix<f64> {
        match self {
            Self::Product { films, joints } => (a * (b * films).transpose()).component_mul(joints),
            Self::Whole { matrix, films, joints } => DMatrix::from_fn(*joints, *joints, |j, k| {
                let of = |(f, g): (usize, usize)| {
                    a[(j, f)] * matrix[(f * joints + j, g * joints + k)] * b[(k, g)]
                };
                (0..*films).flat_map(|f| (0..*films).map(move |g| (f, g))).map(of).sum()
            }),
        }
    }
}

/// Covariance of the rotations of all films: differences of neighbouring tilts, minus those of the erect film that all share.
fn whole_covariance(films: &[&FilmEvidence], joints: usize) -> DMatrix<f64> {
    let differences = |tilts: &DMatrix<f64>| {
        DMatrix::from_fn(joints, joints, |a, b| {
            tilts[(a, b)] - tilts[(a, b + 1)] - tilts[(a + 1, b)] + tilts[(a + 1, b + 1)]
        })
    };
    let alike =
        |sd: Angle| DMatrix::from_diagonal_element(joints + 1, joints + 1, sd.rad().powi(2));
    let mut covariance = DMatrix::zeros(films.len() * joints, films.len() * joints);
    // The erect film is one and the same.
    let erect = films.iter().find_map(|film| film.tilt_covariances.as_ref());
    for (i, film) in films.iter().enumerate() {
        let erect = erect.map_or_else(|| alike(film.erect_tilt_sd), |v| v.erect.clone());
        let shared = differences(&erect);
        for k in 0..films.len() {
            covariance.view_mut((i * joints, k * joints), (joints, joints)).copy_from(&shared);
        }
        let own = film.tilt_covariances.as_ref();
        let own = own.map_or_else(|| alike(film.tilt_sd), |variances| variances.film.clone());
        let mut block = covariance.view_mut((i * joints, i * joints), (joints, joints));
        block += differences(&own);
    }
    covariance
}

/// The joints' random effects: what each has of its own on all films, and what neighbours share, beside the noise.
pub(super) struct RandomEffects {
    blocks: [EffectBlock; 3],
    /// Its covariance once the rotations are known.
    pub covariance: DMatrix<f64>,
}

/// Effects of one kind.
struct EffectBlock {
    /// Rotations per unit of what a joint has: joints by films.
    rotations: DMatrix<f64>,
    /// What joints have, by the effects; `None` where every joint has its own.
    along: Option<DMatrix<f64>>,
}

impl EffectBlock {
    fn len(&self) -> usize {
        self.along.as_ref().map_or(self.rotations.nrows(), DMatrix::ncols)
    }

    /// Sums over joints, by the effects.
    fn gathered(&self, by_joints: DMatrix<f64>) -> DMatrix<f64> {
        match &self.along {
            Some(along) => along.transpose() * by_joints,
            None => by_joints,
        }
    }
}

impl RandomEffects {
    /// Of stiffness by joint, of centres, and of stiffness along the spine, in this order.
    pub fn new(
        [stiffness, centres, along]: [DMatrix<f64>; 3],
        precision: &Precision,
        variances: Vector3<f64>,
    ) -> Option<Self> {
        let trend = Some(random_walk(precision.joints()));
        let blocks = [
            EffectBlock { rotations: stiffness, along: None },
            EffectBlock { rotations: centres, along: None },
            EffectBlock { rotations: along, along: trend },
        ];
        let count = blocks.iter().map(EffectBlock::len).sum();
        let mut own = Self { blocks, covariance: DMatrix::zeros(count, count) };
        let mut known = DMatrix::zeros(count, count);
        for (a, part) in own.blocks.iter().enumerate() {
            let (row, rows) = own.block(a);
            for (b, other) in own.blocks.iter().enumerate() {
                let (column, columns) = own.block(b);
                let between = precision.between([&part.rotations, &other.rotations]);
                let by_columns = other.gathered(part.gathered(between).transpose()).transpose();
                known.view_mut((row, column), (rows, columns)).copy_from(&by_columns);
            }
            for i in row..row + rows {
                known[(i, i)] += 1.0 / variances[a];
            }
        }
        own.covariance = inverse_of(known)?;
        Some(own)
    }

    /// First effect of a block, and their number.
    pub fn block(&self, index: usize) -> (usize, usize) {
        let first = self.blocks[..index].iter().map(EffectBlock::len).sum();
        (first, self.blocks[index].len())
    }

    /// Weighted columns of rotations projected on the effects.
    fn gather(&self, weighed: &DMatrix<f64>) -> DMatrix<f64> {
        let mut gathered = DMatrix::zeros(self.covariance.nrows(), weighed.ncols());
        for (index, block) in self.blocks.iter().enumerate() {
            let (joints, films) = block.rotations.shape();
            let by_joints = DMatrix::from_fn(joints, weighed.ncols(), |joint, column| {
                let of = |a| block.rotations[(joint, a)] * weighed[(a * joints + joint, column)];
                (0..films).map(of).sum()
            });
            let (first, count) = self.block(index);
            gathered.rows_mut(first, count).copy_from(&block.gathered(by_joints));
        }
        gathered
    }
}

/// A random walk over the joints with a mean of zero, by its steps; its mean variance is one for steps of one.
fn random_walk(joints: usize) -> DMatrix<f64> {
    let mut walk = DMatrix::from_fn(joints, joints - 1, |joint, step| {
        let after = (joints - 1 - step) as f64 / joints as f64;
        if joint > step { 1.0 - after } else { -after }
    });
    let variance = walk.norm_squared() / joints as f64;
    walk /= variance.sqrt();
    walk
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
        let across = columns.transpose();
        let (mut matrix, mut right) = (&across * &by_columns, across * &by_residual);
        let (mut effects_by_columns, mut effects_by_residual) = Default::default();
        if let Some(own) = own {
            // Woodbury's identity.
            let (columns, residual) = (own.gather(&by_columns), own.gather(&by_residual));
            effects_by_columns = &own.covariance * &columns;
            effects_by_residual = &own.covariance * &residual;
            let across = columns.transpose();
            matrix -= &across * &effects_by_columns;
            right -= across * &effects_by_residual;
        }
        Self { matrix, right, effects_by_columns, effects_by_residual }
    }
}

/// Inverse of a positive definite matrix, by that of its triangular factor: its product with itself takes fewer steps than
/// solving by the factor twice.
fn inverse_of(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = matrix.nrows();
    let mut inverse = DMatrix::identity(size, size);
    matrix.cholesky()?.l_dirty().solve_lower_triangular_unchecked_mut(&mut inverse);
    Some(inverse.transpose() * inverse)
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

#[cfg(test)]
mod tests {
    use super::super::evidence::TiltCovariances;
    use super::*;
    use crate::anatomy::Levels;

    fn film(sd_deg: f64, spelled_out: bool) -> FilmEvidence {
        let levels = Levels::COMPLETE;
        let [film, erect] = [sd_deg, 0.7].map(Angle::from_deg);
        let alike = |sd: Angle| {
            DMatrix::from_diagonal_element(levels.len(), levels.len(), sd.rad().powi(2))
        };
        let covariances = TiltCovariances { film: alike(film), erect: alike(erect) };
        FilmEvidence {
            joints: Vec::new(),
            tilt_sd: film,
            erect_tilt_sd: erect,
            levels,
            tilt_covariances: spelled_out.then_some(covariances),
        }
    }

    #[test]
    fn the_whole_matrix_of_equal_variances_is_the_product() {
        // Oracle: the two forms are the same covariance.
        let [short, long] = [false, true].map(|whole| {
            let films = [film(0.5, whole), film(0.9, whole)];
            Precision::new(&films.iter().collect::<Vec<_>>(), 14).expect("positive definite")
        });
        assert!(
            matches!(long, Precision::Whole { .. }) && matches!(short, Precision::Product { .. })
        );
        let columns = DMatrix::from_fn(28, 3, |i, j| ((i * 7 + j * 5) % 11) as f64 - 5.0);
        let [a, b] = [&short, &long].map(|precision| precision.times(&columns));
        assert!((&a - &b).amax() < 1e-9 * a.amax());
        let parts = [2, 3].map(|k| DMatrix::from_fn(14, 2, |i, j| ((i * k + j) % 5) as f64 - 2.0));
        let [a, b] = [&short, &long].map(|precision| precision.between([&parts[0], &parts[1]]));
        assert!((&a - &b).amax() < 1e-9 * a.amax());
    }

    #[test]
    fn an_unknown_tilt_leaves_the_sum_of_its_two_joints() {
        // Oracle: with a tilt that is not known at all, opposite errors of the joints beside it have no weight, and their sum
        // has as much as the rotation of one joint over both.
        let mut unknown = film(0.5, true);
        unknown.tilt_covariances.as_mut().expect("spelled out").film[(7, 7)] = 1e6;
        let precision = Precision::new(&[&unknown], 14).expect("positive definite");
        let weight = |of: [f64; 2]| {
            let column = DMatrix::from_fn(14, 1, |i, _| match i {
                6 => of[0],
                7 => of[1],
                _ => 0.0,
            });
            (column.transpose() * precision.times(&column))[(0, 0)]
        };
        assert!(weight([1.0, -1.0]) < 1e-3 * weight([0.5, 0.5]));
    }
}
