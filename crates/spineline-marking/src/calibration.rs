use spineline::measure::{LengthScale, Spacing, SpacingPlane, SpacingSource};
use spineline::number::fixed;
use spineline::spatial::Pixel;

spineline::named! {
    /// An object of known size in the picture.
    pub enum Calibrator {
        /// A ball beside the spine: two clicks on opposite ends of a diameter.
        Ball = "ball",
        /// A ruler beside the spine: two clicks on two of its marks.
        Ruler = "ruler",
    }
}

impl Calibrator {
    /// Smallest and largest true length: balls beside a patient have these sizes, and a ruler is at most as long as the
    /// longest films (assumption).
    const fn lengths_mm(self) -> [f64; 2] {
        match self {
            Self::Ball => [1.0, 200.0],
            Self::Ruler => [1.0, 2000.0],
        }
    }
}

/// Two clicks and a length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Calibration {
    /// What was clicked.
    pub calibrator: Calibrator,
    /// The two clicks.
    pub clicks: [Pixel; 2],
    /// True distance between them.
    pub length_mm: f64,
    /// Standard deviation of that length, as its maker states it; zero if exact.
    pub length_sd_mm: f64,
    /// Standard deviation of one click along each direction of the picture.
    pub click_sd_px: f64,
    /// Height of a pixel over its width, 1 for square ones.
    pub pixel_aspect: f64,
}

/// A calibration that does not give a scale.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationError {
    /// An implausible number.
    #[error("the {what} is {value}, and must be {must}")]
    Value {
        /// Which number.
        what: &'static str,
        /// What it is.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// A length that the object cannot have.
    #[error(
        "the length of the {} is {value_mm} mm, and must be {least_mm} to {most_mm} mm",
        calibrator.key()
    )]
    Length {
        /// The object.
        calibrator: Calibrator,
        /// What was given.
        value_mm: f64,
        /// The least.
        least_mm: f64,
        /// The most.
        most_mm: f64,
    },
    /// A point outside of the picture: it was placed in another one, such as a copy of another size.
    #[error(
        "the point {}, {} lies outside of the {columns} × {rows} picture",
        fixed(point.column_px, 1),
        fixed(point.row_px, 1)
    )]
    OffPicture {
        /// Column and row of the point.
        point: Pixel,
        /// Columns of the picture.
        columns: u32,
        /// Rows of the picture.
        rows: u32,
    },
    /// Points too close for their standard deviation.
    #[error(
        "the two points are {} pixels apart, and the minimum is {} (ten times their standard deviation)",
        fixed(*apart_px, 1),
        fixed(*least_px, 1)
    )]
    TooNear {
        /// Distance between the clicks, in widths of a pixel.
        apart_px: f64,
        /// The least.
        least_px: f64,
    },
}

impl Calibration {
    /// Assumed standard deviation of one careful click.
    pub const CLICK_SD_PX: f64 = 0.5;

    /// The spacing of a film with this number of columns and rows in the plane of the calibrator, with its
    /// uncertainty.
    ///
    /// With the clicks `a` and `b`, `D² = (Δcolumn)² + (aspect · Δrow)²`, `column = length / D` and `row = aspect · column`.
    /// Both points have the same standard deviation in pixels in both directions, so the relative variance of the scale is
    /// `2 σ² (Δcolumn² + aspect⁴ Δrow²) / D⁴ + (σ_length / length)²`, to first order.
    ///
    /// # Assumption
    /// The calibrator is as far from the detector as the spine; 10 mm of difference at a source distance of 2 m adds an
    /// error of 0.5 %, which the picture does not show and the result does not include.
    ///
    /// # Errors
    /// [`CalibrationError`]: an implausible number, or clicks that are too near or outside of the picture.
    ///
    /// ```
    /// use spineline_marking::{Calibration, Calibrator};
    /// use spineline::spatial::Pixel;
    /// let ball = Calibration {
    ///     calibrator: Calibrator::Ball,
    ///     clicks: [Pixel::new(100.0, 400.0), Pixel::new(300.0, 400.0)],
    ///     length_mm: 25.0, length_sd_mm: 0.0, click_sd_px: 0.5, pixel_aspect: 1.0,
    /// };
    /// let spacing = ball.spacing([800, 1200])?;
    /// assert_eq!(spacing.column_mm, 0.125);
    /// assert!((spacing.relative_sd.unwrap() - 0.5 * 2f64.sqrt() / 200.0).abs() < 1e-15);
    /// # Ok::<(), spineline_marking::CalibrationError>(())
    /// ```
    pub fn spacing(&self, size_px: [u32; 2]) -> Result<Spacing, CalibrationError> {
        self.check(size_px)?;
        let [a, b] = self.clicks;
        let (across, down) = (b.column_px - a.column_px, b.row_px - a.row_px);
        let aspect = self.pixel_aspect;
        let apart_px = across.hypot(aspect * down);
        let least_px = 10.0 * self.click_sd_px.max(0.1);
        if apart_px < least_px {
            return Err(CalibrationError::TooNear { apart_px, least_px });
        }
        let column_mm = self.length_mm / apart_px;
        if !Spacing::is_possible(column_mm) || !Spacing::is_possible(aspect * column_mm) {
            let must = "a length that gives pixels from 0.01 to 5 mm";
            return Err(CalibrationError::Value {
                what: "length in mm",
                value: self.length_mm,
                must,
            });
        }
        // The derivative of D: along the line for columns, and once more by the aspect for rows.
        let by_click =
            2.0 * self.click_sd_px.powi(2) * (across.powi(2) + aspect.powi(4) * down.powi(2))
                / apart_px.powi(4);
        let by_length = (self.length_sd_mm / self.length_mm).powi(2);
        Ok(Spacing {
            column_mm,
            row_mm: aspect * column_mm,
            plane: SpacingPlane::Patient,
            source: match self.calibrator {
                Calibrator::Ball => SpacingSource::Ball,
                Calibrator::Ruler => SpacingSource::Ruler,
            },
            relative_sd: Some((by_click + by_length).sqrt()),
        })
    }

    fn check(&self, [columns, rows]: [u32; 2]) -> Result<(), CalibrationError> {
        let positive = |what, value: f64| {
            let good = value.is_finite() && value > 0.0;
            if good {
                Ok(())
            } else {
                Err(CalibrationError::Value { what, value, must: "positive" })
            }
        };
        let not_negative = |what, value: f64| {
            let good = value.is_finite() && value >= 0.0;
            let must = "zero or more";
            if good { Ok(()) } else { Err(CalibrationError::Value { what, value, must }) }
        };
        positive("length in mm", self.length_mm)?;
        let (calibrator, value_mm) = (self.calibrator, self.length_mm);
        let [least_mm, most_mm] = calibrator.lengths_mm();
        if !(least_mm..=most_mm).contains(&value_mm) {
            return Err(CalibrationError::Length { calibrator, value_mm, least_mm, most_mm });
        }
        positive("height of a pixel over its width", self.pixel_aspect)?;
        not_negative("standard deviation of the length in mm", self.length_sd_mm)?;
        if self.length_sd_mm > LengthScale::MAX_RELATIVE_SD * self.length_mm {
            let (what, value) = ("standard deviation of the length in mm", self.length_sd_mm);
            let must = "at most 0.3 times the length; it is in mm, not in percent";
            return Err(CalibrationError::Value { what, value, must });
        }
        not_negative("standard deviation of a point in pixels", self.click_sd_px)?;
        for click in self.clicks {
            if !click.is_finite() {
                let value = click.column_px + click.row_px;
                return Err(CalibrationError::Value {
                    what: "coordinate of a point",
                    value,
                    must: "a number",
                });
            }
            let inside = |place: f64, count: u32| (-0.5..f64::from(count) - 0.5).contains(&place);
            if !(inside(click.column_px, columns) && inside(click.row_px, rows)) {
                return Err(CalibrationError::OffPicture { point: click, columns, rows });
            }
        }
        Ok(())
    }
}
