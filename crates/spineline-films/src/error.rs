use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::Attribute;

/// Likely format of a file that is not a radiograph.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Lookalike {
    /// No bytes at all.
    Empty,
    /// A ZIP archive, or a document with that format.
    Zip,
    /// A gzip archive.
    Gzip,
    /// A PDF document.
    Pdf,
    /// A HEIC or AVIF photograph, or a video.
    Heic,
    /// A GIF picture.
    Gif,
    /// A BMP picture.
    Bmp,
    /// A WebP picture.
    Webp,
    /// An executable program.
    Program,
    /// Text, such as XML or JSON.
    Text,
    /// Nothing known.
    Unknown,
}

impl std::fmt::Display for Lookalike {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Empty => "is empty",
            Self::Zip => "looks like a ZIP archive or an office document",
            Self::Gzip => "looks like a gzip archive",
            Self::Pdf => "looks like a PDF document",
            Self::Heic => "looks like a HEIC or AVIF picture, or a video",
            Self::Gif => "looks like a GIF picture",
            Self::Bmp => "looks like a BMP picture",
            Self::Webp => "looks like a WebP picture",
            Self::Program => "looks like a program",
            Self::Text => "looks like text",
            Self::Unknown => "has an unknown format",
        })
    }
}

/// How pixels are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum Codec {
    Rle,
    Jpeg,
    JpegLossless,
    JpegLs,
    Jpeg2000,
    Deflate,
    Raster,
}

impl std::fmt::Display for Codec {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rle => "RLE",
            Self::Jpeg => "JPEG",
            Self::JpegLossless => "JPEG lossless",
            Self::JpegLs => "JPEG-LS",
            Self::Jpeg2000 => "JPEG 2000",
            Self::Deflate => "deflate",
            Self::Raster => "picture",
        })
    }
}

/// Errors of compressed pixels. The message of a decoding library is never shown, because it may quote the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CodecFault {
    /// The data end before the picture does.
    Truncated,
    /// Headers that contradict the format.
    Header,
    /// The compressed picture has another size than the data set says.
    Size {
        /// Columns and rows of the compressed picture.
        coded: [u32; 2],
        /// Columns and Rows of the data set.
        stated: [u32; 2],
    },
    /// More bits per sample than the data set declares, or an unsupported number.
    Precision {
        /// Bits of the compressed picture.
        bits: u8,
    },
    /// Lossy JPEG of more than 8 bits per sample.
    LossyPrecision {
        /// Bits of the compressed picture.
        bits: u8,
    },
    /// Another number of components than the data set states.
    Components {
        /// Components of the compressed picture.
        count: u16,
    },
    /// A part of the format that is not supported.
    Unsupported,
    /// Data that the decoder refuses.
    Corrupt,
    /// The decoding library panicked.
    Panicked,
}

impl CodecFault {
    pub(super) const fn of(self, codec: Codec) -> FilmError {
        FilmError::Codec { codec, fault: self }
    }
}

impl std::fmt::Display for CodecFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Truncated => f.write_str("they end too early"),
            Self::Header => f.write_str("their header contradicts the format"),
            Self::Size { coded: [a, b], stated: [c, d] } => {
                write!(f, "they are {a} columns by {b} rows, and the file says {c} by {d}")
            }
            Self::Precision { bits } => write!(
                f,
                "they have {bits} bits per sample, which their decoder or the file's Bits Allocated does not hold"
            ),
            Self::LossyPrecision { bits } => write!(f, "{bits}-bit lossy JPEG is not supported"),
            Self::Components { count } => write!(f, "they have {count} components"),
            Self::Unsupported => f.write_str("they use a part of the format that is not supported"),
            Self::Corrupt => f.write_str("the decoder rejects them"),
            Self::Panicked => f.write_str("the decoder failed"),
        }
    }
}

/// A file that cannot be read as a film. Messages contain attributes, numbers and fixed texts; never a value that may name a
/// patient.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FilmError {
    /// Another kind of file.
    #[error("not a radiograph: the file {looks_like}")]
    NotAFilm {
        /// Likely format.
        looks_like: Lookalike,
    },
    /// A limit of [`FilmLimits`](super::FilmLimits).
    #[error("{what}: {found} is more than the limit of {limit}")]
    TooLarge {
        /// What is too large.
        what: Measure,
        /// Size, or a lower bound of it.
        found: u64,
        /// Limit.
        limit: u64,
    },
    /// The file ends before its data set does.
    #[error("the file is truncated: it ends {place}")]
    Truncated {
        /// Where.
        place: Place,
    },
    /// An element that claims more bytes than the file has.
    #[error(
        "{attribute} declares {length} bytes, but only {remaining} are left: the file is truncated or damaged"
    )]
    Length {
        /// Which.
        attribute: Attribute,
        /// Declared length.
        length: u64,
        /// Actual size.
        remaining: u64,
    },
    /// An element whose form contradicts the standard.
    #[error("{attribute} is damaged: {fault}")]
    Element {
        /// Which.
        attribute: Attribute,
        /// How.
        fault: ElementFault,
    },
    /// A data set that dicom-rs refuses.
    #[error("its data set is damaged")]
    DataSet,
    /// A transfer syntax that cannot be read.
    #[error("its transfer syntax {} cannot be read", .uid.as_deref().unwrap_or("(malformed)"))]
    TransferSyntax {
        /// The UID, if it is one of the standard's.
        uid: Option<String>,
    },
    /// Not a radiograph, by its modality.
    #[error("its modality is {}, but a radiograph is needed", .modality.as_deref().unwrap_or("unknown"))]
    Modality {
        /// The modality, if the standard knows it.
        modality: Option<String>,
    },
    /// A data set without a picture.
    #[error("the file has no picture: {missing} is missing")]
    NoPixels {
        /// What is missing.
        missing: Attribute,
    },
    /// More than one frame.
    #[error("it holds {frames} frames or pages, but a film has one")]
    Frames {
        /// How many; 0 if the value is damaged.
        frames: u32,
    },
    /// Colour, where grey is needed.
    #[error("{photometric}")]
    Photometric {
        /// What it is.
        photometric: UnsupportedPhotometric,
    },
    /// An arrangement of bits that is not supported.
    #[error("{attribute} is {value}, which is not supported")]
    PixelFormat {
        /// Which attribute.
        attribute: Attribute,
        /// Its value.
        value: u32,
    },
    /// Fewer pixels than declared.
    #[error("the picture needs {needed} bytes, but has {found}")]
    PixelsMissing {
        /// Rows by columns by bytes of a sample.
        needed: u64,
        /// Actual size.
        found: u64,
    },
    /// Compressed pixels that cannot be decoded.
    #[error("the {codec} pixels cannot be decoded: {fault}")]
    Codec {
        /// How they are compressed.
        codec: Codec,
        /// Why.
        fault: CodecFault,
    },
    /// Compressed pixels with values beyond Bits Stored, where text may hide that de-identification cannot remove
    /// without changing the picture.
    #[error(
        "some pixel values exceed the {bits_stored} bits that Bits Stored (0028,0101) declares; text may be hidden in the bits above"
    )]
    HiddenBits {
        /// Declared bits.
        bits_stored: u8,
    },
    /// The case identifier of a de-identified film has characters other than letters, digits, dot, dash and
    /// underscore, or more than 64 characters.
    #[error("the case identifier must be 1 to 64 letters, digits, dots, dashes or underscores")]
    CaseId,
    /// The decoder could not be started.
    #[error("the decoder cannot be started ({kind})")]
    DecoderStart {
        /// Error of the operating system.
        kind: String,
    },
    /// The decoder crashed on this film.
    #[error("the decoder crashed on this film ({})", .signal.map_or_else(|| "no answer".to_owned(), |s| format!("signal {s}")))]
    DecoderDied {
        /// The signal that ended it, where there was one.
        signal: Option<i32>,
    },
    /// The decoder took too long.
    #[error("the decoder exceeded its time limit of {} s", fixed(*limit_s, 1))]
    DecoderTimeout {
        /// The limit.
        limit_s: f64,
    },
    /// The decoder needed too much memory.
    #[error("the decoder exceeded its memory limit of {limit_bytes} bytes")]
    DecoderMemory {
        /// The limit.
        limit_bytes: u64,
    },
    /// The decoder's answer is invalid.
    #[error("the decoder's answer cannot be understood")]
    DecoderAnswer,
}

/// What is limited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum Measure {
    FileBytes,
    InflatedBytes,
    Pixels,
    Depth,
    Elements,
    AnswerBytes,
}

impl std::fmt::Display for Measure {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::FileBytes => "bytes of the file",
            Self::InflatedBytes => "bytes of the inflated data set",
            Self::Pixels => "pixels of the picture",
            Self::Depth => "depth of nested sequences",
            Self::Elements => "elements of the data set",
            Self::AnswerBytes => "bytes of the decoder's answer",
        })
    }
}

/// Where a file ends too early.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum Place {
    InPreamble,
    InMeta,
    InElement,
    InSequence,
    InFragments,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::InPreamble => "in its preamble",
            Self::InMeta => "in its file meta information",
            Self::InElement => "in the header of an element",
            Self::InSequence => "in a sequence",
            Self::InFragments => "in the compressed picture",
        })
    }
}

/// How an element is damaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum ElementFault {
    /// Its value representation is not a pair of capital letters.
    ValueRepresentation,
    /// An undefined length where the standard requires a length.
    UndefinedLength,
    /// A sequence contains an element that is not an item.
    NotAnItem,
    /// A value of another type or length than in the standard.
    Value,
}

impl std::fmt::Display for ElementFault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ValueRepresentation => "it has no value representation",
            Self::UndefinedLength => "its length may not be undefined",
            Self::NotAnItem => "a sequence holds something else than items",
            Self::Value => "its value has another type or length than the standard gives it",
        })
    }
}

/// Colours that are refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
#[non_exhaustive]
pub enum UnsupportedPhotometric {
    Palette,
    Compressed,
    /// More than 8 bits per channel.
    Deep,
    Unknown,
}

impl std::fmt::Display for UnsupportedPhotometric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Palette => "colour image (PALETTE COLOR); a greyscale one is needed",
            Self::Compressed => {
                "colour image in a transfer syntax that is read for greyscale only; a greyscale one is needed"
            }
            Self::Deep => {
                "colour image with more than 8 bits per channel; a greyscale one is needed"
            }
            Self::Unknown => "its photometric interpretation is unknown and not supported",
        })
    }
}

impl FilmError {
    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::NotAFilm { .. } => {
                "films are DICOM, PNG, JPEG or TIFF files; unpack archives first, export documents as PNG"
            }
            Self::TooLarge { .. } => "export the film alone, uncropped, at its own resolution",
            Self::Truncated { .. } | Self::Length { .. } | Self::PixelsMissing { .. } => {
                "copy the file again: it is incomplete"
            }
            Self::Element { .. } | Self::DataSet => "export the film again from its archive",
            Self::Codec { fault: CodecFault::LossyPrecision { .. }, .. } => {
                "convert the file with `dcmdjpeg IN OUT` (DCMTK) or `gdcmconv --raw IN OUT` (GDCM), or export the film uncompressed"
            }
            Self::TransferSyntax { .. } | Self::Codec { .. } => {
                "export the film uncompressed or as JPEG lossless, JPEG-LS, JPEG 2000 or HTJ2K"
            }
            Self::Modality { .. } => {
                "choose a radiograph: CR, DX, RG, RF, XA, MG, or a digitised film (SC, OT, HC)"
            }
            Self::NoPixels { .. } => "choose the image object of the study, not its report or plan",
            Self::Frames { .. } => "export the one frame or page that is the film",
            Self::Photometric { .. } | Self::PixelFormat { .. } => {
                "export the film as 8 or 16 bit greyscale"
            }
            Self::HiddenBits { .. } => {
                "export the film uncompressed: then these bits are cleared; if they belong to the picture, correct Bits Stored"
            }
            Self::CaseId => "use a short pseudonym without blanks",
            Self::DecoderStart { .. } | Self::DecoderAnswer => "install the program again",
            Self::DecoderDied { .. } | Self::DecoderTimeout { .. } | Self::DecoderMemory { .. } => {
                "this film is damaged or malicious; export it again, uncompressed"
            }
        }
    }
}
