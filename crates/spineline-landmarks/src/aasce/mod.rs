//! The landmarks of the AASCE challenge (SpineWeb, dataset 16): 68 corners, T1 to L5, on each of 609 frontal films.
//!
//! They come as MATLAB files with a variable `p2` of 68 × 2 pixels, or as a folder of tables: `filenames.csv` with a name
//! per row, `landmarks.csv` with 68 columns and then 68 rows per row, divided by the picture's width and height, and,
//! if it exists, `angles.csv`. Each vertebra has its corners in the order upper left, upper right, lower left, lower
//! right of the *picture*, so the patient's left has to be known. The set does not state whether the first pixel is 0
//! or 1; angles do not depend on it, and coordinates are used unchanged.
//!
//! The set has known errors ([`AasceVerdict`]): inspect such a film before computing anything from it.
//!
//! # References
//! [wu-boostnet-2017].

mod labels;
mod mat;
mod verdict;

pub use labels::{AasceRow, AasceRows, image_sizes, picture_names};
pub use mat::parse_mat;
pub use verdict::{AasceFault, AasceVerdict, judge_aasce};

use std::collections::BTreeMap;

use spineline::anatomy::{ImageSide, Level};
use spineline::measure::{Corners, Reading, VertebraLandmarks};
use spineline::spatial::Pixel;

use super::error::GIVE_SIDE;
use super::film::pixel;
use super::{LandmarkError, LandmarkHint, LandmarkReadings, MarkedFilm};

/// Corners of a vertebra in their order.
const PLACES: [&str; 4] = ["upper left", "upper right", "lower left", "lower right"];
/// Corners of a film: four of 17 vertebrae.
const CORNERS: usize = 68;

/// The film of 68 corners in their order.
fn film_of(
    points: &[[f64; 2]; CORNERS],
    hint: &LandmarkHint,
    patient_left: ImageSide,
    at: &str,
) -> Result<MarkedFilm, LandmarkError> {
    // Not placed: MATLAB writes NaN. An infinite number is an error of the program that wrote it.
    let is_absent = |point: &[f64; 2]| point.iter().any(|x| x.is_nan());
    let mut vertebrae = BTreeMap::new();
    // The set counts from T1 downwards.
    for (four, level) in points.chunks_exact(4).zip(Level::ALL.into_iter().rev()) {
        let absent = four.iter().filter(|point| is_absent(point)).count();
        if absent == four.len() {
            continue;
        }
        if absent > 0 {
            let missing = PLACES.into_iter().zip(four).filter(|(_, point)| is_absent(point));
            let missing = missing.map(|(place, _)| format!("{place} of the picture")).collect();
            let what = format!("{at}, {level}");
            return Err(LandmarkError::Incomplete { what, missing }.of(None, Some(level)));
        }
        let mut places = [Pixel::new(0.0, 0.0); 4];
        for (place, &[column, row]) in places.iter_mut().zip(four) {
            let found = pixel(column, row, &format!("{at}, {level}"));
            *place = found.map_err(|error| error.of(None, Some(level)))?;
        }
        let corners = Corners::from_image_sides(places, patient_left);
        vertebrae.insert(level, VertebraLandmarks::clicked(corners));
    }
    if vertebrae.is_empty() {
        return Err(LandmarkError::missing(at, "a vertebra"));
    }
    Ok(MarkedFilm {
        posture: hint.posture,
        picture: None,
        size: None,
        iliac_crests: None,
        landmarks: LandmarkReadings::Corners(vec![Reading { id: hint.reading.clone(), vertebrae }]),
    })
}

fn patient_left(hint: &LandmarkHint) -> Result<ImageSide, LandmarkError> {
    hint.patient_left().ok_or(LandmarkError::Needs {
        format: "a film of AASCE",
        what: "the side of the picture on which the patient's left is",
        help: GIVE_SIDE,
    })
}
