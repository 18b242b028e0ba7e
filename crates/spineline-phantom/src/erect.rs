use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, Normal, Uniform};
use spineline::anatomy::Level;
use spineline::multibody::StiffnessLibrary;
use spineline::spatial::{Angle, Mat3, Vec3};

use crate::build::{Build, Construction, SEGMENTS, Springs, region};
use crate::half_waves::HalfWaveCurve;
use crate::proportions;
use crate::{PhantomError, TableRow};

/// The erect spine as a fine planar chain.
#[derive(Debug, Clone)]
pub(crate) struct ErectSpine {
    /// Length of the curve from L4 to T2.
    pub length_mm: f64,
    /// Rotation of every segment against the one below.
    pub turns_rad: Vec<f64>,
    /// Arc length of the vertebrae.
    pub vertebra_s_mm: Vec<f64>,
    /// Arc length of the two inflections.
    pub inflection_s_mm: [f64; 2],
    /// What bends.
    pub springs: Springs,
}

/// `y''` of the erect curve is `-A (z + a)(z - z1)(z - z2)(b - z)` on `z` in 0…1: curves convex to the left, right and left, as most adolescent curves are, and a polynomial of degree 6.
#[derive(Debug, Clone, Copy)]
struct Shape {
    amplitude: f64,
    inflections: [f64; 2],
}

/// Places of the outer roots, relative to the height of T2: -8 and 415 of 389 mm, so that the ends are nearly straight.
const BELOW: f64 = 8.0 / 389.0;
const ABOVE: f64 = 415.0 / 389.0;

impl Shape {
    /// `dy/dz`: the integral of the quartic.
    fn slope(&self, z: f64) -> f64 {
        let [p, q] = self.inflections;
        // (z + a)(b - z) = ab + (b - a) z - z²;  (z - p)(z - q) = pq - (p + q) z + z²
        let first = [BELOW * ABOVE, ABOVE - BELOW, -1.0];
        let second = [p * q, -(p + q), 1.0];
        let mut sum = 0.0;
        for (i, a) in first.iter().enumerate() {
            for (j, b) in second.iter().enumerate() {
                let power = i + j + 1;
                sum += a * b * z.powi(power as i32) / power as f64;
            }
        }
        -self.amplitude * sum
    }

    /// Tilt: positive to the right.
    fn tilt(&self, z: f64) -> f64 {
        -self.slope(z).atan()
    }

    /// Angles of the three curves between inflections.
    fn curve_turns_rad(&self) -> Vec3 {
        let [p, q] = self.inflections;
        Vec3::new(self.tilt(p), self.tilt(q) - self.tilt(p), self.tilt(1.0) - self.tilt(q))
    }

    /// Heights that divide the curve into parts of equal length.
    fn cut(&self, pieces: usize) -> Vec<f64> {
        const FINE: usize = 20_000;
        let step = 1.0 / FINE as f64;
        let speed = |z: f64| self.slope(z).hypot(1.0);
        let mut lengths = vec![0.0];
        for i in 0..FINE {
            let z = i as f64 * step;
            // Simpson on each fine step.
            let piece = (speed(z) + 4.0 * speed(z + 0.5 * step) + speed(z + step)) * step / 6.0;
            lengths.push(lengths[i] + piece);
        }
        let mut place = 0;
        (0..=pieces)
            .map(|k| {
                let s = lengths[FINE] * k as f64 / pieces as f64;
                while place + 1 < FINE && lengths[place + 1] < s {
                    place += 1;
                }
                (place as f64 + (s - lengths[place]) / (lengths[place + 1] - lengths[place])) * step
            })
            .collect()
    }

    /// Tilt of every segment, equal to the curve's tilt at its middle, and the inflections as parts of the length.
    fn tilts(&self) -> (Vec<f64>, [f64; 2]) {
        // Every second cut ends a segment.
        let cuts = self.cut(2 * SEGMENTS);
        let inflections = self.inflections.map(|z| {
            let k = cuts.partition_point(|&height| height < z).clamp(1, 2 * SEGMENTS);
            let part = (z - cuts[k - 1]) / (cuts[k] - cuts[k - 1]);
            ((k - 1) as f64 + part) / (2 * SEGMENTS) as f64
        });
        ((0..SEGMENTS).map(|k| self.tilt(cuts[2 * k + 1])).collect(), inflections)
    }

    /// The shape whose curves have given angles: Newton with finite differences from a usual shape.
    fn with_turns(target_rad: [f64; 3]) -> Option<Self> {
        let mut shape = Self { amplitude: 20.0 * target_rad[1], inflections: [0.33, 0.73] };
        // The curves alternate: the first bends to the right in cranial direction.
        let goal = Vec3::new(target_rad[0], -target_rad[1], target_rad[2]);
        for _ in 0..200 {
            let now = shape.curve_turns_rad();
            let miss = goal - now;
            if miss.amax() < 1e-13 {
                break;
            }
            let steps = [1e-6 * shape.amplitude, 1e-7, 1e-7];
            let columns =
                [0, 1, 2].map(|i| (shape.moved(i, steps[i]).curve_turns_rad() - now) / steps[i]);
            let step = Mat3::from_columns(&columns).lu().solve(&miss)?;
            // Limits the steps, so that the inflections stay apart and inside far from the solution.
            let most = [0.5 * shape.amplitude, 0.05, 0.05];
            for i in 0..3 {
                shape = shape.moved(i, step[i].clamp(-most[i], most[i]));
            }
            shape.inflections[0] = shape.inflections[0].clamp(0.12, 0.60);
            shape.inflections[1] = shape.inflections[1].clamp(shape.inflections[0] + 0.1, 0.95);
        }
        ((goal - shape.curve_turns_rad()).amax() < 1e-9).then_some(shape)
    }

    fn moved(mut self, parameter: usize, by: f64) -> Self {
        match parameter {
            0 => self.amplitude += by,
            i => self.inflections[i - 1] += by,
        }
        self
    }
}

impl ErectSpine {
    /// Draws the anatomy of one subject.
    pub fn draw(
        row: &TableRow,
        build: &Build,
        rng: &mut ChaCha12Rng,
    ) -> Result<Self, PhantomError> {
        let curve_turns_rad = curve_turns_rad(row, rng);
        let no_curve = PhantomError::NoCurve { number: row.number };
        let (length_mm, tilts, inflection_s_mm) = match build.construction {
            Construction::Rod => {
                let shape = Shape::with_turns(curve_turns_rad).ok_or(no_curve)?;
                let length_mm = draw_length_mm(rng);
                let (tilts, parts) = shape.tilts();
                (length_mm, tilts, parts.map(|part| length_mm * part))
            }
            _ => {
                let curve = HalfWaveCurve::draw(curve_turns_rad, build.construction, rng)
                    .ok_or(no_curve)?;
                let length_mm = draw_length_mm(rng);
                let tilts =
                    (0..SEGMENTS).map(|k| curve.tilt_rad((k as f64 + 0.5) / SEGMENTS as f64));
                (length_mm, tilts.collect(), curve.inflections().map(|part| length_mm * part))
            }
        };
        let turns_rad =
            (0..SEGMENTS).map(|k| tilts[k] - if k == 0 { 0.0 } else { tilts[k - 1] }).collect();
        let vertebra_s_mm = vertebra_s_mm(length_mm);
        let springs = Springs::draw(build, &vertebra_s_mm, inflection_s_mm, rng);
        Ok(Self { length_mm, turns_rad, vertebra_s_mm, inflection_s_mm, springs })
    }

    /// Length of a segment.
    pub fn segment_mm(&self) -> f64 {
        self.length_mm / SEGMENTS as f64
    }

    /// `ln` of every joint's stiffness over the nominal one: the compliances of its segments add up.
    pub fn joint_logs(&self) -> Vec<f64> {
        let mut compliances = vec![0.0; self.vertebra_s_mm.len() - 1];
        for (k, nmm_per_rad) in self.springs.nmm_per_rad.iter().enumerate() {
            let s_mm = k as f64 * self.segment_mm();
            let above = self.vertebra_s_mm[1..].partition_point(|&v| v <= s_mm);
            compliances[above] += nmm_per_rad.recip();
        }
        logs_over_nominal(compliances.into_iter().map(f64::recip))
    }

    /// Region of an arc length: caudal, middle or cranial of the inflections.
    pub fn region(&self, s_mm: f64) -> usize {
        region(self.inflection_s_mm, s_mm)
    }
}

/// `ln` of the joints' stiffness over the nominal one.
pub(crate) fn logs_over_nominal(nmm_per_rad: impl Iterator<Item = f64>) -> Vec<f64> {
    let library = StiffnessLibrary::default();
    let joints = nmm_per_rad.zip(library.rows());
    joints.map(|(own, row)| (own / row.nmm_per_rad[0]).ln()).collect()
}

/// Angles of the three curves: the main one has the angle of Table 1; the minor ones vary by 5 %. The middle one turns to
/// the left.
pub(crate) fn curve_turns_rad(row: &TableRow, rng: &mut ChaCha12Rng) -> [f64; 3] {
    let vary = Uniform::new(0.95, 1.05).expect("0.95 is below 1.05");
    let cobb = row.cobb_deg();
    let main = cobb.iter().copied().fold(0.0, f64::max);
    cobb.map(|deg| {
        #[expect(clippy::float_cmp, reason = "`main` is one of these numbers")]
        let factor = if deg == main { 1.0 } else { vary.sample(rng) };
        Angle::from_deg(deg * factor).rad()
    })
}

/// The paper's chains: 0.39 ± 0.05 mm per segment, so 389 ± 50 mm.
pub(crate) fn draw_length_mm(rng: &mut ChaCha12Rng) -> f64 {
    Normal::<f64>::new(389.0, 50.0).expect("a positive deviation").sample(rng).clamp(300.0, 480.0)
}

pub(crate) fn vertebra_s_mm(length_mm: f64) -> Vec<f64> {
    let mut s = vec![0.0];
    for pair in Level::MODEL.windows(2) {
        s.push(s[s.len() - 1] + proportions::spacing_mm(pair[0], pair[1]));
    }
    let scale = length_mm / s[s.len() - 1];
    s.into_iter().map(|value| value * scale).collect()
}
