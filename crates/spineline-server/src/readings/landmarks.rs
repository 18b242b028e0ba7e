//! The landmarks of a reading in the library's types.

use std::collections::BTreeMap;

use spineline::anatomy::{FilmView, Side};
use spineline::spatial::{Angle, Pixel};
use spineline_marking::{PartialLandmarks, PartialReading};
use spineline_store::{ReadingState, VertebraReading};

/// On the lateral film the front is in place of the left.
pub fn landmarks(state: &ReadingState, view: FilmView) -> PartialReading {
    let sides = |places: &BTreeMap<Side, [f64; 2]>| {
        Side::ALL.map(|side| places.get(&side).copied().map(Pixel::from))
    };
    let vertebra = |landmarks: &VertebraReading| PartialLandmarks {
        corners: landmarks.placed(view).map(|corner| corner.map(Pixel::from)),
        origins: landmarks.corner_origins(view),
        walls: sides(&landmarks.walls),
        axis_clockwise: landmarks.axis_deg.map(Angle::from_deg),
    };
    let vertebrae = state.vertebrae.iter().map(|(&level, one)| (level, vertebra(one))).collect();
    PartialReading { vertebrae, crests: sides(&state.iliac_crests_px) }
}
