//! Landmark files of other programs: read back as written, refused with the place of a fault, and the public AASCE set.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

use spineline_landmarks::{LandmarkReadings, MarkedFilm};

mod aasce;
mod exchange;
mod faults;
mod midlines;
mod origins;
mod wild;

/// Number of vertebrae over all readings.
fn count_vertebrae(film: &MarkedFilm) -> usize {
    match &film.landmarks {
        LandmarkReadings::Corners(readings) => readings.iter().map(|one| one.vertebrae.len()).sum(),
        LandmarkReadings::Placements(readings) | LandmarkReadings::SurfaceMidlines(readings) => {
            readings.iter().map(|one| one.vertebrae.len()).sum()
        }
    }
}
