//! Joint rotations of films, and of bends, from which a prior is learned.

use nalgebra::{DMatrix, RowDVector};

use crate::anatomy::Side;
use crate::measure::Outline;
use crate::spatial::Angle;

/// Rotation of every joint from the erect film, caudal first; positive to the patient's right.
#[must_use]
pub fn joint_rotations(erect: &Outline, film: &Outline) -> Vec<Angle> {
    joint_rotations_of(erect, |i| film.vertebrae[i].tilt)
}

/// The same to a film by the tilts of its vertebrae.
pub(super) fn joint_rotations_of(erect: &Outline, tilt: impl Fn(usize) -> Angle) -> Vec<Angle> {
    let turn = |i: usize| tilt(i) - erect.vertebrae[i].tilt;
    (1..erect.vertebrae.len()).map(|i| (turn(i) - turn(i - 1)).wrapped()).collect()
}

/// Angle of every joint of a film, caudal first; positive to the patient's right.
pub(crate) fn joint_angles(film: &Outline) -> Vec<Angle> {
    film.vertebrae.windows(2).map(|pair| (pair[1].tilt - pair[0].tilt).wrapped()).collect()
}

/// A bend as if it were to the right: a bend to the left is mirrored. Joints are caudal first.
#[derive(Debug, Clone, PartialEq)]
pub struct BendRotations {
    /// Rotation of every joint from the erect film.
    pub rotations: Vec<Angle>,
    /// Angle of every joint on the erect film.
    pub erect: Vec<Angle>,
}

impl BendRotations {
    /// Of a bend to a side, from its rotations and the joint angles of the erect film.
    #[must_use]
    pub fn mirrored(side: Side, rotations: &[Angle], erect: &[Angle]) -> Self {
        let sign = match side {
            Side::Right => 1.0,
            Side::Left => -1.0,
        };
        let mirrored = |angles: &[Angle]| angles.iter().map(|&angle| angle * sign).collect();
        Self { rotations: mirrored(rotations), erect: mirrored(erect) }
    }

    /// The part of some joints.
    #[must_use]
    pub fn of_joints(&self, joints: std::ops::Range<usize>) -> Self {
        Self {
            rotations: self.rotations[joints.clone()].to_vec(),
            erect: self.erect[joints].to_vec(),
        }
    }
}

/// Mean and scatter of the rotations of bends, in rad: a row per bend, a column per joint.
pub(super) struct BendStatistics {
    /// Change of a rotation per change of the joint's angle on the erect film: one number for all joints, by least squares.
    pub erect_coefficient: f64,
    /// Mean rotation of every joint whose angle is zero on the erect film.
    pub mean: RowDVector<f64>,
    /// Deviations of the bends from what follows from mean and erect angles.
    pub deviations: DMatrix<f64>,
}

impl BendStatistics {
    /// Of at least one bend.
    ///
    /// # Panics
    /// If a bend has not one rotation per joint.
    pub fn of(joints: usize, bends: &[&BendRotations]) -> Self {
        let matrix = |of: fn(&BendRotations) -> &Vec<Angle>| {
            assert!(bends.iter().all(|bend| of(bend).len() == joints), "one angle per joint");
            DMatrix::from_fn(bends.len(), joints, |bend, joint| of(bends[bend])[joint].rad())
        };
        let [rotations, erect] = [matrix(|bend| &bend.rotations), matrix(|bend| &bend.erect)];
        let (off_rotations, off_erect) = (about_mean(&rotations), about_mean(&erect));
        let squares = off_erect.norm_squared();
        let erect_coefficient =
            if squares > 0.0 { off_erect.dot(&off_rotations) / squares } else { 0.0 };
        Self {
            erect_coefficient,
            mean: rotations.row_mean() - erect.row_mean() * erect_coefficient,
            deviations: off_rotations - off_erect * erect_coefficient,
        }
    }

    /// Covariance of the rotations of joints, in rad².
    pub fn covariance(&self) -> DMatrix<f64> {
        self.deviations.tr_mul(&self.deviations) / (self.deviations.nrows() as f64 - 1.0)
    }

    /// The sum over patients of the square of a patient's sum, in rad⁴: of the deviations of the product of two joints' deviations from the
    /// mean product. `bends` are the numbers of bends of the patients, in the order of the rows.
    pub fn spread_of_products(&self, i: usize, j: usize, bends: &[usize]) -> f64 {
        let products = self.deviations.column(i).component_mul(&self.deviations.column(j));
        let (mean, mut first) = (products.mean(), 0);
        let of_patient = |&bends: &usize| {
            let own = products.rows(first, bends).sum() - bends as f64 * mean;
            first += bends;
            own.powi(2)
        };
        bends.iter().map(of_patient).sum()
    }
}

fn about_mean(values: &DMatrix<f64>) -> DMatrix<f64> {
    let mean = values.row_mean();
    DMatrix::from_fn(values.nrows(), values.ncols(), |row, column| {
        values[(row, column)] - mean[column]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_coefficient_of_the_erect_angles_is_found_and_leaves_no_scatter() {
        let degrees = |of: &dyn Fn(usize) -> f64| -> Vec<Angle> {
            (0..4).map(|joint| Angle::from_deg(of(joint))).collect()
        };
        let bends: Vec<BendRotations> = (0..6)
            .map(|bend| {
                let erect = move |joint: usize| ((3 * bend + 5 * joint) as f64 * 0.9).sin() * 6.0;
                BendRotations {
                    rotations: degrees(&|joint| 4.0 - joint as f64 - 0.38 * erect(joint)),
                    erect: degrees(&erect),
                }
            })
            .collect();
        let found = BendStatistics::of(4, &bends.iter().collect::<Vec<_>>());
        assert!((found.erect_coefficient + 0.38).abs() < 1e-12);
        assert!(found.deviations.amax() < 1e-14);
        for (joint, mean) in found.mean.iter().enumerate() {
            let mean_deg = Angle::from_rad(*mean).deg();
            assert!((mean_deg - (4.0 - joint as f64)).abs() < 1e-12, "{joint}");
        }
    }

    #[test]
    fn bends_that_are_alike_have_no_coefficient_and_no_scatter() {
        let angles = vec![Angle::from_deg(2.0); 3];
        let bend = BendRotations { rotations: angles.clone(), erect: angles };
        let found = BendStatistics::of(3, &[&bend; 5]);
        assert_eq!(found.erect_coefficient, 0.0);
        assert_eq!(
            (found.covariance().amax(), found.spread_of_products(1, 0, &[1; 5])),
            (0.0, 0.0)
        );
    }
}
