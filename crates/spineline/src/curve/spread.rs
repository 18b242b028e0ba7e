use nalgebra::{DMatrix, DVector, Matrix2, Matrix4, RowDVector};

use super::fit::weighted_rows;
use super::series::for_each_basis;
use super::{Curve, CurveFit, CurveForm};
use crate::measure::Outline;
use crate::spatial::Frontal;

/// Uncertainty of a fitted curve from the noise of the vertebrae that it was fitted to.
///
/// # Definition
/// Linear theory at the order of the fit: the covariance of the coefficients, widened where the residuals exceed the noise. The
/// choice of the order is not included.
#[derive(Debug, Clone, PartialEq)]
pub struct CurveSpread<'a> {
    curve: &'a Curve,
    /// Of the coefficients of `y`, then of `z`.
    covariance: DMatrix<f64>,
}

impl CurveFit {
    /// Uncertainty of the curve; the outline is the one it was fitted to. `None` where its equations are singular.
    #[must_use]
    pub fn spread(&self, outline: &Outline) -> Option<CurveSpread<'_>> {
        let rows = weighted_rows(outline, self.curve.form, &self.vertebra_t_mm, self.order);
        let coefficients = self.curve.y.coefficients().chain(self.curve.z.coefficients());
        let coefficients = DVector::from_iterator(rows.matrix.ncols(), coefficients);
        let squares = (&rows.target - &rows.matrix * coefficients).norm_squared();
        let freedom = rows.target.len().saturating_sub(rows.matrix.ncols()).max(1);
        let factor = (squares / freedom as f64).max(1.0);
        let inverse = rows.matrix.tr_mul(&rows.matrix).cholesky()?.inverse();
        Some(CurveSpread { curve: &self.curve, covariance: inverse * factor })
    }
}

impl CurveSpread<'_> {
    /// Covariance of two inflections along the curve, in mm² of its length.
    #[must_use]
    pub fn inflections_mm2(&self, t_mm: [f64; 2]) -> Matrix2<f64> {
        // Where the turning vanishes, it is off by its slope times the distance along the curve.
        let places = t_mm.map(|t| {
            const H: f64 = 0.5;
            let by_t = (self.curve.bending(t + H) - self.curve.bending(t - H)) / (2.0 * H);
            self.bending_by_coefficients(t) * (self.curve.tangent(t).norm_mm() / by_t)
        });
        Matrix2::from_fn(|i, j| (places[i].transpose() * &self.covariance * &places[j])[(0, 0)])
    }

    /// Covariance of the place of the curve at two parameters: `(y, z)` of the first and of the second, in mm².
    #[must_use]
    pub fn points_mm2(&self, t_mm: [f64; 2]) -> Matrix4<f64> {
        let terms = self.curve.y.coefficients().count();
        let places: Vec<DVector<f64>> = t_mm
            .into_iter()
            .flat_map(|t| [(t, 0), (t, terms)])
            .map(|(t, first)| {
                let mut by = DVector::zeros(self.covariance.nrows());
                if first == 0 || self.curve.form == CurveForm::Parametric {
                    for_each_basis(self.curve.end_mm, t, terms, |k, [value, ..]| {
                        by[first + k] = value;
                    });
                }
                by
            })
            .collect();
        let rows: Vec<RowDVector<f64>> =
            places.iter().map(|place| place.transpose() * &self.covariance).collect();
        Matrix4::from_fn(|i, j| (&rows[i] * &places[j])[(0, 0)])
    }

    fn bending_by_coefficients(&self, t: f64) -> DVector<f64> {
        let terms = self.curve.y.coefficients().count();
        let (tangent, bend) = self.curve.tangent_and_bend(t);
        let mut by = DVector::zeros(self.covariance.nrows());
        for_each_basis(self.curve.end_mm, t, terms, |k, [_, slope, second]| {
            let side = Frontal::new(1.0, 0.0);
            by[k] = (side * slope).cross(bend) + tangent.cross(side * second);
            if self.curve.form == CurveForm::Parametric {
                let up = Frontal::new(0.0, 1.0);
                by[terms + k] = (up * slope).cross(bend) + tangent.cross(up * second);
            }
        });
        by
    }
}
