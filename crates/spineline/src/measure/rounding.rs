//! Coordinates that a spreadsheet has rounded for display.

use super::{Corners, Film, FilmLandmarks, Reading, ReadingId};
use crate::anatomy::FilmView;
use crate::spatial::Pixel;
use crate::warning::{WarningCode, Warnings};

/// Number of coordinates from which whole tens are not a coincidence: one film in 10⁸ has them by chance.
const MIN_COUNT: usize = 8;
/// From here on a spreadsheet with three digits, as in 1.89E+03, shows whole tens.
const THREE_DIGITS: f64 = 1000.0;

/// Warns of readings whose columns or rows, or coordinates of locations, are whole tens: all of them, or all from 1000 on.
pub(super) fn warn_of_rounding(film: &Film, warnings: &mut Warnings) {
    let view = film.posture.into();
    match &film.landmarks {
        FilmLandmarks::Corners { readings, .. } => {
            for Reading { id, vertebrae } in readings {
                let corners = vertebrae.values().map(|landmark| &landmark.corners);
                warn_of_rounded_corners(view, id, corners, warnings);
            }
        }
        FilmLandmarks::Placements { readings, .. } => {
            for Reading { id, vertebrae } in readings {
                let places = vertebrae.values().map(|one| one.location);
                let places = places.map(|place| [place.y_mm, place.z_mm]);
                let names = ["lateral coordinates", "cranial coordinates"];
                warn_of_tens(view, id, names, &places.collect::<Vec<_>>(), warnings);
            }
        }
    }
}

/// The same of one reading of corners, on a film of any view.
pub(super) fn warn_of_rounded_corners<'a>(
    view: FilmView,
    id: &ReadingId,
    corners: impl Iterator<Item = &'a Corners<Pixel>>,
    warnings: &mut Warnings,
) {
    let places = corners.flat_map(Corners::points).map(|place| [place.column_px, place.row_px]);
    warn_of_tens(view, id, ["columns", "rows"], &places.collect::<Vec<_>>(), warnings);
}

fn warn_of_tens(
    view: FilmView,
    id: &ReadingId,
    names: [&str; 2],
    places: &[[f64; 2]],
    warnings: &mut Warnings,
) {
    for (direction, name) in names.into_iter().enumerate() {
        let values = places.iter().map(|place| place[direction]).collect();
        let Some(count) = whole_tens(values) else { continue };
        let text = format!(
            "observer {id}: {count} of its {name} are whole tens, as in 1.89E+03 of a spreadsheet: if the file was rounded, export it again with all digits"
        );
        view.warn_of_film(WarningCode::CoordinatesRounded, text, warnings);
    }
}

/// The number of coordinates that are whole tens, if this is not a coincidence. A straight spine may have one number for all.
fn whole_tens(all: Vec<f64>) -> Option<usize> {
    let large: Vec<f64> = all.iter().copied().filter(|value| *value >= THREE_DIGITS).collect();
    let is_rounded = |values: &[f64]| {
        values.len() >= MIN_COUNT
            && values.iter().all(|value| value % 10.0 == 0.0)
            && values.windows(2).any(|two| (two[0] - two[1]).abs() > 0.0)
    };
    [all, large].into_iter().find(|values| is_rounded(values)).map(|values| values.len())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::anatomy::{ImageSide, Level, Posture};
    use crate::measure::{
        ImageGeometry, LateralFilm, Placement, SpacingPlane, VertebraLandmarks, judge_landmarks,
    };
    use crate::spatial::{Angle, Frontal};

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

    #[test]
    fn locations_and_lateral_films_are_looked_at_too() {
        let tens = |value: f64| (value / 10.0).round() * 10.0;
        let placed = |change: fn(f64) -> f64| {
            let place = |i: usize| Frontal::new(0.0, change(27.3 * i as f64));
            let body = |(i, level)| (level, Placement::new(place(i), Angle::ZERO));
            let vertebrae = Level::MODEL.into_iter().enumerate().map(body).collect();
            let readings = vec![Reading { id: ReadingId::new("A", 1), vertebrae }];
            let landmarks = FilmLandmarks::placed(SpacingPlane::Patient, readings);
            judge_landmarks(&Film::new(Posture::Erect, landmarks))
        };
        assert!(!placed(|value| value).has(WarningCode::CoordinatesRounded), "one number for all");
        let rounded = placed(tens);
        let found = rounded.all().iter().find(|one| one.code == WarningCode::CoordinatesRounded);
        assert!(found.is_some_and(|one| one.message.contains("15 of its cranial")), "{rounded:?}");
        let lateral = |change: fn(f64) -> f64| {
            let frontal = film(change);
            let FilmLandmarks::Corners { image, readings, .. } = frontal.landmarks else {
                panic!("corners")
            };
            let corners = |(level, landmark): (Level, VertebraLandmarks)| (level, landmark.corners);
            let reading = |Reading { id, vertebrae }: Reading<VertebraLandmarks>| Reading {
                id,
                vertebrae: vertebrae.into_iter().map(corners).collect(),
            };
            let readings = readings.into_iter().map(reading).collect();
            let mut warnings = Warnings::default();
            let film = LateralFilm { image, simultaneous: false, readings };
            film.measure(&mut warnings).expect("a sound film");
            warnings
        };
        assert!(!lateral(|value| value).has(WarningCode::CoordinatesRounded));
        assert!(lateral(tens).has(WarningCode::CoordinatesRounded));
    }
}
