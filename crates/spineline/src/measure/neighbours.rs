//! Corners of one reading against the corners of the neighbouring vertebrae.
//!
//! A corner is predicted from the same corner of the two nearest marked vertebrae. A deviation that all four corners of a body share
//! is the place of the body, which no warning is about; a further deviation of one corner is its own error.

use super::Corners;
use super::bodies::{ReadBodies, median};
use crate::anatomy::{FilmView, Level};
use crate::number::fixed;
use crate::spatial::Frontal;
use crate::warning::{WarningCode, Warnings};

/// Marked vertebrae of a reading from which a corner can be called an outlier.
const MIN_VERTEBRAE: usize = 5;

/// Distance of a corner from where its neighbours put it, in medians of such distances in the reading.
const OUTLIER_MEDIANS: f64 = 5.0;

/// The same distance as a part of the body's diagonal, below which a corner is not an outlier in any reading. Both are in
/// units of the error of a single corner, of which the prediction from two neighbours amplifies the errors of all three.
///
/// Of 433 unflagged films of the training landmarks of [wu-boostnet-2017] 5 have such a corner. With one corner moved by
/// 40, 50 and 60 % of the diagonal in any direction, 70, 83 and 92 % of them are found.
const MIN_OUTLIER_SHARE: f64 = 0.25;

/// A corner with its distance from the prediction, as parts of the diagonal of such a body.
struct Predicted {
    distance: f64,
    /// Standard deviation of that distance for errors of 1 in every corner.
    error: f64,
}

impl Predicted {
    fn share(&self) -> f64 {
        self.distance / self.error
    }
}

/// Warnings about corners that their neighbours in the same reading contradict.
pub(super) fn warn_of_corners_off_the_trend(
    film: FilmView,
    reading: &ReadBodies<'_>,
    warnings: &mut Warnings,
) {
    let bodies = &reading.bodies;
    if bodies.len() < MIN_VERTEBRAE {
        return;
    }
    let all: Vec<[Predicted; 4]> =
        (0..bodies.len()).map(|index| predicted(bodies, index)).collect();
    let usual = median(all.iter().flatten().map(Predicted::share).collect());
    let limit = (OUTLIER_MEDIANS * usual).max(MIN_OUTLIER_SHARE);
    for (index, corners) in all.iter().enumerate() {
        for (corner, found) in corners.iter().enumerate() {
            if found.share() > limit && is_worst(&all, index, corner) {
                let text = format!(
                    "observer {}: the {} corner is {} % of the body's diagonal from where the neighbouring vertebrae put it (limit {} %): check this corner",
                    reading.id,
                    film.corners()[corner],
                    fixed(100.0 * found.distance, 0),
                    fixed(100.0 * limit * found.error, 0)
                );
                film.warn(WarningCode::CornerFarFromNeighbours, bodies[index].0, text, warnings);
            }
        }
    }
}

/// Whether a corner far from its prediction is itself misplaced: a misplaced corner spoils the predictions of its
/// neighbours too, to the half.
fn is_worst(all: &[[Predicted; 4]], index: usize, corner: usize) -> bool {
    let share = |at: usize| all[at][corner].share();
    let last = all.len() - 1;
    // The first vertebra and the second one are judged by the same three corners, and so are the last two. Where the inner
    // one is misplaced, the prediction of the third is off by half as much; where the outer one is, not at all.
    let (is_end, partner, third) = match index {
        0 | 1 => (index == 0, 1 - index, 2),
        _ if index + 1 >= last => (index == last, 2 * last - 1 - index, last - 2),
        _ => (false, index, index),
    };
    if third != index && is_end != (share(third) < 0.25 * share(index)) {
        return false;
    }
    let near = index.saturating_sub(2)..=(index + 2).min(last);
    near.filter(|&at| at != partner).all(|at| share(at) <= share(index))
}

/// The four corners of one body of at least three, against the line through the two nearest bodies.
fn predicted(bodies: &[(Level, Corners<Frontal>)], index: usize) -> [Predicted; 4] {
    let [near, far] = match index {
        0 => [1, 2],
        last if last + 1 == bodies.len() => [last - 1, last - 2],
        inner => [inner - 1, inner + 1],
    };
    let number = |at: usize| f64::from(bodies[at].0 as u8);
    let part = (number(index) - number(near)) / (number(far) - number(near));
    let points = |at: usize| bodies[at].1.points();
    let off: [Frontal; 4] = std::array::from_fn(|corner| {
        points(index)[corner] - points(near)[corner] * (1.0 - part) - points(far)[corner] * part
    });
    let error = (1.0 + (1.0 - part).powi(2) + part.powi(2)).sqrt();
    // A misplaced corner lengthens its own body's diagonal.
    let of_three = [index, near, far].map(|at| bodies[at].1.longer_diagonal_mm());
    let diagonal_mm = median(of_three.to_vec());
    std::array::from_fn(|corner| {
        let distance = off[corner].distance_mm(common(&off, corner)) / diagonal_mm;
        Predicted { distance, error }
    })
}

/// Deviation of the other three corners: of them, the one nearest to the other two.
fn common(off: &[Frontal; 4], corner: usize) -> Frontal {
    let others = || (0..4).filter(move |&other| other != corner).map(|other| off[other]);
    let apart = |from: Frontal| others().map(|other| from.distance_mm(other)).sum::<f64>();
    others()
        .fold(off[(corner + 1) % 4], |best, one| if apart(one) < apart(best) { one } else { best })
}
