use super::Level;

/// Sizes of one typical vertebra and of the disc above it.
///
/// # References
/// Endplates and body heights: [panjabi-1991], [panjabi-1992]. Discs: [shin-2024], [bach-2019], [yadav-2020] (lumbar and
/// thoracolumbar), [fletcher-2015] (thoracic, interpolated). Distances between midpoints from L4 to T2: [vid-ct]; the others and the sagittal
/// angles: [bruno-2015]. Which cells were compared with their source: [`PublishedNumbers`](super::PublishedNumbers).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Morphometry {
    /// Width of the superior endplate.
    pub superior_width_mm: f64,
    /// Width of the inferior endplate.
    pub inferior_width_mm: f64,
    /// Depth of the superior endplate.
    pub superior_depth_mm: f64,
    /// Posterior height of the body.
    pub body_height_mm: f64,
    /// Height of the disc between this vertebra and the next one above.
    pub disc_above_mm: f64,
    /// From the midpoint of this vertebra to the next midpoint above; from T1 to the seventh cervical vertebra's.
    pub spacing_above_mm: f64,
    /// Sagittal turn of the joint above in an adult without deformity: kyphosis positive, lordosis negative.
    pub joint_above_deg: f64,
}

impl Morphometry {
    /// From the superior endplate of the sacrum to the midpoint of L5.
    pub const L5_ABOVE_SACRUM_MM: f64 = 17.45;

    /// The typical vertebra of this level.
    #[must_use]
    pub const fn of(level: Level) -> Self {
        // Endplate widths (upper, lower), upper depth, body height, disc above, distance to the midpoint above, sagittal turn above.
        let row: [f64; 7] = match level {
            Level::L5 => [47.3, 49.4, 34.7, 22.9, 9.3, 33.7, -18.0],
            Level::L4 => [46.6, 49.5, 35.5, 24.1, 8.8, 36.4, -12.0],
            Level::L3 => [44.1, 48.0, 35.2, 23.8, 7.9, 35.7, -7.0],
            Level::L2 => [42.6, 45.5, 34.6, 24.3, 6.6, 34.7, -6.0],
            Level::L1 => [41.2, 43.3, 34.1, 23.8, 5.8, 32.2, 2.0],
            Level::T12 => [39.0, 42.1, 32.8, 22.7, 5.5, 29.5, 4.0],
            Level::T11 => [34.9, 39.1, 31.9, 21.3, 5.1, 27.3, 5.0],
            Level::T10 => [31.9, 35.4, 30.5, 20.2, 4.6, 25.3, 4.0],
            Level::T9 => [30.6, 33.0, 29.3, 19.3, 4.1, 24.0, 5.0],
            Level::T8 => [29.5, 30.5, 27.9, 18.7, 3.7, 23.4, 6.0],
            Level::T7 => [27.8, 29.1, 27.4, 18.2, 3.2, 22.9, 6.0],
            Level::T6 => [26.2, 28.2, 26.0, 17.4, 2.9, 22.2, 6.0],
            Level::T5 => [24.9, 27.0, 24.3, 16.2, 2.7, 21.3, 6.0],
            Level::T4 => [24.5, 26.0, 23.3, 16.2, 3.0, 20.9, 4.0],
            Level::T3 => [24.6, 25.9, 22.7, 15.7, 3.5, 20.6, 3.0],
            Level::T2 => [24.9, 27.4, 19.6, 15.6, 3.8, 19.1, 1.0],
            Level::T1 => [24.5, 27.8, 18.5, 14.3, 3.8, 19.1, 0.0],
        };
        Self {
            superior_width_mm: row[0],
            inferior_width_mm: row[1],
            superior_depth_mm: row[2],
            body_height_mm: row[3],
            disc_above_mm: row[4],
            spacing_above_mm: row[5],
            joint_above_deg: row[6],
        }
    }

    /// Typical distance along the spine between the midpoints of two vertebrae, which need not be neighbours; 0 unless the second one lies above.
    #[must_use]
    pub fn spacing_mm(inferior: Level, superior: Level) -> f64 {
        let between = Level::ALL.into_iter().filter(|level| (inferior..superior).contains(level));
        between.map(|level| Self::of(level).spacing_above_mm).sum()
    }
}

/// The sagittal turns of the 14 joints, caudal first: what a frontal film cannot show.
///
/// # References
/// Distribution over levels [bruno-2015]; size from 458 adolescents with scoliosis [sagittal-ais-2018].
#[derive(Debug, Clone, PartialEq)]
pub struct SagittalProfile {
    /// Turn of the superior vertebra against the inferior one; flexion (kyphosis) positive.
    pub turns_deg: [f64; 14],
    /// Axial rotation of every vertebra, right-handed about its own cranial axis; zero where unknown.
    pub axial_deg: [f64; 15],
}

impl SagittalProfile {
    /// Mean kyphosis T5-T12 of adolescents with scoliosis [sagittal-ais-2018].
    pub const KYPHOSIS_T5_T12_DEG: f64 = 24.9;
    /// Mean lordosis L1-L5 of adolescents with scoliosis [sagittal-ais-2018].
    pub const LORDOSIS_L1_L5_DEG: f64 = 46.4;

    /// The template for given sizes: T5-T12 kyphosis and L1-L5 lordosis, both positive.
    ///
    /// The level-wise pattern of an adult spine (36° and 43°) is scaled region by region.
    #[must_use]
    pub fn template(kyphosis_t5_t12_deg: f64, lordosis_l1_l5_deg: f64) -> Self {
        let mut turns_deg = [0.0; 14];
        for (turn, level) in turns_deg.iter_mut().zip(Level::MODEL) {
            let scale = match level {
                Level::L4 | Level::L3 | Level::L2 => lordosis_l1_l5_deg / 43.0,
                Level::L1 => 1.0,
                _ => kyphosis_t5_t12_deg / 36.0,
            };
            *turn = scale * Morphometry::of(level).joint_above_deg;
        }
        Self { turns_deg, axial_deg: [0.0; 15] }
    }
}

impl Default for SagittalProfile {
    fn default() -> Self {
        Self::template(Self::KYPHOSIS_T5_T12_DEG, Self::LORDOSIS_L1_L5_DEG)
    }
}
