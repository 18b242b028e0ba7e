//! Test of a line of action against films, and the 95 % region of the line of best fit.

use nalgebra::{DMatrix, DVector, RowVector3};
use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};
use statrs::function::beta::beta_reg;

use super::super::estimate::{EstimatedLine, line_of};
use super::loads::BestFitLoads;
use super::proposed_line::ProposedLine;
use crate::spatial::Frontal;

/// A test of a proposal.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LineTest {
    /// Sum of squares of the numbers that should vanish, in their standard deviations.
    pub chi_squared: f64,
    /// Numbers that should vanish: 2 for a line, 1 for a direction.
    pub restrictions: u32,
    /// Degrees of freedom of these deviations, if they come from differences of readings; `None` where noise was assumed, or where they
    /// are too many to matter.
    pub noise_degrees_of_freedom: Option<f64>,
    /// Probability of a larger statistic if the proposal is true.
    pub p_value: f64,
}

/// Where a line may cross a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Crossing {
    /// Between these places, in mm to the patient's left.
    Between([f64; 2]),
    /// Anywhere, or nearly so: the films do not determine it.
    Open,
}

/// Tests reject at lower p values, here and everywhere else.
pub const SIGNIFICANCE: f64 = 0.05;
/// 95 % of chi-squared on one degree of freedom.
pub(crate) const CHI_SQUARED_95: f64 = 3.841_458_820_694_124;

impl LineTest {
    /// Whether the films reject it, with an error of 5 % if it is true.
    #[must_use]
    pub fn rejects(&self) -> bool {
        self.p_value < SIGNIFICANCE
    }
}

impl BestFitLoads {
    /// The line of one film's load; `None` for a pure couple.
    #[must_use]
    pub fn line(&self, film: usize, near: Frontal) -> Option<EstimatedLine> {
        line_of(self.components.get(film)?, near)
    }

    /// Tests a proposal on one film.
    ///
    /// # Definition
    /// A force along a line has no moment about points of it, and no part across its direction: these numbers are linear in the load.
    /// Their covariance comes from the load and, by the load's force, from the points or the direction.
    #[must_use]
    pub fn test(&self, film: usize, proposal: &ProposedLine) -> Option<LineTest> {
        let [fy, fz, mx] = *self.components.get(film)?;
        let (rows, known) = proposal.restrictions([fy, fz, mx]);
        let load = RowVector3::new(fy, fz, mx);
        let off = DVector::from_iterator(rows.len(), rows.iter().map(|row| row.dot(&load)));
        let covariance = of_film(&self.covariance.whole, film, &rows) + known;
        let inverse = covariance.cholesky()?.inverse();
        let chi_squared = off.dot(&(&inverse * &off));
        let freedom = self.covariance.freedom(&inverse, |whole| of_film(whole, film, &rows));
        let restrictions = rows.len() as u32;
        let p_value = tail(chi_squared, restrictions.into(), freedom)?;
        Some(LineTest { chi_squared, restrictions, noise_degrees_of_freedom: freedom, p_value })
    }

    /// Where the film's line may cross a height, with 95 % confidence for this height alone.
    ///
    /// # Definition
    /// All places about which a moment of zero is not rejected (Fieller's set).
    #[must_use]
    pub fn crossing(&self, film: usize, z_mm: f64) -> Option<Crossing> {
        let load = self.components.get(film)?;
        // The moment about (y, z) is a - b y.
        let rows = [RowVector3::new(z_mm, 0.0, 1.0), RowVector3::new(0.0, 1.0, 0.0)];
        let [a, b] = rows.map(|row| row.dot(&RowVector3::from(*load)));
        let c = of_film(&self.covariance.whole, film, &rows);
        let limit = self.crossing_limit(film, rows[0] - rows[1] * (a / b));
        // (a - b y)² <= limit (c00 - 2 c01 y + c11 y²)
        let square = b * b - limit * c[(1, 1)];
        let half = a * b - limit * c[(0, 1)];
        let rest = a * a - limit * c[(0, 0)];
        let root = half * half - square * rest;
        if square <= 0.0 || root < 0.0 {
            return Some(Crossing::Open);
        }
        Some(Crossing::Between([(half - root.sqrt()) / square, (half + root.sqrt()) / square]))
    }

    /// Largest square of the moment about a place of the line, in its variances, that is not rejected.
    fn crossing_limit(&self, film: usize, moment: RowVector3<f64>) -> f64 {
        let variance = of_film(&self.covariance.whole, film, &[moment])[(0, 0)];
        let inverse = DMatrix::from_element(1, 1, variance.recip());
        let freedom = self.covariance.freedom(&inverse, |whole| of_film(whole, film, &[moment]));
        square_limit(freedom)
    }
}

/// Largest square of a number in its variances, known on these degrees of freedom, that is not rejected.
pub(super) fn square_limit(freedom: Option<f64>) -> f64 {
    // Every replicate asks for it, and there is one degree of freedom or more: the library's quantile is exact to twelve digits there,
    // and takes a small part of the time of a bisection that is sound below one as well.
    let distribution = freedom.and_then(|freedom| StudentsT::new(0.0, 1.0, freedom).ok());
    distribution.map_or(CHI_SQUARED_95, |t| t.inverse_cdf(1.0 - 0.5 * SIGNIFICANCE).powi(2))
}

/// Probability of a larger sum of squares, in deviations that are known or were estimated.
fn tail(chi_squared: f64, restrictions: f64, freedom: Option<f64>) -> Option<f64> {
    Some(match freedom {
        None => ChiSquared::new(restrictions).ok()?.sf(chi_squared),
        // Of F, without a difference from one.
        Some(freedom) => {
            beta_reg(0.5 * freedom, 0.5 * restrictions, freedom / (freedom + chi_squared))
        }
    })
}

/// Covariance of some linear numbers of a film's load, from the covariance of all components.
fn of_film(covariance: &DMatrix<f64>, film: usize, numbers: &[RowVector3<f64>]) -> DMatrix<f64> {
    let own = covariance.fixed_view::<3, 3>(3 * film, 3 * film);
    DMatrix::from_fn(numbers.len(), numbers.len(), |i, j| {
        (numbers[i] * own * numbers[j].transpose())[0]
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::evidence::{FilmEvidence, TiltErrors};
    use super::super::covariance::EstimatedCovariance;
    use super::*;
    use crate::anatomy::{Level, Levels};
    use crate::spatial::Angle;
    use nalgebra::Matrix4;

    /// 100 N straight up, 10 mm to the left of the origin, with given variances of `fy`, `fz` and `mx`.
    fn upwards(variances: [f64; 3]) -> BestFitLoads {
        BestFitLoads {
            components: vec![[0.0, 100.0, 1000.0]],
            joint_log_sd: 0.1,
            unknowns: DVector::default(),
            covariance: EstimatedCovariance::known(DMatrix::from_diagonal(
                &DVector::from_column_slice(&variances),
            )),
        }
    }

    #[test]
    fn an_unsure_moment_shifts_the_line_by_its_deviation_over_the_force() {
        // 100 N·mm over 100 N are 1 mm, at any height.
        let loads = upwards([0.0, 0.0, 1e4]);
        for z_mm in [0.0, 300.0] {
            let Some(Crossing::Between([low, high])) = loads.crossing(0, z_mm) else {
                panic!("an interval")
            };
            let reach = CHI_SQUARED_95.sqrt();
            assert!((low - (10.0 - reach)).abs() < 1e-9 && (high - (10.0 + reach)).abs() < 1e-9);
        }
    }

    #[test]
    fn a_force_that_may_be_none_crosses_anywhere() {
        // Its deviation is more than 1/1.96 of it.
        assert_eq!(upwards([0.0, 3000.0, 1.0]).crossing(0, 100.0), Some(Crossing::Open));
    }

    #[test]
    fn a_direction_is_tested_by_the_force_across_it() {
        // Across a line of the tilt a, 100 sin a; its deviation is cos a for 1 N of fy.
        let tilt = Angle::from_deg(1.0);
        let along = |sd| ProposedLine::Along { direction: Frontal::leaning(tilt), sd };
        let loads = upwards([1.0, 0.0, 1.0]);
        let test = loads.test(0, &along(Angle::ZERO)).expect("a load");
        let (sin, cos) = tilt.rad().sin_cos();
        assert!((test.chi_squared - (100.0 * sin / cos).powi(2)).abs() < 1e-9);
        assert_eq!(test.restrictions, 1);
        // On one degree of freedom p is 2 (1 - Φ(√χ²)), 0.0809 for 1.7455.
        assert!((test.p_value - 0.0809).abs() < 1e-4 && !test.rejects(), "{}", test.p_value);
        // A direction known to 1° only adds 100 N times that across.
        let unsure = loads.test(0, &along(Angle::from_deg(1.0))).expect("a load");
        let variance = cos * cos + (100.0 * cos * tilt.rad()).powi(2);
        assert!((unsure.chi_squared - (100.0 * sin).powi(2) / variance).abs() < 1e-9);
    }

    #[test]
    fn two_points_beside_the_line_are_rejected_as_far_as_they_are_known() {
        // Moments of 100 N about points 2 mm beside it: 200 N·mm each, with 100 N times 0.5 mm of deviation.
        let points = [Frontal::new(12.0, 50.0), Frontal::new(12.0, 200.0)];
        let through = |mm2: f64| {
            let covariance = Matrix4::identity() * mm2;
            let test =
                upwards([0.0, 0.0, 0.0]).test(0, &ProposedLine::Through { points, covariance });
            test.expect("a load")
        };
        let test = through(0.25);
        assert!((test.chi_squared - 2.0 * 16.0).abs() < 1e-9 && test.rejects());
        // On two degrees p is exp(-χ²/2).
        assert!((test.p_value - (-16.0_f64).exp()).abs() < 1e-12);
        assert!(!through(4.0).rejects());
    }

    #[test]
    fn noise_that_two_films_show_has_few_degrees_of_freedom() {
        // Oracle: Welch's degrees of freedom of a difference, n1 + n2 for equal variances with n1 = n2, and the closed forms of
        // Student's t and of F with 2 degrees.
        let tilt_sd = Angle::from_rad(0.01);
        let film = FilmEvidence {
            joints: Vec::new(),
            levels: Levels::between(Level::L4, Level::L3).expect("neighbours"),
            midpoints_mm: Vec::new(),
            tilts: TiltErrors::alike(2, tilt_sd, Some(1)),
            erect_tilts: TiltErrors::alike(2, tilt_sd, Some(1)),
            repeated_variances: Vec::new(),
        };
        // A rotation is a difference of tilts, on the film and on the erect one; its error is one of the moment.
        let by_error = 5000.0;
        let loads_by_errors = DMatrix::from_column_slice(3, 1, &[0.0, 0.0, by_error]);
        let sd = by_error * tilt_sd.rad() * 2.0;
        let known = upwards([0.0, 0.0, sd * sd]);
        let covariance = known.covariance.clone().with_tilts(&[&film], &loads_by_errors);
        let loads = BestFitLoads { covariance, ..known };
        let Some(Crossing::Between([low, high])) = loads.crossing(0, 100.0) else {
            panic!("an interval")
        };
        let t = 0.95 / (2.0_f64 * 0.975 * 0.025).sqrt();
        assert!((0.5 * (high - low) - t * sd / 100.0).abs() < 1e-9, "{low} {high}");
        let points = [Frontal::new(12.0, 50.0), Frontal::new(12.0, 200.0)];
        let exact = ProposedLine::Through { points, covariance: Matrix4::identity() };
        let test = loads.test(0, &exact).expect("a load");
        let freedom = test.noise_degrees_of_freedom.expect("estimated noise");
        let closed_form = (1.0 + test.chi_squared / freedom).powf(-0.5 * freedom);
        assert!((test.p_value - closed_form).abs() < 1e-12 && freedom > 2.0);
        // If points are known much worse than the noise, its degrees of freedom do not matter.
        let unsure = ProposedLine::Through { points, covariance: Matrix4::identity() * 1e6 };
        assert_eq!(loads.test(0, &unsure).expect("a load").noise_degrees_of_freedom, None);
    }
}
