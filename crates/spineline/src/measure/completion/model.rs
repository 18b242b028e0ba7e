//! What erect spines look like: mean and covariance of the parameters of their shape.

use std::sync::LazyLock;

use nalgebra::{DMatrix, DVector};

use super::shape::{ANGLES, FIRST_ANGLE, FIRST_LENGTH, LENGTHS, LEVELS, PARAMETERS};
use crate::anatomy::Posture;
use crate::spatial::Angle;

/// The table that `training/shape/train.py` writes.
const TABLE: &str = include_str!("erect_spines.txt");

/// Standard deviation of what a joint turns between the erect film and a bend: half the ranges of lateral bending of
/// one side and the other, 5° to 10° per joint [white-panjabi-1990], rounded up; traction straightens by no more.
const BEND_SD: Angle = Angle::from_deg(6.0);

/// Gaussian of the parameters of a shape; place and direction of the film are unknown.
#[derive(Debug)]
pub(super) struct ShapeModel {
    /// Means of the parameters; zero for place and direction.
    pub mean: DVector<f64>,
    /// Inverse of their covariance; zero for place and direction, and for the common scale of all lengths.
    pub precision: DMatrix<f64>,
}

/// The model for films of a posture; the joints of other films than erect ones have more freedom.
pub(super) fn model_of(posture: Option<Posture>) -> &'static ShapeModel {
    static ERECT: LazyLock<ShapeModel> = LazyLock::new(|| ShapeModel::of_table(TABLE, Angle::ZERO));
    static OTHER: LazyLock<ShapeModel> = LazyLock::new(|| ShapeModel::of_table(TABLE, BEND_SD));
    match posture {
        Some(Posture::Erect) => &ERECT,
        _ => &OTHER,
    }
}

impl ShapeModel {
    /// From the table of the erect films, with the standard deviation of what joints turn from there.
    fn of_table(table: &str, bend_sd: Angle) -> Self {
        let rows: Vec<Vec<f64>> =
            table.lines().filter(|line| !line.starts_with('#')).map(numbers).collect();
        let mut mean = DVector::zeros(PARAMETERS);
        for (parameter, row) in rows.iter().enumerate() {
            mean[FIRST_ANGLE + parameter] = row[0];
        }
        let mut angles = symmetric(&rows[..ANGLES]);
        for joint in 0..LEVELS - 1 {
            angles[(joint, joint)] += bend_sd.rad().powi(2);
        }
        let inverse = |covariance: DMatrix<f64>| {
            covariance.cholesky().expect("the table's covariance is one").inverse()
        };
        let lengths = without_scale(inverse(symmetric(&rows[ANGLES..])));
        let mut precision = DMatrix::zeros(PARAMETERS, PARAMETERS);
        for (first, block) in [(FIRST_ANGLE, inverse(angles)), (FIRST_LENGTH, lengths)] {
            precision.view_mut((first, first), block.shape()).copy_from(&block);
        }
        Self { mean, precision }
    }
}

/// A precision of logarithms of lengths where nothing is known of their common scale.
fn without_scale(precision: DMatrix<f64>) -> DMatrix<f64> {
    let of_scale = precision.column_sum();
    let known = of_scale.sum();
    precision - &of_scale * of_scale.transpose() / known
}

/// The numbers of a line, after the two words of its name.
fn numbers(line: &str) -> Vec<f64> {
    line.split(' ').skip(2).map(|word| word.parse().expect("a number of the table")).collect()
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

    #[test]
    fn the_table_has_a_line_for_every_angle_and_length() {
        let rows: Vec<Vec<f64>> =
            TABLE.lines().filter(|line| !line.starts_with('#')).map(numbers).collect();
        assert_eq!(rows.len(), ANGLES + LENGTHS);
        for (index, row) in rows.iter().enumerate() {
            let block = if index < ANGLES { index } else { index - ANGLES };
            assert_eq!(row.len(), block + 2);
            assert!(row[1 + block] > 0.0, "a variance");
        }
    }
}
