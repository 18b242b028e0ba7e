//! Weights of rotations: by their noise, and by the joints' random effects.

use nalgebra::{DMatrix, DMatrixView, DVector};

use super::evidence::FilmEvidence;

/// The inverse of the noise's covariance.
pub(super) enum Precision {
    /// Neighbouring joints share a vertebra on every film alike, and all films share the erect one at every joint alike: the
    /// covariance is the product of one over films and one over joints, and so is its inverse.
    Product { films: DMatrix<f64>, joints: DMatrix<f64> },
    /// Some vertebra is interpolated on some film, and its tilt is less certain than the others', or vertebrae share errors of
    /// completed corners: the whole matrix, over the joints of the first film, then of the next one.
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
        // Of every column and film, one after the other, for all joints at once.
        let (count, of_one) = (columns.ncols(), joints.nrows());
        let by_film = DMatrixView::from_slice(columns.as_slice(), of_one, films.nrows() * count);
        let by_joints = joints * by_film;
        let mut product = DMatrix::zeros(columns.nrows(), count);
        let parts = by_joints.as_slice().chunks_exact(columns.nrows());
        for (from, to) in parts.zip(product.as_mut_slice().chunks_exact_mut(columns.nrows())) {
            for (to, weights) in to.chunks_exact_mut(of_one).zip(films.column_iter()) {
                for (from, weight) in from.chunks_exact(of_one).zip(weights.iter()) {
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
                }
            }
        }
        product
    }

    /// The same of columns of which every film has as many, one film's after the other's, that are zero on all other films.
    pub fn times_of_films(&self, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let (films, joints) = match self {
            Self::Product { films, joints } => (films, joints),
            Self::Whole { .. } => return self.times(columns),
        };
        let (of_one, count) = (joints.nrows(), columns.ncols() / films.nrows());
        let mut product = DMatrix::zeros(columns.nrows(), columns.ncols());
        for (film, weights) in films.column_iter().enumerate() {
            let own = (film * of_one, film * count);
            let by_joints = joints * columns.view(own, (of_one, count));
            for (other, weight) in weights.iter().enumerate() {
                let mut part = product.view_mut((other * of_one, own.1), (of_one, count));
                part.zip_apply(&by_joints, |to, from| *to = weight * from);
            }
        }
        product
    }

    /// Per pair of joints: the sum over pairs of films of their precision times a rotation by either joint's random effect.
    pub fn between(&self, [a, b]: [&DMatrix<f64>; 2]) -> DMatrix<f64> {
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

/// Covariance of the rotations of all films: differences of neighbouring tilts, minus the ones of the erect film, which all share.
fn whole_covariance(films: &[&FilmEvidence], joints: usize) -> DMatrix<f64> {
    let differences = |tilts: &DMatrix<f64>| {
        DMatrix::from_fn(joints, joints, |a, b| {
            tilts[(a, b)] - tilts[(a, b + 1)] - tilts[(a + 1, b)] + tilts[(a + 1, b + 1)]
        })
    };
    let mut covariance = DMatrix::zeros(films.len() * joints, films.len() * joints);
    // The erect film is one and the same.
    let shared = differences(&films[0].erect_tilt_covariance());
    for (i, film) in films.iter().enumerate() {
        for k in 0..films.len() {
            covariance.view_mut((i * joints, k * joints), (joints, joints)).copy_from(&shared);
        }
        let mut block = covariance.view_mut((i * joints, i * joints), (joints, joints));
        block += differences(&film.tilt_covariance());
    }
    covariance
}

/// Inverse of a positive definite matrix, by the inverse of its triangular factor: its product with itself takes fewer steps than
/// solving by the factor twice.
pub(super) fn inverse_of(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
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

/// Divides every column by its largest entry, and returns these entries: newtons and newton millimetres differ by hundreds.
pub(super) fn scale_columns(matrix: &mut DMatrix<f64>) -> DVector<f64> {
    let mut scales = DVector::zeros(matrix.ncols());
    let rows = matrix.nrows();
    let columns = matrix.as_mut_slice().chunks_exact_mut(rows);
    for (column, scale) in columns.zip(&mut scales) {
        *scale = column.iter().fold(f64::MIN_POSITIVE, |most, entry| most.max(entry.abs()));
        column.iter_mut().for_each(|entry| *entry /= *scale);
    }
    scales
}

#[cfg(test)]
mod tests {
    use super::super::evidence::TiltCovariances;
    use super::*;
    use crate::anatomy::Levels;
    use crate::spatial::Angle;

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
            tilt_degrees_of_freedom: [None; 2],
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
        let own =
            DMatrix::from_fn(28, 4, |i, j| if i / 14 == j / 2 { (i + j) as f64 } else { 0.0 });
        for precision in [&short, &long] {
            let [a, b] = [precision.times(&own), precision.times_of_films(&own)];
            assert!((&a - &b).amax() < 1e-12 * a.amax());
        }
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
