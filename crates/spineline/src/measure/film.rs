use std::collections::BTreeMap;
use std::fmt;

use super::{
    Corners, EndplateTilts, LengthScale, Origin, ProgramNoise, Spacing, SpacingPlane,
    VertebraOrigin,
};
use crate::anatomy::{ImageSide, Level, Posture, named};
use crate::number::fixed;
use crate::spatial::{Angle, Frontal, Pixel};

/// The geometry of a picture: its size, the distance between its pixels, and the side of the patient's left; of a lateral film, the
/// side of the patient's front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ImageGeometry {
    /// Number of columns.
    pub columns: u32,
    /// Number of rows.
    pub rows: u32,
    /// Distances between its pixels, or their shape alone; `None` where unknown: then pixels are the unit, and taken as square.
    pub spacing: Option<Spacing>,
    /// The side of the picture on which the patient's left is; of a lateral film, the patient's front.
    pub patient_left: ImageSide,
}

/// A scale that makes a film larger than any film of a spine.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "its scale makes it {} mm {side}, and no film of a spine is more than {} mm {side}",
    fixed(*size_mm, 0),
    fixed(*limit_mm, 0)
)]
#[non_exhaustive]
pub struct FilmTooLarge {
    /// `wide` or `high`.
    pub side: &'static str,
    /// What the film would be.
    pub size_mm: f64,
    /// The most.
    pub limit_mm: f64,
}

impl ImageGeometry {
    /// Distances between its pixels in millimetres; `None` without millimetres, also where only the shape of a pixel is known.
    #[must_use]
    pub fn scale(&self) -> Option<Spacing> {
        self.spacing.filter(Spacing::has_millimetres)
    }

    /// Largest side of a film of a spine: more than whole-body films of the tallest people (assumption).
    pub const LARGEST_SIDE_MM: f64 = 2500.0;

    /// Refuses a scale that makes the film larger than any film of a spine; a film without a scale is of any size.
    ///
    /// # Errors
    /// The side that is too long, its size and the limit.
    pub fn check_size(&self) -> Result<(), FilmTooLarge> {
        let Some(spacing) = self.scale() else { return Ok(()) };
        let limit_mm = Self::LARGEST_SIDE_MM;
        for (side, pixels, mm) in
            [("wide", self.columns, spacing.column_mm), ("high", self.rows, spacing.row_mm)]
        {
            let size_mm = f64::from(pixels) * mm;
            if size_mm > limit_mm {
                return Err(FilmTooLarge { side, size_mm, limit_mm });
            }
        }
        Ok(())
    }

    /// A place of the picture in millimetres, `y` to the patient's left (on a lateral film to the front) and `z` up the film; in widths
    /// of a pixel where the picture has no scale.
    ///
    /// ```
    /// use spineline::anatomy::ImageSide;
    /// use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
    /// use spineline::spatial::{Frontal, Pixel};
    /// let image = ImageGeometry {
    ///     columns: 400, rows: 500, patient_left: ImageSide::Left,
    ///     spacing: Some(Spacing::stated(0.5, 0.2, SpacingPlane::Patient)),
    /// };
    /// assert_eq!(image.frontal(Pixel::new(10.0, 10.0)), Frontal::new(-5.0, -2.0));
    /// ```
    #[must_use]
    pub fn frontal(&self, place: Pixel) -> Frontal {
        let [column_mm, row_mm] = self.steps();
        Frontal::new(self.left_per_column() * column_mm * place.column_px, -row_mm * place.row_px)
    }

    /// The inverse of [`ImageGeometry::frontal`].
    #[must_use]
    pub fn pixel(&self, point: Frontal) -> Pixel {
        let [column_mm, row_mm] = self.steps();
        Pixel::new(point.y_mm / (self.left_per_column() * column_mm), -point.z_mm / row_mm)
    }

    /// Size of one column and one row, in the unit of the film.
    pub(crate) fn steps(&self) -> [f64; 2] {
        self.spacing.map_or([1.0, 1.0], |spacing| [spacing.column_mm, spacing.row_mm])
    }

    /// An angle to the image's vertical, positive clockwise as seen, as a tilt of the patient; its own inverse.
    #[must_use]
    pub fn tilt_from_clockwise(&self, clockwise: Angle) -> Angle {
        clockwise * -self.left_per_column()
    }

    /// The unit of lengths between places of this picture; a pixel stands for a millimetre where it has no spacing.
    #[must_use]
    pub fn length_scale(&self) -> LengthScale {
        let pixels = LengthScale {
            plane: SpacingPlane::Pixels,
            source: None,
            relative_sd: None,
            units_per_mm: 1.0,
        };
        self.spacing.as_ref().map_or(pixels, LengthScale::of)
    }

    /// Width and height of a pixel.
    #[must_use]
    pub fn pixel_size(&self) -> Frontal {
        let to = self.frontal(Pixel::new(1.0, 1.0));
        Frontal::new(to.y_mm.abs(), to.z_mm.abs())
    }

    /// Whether a place lies on the picture.
    #[must_use]
    pub fn contains(&self, place: Pixel) -> bool {
        (-0.5..f64::from(self.columns) - 0.5).contains(&place.column_px)
            && (-0.5..f64::from(self.rows) - 0.5).contains(&place.row_px)
    }

    /// Which way the side of `patient_left` lies when the column grows.
    fn left_per_column(&self) -> f64 {
        match self.patient_left {
            ImageSide::Left => -1.0,
            ImageSide::Right => 1.0,
        }
    }
}

impl FilmLandmarks {
    /// Locations and tilts of vertebrae that were seen; the deviation of their scale is not stated.
    #[must_use]
    pub const fn placed(spacing_plane: SpacingPlane, readings: Vec<Reading<Placement>>) -> Self {
        let source = PlacementSource::Vertebrae;
        Self::Placements { spacing_plane, scale_relative_sd: None, source, readings }
    }

    /// Readings of corners; a film of placements does not have them.
    #[must_use]
    pub fn corner_readings(&self) -> &[Reading<VertebraLandmarks>] {
        match self {
            Self::Corners { readings, .. } => readings,
            Self::Placements { .. } => &[],
        }
    }

    /// Readings of corners, to change them; empty for a film of placements.
    pub fn corner_readings_mut(&mut self) -> &mut [Reading<VertebraLandmarks>] {
        match self {
            Self::Corners { readings, .. } => readings,
            Self::Placements { .. } => &mut [],
        }
    }

    /// Observers and repeats of its readings.
    #[must_use]
    pub fn reading_ids(&self) -> Vec<&ReadingId> {
        match self {
            Self::Corners { readings, .. } => readings.iter().map(|reading| &reading.id).collect(),
            Self::Placements { readings, .. } => {
                readings.iter().map(|reading| &reading.id).collect()
            }
        }
    }
}

/// Observer, and number of the repeat.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ReadingId {
    /// Name or code of the reader.
    pub observer: String,
    /// From 1.
    pub repeat: u32,
}

impl ReadingId {
    /// An identity from its parts.
    #[must_use]
    pub fn new(observer: impl Into<String>, repeat: u32) -> Self {
        Self { observer: observer.into(), repeat }
    }
}

impl fmt::Display for ReadingId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} (repeat {})", self.observer, self.repeat)
    }
}

/// A vertebra as marked on the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VertebraLandmarks {
    /// The corners of its body.
    pub corners: Corners<Pixel>,
    /// How each of them came about.
    pub origins: Corners<Origin>,
    /// The midpoints of its left and right wall, where it was marked by them.
    pub walls: [Option<Pixel>; 2],
    /// The centres of its left and right pedicle, as the film shows them.
    pub pedicles: [Option<Pixel>; 2],
    /// Its axis where it was turned by hand: against the image's vertical, positive clockwise as seen.
    pub axis_clockwise: Option<Angle>,
    /// Confidence of each corner from 0 to 1, where a program found them; `None` where a person placed them.
    pub confidence: Option<Corners<f64>>,
    /// Standard deviation of a corner's coordinate as a part of the height of the body, where a program found the corners in the
    /// picture and stated it.
    pub sd_share: Option<f64>,
}

impl VertebraLandmarks {
    /// Corners that a person clicked.
    #[must_use]
    pub const fn clicked(corners: Corners<Pixel>) -> Self {
        Self {
            corners,
            origins: Corners::all(Origin::Clicked),
            walls: [None; 2],
            pedicles: [None; 2],
            axis_clockwise: None,
            confidence: None,
            sd_share: None,
        }
    }

    /// Whether a person placed all four corners.
    #[must_use]
    pub fn is_placed(&self) -> bool {
        self.origins.points().into_iter().all(Origin::is_placed)
    }

    /// Whether a person has looked at all four corners.
    #[must_use]
    pub fn is_reviewed(&self) -> bool {
        self.origins.points().into_iter().all(Origin::is_reviewed)
    }
}

/// A vertebra as measured on one reading, or by another program, in any frontal frame of its film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Midpoint.
    pub location: Frontal,
    /// Tilt.
    pub tilt: Angle,
    /// Tilts of its two endplates; `None` where its corners are not known.
    pub endplates: Option<EndplateTilts>,
    /// Noise that corners found by a program add to its own; `None` where a person placed all of them.
    pub program: Option<ProgramNoise>,
    /// How its corners came about; `None` where they are not known.
    pub origin: Option<VertebraOrigin>,
}

impl Placement {
    /// A location and a tilt without corners.
    #[must_use]
    pub const fn new(location: Frontal, tilt: Angle) -> Self {
        Self { location, tilt, endplates: None, program: None, origin: None }
    }
}

named! {
    /// Where locations and tilts come from.
    #[default(Vertebrae)]
    pub enum PlacementSource {
        /// Vertebrae that were seen.
        Vertebrae = "vertebrae",
        /// A midline of the back surface: the levels were placed by arc length, not seen.
        SurfaceMidline = "surface_midline",
    }
}

/// One pass of one reader over one film.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading<T> {
    /// Reader and repeat.
    pub id: ReadingId,
    /// The vertebrae that were read.
    pub vertebrae: BTreeMap<Level, T>,
}

/// The superior tips of the two iliac crests.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct IliacCrests {
    /// The patient's left crest.
    pub left: Pixel,
    /// The patient's right crest.
    pub right: Pixel,
}

impl IliacCrests {
    /// The middle between both on their picture.
    #[must_use]
    pub fn middle(self, image: &ImageGeometry) -> Frontal {
        (image.frontal(self.left) + image.frontal(self.right)) * 0.5
    }
}

/// The landmarks of a film, or its locations and tilts.
#[derive(Debug, Clone, PartialEq)]
pub enum FilmLandmarks {
    /// Landmarks on a picture.
    Corners {
        /// The picture.
        image: ImageGeometry,
        /// Tips of the iliac crests.
        iliac_crests: Option<IliacCrests>,
        /// The readings.
        readings: Vec<Reading<VertebraLandmarks>>,
    },
    /// Locations and tilts from another program, all readings in one frame of the film.
    Placements {
        /// Plane of the millimetres.
        spacing_plane: SpacingPlane,
        /// Standard deviation of their scale, as a part of it, where it is stated.
        scale_relative_sd: Option<f64>,
        /// Where they come from.
        source: PlacementSource,
        /// The readings.
        readings: Vec<Reading<Placement>>,
    },
}

/// One radiograph of a case.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Position of the patient.
    pub posture: Posture,
    /// Its landmarks.
    pub landmarks: FilmLandmarks,
    /// Whether a person compared it with the patient's records, and it shows this patient in this posture.
    pub checked: bool,
}

impl Film {
    /// A film that nobody compared with the patient's records.
    #[must_use]
    pub const fn new(posture: Posture, landmarks: FilmLandmarks) -> Self {
        Self { posture, landmarks, checked: false }
    }
}
