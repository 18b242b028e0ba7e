use std::borrow::Cow;
use std::fmt;

use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::{Attribute, Resolution};

/// A remark on a film's file. Contains no text of the file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FilmRemark {
    /// The file has no DICOM preamble.
    NoPreamble,
    /// The file does not state its encoding; this one fits its first bytes.
    TransferSyntaxGuessed {
        /// Name of the transfer syntax.
        name: Cow<'static, str>,
    },
    /// The file does not state the kind of its device.
    NoModality,
    /// The file states that another part of the body was examined than the spine.
    OtherBodyPart {
        /// One of the defined terms of Body Part Examined, such as `BREAST`.
        part: Cow<'static, str>,
    },
    /// An attribute with an implausible value; it is not used.
    Unusable {
        /// Which.
        attribute: Attribute,
    },
    /// The picture was in colour, and was reduced to its luminance.
    Colour {
        /// Largest difference between red, green and blue of a pixel: 0 if all pixels are grey.
        largest_difference: u8,
    },
    /// The picture was compressed with loss at some time.
    Lossy,
    /// Raw data FOR PROCESSING of a detector, not for display.
    ForProcessing,
    /// More bytes of pixels than declared; the surplus is not used.
    PixelsLeftOver {
        /// Surplus bytes.
        bytes: u64,
    },
    /// Compressed pixels hold values beyond the declared bits; they are used as they are.
    BeyondBitsStored {
        /// Declared bits.
        bits_stored: u8,
    },
    /// Photometric interpretation and Presentation LUT Shape contradict one another; the former decides.
    PolarityContradicted,
    /// Neither MONOCHROME1 nor MONOCHROME2 is stated: large values are taken as bright.
    PolarityNotStated,
    /// An invalid table or window; the full range of values is shown instead.
    LookupUnusable {
        /// Which.
        attribute: Attribute,
    },
    /// A pair of distances or a ratio in another notation than the standard's; it has only one meaning and is used.
    PairReadAs {
        /// Which.
        attribute: Attribute,
        /// Its text.
        text: Cow<'static, str>,
        /// The values as read, down first, as in the standard.
        values: [f64; 2],
    },
    /// A pair of distances or a ratio that cannot be read; it is not used.
    PairUnreadable {
        /// Which.
        attribute: Attribute,
        /// Its text.
        text: Cow<'static, str>,
    },
    /// Different resolutions across and down, which give the shape of a pixel.
    UnequalResolution(Resolution),
    /// A resolution, which is not used as a scale: it may belong to a screen or a printer, or mean nothing.
    ResolutionNotUsed(Resolution),
    /// The file states that text is burned into the picture: it may contain the patient's name.
    BurnedIn,
    /// The file does not state whether text is burned into the picture: inspect it before passing it on.
    BurnedInUnknown,
    /// The picture was turned or mirrored by its camera's orientation tag.
    CameraOrientation,
    /// The picture had transparent parts; transparency is not used.
    Transparency,
}

impl FilmRemark {
    /// Whether the file states another part of the body than the spine.
    #[must_use]
    pub const fn is_other_body_part(&self) -> bool {
        matches!(self, Self::OtherBodyPart { .. })
    }
}

impl fmt::Display for FilmRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPreamble => f.write_str("the file has no DICOM preamble"),
            Self::TransferSyntaxGuessed { name } => write!(
                f,
                "the file does not state its encoding; {name} fits its first bytes"
            ),
            Self::NoModality => f.write_str("the file does not state its modality"),
            Self::OtherBodyPart { part } => write!(
                f,
                "the file states that it shows another part of the body ({part}), not the spine"
            ),
            Self::Unusable { attribute } => {
                write!(f, "{attribute} holds a value that is not plausible; it is not used")
            }
            Self::Colour { largest_difference: 0 } => {
                f.write_str("the picture was stored in colour, but all pixels are grey")
            }
            Self::Colour { largest_difference } => write!(
                f,
                "the picture was in colour (channels differ by up to {largest_difference} of 255); its luminance is used"
            ),
            Self::Lossy => f.write_str("the picture was compressed with loss"),
            Self::ForProcessing => {
                f.write_str("the file holds raw detector data (FOR PROCESSING), not a picture for display")
            }
            Self::PixelsLeftOver { bytes } => {
                write!(f, "{bytes} bytes follow the picture; they are not used")
            }
            Self::BeyondBitsStored { bits_stored } => {
                write!(f, "some pixel values exceed {bits_stored} bits; they are used unchanged")
            }
            Self::PolarityContradicted => f.write_str(
                "Photometric Interpretation and Presentation LUT Shape contradict one another; the first one is used",
            ),
            Self::PolarityNotStated => {
                f.write_str("the file does not state whether large values are bright; this is assumed")
            }
            Self::LookupUnusable { attribute } => {
                write!(f, "{attribute} cannot be used for display")
            }
            Self::PairReadAs { attribute, text, values: [down, across] } => write!(
                f,
                "{attribute} is `{text}` and not two values with a backslash between them; it is read as {down} down and {across} across (--spacing COLUMN,ROW,PLANE states another spacing)"
            ),
            Self::PairUnreadable { attribute, text } => write!(
                f,
                "{attribute} is `{text}`, which is not two values with a backslash between them; it is not used (--spacing COLUMN,ROW,PLANE states the spacing)"
            ),
            Self::UnequalResolution(resolution) => write!(
                f,
                "the file states {resolution}: its pixels are taken as {} times as high as wide (--spacing COLUMN,ROW,PLANE states another spacing)",
                fixed(resolution.pixel_aspect(), 3)
            ),
            Self::ResolutionNotUsed(resolution) => write!(
                f,
                "the file states {resolution}; this is not used as a scale, because it may belong to a screen or a printer{}",
                resolution.spacing_words()
            ),
            Self::BurnedIn => {
                f.write_str("text is burned into the picture: inspect it before passing it on")
            }
            Self::BurnedInUnknown => f.write_str(
                "the file does not state whether text is burned into the picture: inspect it",
            ),
            Self::CameraOrientation => {
                f.write_str("the picture was rotated or mirrored according to its orientation tag")
            }
            Self::Transparency => f.write_str("the picture has transparency; it is not used"),
        }
    }
}
