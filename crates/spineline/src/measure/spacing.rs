use std::fmt;

use crate::anatomy::named;
use crate::number::{fixed, with_sd};

named! {
    /// Unit of the lengths of a film.
    ///
    /// A film carries it from its file to the report: a length in the detector's plane is larger than life by the
    /// magnification of the set-up (5 to 15 % on long films), and a length in pixels is not a length of the patient.
    pub enum SpacingPlane {
        /// Millimetres in the patient: calibrated.
        Patient = "patient",
        /// Millimetres on the detector: larger than life by the magnification of the set-up.
        Detector = "detector",
        /// Millimetres in a plane that is not stated.
        Unknown = "unknown",
        /// No millimetres: pixels, taken as square where their shape is not stated. Angles can be measured, lengths cannot.
        Pixels = "pixels",
    }
}

impl SpacingPlane {
    /// The unit of a length from such a film, in words.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Patient => "mm (patient)",
            Self::Detector => "mm (detector)",
            Self::Unknown => "mm (plane not stated)",
            Self::Pixels => "pixels",
        }
    }
}

named! {
    /// How a film's spacing became known.
    ///
    /// # References
    /// Attributes of DICOM PS3.3, C.7.6.3, C.8.1.2, C.8.11.
    pub enum SpacingSource {
        /// Stated by whoever made the case.
        Stated = "stated" as "stated in the case",
        /// Pixel Spacing calibrated to an object of known size in the picture (FIDUCIAL).
        Fiducial = "fiducial" as "calibrated to an object in the picture",
        /// Pixel Spacing corrected by a known geometry of the set-up (GEOMETRY).
        Geometry = "geometry" as "calibrated by the geometry of the set-up",
        /// Pixel Spacing that differs from the detector's, without a reason.
        Uncalibrated = "uncalibrated" as "Pixel Spacing corrected in a way not stated",
        /// Pixel Spacing alone: it may be the detector's or the patient's.
        PixelSpacing = "pixel_spacing" as "Pixel Spacing without calibration type",
        /// Imager Pixel Spacing divided by the Estimated Radiographic Magnification Factor.
        Magnification = "magnification" as "Imager Pixel Spacing by the estimated magnification",
        /// Imager Pixel Spacing multiplied by the distances from source to patient and to detector.
        Distances = "distances" as "Imager Pixel Spacing by the distances of the set-up",
        /// Imager Pixel Spacing: the detector's.
        Imager = "imager" as "Imager Pixel Spacing",
        /// Nominal Scanned Pixel Spacing of a digitised film: that film's surface.
        Scanned = "scanned" as "Nominal Scanned Pixel Spacing",
        /// The shape of a pixel alone: Pixel Aspect Ratio, or the resolutions of a picture across and down.
        PixelAspect = "pixel_aspect" as "the shape of a pixel as the file states it",
        /// A ball of known diameter in the picture.
        Ball = "ball" as "a ball in the picture",
        /// A ruler in the picture.
        Ruler = "ruler" as "a ruler in the picture",
    }
}

/// Distances between neighbouring pixels, and where they come from. In the plane [`SpacingPlane::Pixels`] they are in widths of a
/// pixel: only their ratio is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spacing {
    /// Between neighbouring columns, so along a row.
    pub column_mm: f64,
    /// Between neighbouring rows, so down a column.
    pub row_mm: f64,
    /// Plane of these millimetres.
    pub plane: SpacingPlane,
    /// Where they come from.
    pub source: SpacingSource,
    /// Standard deviation of the scale, as a part of it, where it is known. All lengths of the film are wrong by the same
    /// factor; its angles are not.
    pub relative_sd: Option<f64>,
}

impl Spacing {
    /// A spacing that whoever made the case stated.
    #[must_use]
    pub const fn stated(column_mm: f64, row_mm: f64, plane: SpacingPlane) -> Self {
        Self { column_mm, row_mm, plane, source: SpacingSource::Stated, relative_sd: None }
    }

    /// The shape of a pixel alone: its height over its width.
    #[must_use]
    pub const fn of_aspect(aspect: f64, source: SpacingSource) -> Self {
        let plane = SpacingPlane::Pixels;
        Self { column_mm: 1.0, row_mm: aspect, plane, source, relative_sd: None }
    }

    /// Height of a pixel over its width.
    #[must_use]
    pub fn aspect(&self) -> f64 {
        self.row_mm / self.column_mm
    }

    /// Whether its distances are millimetres.
    #[must_use]
    pub fn has_millimetres(&self) -> bool {
        self.plane != SpacingPlane::Pixels
    }

    /// Whether both distances can be meant.
    #[must_use]
    pub fn is_plausible(&self) -> bool {
        [self.column_mm, self.row_mm].into_iter().all(Self::is_possible)
    }

    /// Detectors and scanners of films have coarser pixels; a finer spacing is probably in metres (assumption).
    pub const MIN_MM: f64 = 0.01;

    /// With coarser pixels a thoracic body is three or four pixels high, too few for its corners (assumption).
    pub const MAX_MM: f64 = 5.0;

    /// Whether a distance between pixels can be meant: finite, not the `0.000` that some devices write, and fine enough for the
    /// corners of a vertebra.
    #[must_use]
    pub fn is_possible(mm: f64) -> bool {
        (Self::MIN_MM..=Self::MAX_MM).contains(&mm)
    }

    /// Whether pixels are as high as wide, to a tenth of a percent: 0.03° at most in an angle.
    #[must_use]
    pub fn is_square(&self) -> bool {
        (self.aspect() - 1.0).abs() <= 1e-3
    }
}

/// The unit of a measured film: what its millimetres are, and the uncertainty of their scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LengthScale {
    /// Plane of the lengths.
    pub plane: SpacingPlane,
    /// Where the scale comes from; `None` for pixels.
    pub source: Option<SpacingSource>,
    /// Standard deviation of the scale, as a part of it.
    pub relative_sd: Option<f64>,
    /// How many units of the film, its millimetres or pixels, one internal millimetre holds: 1 where the film and the erect film
    /// have a spacing. An erect film in pixels is computed with as if its spine had the typical length, and a film that is in pixels, or
    /// whose erect film is, as if its spine had the length of the erect one: rotations compare places at equal lengths along two curves.
    pub units_per_mm: f64,
}

impl LengthScale {
    /// Largest standard deviation of a scale, as a part of it: a less certain scale is useless (assumption).
    pub const MAX_RELATIVE_SD: f64 = 0.3;

    /// The scale of a spacing.
    #[must_use]
    pub fn of(spacing: &Spacing) -> Self {
        Self {
            plane: spacing.plane,
            source: Some(spacing.source),
            relative_sd: spacing.relative_sd,
            units_per_mm: 1.0,
        }
    }

    /// A scale that was stated by another program, with its standard deviation where that is stated too.
    #[must_use]
    pub const fn stated(plane: SpacingPlane, relative_sd: Option<f64>) -> Self {
        Self { plane, source: Some(SpacingSource::Stated), relative_sd, units_per_mm: 1.0 }
    }

    /// Whether its lengths are millimetres, else pixels.
    #[must_use]
    pub fn has_millimetres(&self) -> bool {
        self.plane != SpacingPlane::Pixels
    }

    /// Whether internal millimetres are the film's, as a drawing with axes needs.
    #[must_use]
    pub fn is_internal(&self) -> bool {
        self.mm(1.0) == Some(1.0)
    }

    /// A length as millimetres, where it has any.
    #[must_use]
    pub fn mm(&self, length_mm: f64) -> Option<f64> {
        self.has_millimetres().then_some(self.units_per_mm * length_mm)
    }

    /// A length as pixels, where it has no millimetres.
    #[must_use]
    pub fn px(&self, length_mm: f64) -> Option<f64> {
        (!self.has_millimetres()).then_some(self.units_per_mm * length_mm)
    }

    /// Uncertainty of a length from the scale alone.
    #[must_use]
    pub fn sd_mm(&self, length_mm: f64) -> Option<f64> {
        self.relative_sd.map(|sd| sd * self.units_per_mm * length_mm.abs())
    }

    /// A residual in words, without the uncertainty of the scale.
    #[must_use]
    pub fn residual_text(&self, residual_mm: f64) -> String {
        match self.px(residual_mm) {
            Some(px) => format!("{} px", fixed(px, 1)),
            None => format!("{} mm", fixed(self.units_per_mm * residual_mm, 2)),
        }
    }

    /// A length in words: `371 mm`, `371 ± 4 mm` or `2840 px`.
    ///
    /// ```
    /// use spineline::measure::{LengthScale, Spacing, SpacingPlane};
    /// let mut spacing = Spacing::stated(0.14, 0.14, SpacingPlane::Patient);
    /// assert_eq!(LengthScale::of(&spacing).text(371.4, 0), "371 mm");
    /// spacing.relative_sd = Some(0.01);
    /// assert_eq!(LengthScale::of(&spacing).text(371.4, 0), "371 ± 4 mm");
    /// ```
    #[must_use]
    pub fn text(&self, length_mm: f64, places: usize) -> String {
        if let Some(px) = self.px(length_mm) {
            return format!("{} px", fixed(px, 0));
        }
        let mm = self.units_per_mm * length_mm;
        // An exact scale needs no words.
        match self.sd_mm(length_mm).filter(|sd| *sd > 0.0) {
            Some(sd) => format!("{} mm", with_sd(mm, sd, places)),
            None => format!("{} mm", fixed(mm, places)),
        }
    }
}

impl fmt::Display for LengthScale {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.plane.unit())?;
        if self.plane == SpacingPlane::Pixels && self.source.is_none() {
            f.write_str(" (taken as square)")?;
        }
        if let Some(source) = self.source.filter(|&source| source != SpacingSource::Stated) {
            write!(f, ", {source}")?;
        }
        match self.relative_sd.filter(|sd| *sd > 0.0) {
            Some(sd) => write!(f, ", scale ± {} %", fixed(100.0 * sd, 1)),
            None => Ok(()),
        }
    }
}
