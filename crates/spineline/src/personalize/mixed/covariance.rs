//! Covariance of linear numbers of the effects, and the degrees of freedom on which it is known.
//!
//! # Degrees of freedom
//! The covariance depends on variances that are estimated: of the tilts of each film, on `n_f` degrees of freedom by how readings differ,
//! and of the random effects, with the inverse information `V` of `ln s`. A variance `v` of one number is known on
//!
//! ```text
//! nu = 2 v^2 / (2 sum_f v_f^2 / n_f + g' V g),    v_f = l' M S_f M' l,   g_i = dv / d ln s_i = s_i  l' P D^-1 D_i D^-1 P' l
//! ```
//!
//! degrees of freedom [satterthwaite-1946], [fai-cornelius-1996]: `M` has the derivatives of the numbers by the rotations, `S_f` is the
//! covariance of the rotations by the tilts of film `f`, and `P` the covariance of the numbers with the random effects. For several
//! numbers with the covariance `C`, `v_f / v` is the mean of the eigenvalues of `C^-1 C_f`, and so is `g / v`. Tilts of completed corners
//! and interpolated vertebrae count as the others of their film (assumption), which makes the degrees of freedom smaller.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::super::evidence::{FilmEvidence, TiltErrors};
use super::equations::{Equations, Model, of_rotations};

/// More degrees of freedom make no difference.
const MANY: f64 = 1e4;

#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct EstimatedCovariance {
    /// The covariance.
    pub whole: DMatrix<f64>,
    /// Parts from the tilts of films whose variance is estimated, with its degrees of freedom.
    from_tilts: Vec<(DMatrix<f64>, usize)>,
    /// Derivatives by `ln` of the variances of the random effects.
    by_variances: Vec<DMatrix<f64>>,
    /// Covariance of `ln` of these variances.
    of_variances: Matrix3<f64>,
}

impl EstimatedCovariance {
    /// Of numbers that are rows of effects.
    pub fn of(
        numbers: &DMatrix<f64>,
        films: &[&FilmEvidence],
        model: &Model<'_>,
        x: &DVector<f64>,
        at: &Equations,
    ) -> Self {
        let by_effects = numbers * &at.inverse;
        let (by_variances, of_variances) = model.by_variances(x, at, numbers);
        Self {
            whole: &by_effects * numbers.transpose(),
            from_tilts: from_tilts(films, &(by_effects * &at.weighed)),
            by_variances: by_variances.into(),
            of_variances,
        }
    }

    /// Known, without degrees of freedom.
    #[cfg(test)]
    pub fn known(whole: DMatrix<f64>) -> Self {
        Self { whole, ..Self::default() }
    }

    /// With parts from the tilts of films.
    #[cfg(test)]
    pub fn with_tilts(self, films: &[&FilmEvidence], by_errors: &DMatrix<f64>) -> Self {
        Self { from_tilts: from_tilts(films, by_errors), ..self }
    }

    /// Degrees of freedom of the covariance of some numbers, of which the inverse is given, and which `of` takes from a whole covariance;
    /// `None` where nothing was estimated, or where they are too many to matter.
    pub fn freedom(
        &self,
        inverse: &DMatrix<f64>,
        of: impl Fn(&DMatrix<f64>) -> DMatrix<f64>,
    ) -> Option<f64> {
        let share = |part: &DMatrix<f64>| (inverse * of(part)).trace() / inverse.nrows() as f64;
        let tilts =
            self.from_tilts.iter().map(|(part, freedom)| share(part).powi(2) / *freedom as f64);
        let by_variances = self.by_variances.iter().map(share);
        let by_variances = Vector3::from_iterator(by_variances.chain([0.0; 3]).take(3));
        let sum = tilts.sum::<f64>() + 0.5 * by_variances.dot(&(self.of_variances * by_variances));
        (sum > 1.0 / MANY).then(|| 1.0 / sum)
    }
}

/// Parts by films and by the erect film that they share, from how numbers follow errors of the rotations, numbers by rotations.
fn from_tilts(films: &[&FilmEvidence], by_errors: &DMatrix<f64>) -> Vec<(DMatrix<f64>, usize)> {
    let joints = by_errors.ncols() / films.len();
    let by_film = |film: usize| by_errors.columns(film * joints, joints);
    let part = |by_rotations: DMatrix<f64>, tilts: &TiltErrors| {
        let covariance = &by_rotations * of_rotations(&tilts.covariance) * by_rotations.transpose();
        Some((covariance, tilts.degrees_of_freedom?))
    };
    let of_film =
        films.iter().enumerate().filter_map(|(i, film)| part(by_film(i).into_owned(), &film.tilts));
    let by_erect = (0..films.len())
        .map(by_film)
        .fold(DMatrix::zeros(by_errors.nrows(), joints), |sum, by_film| sum + by_film);
    of_film.chain(part(by_erect, &films[0].erect_tilts)).collect()
}
