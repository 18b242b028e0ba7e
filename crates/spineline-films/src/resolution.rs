//! Pixels of pictures without a data set: resolutions across and down (PNG `pHYs`, JPEG JFIF and Exif, TIFF), the number
//! of pictures in a file, and the text of a synthetic film. Read from the bytes, because picture decoders ignore them.

use std::fmt;

use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::FilmKind;
use super::png_file::SYNTHETIC;

spineline::named! {
    /// Unit of length of a resolution.
    pub enum ResolutionUnit {
        /// Missing: only the ratio has a meaning.
        None = "none" as "without a unit",
        /// An inch.
        Inch = "inch" as "pixels per inch",
        /// A centimetre.
        Centimetre = "centimetre" as "pixels per centimetre",
        /// A metre.
        Metre = "metre" as "pixels per metre",
    }
}

/// Pixels per unit of length, across and down.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Resolution {
    /// Across: along a row.
    pub across: f64,
    /// Down: along a column.
    pub down: f64,
    /// The unit of length.
    pub unit: ResolutionUnit,
}

/// Resolutions, in pixels per inch, that programs write for unknown ones.
const MEANINGLESS_PER_INCH: [f64; 3] = [1.0, 72.0, 96.0];

impl Resolution {
    /// Height of a pixel over its width.
    #[must_use]
    pub fn pixel_aspect(&self) -> f64 {
        self.across / self.down
    }

    /// Whether pixels are as high as wide, to a percent.
    pub(super) fn is_square(&self) -> bool {
        (self.pixel_aspect() - 1.0).abs() <= 0.01
    }

    /// Width and height of a pixel in millimetres.
    fn pixel_mm(&self) -> Option<[f64; 2]> {
        let unit_mm = match self.unit {
            ResolutionUnit::None => return None,
            ResolutionUnit::Inch => 25.4,
            ResolutionUnit::Centimetre => 10.0,
            ResolutionUnit::Metre => 1000.0,
        };
        Some([unit_mm / self.across, unit_mm / self.down])
    }

    /// Whether it may be a scale.
    pub(super) fn is_meant(&self) -> bool {
        let per_inch = self.pixel_mm().map(|[width, _]| 25.4 / width);
        per_inch.is_some_and(|dpi| {
            !MEANINGLESS_PER_INCH.iter().any(|other| (dpi / other - 1.0).abs() < 0.005)
        })
    }

    /// The option that states such a resolution of a scan.
    pub(super) fn spacing_words(&self) -> String {
        self.pixel_mm().map_or_else(String::new, |[width, height]| {
            format!(
                " (if this is the scanner's, give --spacing {},{},unknown)",
                fixed(width, 4),
                fixed(height, 4)
            )
        })
    }

    /// The resolution after a turn of the picture by a right angle.
    pub(super) const fn turned(self) -> Self {
        Self { across: self.down, down: self.across, unit: self.unit }
    }
}

impl fmt::Display for Resolution {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let round = |value: f64| (value * 1e3).round() / 1e3;
        let [across, down] = [self.across, self.down].map(round);
        write!(f, "resolutions of {across} across and {down} down, {}", self.unit)
    }
}

/// Resolution, number of pictures and origin, by the bytes of a file.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Stated {
    pub resolution: Option<Resolution>,
    /// Number of pictures of full size in the file; 0 if unknown.
    pub pictures: u32,
    /// Whether the film is synthetic.
    pub is_phantom: bool,
}

pub(super) fn stated(bytes: &[u8], kind: FilmKind) -> Stated {
    let stated = match kind {
        FilmKind::Png => png(bytes),
        FilmKind::Jpeg => jpeg(bytes),
        FilmKind::Tiff => tiff(bytes),
        FilmKind::Dicom => None,
    };
    stated.unwrap_or_default()
}

fn resolution(across: f64, down: f64, unit: ResolutionUnit) -> Option<Resolution> {
    let good = |value: f64| value.is_finite() && value > 0.0;
    (good(across) && good(down)).then_some(Resolution { across, down, unit })
}

/// Big- or little-endian numbers of some bytes.
#[derive(Clone, Copy)]
struct Numbers<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl Numbers<'_> {
    fn at<const N: usize>(&self, place: usize) -> Option<[u8; N]> {
        let end = place.checked_add(N)?;
        let mut bytes: [u8; N] = self.bytes.get(place..end)?.try_into().ok()?;
        if !self.big_endian {
            bytes.reverse();
        }
        Some(bytes)
    }

    fn u16(&self, place: usize) -> Option<u16> {
        self.at(place).map(u16::from_be_bytes)
    }

    fn u32(&self, place: usize) -> Option<u32> {
        self.at(place).map(u32::from_be_bytes)
    }

    fn u64(&self, place: usize) -> Option<u64> {
        self.at(place).map(u64::from_be_bytes)
    }
}

/// Chunks of a PNG before its pixels: `pHYs`, `tEXt` of a synthetic film, and `acTL` of an animated one.
fn png(bytes: &[u8]) -> Option<Stated> {
    let numbers = Numbers { bytes, big_endian: true };
    let (mut found, mut place) = (Stated { pictures: 1, ..Stated::default() }, 8_usize);
    loop {
        let length = usize::try_from(numbers.u32(place)?).ok()?;
        let data = place + 8;
        match bytes.get(place + 4..data)? {
            b"pHYs" => {
                let unit = match bytes.get(data + 8)? {
                    1 => ResolutionUnit::Metre,
                    _ => ResolutionUnit::None,
                };
                let [across, down] = [numbers.u32(data)?, numbers.u32(data + 4)?].map(f64::from);
                found.resolution = resolution(across, down, unit);
            }
            b"tEXt" => {
                let text = bytes.get(data..data.checked_add(length)?)?;
                found.is_phantom |= text == SYNTHETIC.join("\0").as_bytes();
            }
            b"acTL" => found.pictures = numbers.u32(data)?,
            b"IDAT" | b"IEND" => return Some(found),
            _ => {}
        }
        place = data.checked_add(length)?.checked_add(4)?;
    }
}

/// Segments of a JPEG before its pixels: JFIF, else Exif.
fn jpeg(bytes: &[u8]) -> Option<Stated> {
    let numbers = Numbers { bytes, big_endian: true };
    let (mut by_jfif, mut by_exif) = (None, None);
    let mut place = 2_usize;
    while let Some(marker) = numbers.u16(place) {
        let length = usize::from(numbers.u16(place + 2)?);
        let (data, end) = (place + 4, (place + 2).checked_add(length)?);
        let body = bytes.get(data..end)?;
        match marker {
            0xFFE0 if body.starts_with(b"JFIF\0") => {
                let unit = match body.get(7)? {
                    1 => ResolutionUnit::Inch,
                    2 => ResolutionUnit::Centimetre,
                    _ => ResolutionUnit::None,
                };
                let [across, down] =
                    [numbers.u16(data + 8)?, numbers.u16(data + 10)?].map(f64::from);
                by_jfif = resolution(across, down, unit);
            }
            0xFFE1 if body.starts_with(b"Exif\0\0") => {
                by_exif = body.get(6..).and_then(tiff).and_then(|stated| stated.resolution);
            }
            // Pixels follow.
            0xFFDA => break,
            _ => {}
        }
        place = end;
    }
    // The more informative one: unequal resolutions first, then those with a unit.
    let all = || [by_jfif, by_exif].into_iter().flatten();
    let unequal = all().find(|one| !one.is_square());
    let meant = unequal.or_else(|| all().find(Resolution::is_meant));
    Some(Stated { resolution: meant.or_else(|| all().next()), pictures: 1, ..Stated::default() })
}

/// Maximum number of directories of one file that are counted.
const MAX_DIRECTORIES: u32 = 1000;

/// Directories of a TIFF or a `BigTIFF`: the resolutions of the first, and how many are pictures of full size.
fn tiff(bytes: &[u8]) -> Option<Stated> {
    let big_endian = match bytes.get(..2)? {
        b"MM" => true,
        b"II" => false,
        _ => return None,
    };
    let numbers = Numbers { bytes, big_endian };
    let layout = match numbers.u16(2)? {
        42 => Layout { is_big: false },
        43 => Layout { is_big: true },
        _ => return None,
    };
    let mut found = Stated::default();
    let mut next = layout.offset(numbers, if layout.is_big { 8 } else { 4 });
    for count in 0..MAX_DIRECTORIES {
        let Some(place) = next.filter(|place| *place > 0) else { break };
        let Some(directory) = layout.directory(numbers, place) else { break };
        if count == 0 {
            found.resolution = directory.resolution();
        }
        // Bit 0 is a copy at a lower resolution, bit 2 a mask.
        found.pictures += u32::from(directory.kind & 0b101 == 0);
        next = directory.next;
    }
    Some(found)
}

/// Byte layout of a TIFF.
#[derive(Clone, Copy)]
struct Layout {
    is_big: bool,
}

/// Values of one directory.
#[derive(Default)]
struct Directory {
    kind: u32,
    across: Option<f64>,
    down: Option<f64>,
    unit: Option<u16>,
    next: Option<usize>,
}

impl Directory {
    fn resolution(&self) -> Option<Resolution> {
        let unit = match self.unit {
            // Inches by default.
            None | Some(2) => ResolutionUnit::Inch,
            Some(3) => ResolutionUnit::Centimetre,
            Some(_) => ResolutionUnit::None,
        };
        resolution(self.across?, self.down?, unit)
    }
}

impl Layout {
    fn offset(self, numbers: Numbers<'_>, place: usize) -> Option<usize> {
        if self.is_big {
            numbers.u64(place).and_then(|value| usize::try_from(value).ok())
        } else {
            numbers.u32(place).and_then(|value| usize::try_from(value).ok())
        }
    }

    fn directory(self, numbers: Numbers<'_>, place: usize) -> Option<Directory> {
        let (count, first, size, value) = if self.is_big {
            (usize::try_from(numbers.u64(place)?).ok()?, place.checked_add(8)?, 20, 12)
        } else {
            (usize::from(numbers.u16(place)?), place.checked_add(2)?, 12, 8)
        };
        let end = first.checked_add(count.checked_mul(size)?)?;
        if end > numbers.bytes.len() {
            return None;
        }
        let mut found = Directory { next: self.offset(numbers, end), ..Directory::default() };
        for entry in (first..end).step_by(size) {
            let at = entry + value;
            match numbers.u16(entry)? {
                254 => found.kind = numbers.u32(at)?,
                282 => found.across = self.ratio(numbers, at),
                283 => found.down = self.ratio(numbers, at),
                296 => found.unit = numbers.u16(at),
                _ => {}
            }
        }
        Some(found)
    }

    /// A rational number: inside the entry if it has eight bytes, else at its offset.
    fn ratio(self, numbers: Numbers<'_>, at: usize) -> Option<f64> {
        let place = if self.is_big { at } else { self.offset(numbers, at)? };
        let [above, below] = [numbers.u32(place)?, numbers.u32(place.checked_add(4)?)?];
        Some(f64::from(above) / f64::from(below))
    }
}
