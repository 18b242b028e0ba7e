//! The landmarks of a reading in the library's types.

use std::collections::BTreeMap;

use spineline::anatomy::{FilmView, Level, Side};
use spineline::spatial::{Angle, Pixel};
use spineline_marking::{PartialLandmarks, PartialReading};
use spineline_store::ReadingState;

/// On the lateral film the front is in place of the left.
pub fn landmarks(state: &ReadingState, view: FilmView) -> PartialReading {
    let vertebrae: BTreeMap<Level, PartialLandmarks> = state
        .vertebrae
        .iter()
        .map(|(&level, landmarks)| {
            let place = |&[column, row]: &[f64; 2]| Pixel::new(column, row);
            (
                level,
                PartialLandmarks {
                    corners: landmarks.placed(view).map(|corner| corner.as_ref().map(place)),
                    origins: landmarks.corner_origins(view),
                    walls: [Side::Left, Side::Right]
                        .map(|side| landmarks.walls.get(&side).map(place)),
                    axis_clockwise: landmarks.axis_deg.map(Angle::from_deg),
                },
            )
        })
        .collect();
    let crests = [Side::Left, Side::Right]
        .map(|side| state.iliac_crests_px.get(&side).map(|&[column, row]| Pixel::new(column, row)));
    PartialReading { vertebrae, crests }
}
