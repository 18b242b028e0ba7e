//! Shape of erect spines: mean and covariance of its parameters.

use std::sync::OnceLock;

use nalgebra::{DMatrix, DVector};

use super::error::CompletionError;
use super::shape::{ANGLES, FIRST_ANGLE, FIRST_LENGTH, LENGTHS, LEVELS, PARAMETERS};
use crate::anatomy::Posture;
use crate::spatial::Angle;

/// The table of the shape of erect spines, once a program has provided it.
static TABLE: OnceLock<&str> = OnceLock::new();

/// Joints, whose rotations are the first angles.
pub(super) const JOINTS: usize = LEVELS - 1;

/// Standard deviation of the rotation of a joint between the erect film and a bend: half the ranges of lateral bending of
/// one side and the other, 5° to 10° per joint [white-panjabi-1990], rounded up; traction straightens by no more.
pub(super) const BEND_SD: Angle = Angle::from_deg(6.0);

/// Shape of spines: a Gaussian of its parameters; place and direction of the film are unknown.
#[derive(Debug, Clone)]
pub struct ShapeModel {
    /// Means of the parameters; zero for place and direction.
    pub(super) mean: DVector<f64>,
    /// Covariance of angles and lengths.
    pub(super) covariance: DMatrix<f64>,
    /// Inverse of their covariance; zero for place and direction, and for the common scale of all lengths.
    pub(super) precision: DMatrix<f64>,
}

/// Provides the table of the shape of erect spines, as `training/shape/train.py` writes it, for all completions of this process. The first
/// table stays.
///
/// The library contains no table, since the X-rays from which one was learned have an unconfirmed licence: the crate
/// `spineline-weights` has it. Programs provide it at their start.
pub fn provide_shape(table: &'static str) {
    TABLE.get_or_init(|| table);
}

/// Whether a table was provided, so that corners can be completed.
pub fn has_shape() -> bool {
    TABLE.get().is_some()
}

/// The model for films of a posture; the joints of other films than erect ones have more freedom.
pub(super) fn model_of(posture: Option<Posture>) -> Result<&'static ShapeModel, CompletionError> {
    static ERECT: OnceLock<Option<ShapeModel>> = OnceLock::new();
    static OTHER: OnceLock<Option<ShapeModel>> = OnceLock::new();
    let table = TABLE.get().ok_or(CompletionError::NoShape)?;
    let (model, bend_sd) = match posture {
        Some(Posture::Erect) => (&ERECT, Angle::ZERO),
        _ => (&OTHER, BEND_SD),
    };
    let model = model.get_or_init(|| ShapeModel::of_table(table, bend_sd));
    model.as_ref().ok_or(CompletionError::NoShape)
}

impl ShapeModel {
    /// The shape of erect spines from a table as `training/shape/train.py` writes it.
    ///
    /// `None` for any other text.
    #[must_use]
    pub fn of_erect(table: &str) -> Option<Self> {
        Self::of_table(table, Angle::ZERO)
    }

    /// From the table of the erect films, with the standard deviation of the rotations of joints from there.
    fn of_table(table: &str, bend_sd: Angle) -> Option<Self> {
        let lines = table.lines().filter(|line| !line.starts_with('#'));
        let rows: Vec<Vec<f64>> = lines.map(numbers).collect::<Option<_>>()?;
        // A row has its mean, and covariances with the rows of its block before it and with itself.
        let length = |row: usize| if row < ANGLES { row + 2 } else { row - ANGLES + 2 };
        let is_whole = |(row, values): (usize, &Vec<f64>)| values.len() == length(row);
        if rows.len() != ANGLES + LENGTHS || !rows.iter().enumerate().all(is_whole) {
            return None;
        }
        let mut mean = DVector::zeros(PARAMETERS);
        for (parameter, row) in rows.iter().enumerate() {
            mean[FIRST_ANGLE + parameter] = row[0];
        }
        let mut angles = symmetric(&rows[..ANGLES]);
        for joint in 0..JOINTS {
            angles[(joint, joint)] += bend_sd.rad().powi(2);
        }
        let lengths = symmetric(&rows[ANGLES..]);
        let mut covariance = DMatrix::zeros(rows.len(), rows.len());
        covariance.view_mut((0, 0), angles.shape()).copy_from(&angles);
        covariance.view_mut((ANGLES, ANGLES), lengths.shape()).copy_from(&lengths);
        let inverse = |covariance: DMatrix<f64>| Some(covariance.cholesky()?.inverse());
        let lengths = without_scale(inverse(lengths)?);
        let mut precision = DMatrix::zeros(PARAMETERS, PARAMETERS);
        for (first, block) in [(FIRST_ANGLE, inverse(angles)?), (FIRST_LENGTH, lengths)] {
            precision.view_mut((first, first), block.shape()).copy_from(&block);
        }
        Some(Self { mean, covariance, precision })
    }
}

/// A precision of logarithms of lengths whose common scale is unknown.
fn without_scale(precision: DMatrix<f64>) -> DMatrix<f64> {
    let of_scale = precision.column_sum();
    let known = of_scale.sum();
    precision - &of_scale * of_scale.transpose() / known
}

/// The numbers of a line, after the two words of its name.
fn numbers(line: &str) -> Option<Vec<f64>> {
    let numbers =
        line.split(' ').skip(2).map(|word| word.parse().ok().filter(|n: &f64| n.is_finite()));
    numbers.collect()
}

/// A symmetric matrix from the ends of rows that hold its lower triangle.
fn symmetric(rows: &[Vec<f64>]) -> DMatrix<f64> {
    let element = |row: usize, column: usize| rows[row.max(column)][1 + row.min(column)];
    DMatrix::from_fn(rows.len(), rows.len(), element)
}

const _: () = assert!(FIRST_LENGTH + LENGTHS == PARAMETERS);

#[cfg(test)]
mod tests {
    use super::*;
    use spineline_weights::ERECT_SPINES;

    #[test]
    fn a_table_that_is_cut_or_damaged_is_refused() {
        assert!(ShapeModel::of_erect(ERECT_SPINES).is_some());
        let cut = &ERECT_SPINES[..ERECT_SPINES.len() / 2];
        assert!(ShapeModel::of_erect(cut).is_none());
        assert!(ShapeModel::of_erect("").is_none());
        assert!(ShapeModel::of_erect(&ERECT_SPINES.replacen("0.0", "NaN", 3)).is_none());
    }

    #[test]
    fn joints_of_other_films_are_freer_and_nothing_else_is() {
        provide_shape(ERECT_SPINES);
        let [erect, other] =
            [Some(Posture::Erect), None].map(|one| model_of(one).expect("a table"));
        assert_eq!(erect.mean, other.mean);
        let joint = |model: &ShapeModel| model.precision[(FIRST_ANGLE, FIRST_ANGLE)];
        assert!(joint(other) < joint(erect));
        let length = |model: &ShapeModel| model.precision[(FIRST_LENGTH, FIRST_LENGTH)];
        assert_eq!(length(other), length(erect));
    }
}
