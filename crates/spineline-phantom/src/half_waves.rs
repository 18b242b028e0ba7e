//! Erect curves that are not polynomials.

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Uniform};

use crate::build::Construction;

/// Number of parts of the length for which curvature and tilt are stored.
const PARTS: usize = 2000;

/// A smooth curve whose curvature has three half-waves of alternating sign and fades towards its ends.
#[derive(Debug, Clone)]
pub(crate) struct HalfWaveCurve {
    /// Tilt at equal parts of the length; positive to the right, zero at the base.
    tilts_rad: Vec<f64>,
    /// Places where the curvature vanishes, as parts of the length.
    inflections: [f64; 2],
}

impl HalfWaveCurve {
    /// A curve whose half-waves turn by given angles: the first is convex to the left, as most adolescent curves are.
    /// `None` if it was not found.
    pub fn draw(
        turns_rad: [f64; 3],
        construction: Construction,
        rng: &mut ChaCha12Rng,
    ) -> Option<Self> {
        let mut between =
            |low: f64, high: f64| Uniform::new(low, high).expect("a range upwards").sample(rng);
        let ends = [0.0, between(0.27, 0.39), between(0.66, 0.78), 1.0];
        // Places of the maxima within the half-waves.
        let maxima = match construction {
            Construction::Hinges => [0; 3].map(|_| between(0.35, 0.65)),
            _ => [0.5; 3],
        };
        let target = [turns_rad[0], -turns_rad[1], turns_rad[2]];
        let mut sizes = target;
        // Smoothing reduces every half-wave, and a small one beside a large one more.
        for _ in 0..50 {
            let curve = Self::of(&half_waves(ends, maxima, sizes))?;
            let [p, q] = curve.inflections;
            let tilts = [0.0, p, q, 1.0].map(|part| curve.tilt_rad(part));
            let miss: [f64; 3] = std::array::from_fn(|i| target[i] - (tilts[i + 1] - tilts[i]));
            if miss.iter().all(|miss| miss.abs() < 1e-9) {
                return Some(curve);
            }
            sizes = std::array::from_fn(|i| sizes[i] + miss[i]);
        }
        None
    }

    /// The two inflections as parts of the length.
    pub fn inflections(&self) -> [f64; 2] {
        self.inflections
    }

    /// Tilt at a part of the length.
    pub fn tilt_rad(&self, part: f64) -> f64 {
        let place = part * PARTS as f64;
        let k = (place.floor() as usize).min(PARTS - 1);
        self.tilts_rad[k] + (self.tilts_rad[k + 1] - self.tilts_rad[k]) * (place - k as f64)
    }

    fn of(curvature: &[f64]) -> Option<Self> {
        let step = 1.0 / PARTS as f64;
        let mut tilts_rad = vec![0.0];
        for (i, pair) in curvature.windows(2).enumerate() {
            tilts_rad.push(tilts_rad[i] + 0.5 * (pair[0] + pair[1]) * step);
        }
        let zero = |(i, pair): (usize, &[f64])| {
            (pair[0] * pair[1] < 0.0).then(|| (i as f64 + pair[0] / (pair[0] - pair[1])) * step)
        };
        let zeros: Vec<f64> = curvature.windows(2).enumerate().filter_map(zero).collect();
        Some(Self { tilts_rad, inflections: zeros.try_into().ok()? })
    }
}

/// Curvature over the length: half sines with a maximum anywhere, smoothed over the distance of two vertebrae, so that
/// only the change of sign marks the inflections.
fn half_waves(ends: [f64; 4], maxima: [f64; 3], sizes_rad: [f64; 3]) -> Vec<f64> {
    let sharp = |part: f64| -> f64 {
        let wave = (0..3).find(|&i| part <= ends[i + 1]).unwrap_or(2);
        let width = ends[wave + 1] - ends[wave];
        let within = ((part - ends[wave]) / width).clamp(0.0, 1.0);
        // The mean of a half sine is 2/π.
        let power = -1.0 / maxima[wave].log2();
        let height = 0.5 * std::f64::consts::PI * sizes_rad[wave] / width;
        height * (std::f64::consts::PI * within.powf(power)).sin()
    };
    /// Standard deviation of the smoothing, in parts of the length: one distance of two vertebrae.
    const SMOOTH: f64 = 0.06;
    let step = 1.0 / PARTS as f64;
    let reach = (3.0 * SMOOTH / step) as i64;
    let weights: Vec<f64> =
        (-reach..=reach).map(|i| (-0.5 * (i as f64 * step / SMOOTH).powi(2)).exp()).collect();
    let sum: f64 = weights.iter().sum();
    let values: Vec<f64> = (0..=PARTS as i64).map(|i| sharp(i as f64 * step)).collect();
    // The curvature is zero beyond the ends.
    let at = |i: i64| usize::try_from(i).ok().and_then(|i| values.get(i)).copied().unwrap_or(0.0);
    let smoothed = |i: i64| {
        (-reach..=reach).zip(&weights).map(|(off, weight)| weight * at(i + off)).sum::<f64>() / sum
    };
    (0..=PARTS as i64).map(smoothed).collect()
}
