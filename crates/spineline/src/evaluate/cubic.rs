//! A prediction without a spine: the curve between both ends of the model.

use super::baseline::{Baseline, BaselinePrediction, Links};
use super::bend_rotations::joint_rotations_of;
use super::film_shape::FilmShape;
use crate::least_squares::FitStatus;
use crate::measure::Outline;
use crate::spatial::{Angle, Frontal};

/// Chords by which the length of the curve is measured; 1000 keep it to a millionth.
const CHORDS: usize = 1000;

/// Predicts a film from the location and the tilt of its ends, L4 and T2.
///
/// # Definition
/// The cubic `P(u)`, `0 ≤ u ≤ 1`, with `P(0)` at the base and `P(1)` at T2; its derivatives at both ends point along the tilts there, and have
/// the length of the line from the base to T2. A vertebra lies at the part of the length of the curve at which it lies on the erect film.
pub(crate) fn predict_cubic(erect: &Outline, film: &Outline) -> BaselinePrediction {
    let last = film.vertebrae.len() - 1;
    let ends = [0, last].map(|i| (film.vertebrae[i].location, film.vertebrae[i].tilt));
    let cubic = Cubic::between(ends);
    let places = cubic.at_parts(&parts(erect));
    let tilts: Vec<Angle> = places.iter().map(|&u| cubic.tilt(u)).collect();
    let locations = places.iter().map(|&u| cubic.location(u)).collect();
    BaselinePrediction {
        shape: FilmShape::new(locations, film),
        baseline: Baseline::Cubic,
        status: FitStatus::Converged,
        amount: None,
        rotations: joint_rotations_of(erect, |i| tilts[i]),
    }
}

/// The part of the length from the base to T2 at which every vertebra of the erect film lies, from 0 to 1.
fn parts(erect: &Outline) -> Vec<f64> {
    let reached = sums(Links::of(erect).links.iter().map(|link| link.norm_mm()));
    let all = reached[reached.len() - 1];
    reached.into_iter().map(|length| length / all).collect()
}

/// The sums of the first lengths, from none to all.
fn sums(lengths: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut sums = vec![0.0];
    for (place, length) in lengths.enumerate() {
        sums.push(sums[place] + length);
    }
    sums
}

/// A cubic by its ends and its derivatives there.
struct Cubic {
    ends: [Frontal; 2],
    derivatives: [Frontal; 2],
}

impl Cubic {
    fn between([(base, base_tilt), (top, top_tilt)]: [(Frontal, Angle); 2]) -> Self {
        let length_mm = base.distance_mm(top);
        let derivatives = [base_tilt, top_tilt].map(|tilt| Frontal::leaning(tilt) * length_mm);
        Self { ends: [base, top], derivatives }
    }

    fn location(&self, u: f64) -> Frontal {
        let (u2, u3) = (u * u, u * u * u);
        self.ends[0] * (2.0 * u3 - 3.0 * u2 + 1.0)
            + self.ends[1] * (3.0 * u2 - 2.0 * u3)
            + self.derivatives[0] * (u3 - 2.0 * u2 + u)
            + self.derivatives[1] * (u3 - u2)
    }

    fn tilt(&self, u: f64) -> Angle {
        let along = self.ends[1] - self.ends[0];
        let derivative = along * (6.0 * u * (1.0 - u))
            + self.derivatives[0] * (1.0 - 4.0 * u + 3.0 * u * u)
            + self.derivatives[1] * (3.0 * u * u - 2.0 * u);
        derivative.lateral_tilt()
    }

    /// The parameters at increasing parts of the length of the curve.
    fn at_parts(&self, parts: &[f64]) -> Vec<f64> {
        let at = |chord: usize| self.location(chord as f64 / CHORDS as f64);
        let reached = sums((0..CHORDS).map(|chord| at(chord).distance_mm(at(chord + 1))));
        let all = reached[CHORDS];
        let of_part = |part: &f64| {
            let length = part * all;
            let chord = reached.partition_point(|&from| from <= length).clamp(1, CHORDS) - 1;
            let rest = (length - reached[chord]) / (reached[chord + 1] - reached[chord]);
            (chord as f64 + rest) / CHORDS as f64
        };
        parts.iter().map(of_part).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle's arc of 60° from the cranial direction to the left.
    fn arc(u: f64) -> (Frontal, Angle) {
        let (sin, cos) = (u * std::f64::consts::FRAC_PI_3).sin_cos();
        (Frontal::new(400.0 * (1.0 - cos), 400.0 * sin), Frontal::new(sin, cos).lateral_tilt())
    }

    #[test]
    fn an_arc_of_a_circle_is_followed_and_its_mirror_image_too() {
        let parts: Vec<f64> = (0..=13).map(|i| f64::from(i) / 13.0).collect();
        for side in [1.0, -1.0] {
            let at = |u: f64| {
                let (place, tilt) = arc(u);
                (Frontal::new(side * place.y_mm, place.z_mm), tilt * side)
            };
            let cubic = Cubic::between([at(0.0), at(1.0)]);
            for (&part, u) in parts.iter().zip(cubic.at_parts(&parts)) {
                let (place, tilt) = at(part);
                // 419 mm long; its derivatives have the length of the chord, 400 mm.
                assert!(cubic.location(u).distance_mm(place) < 4.0, "{part}");
                assert!((cubic.tilt(u) - tilt).deg().abs() < 2.5, "{part}");
            }
        }
    }

    #[test]
    fn its_ends_keep_their_locations_and_tilts() {
        let ends = [
            (Frontal::new(3.0, -1.0), Angle::from_deg(-12.0)),
            (Frontal::new(-40.0, 390.0), Angle::from_deg(25.0)),
        ];
        let cubic = Cubic::between(ends);
        for (u, (place, tilt)) in [0.0, 1.0].into_iter().zip(ends) {
            assert!(cubic.location(u).distance_mm(place) < 1e-9);
            assert!((cubic.tilt(u) - tilt).rad().abs() < 1e-12);
        }
        let straight =
            Cubic::between([0.0, 300.0].map(|z| (Frontal::new(0.0, z), Angle::default())));
        assert!((straight.at_parts(&[0.25])[0] - 0.25).abs() < 1e-9);
    }
}
