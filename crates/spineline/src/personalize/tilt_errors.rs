//! How well the variance of a load is known: the noise of tilts is estimated from how readings differ.
//!
//! # Equations
//! The loads `w` follow errors of the rotations by `M = (X' V^-1 X)^-1 X' V^-1`. The part of a film `s` in the covariance of `w`, with
//! the covariance `T_s` of its tilts and the differences `B_s` that make rotations of them, grows with the variance of its tilts, which
//! is known on `n_s` degrees of freedom. A variance `v` of a number of the loads, of which this part is `v_s`, is then known on
//!
//! ```text
//! C_s = M B_s T_s B_s' M',    nu = v^2 / sum_s (v_s^2 / n_s)
//! ```
//!
//! degrees of freedom [satterthwaite-1946]. For several numbers with the covariance `C`, `v_s / v` is the mean of the eigenvalues of
//! `C^-1 C_s`. Deviations of the random effects are taken as known: their priors keep them above zero. Tilts of completed
//! corners and interpolated vertebrae count as the others of their film (assumption), which makes the degrees of freedom smaller.

use nalgebra::{DMatrix, RowVector3};

use super::evidence::FilmEvidence;

/// More degrees of freedom make no difference.
const MANY: f64 = 1e4;

/// Parts of the covariance of the loads from tilts of films whose variance is estimated.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct TiltErrors(Vec<FilmPart>);

#[derive(Debug, Clone, PartialEq)]
struct FilmPart {
    /// Of all load components.
    covariance: DMatrix<f64>,
    /// Degrees of freedom of the variance of the film's tilts.
    freedom: usize,
}

impl TiltErrors {
    /// Of films and of the erect film that they share, from how loads follow errors of the rotations, components by rotations.
    pub fn of_films(films: &[&FilmEvidence], loads_by_errors: &DMatrix<f64>) -> Self {
        let joints = loads_by_errors.ncols() / films.len();
        let loads = loads_by_errors.nrows();
        let mut by_erect_tilts = DMatrix::zeros(loads, joints + 1);
        let mut parts = Vec::new();
        let mut add = |by_tilts: &DMatrix<f64>, covariance: DMatrix<f64>, freedom| {
            parts.push(FilmPart {
                covariance: by_tilts * covariance * by_tilts.transpose(),
                freedom,
            });
        };
        for (i, film) in films.iter().enumerate() {
            let by_rotations = loads_by_errors.columns(i * joints, joints);
            // A rotation is the upper tilt minus the lower one.
            let by_tilts = DMatrix::from_fn(loads, joints + 1, |load, tilt| {
                let of = |joint: usize| by_rotations.get((load, joint)).copied().unwrap_or(0.0);
                tilt.checked_sub(1).map_or(0.0, of) - of(tilt)
            });
            by_erect_tilts += &by_tilts;
            if let Some(freedom) = film.tilt_degrees_of_freedom[0] {
                add(&by_tilts, film.tilt_covariance(), freedom);
            }
        }
        if let Some(freedom) = films[0].tilt_degrees_of_freedom[1] {
            add(&by_erect_tilts, films[0].erect_tilt_covariance(), freedom);
        }
        Self(parts)
    }

    /// Degrees of freedom of the covariance of some numbers of a film's load, of which the inverse is given; `None` where no noise was
    /// estimated, or where they are too many to matter.
    pub fn freedom(
        &self,
        film: usize,
        numbers: &[RowVector3<f64>],
        inverse: &DMatrix<f64>,
    ) -> Option<f64> {
        let count = numbers.len() as f64;
        let unsure = self.0.iter().map(|part| {
            let own = of_film(&part.covariance, film, numbers);
            ((inverse * own).trace() / count).powi(2) / part.freedom as f64
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
