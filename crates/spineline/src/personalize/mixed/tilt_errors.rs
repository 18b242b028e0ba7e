//! The part of the loads' covariance from tilts whose variance is estimated.

use nalgebra::{DMatrix, RowVector3};

use super::super::evidence::FilmEvidence;
use super::equations::of_rotations;

/// More degrees of freedom make no difference.
const MANY: f64 = 1e4;

/// Parts of the covariance of the loads from tilts whose variance is estimated, with its degrees of freedom.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct TiltErrors(Vec<(DMatrix<f64>, usize)>);

impl TiltErrors {
    /// Of films and of the erect film that they share, from how loads follow errors of the rotations, components by rotations.
    pub fn of_films(films: &[&FilmEvidence], loads_by_errors: &DMatrix<f64>) -> Self {
        let joints = loads_by_errors.ncols() / films.len();
        let by_film = |film: usize| loads_by_errors.columns(film * joints, joints);
        let part = |by_rotations: DMatrix<f64>, tilts, freedom: Option<usize>| {
            let covariance = &by_rotations * of_rotations(&tilts) * by_rotations.transpose();
            Some((covariance, freedom?))
        };
        let of_film = films.iter().enumerate().filter_map(|(i, film)| {
            part(by_film(i).into_owned(), film.tilt_covariance(), film.tilt_degrees_of_freedom[0])
        });
        let by_erect = (0..films.len())
            .map(by_film)
            .fold(DMatrix::zeros(loads_by_errors.nrows(), joints), |sum, by_film| sum + by_film);
        let of_erect =
            part(by_erect, films[0].erect_tilt_covariance(), films[0].tilt_degrees_of_freedom[1]);
        Self(of_film.chain(of_erect).collect())
    }

    /// Degrees of freedom of the covariance of some numbers of a film's load, of which the inverse is given; `None` where no noise was
    /// estimated, or where they are too many to matter.
    pub fn freedom(
        &self,
        film: usize,
        numbers: &[RowVector3<f64>],
        inverse: &DMatrix<f64>,
    ) -> Option<f64> {
        let unsure = self.0.iter().map(|(covariance, freedom)| {
            let share = (inverse * of_film(covariance, film, numbers)).trace();
            (share / numbers.len() as f64).powi(2) / *freedom as f64
        });
        let sum: f64 = unsure.sum();
        (sum > 1.0 / MANY).then(|| 1.0 / sum)
    }
}

/// Covariance of some linear numbers of a film's load, from the covariance of all components.
pub(super) fn of_film(
    covariance: &DMatrix<f64>,
    film: usize,
    numbers: &[RowVector3<f64>],
) -> DMatrix<f64> {
    let own = covariance.fixed_view::<3, 3>(3 * film, 3 * film);
    DMatrix::from_fn(numbers.len(), numbers.len(), |i, j| {
        (numbers[i] * own * numbers[j].transpose())[0]
    })
}
