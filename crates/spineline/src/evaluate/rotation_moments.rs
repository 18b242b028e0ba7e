//! Sums over the joint rotations of bends, from which a prior is learned without keeping the bends.

use nalgebra::{DMatrix, DVector};

use crate::spatial::Angle;

/// Sums over bends of the rotations of their joints, of the products of two joints, and of the squares of these.
///
/// Rotations are taken from a centre near them, so that little is lost where sums are subtracted from each other.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RotationMoments {
    centre_rad: DVector<f64>,
    /// Patients with a bend.
    patients: usize,
    bends: usize,
    /// Σ a, by joint.
    sums: DVector<f64>,
    /// Σ a b, by two joints.
    products: DMatrix<f64>,
    /// Σ a² b: the first joint is the row.
    squares_by_other: DMatrix<f64>,
    /// Σ a² b².
    squares: DMatrix<f64>,
}

impl RotationMoments {
    /// Without bends.
    pub fn about(centre: &[Angle]) -> Self {
        Self::about_rad(DVector::from_iterator(centre.len(), centre.iter().map(|a| a.rad())))
    }

    /// Without bends, from the same centre.
    pub fn without_bends(&self) -> Self {
        Self::about_rad(self.centre_rad.clone())
    }

    fn about_rad(centre_rad: DVector<f64>) -> Self {
        let joints = centre_rad.len();
        let zeros = || DMatrix::zeros(joints, joints);
        Self {
            centre_rad,
            patients: 0,
            bends: 0,
            sums: DVector::zeros(joints),
            products: zeros(),
            squares_by_other: zeros(),
            squares: zeros(),
        }
    }

    /// Adds a patient's bends, each as if it were to the right.
    ///
    /// # Panics
    /// If a bend has not one rotation per joint.
    pub fn add(&mut self, bends: &[Vec<Angle>]) {
        self.patients += usize::from(!bends.is_empty());
        self.bends += bends.len();
        for bend in bends {
            assert_eq!(bend.len(), self.joints(), "one rotation per joint");
            let rotations = bend.iter().map(|angle| angle.rad());
            let off = DVector::from_iterator(bend.len(), rotations) - &self.centre_rad;
            let squared = off.component_mul(&off);
            self.products.ger(1.0, &off, &off, 1.0);
            self.squares_by_other.ger(1.0, &squared, &off, 1.0);
            self.squares.ger(1.0, &squared, &squared, 1.0);
            self.sums += off;
        }
    }

    /// Adds the bends of other patients, taken from the same centre.
    pub fn merge(&mut self, other: &Self) {
        debug_assert_eq!(self.centre_rad, other.centre_rad);
        self.patients += other.patients;
        self.bends += other.bends;
        self.sums += &other.sums;
        self.products += &other.products;
        self.squares_by_other += &other.squares_by_other;
        self.squares += &other.squares;
    }

    pub fn joints(&self) -> usize {
        self.centre_rad.len()
    }

    /// Patients with a bend.
    pub const fn patients(&self) -> usize {
        self.patients
    }

    /// Their bends.
    pub const fn bends(&self) -> usize {
        self.bends
    }

    /// Mean rotation of every joint.
    pub fn mean(&self) -> Vec<Angle> {
        let mean = &self.centre_rad + &self.sums / self.bends as f64;
        mean.iter().map(|&rad| Angle::from_rad(rad)).collect()
    }

    /// Covariance of the rotations, in rad².
    pub fn covariance_rad2(&self) -> DMatrix<f64> {
        let bends = self.bends as f64;
        let about_mean = &self.products - &self.sums * self.sums.transpose() / bends;
        about_mean / (bends - 1.0)
    }

    /// Over bends, the sum of squares of the deviations of the product of two joints' deviations from the mean product, in rad⁴.
    pub fn spread_of_products(&self, i: usize, j: usize) -> f64 {
        let bends = self.bends as f64;
        let [a, b] = [i, j].map(|joint| self.sums[joint] / bends);
        let product = self.products[(i, j)] - bends * a * b;
        // Σ (x - a)² (y - b)², multiplied out.
        let squares = self.squares[(i, j)]
            - 2.0 * (b * self.squares_by_other[(i, j)] + a * self.squares_by_other[(j, i)])
            + b * b * self.products[(i, i)]
            + a * a * self.products[(j, j)]
            + 4.0 * a * b * self.products[(i, j)]
            - 3.0 * bends * (a * b).powi(2);
        squares - product * product / bends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rotations of three joints that differ from bend to bend.
    fn bends(patient: usize) -> Vec<Vec<Angle>> {
        let rotation = |bend: usize, joint: usize| {
            let x = (7 * patient + 3 * bend + joint) as f64;
            Angle::from_deg(4.0 + joint as f64 + 2.0 * (x * 1.7).sin())
        };
        (0..2).map(|bend| (0..3).map(|joint| rotation(bend, joint)).collect()).collect()
    }

    #[test]
    fn sums_equal_the_definitions_over_all_bends() {
        let centre = &bends(0)[0];
        let [mut first, mut second] = [(); 2].map(|()| RotationMoments::about(centre));
        (0..6).for_each(|patient| first.add(&bends(patient)));
        (6..9).for_each(|patient| second.add(&bends(patient)));
        second.add(&[]);
        first.merge(&second);
        assert_eq!((first.patients(), first.bends()), (9, 18));

        // Oracle: the definitions, over all bends.
        let all: Vec<Vec<f64>> =
            (0..9).flat_map(bends).map(|bend| bend.iter().map(|a| a.rad()).collect()).collect();
        let mean_of = |of: &dyn Fn(&Vec<f64>) -> f64| all.iter().map(of).sum::<f64>() / 18.0;
        let means: Vec<f64> = (0..3).map(|joint| mean_of(&|bend| bend[joint])).collect();
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12 * b.abs(), "{a} and {b}");
        for i in 0..3 {
            near(first.mean()[i].rad(), means[i]);
            for j in 0..3 {
                let product = |bend: &Vec<f64>| (bend[i] - means[i]) * (bend[j] - means[j]);
                let mean = mean_of(&product);
                near(first.covariance_rad2()[(i, j)], mean * 18.0 / 17.0);
                let spread = mean_of(&|bend| (product(bend) - mean).powi(2)) * 18.0;
                near(first.spread_of_products(i, j), spread);
            }
        }
    }

    #[test]
    fn joints_that_always_turn_alike_have_no_variance_at_all() {
        let bend = &bends(0)[0];
        let mut moments = RotationMoments::about(bend);
        (0..5).for_each(|_| moments.add(std::slice::from_ref(bend)));
        assert!(moments.covariance_rad2().iter().all(|&covariance| covariance == 0.0));
        assert_eq!(moments.spread_of_products(1, 0), 0.0);
    }
}
