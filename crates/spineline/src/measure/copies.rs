//! Readings of one film with the same landmarks: copies, or one reading from two files. They count once, because their differences
//! are not the errors of readers.

use std::borrow::Cow;
use std::collections::BTreeSet;

use super::{Corners, Film, FilmLandmarks, Placement, Reading, VertebraLandmarks};
use crate::anatomy::FilmView;
use crate::spatial::{Angle, Pixel};
use crate::warning::{WarningCode, Warnings, first_named};

/// Vertebrae from which equal coordinates in two readings are not a coincidence.
pub(super) const MIN_SAME: usize = 2;

/// Coordinates that differ by less are equal: formats of single precision and of two decimals differ by this.
const SAME_PX: f64 = 0.01;
/// The same for locations of another program.
const SAME_MM: f64 = 0.001;
/// The same for tilts of another program.
const SAME_TILT: Angle = Angle::from_deg(0.01);

/// The landmarks of one vertebra in a reading.
pub(super) trait Mark: Copy {
    /// Whether both have the same coordinates; `None` for equal corners that a program proposed.
    fn is_same(&self, other: &Self) -> Option<bool>;

    /// Adds landmarks that only the copy has.
    fn complete(&mut self, _copy: &Self) {}
}

impl Mark for Corners<Pixel> {
    fn is_same(&self, other: &Self) -> Option<bool> {
        let is_near = |a: f64, b: f64| (a - b).abs() <= SAME_PX;
        let mut pairs = self.points().into_iter().zip(other.points());
        Some(pairs.all(|(a, b)| is_near(a.column_px, b.column_px) && is_near(a.row_px, b.row_px)))
    }
}

impl Mark for VertebraLandmarks {
    /// Two readers who accept the proposals of one program have the same corners.
    fn is_same(&self, other: &Self) -> Option<bool> {
        let is_placed = self.is_placed() && other.is_placed();
        self.corners.is_same(&other.corners).filter(|is_same| is_placed || !is_same)
    }

    fn complete(&mut self, copy: &Self) {
        self.axis_clockwise = self.axis_clockwise.or(copy.axis_clockwise);
        for (own, other) in self.pedicles.iter_mut().zip(copy.pedicles) {
            *own = own.or(other);
        }
    }
}

impl Mark for Placement {
    fn is_same(&self, other: &Self) -> Option<bool> {
        let apart = self.location - other.location;
        let tilt = (self.tilt - other.tilt).wrapped().abs();
        Some(apart.y_mm.abs() <= SAME_MM && apart.z_mm.abs() <= SAME_MM && tilt <= SAME_TILT)
    }
}

/// Whether two readings have the same landmarks in all vertebrae that both have.
fn are_same<T: Mark>(one: &Reading<T>, other: &Reading<T>) -> bool {
    let pairs = one
        .vertebrae
        .iter()
        .filter_map(|(level, mark)| other.vertebrae.get(level).and_then(|of| mark.is_same(of)));
    // Two readings of one name are refused elsewhere.
    one.id != other.id && all_same(pairs)
}

/// Whether no pair of marks differs, and enough of them are equal.
pub(super) fn all_same(mut pairs: impl Iterator<Item = bool>) -> bool {
    let mut same = 0;
    pairs.all(|is_same| {
        same += usize::from(is_same);
        is_same
    }) && same >= MIN_SAME
}

/// The places of every reading with copies, and of its copies, in the order of observers and repeats: the first one is the original.
fn copies<T: Mark>(readings: &[Reading<T>]) -> Vec<(usize, Vec<usize>)> {
    if readings.len() < 2 {
        return Vec::new();
    }
    let mut order: Vec<usize> = (0..readings.len()).collect();
    order.sort_by(|&a, &b| readings[a].id.cmp(&readings[b].id));
    let mut found: Vec<(usize, Vec<usize>)> = Vec::new();
    for place in order {
        // Of all others, since copies may have vertebrae that the original lacks.
        let is_copy = |(first, copies): &&mut (usize, Vec<usize>)| {
            let mut all = std::iter::once(first).chain(copies.iter());
            all.all(|&one| are_same(&readings[one], &readings[place]))
        };
        match found.iter_mut().find(is_copy) {
            Some((_, copies)) => copies.push(place),
            None => found.push((place, Vec::new())),
        }
    }
    found.retain(|(_, copies)| !copies.is_empty());
    found
}

/// The readings of a film, where an original and its copies are one reading with the vertebrae of all of them.
pub(super) fn as_one<T: Mark>(readings: &[Reading<T>]) -> Cow<'_, [Reading<T>]> {
    let found = copies(readings);
    if found.is_empty() {
        return Cow::Borrowed(readings);
    }
    let mut all = readings.to_vec();
    for (first, copies) in &found {
        for (&level, mark) in copies.iter().flat_map(|&copy| &readings[copy].vertebrae) {
            let own = all[*first].vertebrae.entry(level);
            own.and_modify(|own| own.complete(mark)).or_insert(*mark);
        }
    }
    let left_out: BTreeSet<usize> = found.into_iter().flat_map(|(_, copies)| copies).collect();
    let kept = all.into_iter().enumerate().filter(|(place, _)| !left_out.contains(place));
    Cow::Owned(kept.map(|(_, reading)| reading).collect())
}

/// Names the readings that count as one.
pub(super) fn warn_of_copies<T: Mark>(
    film: FilmView,
    readings: &[Reading<T>],
    warnings: &mut Warnings,
) {
    for (first, copies) in copies(readings) {
        let count = copies.len() + 1;
        let places = std::iter::once(first).chain(copies);
        let names = first_named(places.map(|place| readings[place].id.to_string()), count);
        let text = format!(
            "the readings of observers {names} have the same landmarks, so they count as one reading and do not show the errors of readers: keep one of them, and read the film again for a second reading"
        );
        film.warn_of_film(WarningCode::ReadingsCopied, text, warnings);
    }
}

impl Film {
    /// This film, where an original and its copies are one reading.
    pub(crate) fn with_copies_as_one(&self) -> Cow<'_, Self> {
        let landmarks = match &self.landmarks {
            FilmLandmarks::Corners { image, iliac_crests, readings } => {
                let Cow::Owned(readings) = as_one(readings) else { return Cow::Borrowed(self) };
                FilmLandmarks::Corners { image: *image, iliac_crests: *iliac_crests, readings }
            }
            FilmLandmarks::Placements { spacing_plane, scale_relative_sd, source, readings } => {
                let Cow::Owned(readings) = as_one(readings) else { return Cow::Borrowed(self) };
                FilmLandmarks::Placements {
                    spacing_plane: *spacing_plane,
                    scale_relative_sd: *scale_relative_sd,
                    source: *source,
                    readings,
                }
            }
        };
        Cow::Owned(Self { landmarks, ..*self })
    }

    /// Names its readings that count as one.
    pub(super) fn warn_of_copies(&self, warnings: &mut Warnings) {
        let film = self.posture.into();
        match &self.landmarks {
            FilmLandmarks::Corners { readings, .. } => warn_of_copies(film, readings, warnings),
            FilmLandmarks::Placements { readings, .. } => warn_of_copies(film, readings, warnings),
        }
    }
}
