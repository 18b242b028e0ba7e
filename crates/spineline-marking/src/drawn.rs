use spineline::measure::{ImageGeometry, LengthScale};
use spineline::number::{fixed, with_sd};
use spineline::spatial::{Angle, Frontal, Pixel};

use super::Calibration;

/// A line that a person draws on a film to measure a length or an angle. It is not part of a reading.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnLine {
    /// One end.
    pub from: Pixel,
    /// Other end.
    pub to: Pixel,
}

/// The length of a drawn line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnLength {
    /// Length in the millimetres of [`DrawnLength::scale`]; in pixels for a film without scale.
    pub length_mm: f64,
    /// Its standard deviation by the two clicks alone, in the same unit.
    pub click_sd_mm: f64,
    /// Unit and plane of the length, with the error of the film's scale.
    pub scale: LengthScale,
}

/// The angle between two drawn lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DrawnAngle {
    /// The smaller angle between the lines, from 0° to 90°, for any order of their ends.
    pub angle: Angle,
    /// Its standard deviation by the four clicks. The error of the scale does not contribute: it changes both
    /// directions alike.
    pub click_sd: Angle,
}

/// A drawn line that cannot be measured.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DrawnFault {
    /// An end outside of the picture, or not a number.
    #[error(
        "an end at column {}, row {} lies outside of the {columns} × {rows} picture",
        fixed(place.column_px, 1),
        fixed(place.row_px, 1)
    )]
    OffPicture {
        /// The end.
        place: Pixel,
        /// Columns of the picture.
        columns: u32,
        /// Rows of the picture.
        rows: u32,
    },
    /// Ends too close for their standard deviation.
    #[error(
        "the ends of a line are {} pixels apart, and the minimum is {} (ten times the standard deviation of a click)",
        fixed(*apart_px, 1),
        fixed(*least_px, 1)
    )]
    TooNear {
        /// Distance between the ends, in widths of a pixel.
        apart_px: f64,
        /// The least.
        least_px: f64,
    },
}

impl DrawnLine {
    /// The length of a drawn line, by the spacing of columns and rows.
    ///
    /// With the sides `y` and `z` of the line and the size `c` × `r` of a pixel, its variance by the clicks is
    /// `2 σ² (c² y² + r² z²) / (y² + z²)`, to first order; `σ` is [`Calibration::CLICK_SD_PX`].
    ///
    /// # Errors
    /// [`DrawnFault`].
    ///
    /// ```
    /// use spineline::anatomy::ImageSide;
    /// use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
    /// use spineline_marking::DrawnLine;
    /// use spineline::spatial::Pixel;
    /// let image = ImageGeometry {
    ///     columns: 400, rows: 500, patient_left: ImageSide::Left,
    ///     spacing: Some(Spacing::stated(0.5, 0.2, SpacingPlane::Patient)),
    /// };
    /// let line = DrawnLine { from: Pixel::new(10.0, 10.0), to: Pixel::new(70.0, 210.0) };
    /// let length = line.length(&image)?;
    /// assert!((length.length_mm - 50.0).abs() < 1e-12);
    /// assert_eq!(length.text(), "50.0 ± 0.2 mm");
    /// # Ok::<(), spineline_marking::DrawnFault>(())
    /// ```
    pub fn length(&self, image: &ImageGeometry) -> Result<DrawnLength, DrawnFault> {
        let way = self.way(image)?;
        let by_click = by_click(image, Frontal::new(way.y_mm.abs(), way.z_mm.abs()));
        Ok(DrawnLength {
            length_mm: way.norm_mm(),
            click_sd_mm: by_click / way.norm_mm(),
            scale: image.length_scale(),
        })
    }

    /// The angle to another drawn line in the patient's frontal plane, where pixels need not be square.
    ///
    /// The variance of one direction by its clicks is `2 σ² (c² z² + r² y²) / (y² + z²)²`, to first order, with the
    /// letters of [`DrawnLine::length`].
    ///
    /// # Errors
    /// [`DrawnFault`].
    ///
    /// ```
    /// use spineline::anatomy::ImageSide;
    /// use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
    /// use spineline_marking::DrawnLine;
    /// use spineline::spatial::Pixel;
    /// let image = ImageGeometry {
    ///     columns: 400, rows: 500, patient_left: ImageSide::Left,
    ///     spacing: Some(Spacing::stated(0.2, 0.1, SpacingPlane::Patient)),
    /// };
    /// let level = DrawnLine { from: Pixel::new(10.0, 10.0), to: Pixel::new(60.0, 10.0) };
    /// // Fifty columns and a hundred rows: 10 mm across and 10 mm down.
    /// let slope = DrawnLine { from: Pixel::new(60.0, 110.0), to: Pixel::new(10.0, 10.0) };
    /// let angle = level.angle_to(&slope, &image)?;
    /// assert!((angle.angle.deg() - 45.0).abs() < 1e-12);
    /// # Ok::<(), spineline_marking::DrawnFault>(())
    /// ```
    pub fn angle_to(&self, other: &Self, image: &ImageGeometry) -> Result<DrawnAngle, DrawnFault> {
        let (a, b) = (self.way(image)?, other.way(image)?);
        let sd_rad = |way: Frontal| {
            // Only movement of a click across the line changes the direction.
            let across = Frontal::new(way.z_mm.abs(), way.y_mm.abs());
            by_click(image, across) / way.dot(way)
        };
        Ok(DrawnAngle {
            angle: Angle::from_sin_cos(a.cross(b).abs(), a.dot(b).abs()),
            click_sd: Angle::from_rad(sd_rad(a).hypot(sd_rad(b))),
        })
    }

    /// From one end of a line to the other.
    fn way(&self, image: &ImageGeometry) -> Result<Frontal, DrawnFault> {
        let ends = [self.from, self.to];
        if let Some(&place) = ends.iter().find(|&&place| !image.contains(place)) {
            let (columns, rows) = (image.columns, image.rows);
            return Err(DrawnFault::OffPicture { place, columns, rows });
        }
        let [from, to] = ends.map(|place| image.frontal(place));
        let way = to - from;
        let least_px = 10.0 * Calibration::CLICK_SD_PX;
        let apart_px = way.norm_mm() / image.pixel_size().y_mm;
        if apart_px < least_px {
            return Err(DrawnFault::TooNear { apart_px, least_px });
        }
        Ok(way)
    }
}

/// Standard deviation of `y Δy + z Δz` by two clicks, for given `y` and `z`.
fn by_click(image: &ImageGeometry, weights: Frontal) -> f64 {
    let size = image.pixel_size();
    let spread = (weights.y_mm * size.y_mm).hypot(weights.z_mm * size.z_mm);
    std::f64::consts::SQRT_2 * Calibration::CLICK_SD_PX * spread
}

impl DrawnLength {
    /// Standard deviation of the length by the clicks and, if known, by the film's scale; in the unit of the length.
    #[must_use]
    pub fn sd_mm(&self) -> f64 {
        self.click_sd_mm.hypot(self.scale.sd_mm(self.length_mm).unwrap_or_default())
    }

    /// The length as text: `123.4 ± 0.9 mm`, or `842 px` for a film without scale.
    #[must_use]
    pub fn text(&self) -> String {
        let relative_sd = Some(self.sd_mm() / self.length_mm);
        LengthScale { relative_sd, ..self.scale }.text(self.length_mm, 1)
    }
}

impl DrawnAngle {
    /// The angle in words: `23.4 ± 0.3°`.
    #[must_use]
    pub fn text(&self) -> String {
        format!("{}°", with_sd(self.angle.deg(), self.click_sd.deg(), 1))
    }
}
