//! Grey values for the screen.

use png::BitDepth;
use spineline_marking::judge_spacing;

use super::lookup::{ModalityTransform, Voi, Window, WindowFunction};
use super::pixels::little_endian;
use super::png_file::PngFile;
use super::{FilmFile, Photometric, StoredPixels};

/// A picture for the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Display {
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Brightness row by row from the top left: 0 is black.
    pub grey: Vec<u8>,
    /// Height of a pixel over its width, where the film states it.
    pub pixel_aspect: Option<f64>,
    /// Whether the film is synthetic.
    pub is_phantom: bool,
}

impl Display {
    /// A small picture with this number of rows and square pixels; `pixel_aspect` is the height of a pixel here over
    /// its width.
    ///
    /// # Panics
    /// If the number of pixels is not `columns` times `rows`.
    #[must_use]
    pub fn thumbnail(&self, rows: u32, pixel_aspect: f64) -> Self {
        let grey = self.grey.clone();
        let picture = image::GrayImage::from_raw(self.columns, self.rows, grey)
            .expect("pixels fill the picture");
        let shape = f64::from(self.columns) / (f64::from(self.rows) * pixel_aspect);
        let columns = (f64::from(rows) * shape).round().clamp(1.0, 4.0 * f64::from(rows)) as u32;
        // Extreme spacings must not make it empty.
        let columns = columns.max(1);
        let small = image::imageops::thumbnail(&picture, columns, rows);
        Self {
            columns,
            rows,
            grey: small.into_raw(),
            pixel_aspect: Some(1.0),
            is_phantom: self.is_phantom,
        }
    }

    /// The picture as a PNG file, which states the shape of its pixels and whether it is synthetic; millimetres are left
    /// out.
    ///
    /// # Panics
    /// If the number of pixels is not `columns` times `rows`.
    #[must_use]
    pub fn to_png(&self) -> Vec<u8> {
        let file = PngFile {
            columns: self.columns,
            rows: self.rows,
            samples: &self.grey,
            depth: BitDepth::Eight,
            pixel_aspect: self.pixel_aspect,
            is_phantom: self.is_phantom,
        };
        file.bytes().expect("pixels fill the picture, and memory takes all that is written")
    }
}

/// Values for a viewer that sets window and level by itself. Greater is brighter, whatever the file's polarity.
///
/// A value corresponds to `modality_offset + modality_step · value` of the device, so a window with centre `c` and
/// width `w` has centre `(c - modality_offset) / modality_step` and width `w / |modality_step|` here.
#[derive(Debug, Clone, PartialEq)]
pub struct ScreenValues {
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Values row by row from the top left.
    pub values: Vec<u16>,
    /// The device's value of 0.
    pub modality_offset: f64,
    /// The device's difference between neighbouring values; negative where small ones are bright.
    pub modality_step: f64,
    /// Brightness of every value from 0 to the largest one, by the file's table or window.
    pub default_grey: Vec<u8>,
    /// Centre and width of the file's default window in these values; for a table, of the values between black and
    /// white.
    pub default_window: [f64; 2],
    /// All windows and tables of the file in these values, in its order; may be empty.
    pub file_windows: Vec<[f64; 2]>,
}

impl ScreenValues {
    /// The largest value; 0 without pixels.
    #[must_use]
    pub fn max(&self) -> u16 {
        self.values.iter().copied().max().unwrap_or_default()
    }

    /// The values as little-endian words, row by row.
    #[must_use]
    pub fn to_le_bytes(&self) -> Vec<u8> {
        little_endian(&self.values)
    }
}

impl FilmFile {
    /// Whether small values are bright. Photometric interpretation decides; a Presentation LUT Shape that agrees does
    /// not invert again, and one that contradicts it gives a remark.
    #[must_use]
    pub fn is_inverted(&self) -> bool {
        self.tags.photometric == Photometric::Monochrome1
    }

    /// The default display: the first table or window of the file, or the full range of values without padding.
    fn default_voi(&self) -> Voi {
        self.look.voi.first().cloned().unwrap_or_else(|| Voi::Window(self.whole_range()))
    }

    /// The window from the smallest to the largest value of the picture, padding apart.
    fn whole_range(&self) -> Window {
        let is_padding =
            |value: i32| self.look.padding.is_some_and(|[low, high]| (low..=high).contains(&value));
        let (mut low, mut high) = self.stored.range();
        if is_padding(low) || is_padding(high) {
            let within = || self.stored.iter().filter(|&value| !is_padding(value));
            // A picture of padding only keeps its range.
            low = within().min().unwrap_or(low);
            high = within().max().unwrap_or(high);
        }
        // A table need not ascend.
        let values = (low..=high).map(|value| self.look.modality.apply(value));
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        let width = (high - low).max(f64::MIN_POSITIVE);
        Window { center: f64::midpoint(low, high), width, function: WindowFunction::LinearExact }
    }

    /// The picture by the standard's pipeline: modality, values of interest, polarity.
    ///
    /// A valid `window` replaces the file's; `inverted` exchanges black and white once more, for display, and for
    /// devices that state a wrong polarity.
    #[must_use]
    pub fn display(&self, window: Option<&Window>, inverted: bool) -> Display {
        let voi = match window.filter(|window| window.is_valid()) {
            Some(window) => Voi::Window(*window),
            None => self.default_voi(),
        };
        let invert = self.is_inverted() != inverted;
        let (low, high) = self.stored.range();
        let table: Vec<u8> = (low..=high)
            .map(|stored| grey(&voi, self.look.modality.apply(stored), invert))
            .collect();
        Display {
            columns: self.columns,
            rows: self.rows,
            grey: self.map(low, &table),
            pixel_aspect: judge_spacing(&self.tags.spacing).spacing.map(|one| one.aspect()),
            is_phantom: self.tags.is_phantom,
        }
    }

    /// Values for a viewer that sets window and level, and the file's default display.
    #[must_use]
    pub fn screen_values(&self) -> ScreenValues {
        let (low, high) = self.stored.range();
        let invert = self.is_inverted();
        let modality = &self.look.modality;
        let voi = self.default_voi();
        let as_is = match modality {
            ModalityTransform::Rescale { slope, .. } => (*slope > 0.0) != invert,
            ModalityTransform::Lut(_) => !invert,
        };
        // Stored values and table entries are whole numbers, so rounding is not needed.
        let whole: Vec<i32> = (low..=high)
            .map(|stored| match modality {
                ModalityTransform::Rescale { .. } => stored,
                ModalityTransform::Lut(lut) => i32::from(lut.apply(stored)),
            })
            .collect();
        let least = whole.iter().copied().min().unwrap_or_default();
        let most = whole.iter().copied().max().unwrap_or_default();
        let code = |value: i32| if as_is { value - least } else { most - value };
        let table: Vec<u16> =
            whole.iter().map(|&value| u16::try_from(code(value)).unwrap_or(u16::MAX)).collect();
        let (zero, sign) = if as_is { (least, 1.0) } else { (most, -1.0) };
        let (modality_offset, modality_step) = match modality {
            ModalityTransform::Rescale { slope, .. } => (modality.apply(zero), sign * slope),
            ModalityTransform::Lut(_) => (f64::from(zero), sign),
        };
        let greys = |voi: &Voi| -> Vec<u8> {
            (0..=most - least)
                .map(|value| grey(voi, modality_offset + modality_step * f64::from(value), invert))
                .collect()
        };
        let window_of = |voi: &Voi| match voi {
            Voi::Window(window) => [
                (window.center - modality_offset) / modality_step,
                window.width / modality_step.abs(),
            ],
            Voi::Lut(_) => span(&greys(voi)),
        };
        ScreenValues {
            columns: self.columns,
            rows: self.rows,
            values: self.map(low, &table),
            modality_offset,
            modality_step,
            default_grey: greys(&voi),
            default_window: window_of(&voi),
            file_windows: self.look.voi.iter().map(window_of).collect(),
        }
    }

    /// Every stored value looked up in a table that starts at the smallest one.
    fn map<T: Copy>(&self, low: i32, table: &[T]) -> Vec<T> {
        let at =
            |value: i32| table[usize::try_from(value - low).expect("low is the smallest value")];
        match &self.stored {
            StoredPixels::Unsigned(values) => values.iter().map(|&v| at(i32::from(v))).collect(),
            StoredPixels::Signed(values) => values.iter().map(|&v| at(i32::from(v))).collect(),
        }
    }
}

/// Centre and width of the values between black and white.
fn span(grey: &[u8]) -> [f64; 2] {
    let low = grey.iter().position(|&value| value > 0).unwrap_or(0);
    let high = grey.iter().rposition(|&value| value < u8::MAX).unwrap_or(grey.len());
    let (low, high) = (low as f64, high as f64);
    [f64::midpoint(low, high), (high - low).max(1.0)]
}

/// Brightness of a value of the device.
fn grey(voi: &Voi, value: f64, invert: bool) -> u8 {
    let part = match voi {
        Voi::Window(window) => window.apply(value),
        Voi::Lut(lut) => {
            // The cast saturates; tables have at most 17 bits.
            let top = f64::from((1_u32 << lut.bits) - 1);
            (f64::from(lut.apply(value.round() as i32)) / top).min(1.0)
        }
    };
    let part = if invert { 1.0 - part } else { part };
    (255.0 * part).round() as u8
}
