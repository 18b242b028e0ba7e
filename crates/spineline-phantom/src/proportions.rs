//! Distances between vertebrae, and places of pedicles, of phantoms. They come from other published tables than the
//! library's, so that phantoms are an independent check of the library's readings.

use spineline::anatomy::{Level, Morphometry};

/// Distance between the midpoints of two neighbouring vertebrae: half of both lengths with their share of the discs, in
/// an adult model [bruno-2015].
pub fn spacing_mm(inferior: Level, superior: Level) -> f64 {
    0.5 * (unit_mm(inferior) + unit_mm(superior))
}

/// Size of a spine of this length from L4 to T2 over the typical one.
pub fn body_scale(length_mm: f64) -> f64 {
    let typical: f64 = Level::MODEL.windows(2).map(|pair| spacing_mm(pair[0], pair[1])).sum();
    length_mm / typical
}

/// From the joint below a vertebra to the joint above.
const fn unit_mm(level: Level) -> f64 {
    match level {
        Level::L5 => 34.9,
        Level::L4 | Level::L3 => 32.5,
        Level::L2 => 30.1,
        Level::L1 => 31.3,
        Level::T12 => 33.2,
        Level::T11 => 29.0,
        Level::T10 => 28.5,
        Level::T9 => 24.7,
        Level::T8 | Level::T6 => 24.2,
        Level::T7 => 25.5,
        Level::T5 => 24.8,
        Level::T4 => 23.1,
        Level::T3 => 20.9,
        Level::T2 | Level::T1 => 19.1,
    }
}

/// From the posterior wall to the narrowest part of a pedicle, which is its outline on a frontal film (assumption).
const BEHIND_WALL_MM: f64 = 4.0;

/// Places of the centres of the pedicles: beside the sagittal plane by half the width of the canal and half the width
/// of a pedicle ([panjabi-1991], [panjabi-1992]), and behind the centre of the body by half its depth and
/// [`BEHIND_WALL_MM`].
pub fn pedicle_mm(level: Level) -> [f64; 2] {
    let [canal_mm, pedicle_mm]: [f64; 2] = match level {
        Level::L5 => [27.1, 18.6],
        Level::L4 => [25.4, 14.1],
        Level::L3 => [24.3, 10.1],
        Level::L2 => [23.8, 8.25],
        Level::L1 => [23.7, 8.6],
        Level::T12 => [22.2, 8.7],
        Level::T11 => [19.4, 9.75],
        Level::T10 => [18.2, 7.2],
        Level::T9 => [17.8, 6.5],
        Level::T8 => [17.6, 6.1],
        Level::T7 => [17.3, 5.8],
        Level::T6 => [17.3, 5.7],
        Level::T5 => [17.4, 5.5],
        Level::T4 => [17.0, 5.5],
        Level::T3 => [17.2, 6.0],
        Level::T2 => [18.8, 7.3],
        Level::T1 => [21.8, 8.5],
    };
    let depth_mm = Morphometry::of(level).superior_depth_mm;
    [0.5 * (canal_mm + pedicle_mm), 0.5 * depth_mm + BEHIND_WALL_MM]
}
