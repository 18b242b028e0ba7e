//! Errors that vertebrae of a film share, and residuals weighted by them.
//!
//! Corners that were completed share the shape that they were completed with, so that errors of their vertebrae are correlated.
//! A fit of residuals `r` with the covariance `S` is generalised least squares: the minimum of `r' S⁻¹ r`. Residuals are
//! first divided by the standard deviation of each; with `L L' = D⁻¹ S D⁻¹`, where `D` holds these deviations, `L⁻¹ D⁻¹ r` are
//! independent and of variance one. Where all errors are independent, `L` is the identity and is left out.
//!
//! # Model and assumptions
//! The base gives the frame of a film, and its own errors move and turn all other vertebrae alike. The shape of a model is compared
//! with the film in that frame, so that the residuals contain these errors. A curve is laid through the vertebrae in that frame and
//! meets the base by construction: its residuals are conditional on the base.
//! Readings share the model of completion and count as fully correlated; films do not.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use super::{
    Film, FilmLandmarks, LengthScale, MeasuredVertebra, Noise, Outline, ProgramCorners,
    SharedErrors, TiltRule,
};
use crate::anatomy::{Level, Morphometry};
use crate::spatial::{Angle, Frontal};

/// Measured numbers of a vertebra.
const NUMBERS: usize = 3;

/// A measured number of a vertebra, by its row in a covariance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Measured {
    /// Location to the patient's left.
    Left,
    /// Location cranial.
    Cranial,
    /// Tilt.
    Tilt,
}

/// How a residual changes with the error of a measured number: place of the vertebra, the number, and the derivative, which is one
/// over the standard deviation that the residual is divided by, with its sign.
pub(crate) type ErrorRate = (usize, Measured, f64);

impl SharedErrors {
    /// Of the means over the readings of a film, by their corners that a program found; `None` without such corners.
    ///
    /// `base_tilt` is the tilt of `G` on the film, and `scale` the scale of its lengths.
    pub(super) fn of_film(
        film: &Film,
        program: &[Option<ProgramCorners>],
        rule: TiltRule,
        marked: &BTreeMap<Level, MeasuredVertebra>,
        base_tilt: Angle,
        scale: &LengthScale,
    ) -> Option<Self> {
        let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return None };
        let own = readings.iter().zip(program);
        let mut own: Vec<_> = own.filter_map(|(one, found)| Some((one, found.as_ref()?))).collect();
        // Sums in a fixed order: the order of the readings must not reach the last bit.
        own.sort_by(|(a, _), (b, _)| a.id.cmp(&b.id));
        let of_model = marked.values().filter(|vertebra| vertebra.level.model_index().is_some());
        let of_model: Vec<&MeasuredVertebra> = of_model.collect();
        let size = NUMBERS * of_model.len();
        let mut covariance = DMatrix::zeros(size, size);
        for (reading, corners) in own {
            let mut spread = DMatrix::zeros(size, corners.deviates());
            for (i, vertebra) in of_model.iter().enumerate() {
                let landmark = reading.vertebrae.get(&vertebra.level);
                let own = landmark
                    .and_then(|landmark| corners.spread(image, vertebra.level, landmark, rule));
                let Some(mut own) = own else { continue };
                for mut column in own.column_iter_mut() {
                    let off = Frontal::new(column[0], column[1]).rotated(-base_tilt)
                        * (1.0 / scale.units_per_mm);
                    (column[0], column[1]) = (off.y_mm, off.z_mm);
                }
                // The mean of variances, as for one vertebra.
                own /= (vertebra.readings as f64).sqrt();
                spread.rows_mut(NUMBERS * i, NUMBERS).copy_from(&own);
            }
            covariance += &spread * spread.transpose();
        }
        let levels = of_model.iter().map(|vertebra| vertebra.level).collect();
        (covariance.trace() > 0.0).then_some(Self { levels, covariance })
    }

    /// The same errors where every length is multiplied by a factor.
    pub(super) fn with_lengths_times(mut self, factor: f64) -> Self {
        let by = |row: usize| if row % NUMBERS == Measured::Tilt as usize { 1.0 } else { factor };
        let size = self.covariance.nrows();
        let factors = DMatrix::from_fn(size, size, |i, j| by(i) * by(j));
        self.covariance.component_mul_assign(&factors);
        self
    }

    /// Adds them to a covariance over these vertebrae.
    fn add_to(&self, covariance: &mut DMatrix<f64>, vertebrae: &[MeasuredVertebra]) {
        let place = |vertebra: &MeasuredVertebra| {
            self.levels.iter().position(|level| *level == vertebra.level)
        };
        let places: Vec<Option<usize>> = vertebrae.iter().map(place).collect();
        for (i, row) in places.iter().enumerate() {
            for (j, column) in places.iter().enumerate() {
                let Some((row, column)) = row.zip(*column) else { continue };
                let own =
                    self.covariance.fixed_view::<NUMBERS, NUMBERS>(NUMBERS * row, NUMBERS * column);
                let mut sum =
                    covariance.fixed_view_mut::<NUMBERS, NUMBERS>(NUMBERS * i, NUMBERS * j);
                sum += own;
            }
        }
    }
}

/// Variances of a coordinate and of the tilt.
fn variances(noise: &Noise) -> [f64; 2] {
    [noise.location_mm.powi(2), noise.tilt.rad().powi(2)]
}

impl Outline {
    /// Whether errors of its vertebrae are correlated.
    pub(crate) fn has_shared_errors(&self) -> bool {
        self.shared_errors.is_some()
    }

    /// Covariance of all measured numbers of the model's vertebrae, three of each; interpolated vertebrae are independent
    /// (assumption). The errors of the frame that the base gives are left out.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        self.with_landmarks(self.of_program())
    }

    /// Shared errors of all vertebrae.
    fn of_program(&self) -> DMatrix<f64> {
        let size = NUMBERS * self.vertebrae.len();
        let mut covariance = DMatrix::zeros(size, size);
        if let Some(shared) = &self.shared_errors {
            shared.add_to(&mut covariance, &self.vertebrae);
        }
        covariance
    }

    /// Shared errors and errors of the frame: an error of the base moves and turns all vertebrae against it, which is the origin.
    fn of_program_in_frame(&self) -> DMatrix<f64> {
        let of_program = self.of_program();
        let mut by_errors = DMatrix::<f64>::identity(of_program.nrows(), of_program.nrows());
        for (place, vertebra) in self.vertebrae.iter().enumerate() {
            let row = NUMBERS * place;
            for k in 0..NUMBERS {
                by_errors[(row + k, k)] -= 1.0;
            }
            let tilt = Measured::Tilt as usize;
            by_errors[(row, tilt)] += vertebra.location.z_mm;
            by_errors[(row + 1, tilt)] -= vertebra.location.y_mm;
        }
        &by_errors * of_program * by_errors.transpose()
    }

    /// Adds the errors of landmarks and of interpolated vertebrae.
    fn with_landmarks(&self, covariance: DMatrix<f64>) -> DMatrix<f64> {
        let [location, tilt] = variances(&self.noise);
        let mut covariance = self.with_independent(covariance, |vertebra| match vertebra.program {
            None => [location, tilt],
            Some(program) => [program.placed_share * location, program.placed_tilt_share * tilt],
        });
        // Noise is never below pixel rounding.
        let least = [Noise::FLOOR_LOCATION_MM, Noise::FLOOR_LOCATION_MM, Noise::FLOOR_TILT.rad()];
        for row in 0..covariance.nrows() {
            covariance[(row, row)] = covariance[(row, row)].max(least[row % NUMBERS].powi(2));
        }
        covariance
    }

    /// Adds variances of a coordinate and of the tilt: their own for interpolated vertebrae, and given ones for the others.
    fn with_independent(
        &self,
        mut covariance: DMatrix<f64>,
        of_marked: impl Fn(&MeasuredVertebra) -> [f64; 2],
    ) -> DMatrix<f64> {
        for (place, vertebra) in self.vertebrae.iter().enumerate() {
            let [location, tilt] = vertebra.interpolated.map_or_else(
                || of_marked(vertebra),
                |found| [found.location_sd_mm.powi(2), found.tilt_sd.rad().powi(2)],
            );
            for (k, variance) in [location, location, tilt].into_iter().enumerate() {
                covariance[(NUMBERS * place + k, NUMBERS * place + k)] += variance;
            }
        }
        covariance
    }

    /// Covariance of the tilts of the model's vertebrae by the noise of readings, in rad².
    pub(crate) fn tilt_covariance(&self) -> DMatrix<f64> {
        self.tilt_covariance_by(|v| self.noise_of(v).tilt.rad().powi(2))
    }

    /// Covariance of the errors of these tilts against the true ones, in rad².
    ///
    /// # Definition
    /// The noise of a tilt falls with the width of the body: it is the film's on the quadratic mean over the vertebrae. The assumed noise of
    /// one reading repeats itself; against the true tilt, its observer's bias adds to it ([`Noise::OBSERVER_BIAS`]).
    pub(crate) fn tilt_error_covariance(&self) -> DMatrix<f64> {
        let by_width = |v: &MeasuredVertebra| {
            let typical = Morphometry::of(v.level);
            (typical.superior_width_mm + typical.inferior_width_mm).powi(-2)
        };
        let mean = self.vertebrae.iter().map(by_width).sum::<f64>() / self.vertebrae.len() as f64;
        let bias = if self.noise.is_measured() { 0.0 } else { Noise::OBSERVER_BIAS.rad() };
        self.tilt_covariance_by(|v| match v.program {
            Some(_) => self.noise_of(v).tilt.rad().powi(2),
            None => (self.noise.tilt.rad().powi(2) + bias * bias) * by_width(v) / mean,
        })
    }

    /// Covariance of tilts with given variances of marked vertebrae; errors that corners share come from these.
    fn tilt_covariance_by(&self, of_marked: impl Fn(&MeasuredVertebra) -> f64) -> DMatrix<f64> {
        let tilt = |place: usize| NUMBERS * place + Measured::Tilt as usize;
        if self.has_shared_errors() {
            let (size, all) = (self.vertebrae.len(), self.covariance());
            return DMatrix::from_fn(size, size, |i, j| all[(tilt(i), tilt(j))]);
        }
        let variance = |v: &MeasuredVertebra| match v.interpolated {
            Some(found) => found.tilt_sd.rad().powi(2),
            None => of_marked(v),
        };
        let variances = self.vertebrae.iter().map(variance);
        DMatrix::from_diagonal(&DVector::from_iterator(self.vertebrae.len(), variances))
    }

    /// Errors of this film in a model that is made from it, beyond landmark noise; `None` where errors are independent.
    pub(crate) fn model_covariance(&self) -> Option<DMatrix<f64>> {
        self.shared_errors.as_ref()?;
        Some(self.with_independent(self.of_program_in_frame(), |_| [0.0; 2]))
    }

    /// Covariance of the differences of this film from the shape of a model, with the errors of both frames: of the film, of the
    /// landmarks of the erect film, and of the erect film's shared errors in the model.
    /// `None` where errors are independent.
    pub(crate) fn difference_covariance(
        &self,
        erect: &Outline,
        of_model: Option<&DMatrix<f64>>,
    ) -> Option<DMatrix<f64>> {
        if !self.has_shared_errors() && of_model.is_none() {
            return None;
        }
        let mut covariance = self.with_landmarks(self.of_program_in_frame());
        let [location, tilt] = variances(&erect.noise);
        for row in 0..covariance.nrows() {
            let is_tilt = row % NUMBERS == Measured::Tilt as usize;
            covariance[(row, row)] += if is_tilt { tilt } else { location };
        }
        Some(match of_model {
            Some(of_model) => covariance + of_model,
            None => covariance,
        })
    }

    /// Variance of a sum of errors of measured numbers.
    pub(crate) fn variance_of(&self, rates: &[ErrorRate]) -> f64 {
        let by_errors = rate_matrix(rates, NUMBERS * self.vertebrae.len());
        let total = by_errors.row_sum();
        (&total * self.covariance() * total.transpose())[(0, 0)]
    }

    /// Makes weighted residuals of all vertebrae independent, the base among them; `None` if they are.
    pub(crate) fn whitening(&self, rates: &[ErrorRate]) -> Option<Whitening> {
        self.has_shared_errors().then(|| Whitening::of(&self.covariance(), rates))?
    }

    /// The same for residuals of a fit that meets the base.
    pub(crate) fn whitening_given_base(&self, rates: &[ErrorRate]) -> Option<Whitening> {
        self.has_shared_errors().then(|| Whitening::of(&given_base(self.covariance()), rates))?
    }
}

/// The covariance of all other numbers given the first vertebra's, with zeros for that one.
fn given_base(covariance: DMatrix<f64>) -> DMatrix<f64> {
    let base = covariance.fixed_view::<NUMBERS, NUMBERS>(0, 0).into_owned();
    let Some(base) = base.cholesky() else { return covariance };
    let with_base = covariance.columns(0, NUMBERS).into_owned();
    let mut given = covariance - &with_base * base.solve(&with_base.transpose());
    given.rows_mut(0, NUMBERS).fill(0.0);
    given.columns_mut(0, NUMBERS).fill(0.0);
    given
}

fn rate_matrix(rates: &[ErrorRate], size: usize) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(rates.len(), size);
    for (row, &(place, measured, rate)) in rates.iter().enumerate() {
        matrix[(row, NUMBERS * place + measured as usize)] = rate;
    }
    matrix
}

/// Makes residuals independent that were divided by their standard deviations.
#[derive(Debug, Clone)]
pub(crate) struct Whitening {
    /// Lower triangular factor of the covariance of the divided residuals.
    factor: DMatrix<f64>,
}

impl Whitening {
    /// From the covariance of all measured numbers; `None` where it is singular to rounding, so that residuals keep their own
    /// deviations alone.
    pub fn of(covariance: &DMatrix<f64>, rates: &[ErrorRate]) -> Option<Self> {
        let by_errors = rate_matrix(rates, covariance.nrows());
        let correlation = &by_errors * covariance * by_errors.transpose();
        Some(Self { factor: correlation.cholesky()?.unpack() })
    }

    /// Residuals, or their derivatives by one unknown.
    pub fn apply(&self, column: &mut [f64]) {
        let mut vector = nalgebra::DVectorViewMut::from_slice(column, self.factor.nrows());
        self.factor.solve_lower_triangular_unchecked_mut(&mut vector);
    }

    /// Rows of a linear fit and their targets.
    pub fn apply_to_rows(&self, matrix: &mut DMatrix<f64>, target: &mut DVector<f64>) {
        self.factor.solve_lower_triangular_unchecked_mut(matrix);
        self.factor.solve_lower_triangular_unchecked_mut(target);
    }

    /// From independent residuals to residuals of blocks of rows, each in units of its error given all others.
    ///
    /// # Definition
    /// With `W = (L L')⁻¹` and `C C' = W_ii` for block `i`: rows `C⁻¹ (L'⁻¹)_i`.
    pub fn by_blocks(&self, size: usize) -> Option<DMatrix<f64>> {
        let rows = self.factor.nrows();
        let mut inverse = DMatrix::identity(rows, rows);
        self.factor.solve_lower_triangular_unchecked_mut(&mut inverse);
        let mut by_blocks = inverse.transpose();
        for first in (0..rows).step_by(size) {
            let mut block = by_blocks.rows_mut(first, size);
            let own = (&block * block.transpose()).cholesky()?;
            own.l_dirty().solve_lower_triangular_unchecked_mut(&mut block);
        }
        Some(by_blocks)
    }
}

#[cfg(test)]
mod tests;
