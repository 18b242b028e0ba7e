//! Coordinates that a spreadsheet has rounded for display.

use super::{Film, Reading, VertebraLandmarks};
use crate::spatial::Pixel;
use crate::warning::{WarningCode, Warnings};

/// Number of coordinates from which whole tens are not a coincidence: one film in 10⁸ has them by chance.
const MIN_COUNT: usize = 8;
/// From here on a spreadsheet with three digits, as in 1.89E+03, shows whole tens.
const THREE_DIGITS_PX: f64 = 1000.0;

/// Warns of readings whose columns or rows are whole tens: all of them, or all from 1000 on.
pub(super) fn warn_of_rounding(film: &Film, warnings: &mut Warnings) {
    for reading in film.landmarks.corner_readings() {
        let columns = whole_tens(reading, |place| place.column_px);
        let rows = whole_tens(reading, |place| place.row_px);
        for (direction, found) in [("columns", columns), ("rows", rows)] {
            let Some(count) = found else { continue };
            let text = format!(
                "observer {}: {count} of its {direction} are whole tens, as in 1.89E+03 of a spreadsheet: if the file was rounded, export it again with all digits",
                reading.id
            );
            warnings.film(WarningCode::CoordinatesRounded, film.posture, text);
        }
    }
}

/// The number of coordinates that are whole tens, if this is not a coincidence.
fn whole_tens(reading: &Reading<VertebraLandmarks>, of: fn(&Pixel) -> f64) -> Option<usize> {
    let bodies = reading.vertebrae.values().flat_map(|landmark| landmark.corners.points());
    let all: Vec<f64> = bodies.map(|place| of(&place)).collect();
    let large: Vec<f64> = all.iter().copied().filter(|value| *value >= THREE_DIGITS_PX).collect();
    let is_rounded = |values: &[f64]| {
        values.len() >= MIN_COUNT && values.iter().all(|value| value % 10.0 == 0.0)
    };
    [all, large].into_iter().find(|values| is_rounded(values)).map(|values| values.len())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::anatomy::{ImageSide, Level, Posture};
    use crate::measure::{Corners, FilmLandmarks, ImageGeometry, ReadingId, judge_landmarks};

    /// A straight spine of a film 2500 pixels high, whose coordinates were changed.
    fn film(change: fn(f64) -> f64) -> Film {
        let body = |(i, level): (usize, Level)| {
            let (x, y) = (903.0, 2203.25 - 121.5 * i as f64);
            let at = |x: f64, y: f64| Pixel::new(change(x), change(y));
            let corners = Corners {
                superior_left: at(x + 90.5, y),
                superior_right: at(x - 91.25, y + 1.5),
                inferior_left: at(x + 92.0, y + 81.5),
                inferior_right: at(x - 93.0, y + 82.0),
            };
            (level, VertebraLandmarks::clicked(corners))
        };
        let vertebrae: BTreeMap<_, _> = Level::MODEL.into_iter().enumerate().map(body).collect();
        let readings = vec![Reading { id: ReadingId::new("A", 1), vertebrae }];
        let patient_left = ImageSide::Right;
        let image = ImageGeometry { columns: 2000, rows: 2500, spacing: None, patient_left };
        let landmarks = FilmLandmarks::Corners { image, iliac_crests: None, readings };
        Film::new(Posture::Erect, landmarks)
    }

    #[test]
    fn whole_tens_of_a_spreadsheet_are_doubted() {
        let tens = |value: f64| (value / 10.0).round() * 10.0;
        let three_digits = |value: f64| {
            if value < 1000.0 { value } else { (value / 10.0).round() * 10.0 }
        };
        let said = |change| {
            let warnings = judge_landmarks(&film(change));
            let all =
                warnings.all().iter().filter(|one| one.code == WarningCode::CoordinatesRounded);
            all.map(|one| one.message.clone()).collect::<Vec<_>>()
        };
        assert!(said(|value| value).is_empty());
        assert!(said(f64::round).is_empty(), "whole pixels are not tens");
        assert_eq!(said(tens).len(), 2, "columns and rows");
        // 1.89E+03 for rows, while columns stay below 1000.
        let rows = said(three_digits);
        assert!(rows.len() == 1 && rows[0].contains("of its rows"), "{rows:?}");
    }
}
