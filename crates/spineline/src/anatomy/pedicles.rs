use super::Level;

/// Where the centres of the pedicles lie in a typical vertebra, as a frontal film shows them.
///
/// # Definition
/// Their distance from the sagittal plane is half of the width of the canal and half of a pedicle's width. Their distance behind the
/// centre of the body is that times a ratio: only this ratio enters the axial rotation after Stokes.
///
/// # References
/// Ratios from L4 to T1: means over 2,068 CTs [vid-ct]. At L5, [panjabi-1992] corrected as at L4 (assumption). Canals and
/// pedicles: [panjabi-1991], [panjabi-1992]. Which cells were compared with their source:
/// [`PublishedNumbers`](super::PublishedNumbers).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PediclePlace {
    /// From the sagittal plane of the vertebra.
    pub beside_mm: f64,
    /// Behind the centre of the body.
    pub behind_mm: f64,
}

impl PediclePlace {
    /// Standard deviation of the ratio of both distances between people, as a part of it (assumption).
    pub const RATIO_SD: f64 = 0.1;

    /// Of the typical vertebra of this level.
    #[must_use]
    pub const fn of(level: Level) -> Self {
        // Width of the canal and of a pedicle; distance behind the centre of the body over distance from the sagittal plane.
        let [canal_mm, pedicle_mm, ratio]: [f64; 3] = match level {
            Level::L5 => [27.1, 18.6, 1.146],
            Level::L4 => [25.4, 14.1, 1.333],
            Level::L3 => [24.3, 10.1, 1.494],
            Level::L2 => [23.8, 8.25, 1.628],
            Level::L1 => [23.7, 8.6, 1.655],
            Level::T12 => [22.2, 8.7, 1.671],
            Level::T11 => [19.4, 9.75, 1.718],
            Level::T10 => [18.2, 7.2, 1.758],
            Level::T9 => [17.8, 6.5, 1.781],
            Level::T8 => [17.6, 6.1, 1.742],
            Level::T7 => [17.3, 5.8, 1.686],
            Level::T6 => [17.3, 5.7, 1.582],
            Level::T5 => [17.4, 5.5, 1.495],
            Level::T4 => [17.0, 5.5, 1.363],
            Level::T3 => [17.2, 6.0, 1.178],
            Level::T2 => [18.8, 7.3, 0.983],
            Level::T1 => [21.8, 8.5, 0.743],
        };
        let beside_mm = 0.5 * (canal_mm + pedicle_mm);
        Self { beside_mm, behind_mm: ratio * beside_mm }
    }
}
