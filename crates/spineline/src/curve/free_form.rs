//! Where the erect curve inflects if its form is not known: a Gaussian process instead of the polynomial.
//!
//! # Model
//! `y''` over the height is a Gaussian process, `y` and its slope at L4 are free, and locations and tilts are measured with the
//! film's noise. The process is a sum of sines on a longer stretch than the spine, whose variances are the kernel's spectral
//! density [solin-sarkka-2020]. The kernel (squared exponential, or Matérn's of order 3/2 for rougher curves), its length scale
//! and its deviation against the noise lie on a grid, weighted by their marginal likelihood. Noise may be larger than what
//! the readings say, which is fitted too.
//!
//! Where `y''` of the mean is nearer to zero than 1.96 deviations, it may inflect. A polynomial of the order that predicts best
//! has another inflection than the true curve, by 3 to 5 mm on synthetic spines (its bias); noise alone does not show that.

use nalgebra::{DMatrix, DVector, Matrix2, SMatrix, SVector};

use super::{CurveFit, CurveForm, Inflection};
use crate::anatomy::Level;
use crate::measure::{Measured, Outline};
use crate::number::NORMAL_975;

/// Sines of the process.
const TERMS: usize = 24;
/// Coefficients: of the sines, then of place and slope at L4.
const COEFFICIENTS: usize = TERMS + 2;
/// Of the coefficients.
type Coefficients = SVector<f64, COEFFICIENTS>;
/// By two coefficients.
type ByCoefficients = SMatrix<f64, COEFFICIENTS, COEFFICIENTS>;
/// Domain of the process in heights of the spine, so that the ends of the spine are free.
const STRETCH: f64 = 1.5;
/// Length scales as parts of the height.
const LENGTHS: [f64; 5] = [0.10, 0.14, 0.20, 0.28, 0.40];
/// Deviations of `y''` times the height: 50° on a third of the height are about four.
const DEVIATIONS: [f64; 8] = [0.25, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0];
/// Pairs of length scale and deviation with less weight than this are left out.
const MIN_WEIGHT: f64 = 1e-3;

/// Where an inflection may lie, by the noise of the landmarks and the unknown form of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InflectionInterval {
    /// Parameters on the erect curve between which it lies with 95 % confidence, caudal first.
    pub t_mm: [f64; 2],
    /// The same as lengths of the curve from L4.
    pub along_mm: [f64; 2],
    /// The vertebra below its caudal end, and the one above its cranial end.
    pub between: (Level, Level),
}

/// Where two inflections may lie, caudal first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InflectionIntervals {
    /// `None` for one that may lie at an end of the spine, or that may not exist.
    pub each: [Option<InflectionInterval>; 2],
    /// Mean square differences from the polynomial's inflections along the height, in mm²: covariance, and products of the
    /// differences of the means.
    pub about_polynomial_mm2: Matrix2<f64>,
}

impl CurveFit {
    /// Where the inflections of the curve may lie if its form is not a polynomial; the outline is the one it was fitted to.
    ///
    /// `None` for a curve in parametric form, and where the vertebrae do not determine it.
    #[must_use]
    pub fn inflection_intervals(
        &self,
        outline: &Outline,
        pair: [Inflection; 2],
    ) -> Option<InflectionIntervals> {
        if self.curve.form != CurveForm::Graph {
            return None;
        }
        let process = Process::fit(outline, &self.vertebra_t_mm)?;
        let end_mm = self.curve.end_mm;
        let zeros = pair.map(|inflection| process.zero_near(inflection.t_mm, end_mm));
        let each = zeros.map(|zero| Some(self.interval(process.around(zero?, end_mm)?)));
        // Where the process has no zero near, the polynomial's place is kept.
        let places: [f64; 2] = std::array::from_fn(|i| zeros[i].unwrap_or(pair[i].t_mm));
        let slopes = places.map(|t| process.slope(t));
        let about_polynomial_mm2 = Matrix2::from_fn(|i, j| {
            let covariance = process.covariance(places[i], places[j]) / (slopes[i] * slopes[j]);
            covariance + (places[i] - pair[i].t_mm) * (places[j] - pair[j].t_mm)
        });
        let finite = about_polynomial_mm2.iter().all(|mm2| mm2.is_finite());
        finite.then_some(InflectionIntervals { each, about_polynomial_mm2 })
    }

    fn interval(&self, t_mm: [f64; 2]) -> InflectionInterval {
        let levels = self.levels.as_slice();
        let below = self.vertebra_t_mm.iter().rposition(|&t| t <= t_mm[0]).unwrap_or(0);
        let above = self.vertebra_t_mm.iter().position(|&t| t >= t_mm[1]);
        InflectionInterval {
            t_mm,
            along_mm: t_mm.map(|t| self.curve.length_mm(t)),
            between: (levels[below], levels[above.unwrap_or(levels.len() - 1)]),
        }
    }
}

/// The process after the vertebrae are known, over all pairs of length scale and deviation.
struct Process {
    height_mm: f64,
    mean: Coefficients,
    /// Their covariance: within the pairs, and between the pairs' means.
    covariance: ByCoefficients,
}

impl Process {
    fn fit(outline: &Outline, t_mm: &[f64]) -> Option<Self> {
        let height_mm = t_mm[t_mm.len() - 1];
        let (matrix, target) = rows(outline, t_mm);
        let normal = ByCoefficients::from_column_slice(matrix.tr_mul(&matrix).as_slice());
        let right = Coefficients::from_column_slice(matrix.tr_mul(&target).as_slice());
        let squares = target.norm_squared();
        let shapes = [Kernel::SquaredExponential, Kernel::Matern]
            .into_iter()
            .flat_map(|kernel| LENGTHS.map(|length| (kernel, length)));
        let grid = shapes.flat_map(|shape| DEVIATIONS.map(|deviation| (shape, deviation)));
        let mut parts = Vec::new();
        for ((kernel, length), deviation) in grid {
            let variances = prior_variances(kernel, length, deviation);
            let mut precision = normal;
            for (i, variance) in variances.iter().enumerate() {
                precision[(i, i)] += 1.0 / variance;
            }
            let cholesky = precision.cholesky()?;
            let mean = cholesky.solve(&right);
            let rows = target.len() as f64;
            let left = squares - right.dot(&mean);
            // The noise that makes the measured values most probable, but not below the noise of the readings.
            let noise = (left / rows).max(1.0);
            let log_determinant = 2.0
                * cholesky.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>()
                + variances.iter().map(|v| v.ln()).sum::<f64>();
            let log_likelihood = -0.5 * (rows * noise.ln() + left / noise + log_determinant);
            parts.push((log_likelihood, mean, cholesky, noise));
        }
        let best = parts.iter().map(|part| part.0).fold(f64::NEG_INFINITY, f64::max);
        let weight = |log_likelihood: f64| (log_likelihood - best).exp();
        let sum: f64 = parts.iter().map(|part| weight(part.0)).sum();
        parts.retain(|part| weight(part.0) > MIN_WEIGHT * sum);
        let mean =
            parts.iter().fold(Coefficients::zeros(), |mean, (log_likelihood, of_pair, ..)| {
                mean + of_pair * (weight(*log_likelihood) / sum)
            });
        let mut covariance = ByCoefficients::zeros();
        for (log_likelihood, of_pair, cholesky, noise) in parts {
            let off = of_pair - mean;
            let of_pair = cholesky.inverse() * noise + off * off.transpose();
            covariance += of_pair * (weight(log_likelihood) / sum);
        }
        Some(Self { height_mm, mean, covariance })
    }

    /// Mean of `y''` times the height.
    fn mean(&self, t_mm: f64) -> f64 {
        bending(t_mm / self.height_mm).dot(&self.mean)
    }

    /// Covariance of `y''` times the height at two heights.
    fn covariance(&self, a_mm: f64, b_mm: f64) -> f64 {
        let [a, b] = [a_mm, b_mm].map(|t| bending(t / self.height_mm));
        a.dot(&(self.covariance * b))
    }

    fn slope(&self, t_mm: f64) -> f64 {
        const H_MM: f64 = 0.5;
        (self.mean(t_mm + H_MM) - self.mean(t_mm - H_MM)) / (2.0 * H_MM)
    }

    /// The zero of the mean that is next to a height, where it is not further away than a quarter of the spine.
    fn zero_near(&self, t_mm: f64, end_mm: f64) -> Option<f64> {
        const STEP_MM: f64 = 1.0;
        let sign = self.mean(t_mm).signum();
        let steps = (0.25 * end_mm / STEP_MM) as u32;
        let crossing = |way: f64| {
            (1..=steps)
                .map(|k| t_mm + way * STEP_MM * f64::from(k))
                .find(|&t| (0.0..=end_mm).contains(&t) && self.mean(t) * sign <= 0.0)
        };
        let (up, down) = (crossing(1.0), crossing(-1.0));
        let far = |t: Option<f64>| t.map_or(f64::INFINITY, |t| (t - t_mm).abs());
        let (beyond, way) = if far(up) <= far(down) { (up?, 1.0) } else { (down?, -1.0) };
        let (mut inside, mut outside) = (beyond - way * STEP_MM, beyond);
        for _ in 0..30 {
            let middle = 0.5 * (inside + outside);
            if self.mean(middle) * sign > 0.0 {
                inside = middle;
            } else {
                outside = middle;
            }
        }
        Some(0.5 * (inside + outside))
    }

    /// Heights around a zero at which the curvature may vanish.
    fn around(&self, zero_mm: f64, end_mm: f64) -> Option<[f64; 2]> {
        const STEP_MM: f64 = 0.25;
        let may_vanish =
            |t: f64| self.mean(t).abs() <= NORMAL_975 * self.covariance(t, t).max(0.0).sqrt();
        let end = |way: f64| {
            (1..)
                .map(|k| zero_mm + way * STEP_MM * f64::from(k))
                .find(|&t| !(0.0..=end_mm).contains(&t) || !may_vanish(t))
        };
        let ends = [end(-1.0)?, end(1.0)?];
        (ends[0] >= 0.0 && ends[1] <= end_mm).then_some(ends)
    }
}

/// Variances of the coefficients of the sines, and wide ones of place and slope at L4.
fn prior_variances(kernel: Kernel, length: f64, deviation: f64) -> Vec<f64> {
    let sines = (1..=TERMS).map(|j| {
        let density = kernel.spectral_density(length, sine(j, 0.0).0);
        // Variances have this minimum.
        (deviation * deviation * density).max(1e-12)
    });
    sines.chain([1.0, 1.0]).collect()
}

/// How curvature at two heights is correlated.
#[derive(Clone, Copy)]
enum Kernel {
    SquaredExponential,
    /// Of order 3/2.
    Matern,
}

impl Kernel {
    /// Of a deviation of one on the unit height.
    fn spectral_density(self, length: f64, omega: f64) -> f64 {
        match self {
            Self::SquaredExponential => {
                std::f64::consts::TAU.sqrt() * length * (-0.5 * (omega * length).powi(2)).exp()
            }
            Self::Matern => {
                let rate = f64::sqrt(3.0) / length;
                4.0 * rate.powi(3) / (rate * rate + omega * omega).powi(2)
            }
        }
    }
}

/// `y''` times the height at a part of the height, by the coefficients.
fn bending(part: f64) -> Coefficients {
    let sines = (1..=TERMS).map(|j| amplitude() * sine(j, part).1.sin());
    Coefficients::from_iterator(sines.chain([0.0, 0.0]))
}

/// Frequency of a sine and its phase at a part of the height; the spine lies in the middle of the stretch.
fn sine(j: usize, part: f64) -> (f64, f64) {
    let omega = std::f64::consts::PI * j as f64 / STRETCH;
    (omega, omega * (part + 0.5 * (STRETCH - 1.0)))
}

fn amplitude() -> f64 {
    (2.0 / STRETCH).sqrt()
}

/// Weighted rows of all vertebrae, L4 among them: place and slope as parts of the height.
fn rows(outline: &Outline, t_mm: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let height_mm = t_mm[t_mm.len() - 1];
    let measured: Vec<_> = outline.measured().collect();
    let mut matrix = DMatrix::zeros(2 * measured.len(), COEFFICIENTS);
    let mut target = DVector::zeros(2 * measured.len());
    for (row, (i, vertebra)) in measured.into_iter().enumerate() {
        let part = t_mm[i] / height_mm;
        let slope = -vertebra.tilt.rad().tan();
        let noise = outline.noise_of(vertebra);
        let slope_sd = noise.tilt.rad() * (1.0 + slope * slope);
        let place_sd = noise.location_mm / height_mm;
        target[2 * row] = vertebra.location.y_mm / height_mm / place_sd;
        target[2 * row + 1] = slope / slope_sd;
        for j in 1..=TERMS {
            let (omega, phase) = sine(j, part);
            let (_, base) = sine(j, 0.0);
            // Integrals of the sine from L4 up.
            let slope = (base.cos() - phase.cos()) / omega;
            let place = part * base.cos() / omega - (phase.sin() - base.sin()) / (omega * omega);
            matrix[(2 * row, j - 1)] = amplitude() * place / place_sd;
            matrix[(2 * row + 1, j - 1)] = amplitude() * slope / slope_sd;
        }
        matrix[(2 * row, TERMS)] = 1.0 / place_sd;
        matrix[(2 * row, TERMS + 1)] = part / place_sd;
        matrix[(2 * row + 1, TERMS + 1)] = 1.0 / slope_sd;
    }
    let rates = outline.measured().flat_map(|(place, vertebra)| {
        let noise = outline.noise_of(vertebra);
        let location = (place, Measured::Left, 1.0 / noise.location_mm);
        [location, (place, Measured::Tilt, -1.0 / noise.tilt.rad())]
    });
    if let Some(whitening) = outline.whitening(&rates.collect::<Vec<_>>()) {
        whitening.apply_to_rows(&mut matrix, &mut target);
    }
    (matrix, target)
}
