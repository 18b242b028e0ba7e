//! Readings of one film that name its vertebrae differently, or place them far apart.

use super::bodies::{ReadBodies, median};
use super::{Corners, ReadingId};
use crate::anatomy::{FilmView, Level};
use crate::number::{fixed, mean};
use crate::spatial::Frontal;
use crate::warning::{WarningCode, Warnings, levels_apart};

/// Fewer common vertebrae than this would be close to each other by chance.
const MIN_COMMON: usize = 4;

/// Mean distance between the midpoints of two readings, as a part of the distance between neighbouring vertebrae, above which one of them is
/// doubted: about 6 mm in an adult, and far above the errors of careful readers (assumption).
const MAX_APART: f64 = 0.25;

/// Names that are one level higher or lower explain two readings if they lower this distance by this factor.
const MAX_SHIFTED: f64 = 0.5;

/// The midpoints of a reading by level.
type Midpoints = [Option<Frontal>; Level::ALL.len()];

fn midpoints(reading: &ReadBodies<'_>) -> Midpoints {
    Level::ALL.map(|level| reading.body(level).map(Corners::centre))
}

/// Two readings of a film, with lengths as parts of the distance between neighbouring vertebrae.
struct Pair {
    apart: f64,
    /// By how many levels the names of the other reading are higher, and the distance by such names.
    shifted: Option<(isize, f64)>,
}

impl Pair {
    /// `None` where too few vertebrae are common.
    fn of(first: &Midpoints, other: &Midpoints) -> Option<Self> {
        let steps = first.windows(2).filter_map(|pair| Some(pair[0]?.distance_mm(pair[1]?)));
        let step = median(steps.collect());
        let apart = |shift: isize| {
            let common = first.iter().enumerate().filter_map(|(place, midpoint)| {
                let same = *other.get(place.checked_add_signed(shift)?)?;
                Some((*midpoint)?.distance_mm(same?) / step)
            });
            let all: Vec<f64> = common.collect();
            (all.len() >= MIN_COMMON).then_some(all).and_then(mean)
        };
        let same = apart(0)?;
        let shifts = [1, -1, 2, -2].into_iter().filter_map(|shift| Some((shift, apart(shift)?)));
        let nearest = shifts.min_by(|a, b| a.1.total_cmp(&b.1));
        let shifted = nearest.filter(|&(_, by_shift)| by_shift < MAX_SHIFTED * same);
        Some(Self { apart: same, shifted })
    }
}

/// Compares every reading of a film, or the one that is asked for, with the first other one.
pub(super) fn warn_of_readings_apart(
    film: FilmView,
    readings: &[ReadBodies<'_>],
    of: Option<&ReadingId>,
    warnings: &mut Warnings,
) {
    let Some(first) = readings.iter().find(|one| of.is_none_or(|of| one.id != of)) else { return };
    let reference = midpoints(first);
    let others = readings.iter().filter(|one| one.id != first.id);
    for other in others.filter(|one| of.is_none_or(|of| one.id == of)) {
        let Some(pair) = Pair::of(&reference, &midpoints(other)) else { continue };
        if pair.apart.is_nan() || pair.apart <= MAX_APART {
            continue;
        }
        let percent = |share: f64| fixed(100.0 * share, 0);
        let (apart, limit) = (percent(pair.apart), percent(MAX_APART));
        let (other, first) = (other.id, first.id);
        let (code, text) = match pair.shifted {
            Some((shift, by_shift)) => {
                let text = format!(
                    "observer {other} names the vertebrae {} than observer {first}: their midpoints are {apart} % of the distance between neighbouring vertebrae apart (limit {limit} %), by such names {} %: correct the wrong reading",
                    levels_apart(shift),
                    percent(by_shift)
                );
                (WarningCode::LevelsMayBeShifted, text)
            }
            None => {
                let text = format!(
                    "observers {first} and {other} place the midpoints of vertebrae {apart} % of the distance between neighbouring vertebrae apart (mean; limit {limit} %): mark the film again"
                );
                (WarningCode::ReadingsApart, text)
            }
        };
        film.warn_of_film(code, text, warnings);
    }
}
