use super::Level;

/// Where the centres of the pedicles lie in a typical vertebra, as a frontal film shows them.
///
/// # Definition
/// Their distance from the sagittal plane is half of the width of the canal and half of that of a pedicle. Their distance behind the
/// centre of the body is half of the depth of the body and [`PediclePlace::BEHIND_WALL_MM`].
///
/// # References
/// Canals and pedicles: [panjabi-1991], [panjabi-1992], from memory; most cells were not checked against the originals. Depths:
/// [`super::Morphometry`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PediclePlace {
    /// From the sagittal plane of the vertebra.
    pub beside_mm: f64,
    /// Behind the centre of the body.
    pub behind_mm: f64,
}

impl PediclePlace {
    /// From the posterior wall to the narrowest part of a pedicle, which a frontal film shows as its outline (assumption).
    pub const BEHIND_WALL_MM: f64 = 4.0;
    /// Standard deviation of the ratio of both distances between people, as a part of it (assumption).
    pub const RATIO_SD: f64 = 0.1;

    /// Of the typical vertebra of this level.
    #[must_use]
    pub const fn of(level: Level) -> Self {
        // Width of the canal and of a pedicle.
        let [canal_mm, pedicle_mm]: [f64; 2] = match level {
            Level::L5 => [27.1, 18.0],
            Level::L4 => [25.4, 14.1],
            Level::L3 => [24.3, 10.1],
            Level::L2 => [23.8, 8.9],
            Level::L1 => [23.7, 8.6],
            Level::T12 => [22.2, 8.8],
            Level::T11 => [19.4, 8.7],
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
        let depth_mm = super::Morphometry::of(level).superior_depth_mm;
        Self {
            beside_mm: 0.5 * (canal_mm + pedicle_mm),
            behind_mm: 0.5 * depth_mm + Self::BEHIND_WALL_MM,
        }
    }
}
