//! Tables and windows that turn stored values into grey, as a file states them.

use dicom_core::Tag;
use dicom_core::value::PrimitiveValue;
use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use serde::{Deserialize, Serialize};

use super::FilmRemark;
use super::element::{Attributes, number, numbers};

/// A table of up to 65536 values.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lut {
    /// The input to which the first value belongs; smaller inputs get the same value.
    pub first: i32,
    /// Bits of an output: 8 to 16.
    pub bits: u8,
    /// Outputs. Never empty.
    pub values: Vec<u16>,
}

impl Lut {
    /// The output for an input; inputs beyond either end get the value of that end.
    #[must_use]
    pub fn apply(&self, input: i32) -> u16 {
        let last = self.values.len().saturating_sub(1);
        let index = usize::try_from(input.saturating_sub(self.first)).unwrap_or(0).min(last);
        self.values.get(index).copied().unwrap_or_default()
    }
}

/// Stored values to device values: the first step of the pipeline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum ModalityTransform {
    /// `slope · stored + intercept`.
    Rescale {
        /// Never zero.
        slope: f64,
        /// Added.
        intercept: f64,
    },
    /// A table.
    Lut(Lut),
}

impl ModalityTransform {
    /// Nothing to do.
    pub const IDENTITY: Self = Self::Rescale { slope: 1.0, intercept: 0.0 };

    /// The value of the device for a stored one.
    #[must_use]
    pub fn apply(&self, stored: i32) -> f64 {
        match self {
            Self::Rescale { slope, intercept } => slope * f64::from(stored) + intercept,
            Self::Lut(lut) => f64::from(lut.apply(stored)),
        }
    }
}

/// Shape of a window: VOI LUT Function (0028,1056).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum WindowFunction {
    Linear,
    LinearExact,
    Sigmoid,
}

/// Which values are shown between black and white, after the modality's transform.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Window Center (0028,1050).
    pub center: f64,
    /// Window Width (0028,1051).
    pub width: f64,
    /// Its shape.
    pub function: WindowFunction,
}

impl Window {
    /// Whether centre and width are valid: finite, and a width of at least 1, or above 0 where the function allows.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        let least = match self.function {
            WindowFunction::Linear => self.width >= 1.0,
            WindowFunction::LinearExact | WindowFunction::Sigmoid => self.width > 0.0,
        };
        least && self.width.is_finite() && self.center.is_finite()
    }

    /// Brightness of a value, 0 to 1.
    ///
    /// # References
    /// DICOM PS3.3, C.11.2.1.2 and C.11.2.1.3.
    #[must_use]
    pub fn apply(&self, value: f64) -> f64 {
        let Self { center, width, function } = *self;
        match function {
            // A width of 1 is a step between two neighbouring values.
            WindowFunction::Linear if value <= center - 0.5 - (width - 1.0) / 2.0 => 0.0,
            WindowFunction::Linear if value > center - 0.5 + (width - 1.0) / 2.0 => 1.0,
            WindowFunction::Linear => (value - (center - 0.5)) / (width - 1.0) + 0.5,
            WindowFunction::LinearExact => ((value - center) / width + 0.5).clamp(0.0, 1.0),
            WindowFunction::Sigmoid => 1.0 / (1.0 + (-4.0 * (value - center) / width).exp()),
        }
    }
}

/// The second step of the pipeline: values of interest.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub enum Voi {
    /// A table.
    Lut(Lut),
    /// A window.
    Window(Window),
}

/// How a film's values become grey, by its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Look {
    /// Stored values to device values.
    pub modality: ModalityTransform,
    /// Tables and windows to show, in the file's order, tables first; the first one is the default. Empty:
    /// the whole range.
    pub voi: Vec<Voi>,
    /// Stored values outside of the picture, both ends included.
    pub padding: Option<[i32; 2]>,
}

impl Look {
    /// For a picture without tables or windows.
    #[must_use]
    pub const fn plain() -> Self {
        Self { modality: ModalityTransform::IDENTITY, voi: Vec::new(), padding: None }
    }
}

/// Reads the tables and windows of a data set; invalid ones get a remark.
pub(super) fn look(data: &InMemDicomObject, remarks: &mut Vec<FilmRemark>) -> Look {
    let signed = matches!(data.word(tags::PIXEL_REPRESENTATION), Ok(Some(1)));
    let modality = modality(data, signed, remarks);
    let below_zero = match modality {
        ModalityTransform::Rescale { slope, intercept } => signed || intercept < 0.0 || slope < 0.0,
        ModalityTransform::Lut(_) => false,
    };
    let mut voi = Vec::new();
    if let Some(item) = data.item(tags::VOILUT_SEQUENCE) {
        match lut(item, below_zero) {
            Some(table) => voi.push(Voi::Lut(table)),
            None => remarks.push(FilmRemark::lookup_unusable(tags::VOILUT_SEQUENCE)),
        }
    }
    voi.extend(windows(data, remarks).into_iter().map(Voi::Window));
    let padding = data.word(tags::PIXEL_PADDING_VALUE).ok().flatten().map(|value| {
        let limit = data.word(tags::PIXEL_PADDING_RANGE_LIMIT).ok().flatten().unwrap_or(value);
        let [a, b] = [value, limit].map(|word| signed_word(word, signed));
        [a.min(b), a.max(b)]
    });
    Look { modality, voi, padding }
}

fn modality(
    data: &InMemDicomObject,
    signed: bool,
    remarks: &mut Vec<FilmRemark>,
) -> ModalityTransform {
    if let Some(item) = data.item(tags::MODALITY_LUT_SEQUENCE) {
        match lut(item, signed) {
            Some(table) => return ModalityTransform::Lut(table),
            None => remarks.push(FilmRemark::lookup_unusable(tags::MODALITY_LUT_SEQUENCE)),
        }
    }
    let slope = match number(data, tags::RESCALE_SLOPE, remarks) {
        Some(slope) if slope.abs() < 1e-12 || slope.abs() > 1e12 => {
            remarks.push(FilmRemark::unusable(tags::RESCALE_SLOPE));
            return ModalityTransform::IDENTITY;
        }
        slope => slope.unwrap_or(1.0),
    };
    let intercept = number(data, tags::RESCALE_INTERCEPT, remarks).unwrap_or(0.0);
    ModalityTransform::Rescale { slope, intercept }
}

fn windows(data: &InMemDicomObject, remarks: &mut Vec<FilmRemark>) -> Vec<Window> {
    let function = match data.text(tags::VOILUT_FUNCTION).as_deref() {
        None | Some("LINEAR") => WindowFunction::Linear,
        Some("LINEAR_EXACT") => WindowFunction::LinearExact,
        Some("SIGMOID") => WindowFunction::Sigmoid,
        Some(_) => {
            remarks.push(FilmRemark::lookup_unusable(tags::VOILUT_FUNCTION));
            return Vec::new();
        }
    };
    let centers = numbers(data, tags::WINDOW_CENTER, remarks).unwrap_or_default();
    let widths = numbers(data, tags::WINDOW_WIDTH, remarks).unwrap_or_default();
    let windows: Vec<_> = centers
        .iter()
        .zip(&widths)
        .map(|(&center, &width)| Window { center, width, function })
        .collect();
    if centers.len() != widths.len() || !windows.iter().all(Window::is_valid) {
        remarks.push(FilmRemark::lookup_unusable(tags::WINDOW_WIDTH));
    }
    windows.into_iter().filter(Window::is_valid).collect()
}

fn signed_word(word: u16, signed: bool) -> i32 {
    if signed { i32::from(word.cast_signed()) } else { i32::from(word) }
}

/// The table of one item of a LUT sequence; `None` if descriptor and data do not agree.
///
/// # References
/// DICOM PS3.3, C.11.1.1 and C.11.2.1.1: 0 entries are 65536; entries of 8 bits may be packed two to a word.
fn lut(item: &InMemDicomObject, signed: bool) -> Option<Lut> {
    let [entries, first, bits] = item.words(tags::LUT_DESCRIPTOR)?[..] else { return None };
    let entries = if entries == 0 { 65536 } else { usize::from(entries) };
    let bits = u8::try_from(bits).ok().filter(|bits| (8..=16).contains(bits))?;
    let values: Vec<u16> = match item.primitive(tags::LUT_DATA)?.1 {
        PrimitiveValue::U16(words) if words.len() == entries => words.to_vec(),
        // Packed: the low byte of a word comes first.
        PrimitiveValue::U16(words) if bits == 8 && words.len() == entries.div_ceil(2) => {
            let pairs = words.iter().flat_map(|word| [word & 0xFF, word >> 8]);
            pairs.take(entries).collect()
        }
        PrimitiveValue::U8(bytes) if bytes.len() == 2 * entries => item.words(tags::LUT_DATA)?,
        PrimitiveValue::U8(bytes) if bits == 8 && bytes.len().abs_diff(entries) <= 1 => {
            bytes.get(..entries)?.iter().map(|&byte| u16::from(byte)).collect()
        }
        _ => return None,
    };
    Some(Lut { first: signed_word(first, signed), bits, values })
}

/// The unchanged descriptor and data of an item of a LUT sequence, if they make a table.
pub(super) fn whole_table(item: &InMemDicomObject) -> Option<[PrimitiveValue; 2]> {
    lut(item, false)?;
    let part = |tag: Tag| item.primitive(tag).map(|(_, value)| value.clone());
    Some([part(tags::LUT_DESCRIPTOR)?, part(tags::LUT_DATA)?])
}
