use std::io::ErrorKind;

use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::{Attribute, FilmKind};

spineline::named! {
    /// Likely format of a file that is not a radiograph.
    pub enum Lookalike {
        /// No bytes at all.
        Empty = "empty" as "is empty",
        /// A ZIP archive, or a document with that format.
        Zip = "zip" as "looks like a ZIP archive or an office document",
        /// A gzip archive.
        Gzip = "gzip" as "looks like a gzip archive",
        /// A PDF document.
        Pdf = "pdf" as "looks like a PDF document",
        /// A HEIC or AVIF photograph, or a video.
        Heic = "heic" as "looks like a HEIC or AVIF picture, or a video",
        /// A GIF picture.
        Gif = "gif" as "looks like a GIF picture",
        /// A BMP picture.
        Bmp = "bmp" as "looks like a BMP picture",
        /// A WebP picture.
        Webp = "webp" as "looks like a WebP picture",
        /// An executable program.
        Program = "program" as "looks like a program",
        /// Text, such as XML or JSON.
        Text = "text" as "looks like text",
        /// Nothing known.
        Unknown = "unknown" as "has an unknown format",
    }
}

spineline::named! {
    /// How pixels are packed.
    pub enum Codec {
        /// Run lengths.
        Rle = "rle" as "RLE",
        /// JPEG with loss.
        Jpeg = "jpeg" as "JPEG",
        /// JPEG without loss.
        JpegLossless = "jpeg_lossless" as "JPEG lossless",
        /// JPEG-LS.
        JpegLs = "jpeg_ls" as "JPEG-LS",
        /// JPEG 2000, or HTJ2K.
        Jpeg2000 = "jpeg_2000" as "JPEG 2000",
        /// A deflated data set.
        Deflate = "deflate",
        /// A PNG, JPEG or TIFF file.
        Raster = "raster" as "picture",
    }
}

/// Errors of compressed pixels. The message of a decoding library is never shown, because it may quote the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error, Serialize, Deserialize)]
#[non_exhaustive]
pub enum CodecFault {
    /// The data end before the picture does.
    #[error("they end too early")]
    Truncated,
    /// Headers that contradict the format.
    #[error("their header contradicts the format")]
    Header,
    /// The compressed picture has another size than the data set says.
    #[error("they are {} columns by {} rows, and the file says {} by {}", coded[0], coded[1], stated[0], stated[1])]
    Size {
        /// Columns and rows of the compressed picture.
        coded: [u32; 2],
        /// Columns and Rows of the data set.
        stated: [u32; 2],
    },
    /// More bits per sample than the data set declares, or an unsupported number.
    #[error(
        "they have {bits} bits per sample, which their decoder or the file's Bits Allocated does not hold"
    )]
    Precision {
        /// Bits of the compressed picture.
        bits: u8,
    },
    /// Lossy JPEG of more than 8 bits per sample.
    #[error("{bits}-bit lossy JPEG is not supported")]
    LossyPrecision {
        /// Bits of the compressed picture.
        bits: u8,
    },
    /// Another number of components than the data set states.
    #[error("they have {count} components")]
    Components {
        /// Components of the compressed picture.
        count: u16,
    },
    /// A part of the format that is not supported.
    #[error("they use a part of the format that is not supported")]
    Unsupported,
    /// Data that the decoder refuses.
    #[error("the decoder rejects them")]
    Corrupt,
    /// The decoding library panicked.
    #[error("the decoder failed")]
    Panicked,
}

/// An error of the operating system in words.
pub(super) fn system_words(kind: ErrorKind) -> String {
    match kind {
        ErrorKind::NotFound => "no such file".to_owned(),
        other => other.to_string(),
    }
}

impl CodecFault {
    pub(super) const fn of(self, codec: Codec) -> FilmError {
        FilmError::Codec { codec, fault: self }
    }
}

const COPY_HELP: &str = "copy the file again: it is incomplete";
const EXPORT_HELP: &str = "export the film again from its archive";
const ENCODING_HELP: &str =
    "export the film uncompressed or as JPEG lossless, JPEG-LS, JPEG 2000 or HTJ2K";
const PICTURE_COPY_HELP: &str =
    "copy the picture again, or export it again: it is incomplete or damaged";
const PICTURE_FORMAT_HELP: &str = "save the picture as PNG with 8 or 16 bits of grey";
const GREY_HELP: &str = "export the film as 8 or 16 bit greyscale";
const INSTALL_HELP: &str = "install the program again";
const DAMAGED_HELP: &str = "this film is damaged or malicious; export it again, uncompressed";

spineline::faults! {
    /// A file that cannot be read as a film. Messages contain attributes, numbers and fixed texts; never a value that may name a
    /// patient.
    #[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
    #[non_exhaustive]
    pub enum FilmError {
        /// Another kind of file.
        #[error("not a radiograph: the file {looks_like}")]
        #[help("films are DICOM, PNG, JPEG or TIFF files; unpack archives first, export documents as PNG")]
        NotAFilm {
            looks_like: Lookalike,
        },
        /// A picture where a data set is needed.
        #[error("it is a {kind} picture, and a DICOM file is needed")]
        #[help("name the DICOM file of the film")]
        NotDicom {
            /// Its format.
            kind: FilmKind,
        },
        /// A limit of [`FilmLimits`](super::FilmLimits).
        #[error("{what}: {found} is more than the limit of {limit}")]
        #[help("export the film alone, uncropped, at its own resolution")]
        TooLarge {
            what: Measure,
            /// Size, or a lower bound of it.
            found: u64,
            limit: u64,
        },
        /// The file ends before its data set does.
        #[error("the file is truncated: it ends {place}")]
        #[help(COPY_HELP)]
        Truncated {
            place: Place,
        },
        /// An element that claims more bytes than the file has.
        #[error(
            "{attribute} declares {length} bytes, but only {remaining} are left: the file is truncated or damaged"
        )]
        #[help(COPY_HELP)]
        Length {
            attribute: Attribute,
            /// Declared length.
            length: u64,
            /// Actual size.
            remaining: u64,
        },
        /// An element whose form contradicts the standard.
        #[error("{attribute} is damaged: {fault}")]
        #[help(EXPORT_HELP)]
        Element {
            attribute: Attribute,
            fault: ElementFault,
        },
        /// A data set that dicom-rs refuses.
        #[error("its data set is damaged")]
        #[help(EXPORT_HELP)]
        DataSet,
        /// A transfer syntax that cannot be read.
        #[error("its transfer syntax {} cannot be read", .uid.as_deref().unwrap_or("(malformed)"))]
        #[help(ENCODING_HELP)]
        TransferSyntax {
            /// The UID, if it is one of the standard's.
            uid: Option<String>,
        },
        /// Not a radiograph, by its modality.
        #[error("its modality is {}, but a radiograph is needed", .modality.as_deref().unwrap_or("unknown"))]
        #[help("choose a radiograph: CR, DX, RG, RF, XA, MG, or a digitised film (SC, OT, HC)")]
        Modality {
            /// The modality, if the standard knows it.
            modality: Option<String>,
        },
        /// A data set without a picture.
        #[error("the file has no picture: {missing} is missing")]
        #[help("choose the image object of the study, not its report or plan")]
        NoPixels {
            missing: Attribute,
        },
        /// More than one frame.
        #[error("it holds {frames} frames or pages, but a film has one")]
        #[help("export the one frame or page that is the film")]
        Frames {
            /// How many; 0 if the value is damaged.
            frames: u32,
        },
        /// Colour, where grey is needed.
        #[error("{photometric}")]
        #[help(GREY_HELP)]
        Photometric {
            photometric: UnsupportedPhotometric,
        },
        /// An arrangement of bits that is not supported.
        #[error("{attribute} is {value}, which is not supported")]
        #[help(GREY_HELP)]
        PixelFormat {
            attribute: Attribute,
            value: u32,
        },
        /// Fewer pixels than declared.
        #[error("the picture needs {needed} bytes, but has {found}")]
        #[help(COPY_HELP)]
        PixelsMissing {
            /// Rows by columns by bytes of a sample.
            needed: u64,
            /// Actual size.
            found: u64,
        },
        /// Compressed pixels that cannot be decoded.
        #[error("the {codec} pixels cannot be decoded: {fault}")]
        #[help(match (codec, fault) {
            (Codec::Raster, CodecFault::Unsupported) => PICTURE_FORMAT_HELP,
            (Codec::Raster, _) => PICTURE_COPY_HELP,
            (_, CodecFault::LossyPrecision { .. }) => "convert the file with `dcmdjpeg IN OUT` (DCMTK) or `gdcmconv --raw IN OUT` (GDCM), or export the film uncompressed",
            _ => ENCODING_HELP,
        })]
        Codec {
            codec: Codec,
            fault: CodecFault,
        },
        /// Compressed pixels with values beyond Bits Stored, where text may hide that de-identification cannot remove
        /// without changing the picture.
        #[error(
            "some pixel values exceed the {bits_stored} bits that Bits Stored (0028,0101) declares; text may be hidden in the bits above"
        )]
        #[help("export the film uncompressed: then these bits are cleared; if they belong to the picture, correct Bits Stored")]
        HiddenBits {
            /// Declared bits.
            bits_stored: u8,
        },
        /// The case identifier of a de-identified film has characters other than letters, digits, dot, dash and
        /// underscore, or more than 64 characters.
        #[error("the case identifier must be 1 to 64 letters, digits, dots, dashes or underscores")]
        #[help("use a short pseudonym without blanks")]
        CaseId,
        /// The decoder could not be started.
        #[error("the decoder cannot be started ({kind})")]
        #[help(INSTALL_HELP)]
        DecoderStart {
            /// Error of the operating system.
            kind: String,
        },
        /// The decoder crashed on this film.
        #[error("the decoder crashed on this film ({})", .signal.map_or_else(|| "no answer".to_owned(), |s| format!("signal {s}")))]
        #[help(DAMAGED_HELP)]
        DecoderDied {
            /// The signal that ended it, where there was one.
            signal: Option<i32>,
        },
        /// The decoder took too long.
        #[error("the decoder exceeded its time limit of {} s", fixed(*limit_s, 1))]
        #[help(DAMAGED_HELP)]
        DecoderTimeout {
            limit_s: f64,
        },
        /// The decoder needed too much memory.
        #[error("the decoder exceeded its memory limit of {limit_bytes} bytes")]
        #[help(DAMAGED_HELP)]
        DecoderMemory {
            limit_bytes: u64,
        },
        /// The decoder's answer is invalid.
        #[error("the decoder's answer cannot be understood")]
        #[help(INSTALL_HELP)]
        DecoderAnswer,
    }
}

spineline::named! {
    /// What is limited.
    pub enum Measure {
        /// The file.
        FileBytes = "file_bytes" as "bytes of the file",
        /// The data set after inflation.
        InflatedBytes = "inflated_bytes" as "bytes of the inflated data set",
        /// The picture.
        Pixels = "pixels" as "pixels of the picture",
        /// How deep sequences are nested.
        Depth = "depth" as "depth of nested sequences",
        /// The elements.
        Elements = "elements" as "elements of the data set",
        /// The answer of the process that decodes.
        AnswerBytes = "answer_bytes" as "bytes of the decoder's answer",
    }
}

impl Measure {
    /// Refuses a size above its limit.
    pub(super) const fn within(self, found: u64, limit: u64) -> Result<(), FilmError> {
        if found > limit {
            return Err(FilmError::TooLarge { what: self, found, limit });
        }
        Ok(())
    }
}

spineline::named! {
    /// Where a file ends too early.
    pub enum Place {
        /// Before the first element.
        InPreamble = "preamble" as "in its preamble",
        /// In the file meta information.
        InMeta = "meta" as "in its file meta information",
        /// In an element's tag, type or length.
        InElement = "element" as "in the header of an element",
        /// Between the items of a sequence.
        InSequence = "sequence" as "in a sequence",
        /// Between the parts of a compressed picture.
        InFragments = "fragments" as "in the compressed picture",
    }
}

spineline::named! {
    /// How an element is damaged.
    pub enum ElementFault {
        /// Its value representation is not a pair of capital letters.
        ValueRepresentation = "value_representation" as "it has no value representation",
        /// An undefined length where the standard requires a length.
        UndefinedLength = "undefined_length" as "its length may not be undefined",
        /// A sequence contains an element that is not an item.
        NotAnItem = "not_an_item" as "a sequence holds something else than items",
        /// A value of another type or length than in the standard.
        Value = "value" as "its value has another type or length than the standard gives it",
    }
}

spineline::named! {
    /// Colours that are refused.
    pub enum UnsupportedPhotometric {
        /// Numbers of colours in a table.
        Palette = "palette" as "colour image (PALETTE COLOR); a greyscale one is needed",
        /// Colour in a transfer syntax that is read for greyscale only.
        Compressed = "compressed" as "colour image in a transfer syntax that is read for greyscale only; a greyscale one is needed",
        /// More than 8 bits per channel.
        Deep = "deep" as "colour image with more than 8 bits per channel; a greyscale one is needed",
        /// Any other value.
        Unknown = "unknown" as "its photometric interpretation is unknown and not supported",
    }
}
