use std::borrow::Cow;

use dicom_core::Tag;
use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::{Attribute, Resolution};

/// A remark on a film's file. Contains no text of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[non_exhaustive]
pub enum FilmRemark {
    /// The file has no DICOM preamble.
    #[error("the file has no DICOM preamble")]
    NoPreamble,
    /// The file does not state its encoding; this one fits its first bytes.
    #[error("the file does not state its encoding; {name} fits its first bytes")]
    TransferSyntaxGuessed {
        /// Name of the transfer syntax.
        name: Cow<'static, str>,
    },
    /// The file does not state the kind of its device.
    #[error("the file does not state its modality")]
    NoModality,
    /// The file states that another part of the body was examined than the spine.
    #[error("the file states that it shows another part of the body ({part}), not the spine")]
    OtherBodyPart {
        /// One of the defined terms of Body Part Examined, such as `BREAST`.
        part: Cow<'static, str>,
    },
    /// An attribute with an implausible value; it is not used.
    #[error("{attribute} holds a value that is not plausible; it is not used")]
    Unusable {
        /// Which.
        attribute: Attribute,
    },
    /// The picture was in colour, and was reduced to its luminance.
    #[error("{}", colour_words(*largest_difference))]
    Colour {
        /// Largest difference between red, green and blue of a pixel: 0 if all pixels are grey.
        largest_difference: u8,
    },
    /// The picture was compressed with loss at some time.
    #[error("the picture was compressed with loss")]
    Lossy,
    /// Raw data FOR PROCESSING of a detector, not for display.
    #[error("the file holds raw detector data (FOR PROCESSING), not a picture for display")]
    ForProcessing,
    /// More bytes of pixels than declared; the surplus is not used.
    #[error("{bytes} bytes follow the picture; they are not used")]
    PixelsLeftOver {
        /// Surplus bytes.
        bytes: u64,
    },
    /// Compressed pixels hold values beyond the declared bits; they are used as they are.
    #[error("some pixel values exceed {bits_stored} bits; they are used unchanged")]
    BeyondBitsStored {
        /// Declared bits.
        bits_stored: u8,
    },
    /// Photometric interpretation and Presentation LUT Shape contradict one another; the former decides.
    #[error(
        "Photometric Interpretation and Presentation LUT Shape contradict one another; the first one is used"
    )]
    PolarityContradicted,
    /// Neither MONOCHROME1 nor MONOCHROME2 is stated: large values are taken as bright.
    #[error("the file does not state whether large values are bright; this is assumed")]
    PolarityNotStated,
    /// An invalid table or window; the full range of values is shown instead.
    #[error("{attribute} cannot be used for display")]
    LookupUnusable {
        /// Which.
        attribute: Attribute,
    },
    /// A pair of distances or a ratio in another notation than the standard's; it has only one meaning and is used.
    #[error("{attribute} is `{text}` and not two values with a backslash between them; it is read as {} down and {} across (--spacing COLUMN,ROW,PLANE states another spacing)", values[0], values[1])]
    PairReadAs {
        /// Which.
        attribute: Attribute,
        /// Its text.
        text: Cow<'static, str>,
        /// The values as read, down first, as in the standard.
        values: [f64; 2],
    },
    /// A pair of distances or a ratio that cannot be read; it is not used.
    #[error(
        "{attribute} is `{text}`, which is not two values with a backslash between them; it is not used (--spacing COLUMN,ROW,PLANE states the spacing)"
    )]
    PairUnreadable {
        /// Which.
        attribute: Attribute,
        /// Its text.
        text: Cow<'static, str>,
    },
    /// Different resolutions across and down, which give the shape of a pixel.
    #[error("the file states {}: its pixels are taken as {} times as high as wide (--spacing COLUMN,ROW,PLANE states another spacing)", .0, fixed(.0.pixel_aspect(), 3))]
    UnequalResolution(Resolution),
    /// A resolution, which is not used as a scale: it may belong to a screen or a printer, or mean nothing.
    #[error("the file states {}; this is not used as a scale, because it may belong to a screen or a printer{}", .0, .0.spacing_words())]
    ResolutionNotUsed(Resolution),
    /// The file states that text is burned into the picture: it may contain the patient's name.
    #[error("text is burned into the picture: inspect it before passing it on")]
    BurnedIn,
    /// The file does not state whether text is burned into the picture: inspect it before passing it on.
    #[error("the file does not state whether text is burned into the picture: inspect it")]
    BurnedInUnknown,
    /// The picture was turned or mirrored by its camera's orientation tag.
    #[error("the picture was rotated or mirrored according to its orientation tag")]
    CameraOrientation,
    /// A JPEG has no end marker, but every row.
    #[error("the end of the file is missing; all rows of the picture are there")]
    EndMissing,
    /// The picture had transparent parts; transparency is not used.
    #[error("the picture has transparency; it is not used")]
    Transparency,
}

impl FilmRemark {
    pub(super) fn unusable(tag: Tag) -> Self {
        Self::Unusable { attribute: tag.into() }
    }

    pub(super) fn lookup_unusable(tag: Tag) -> Self {
        Self::LookupUnusable { attribute: tag.into() }
    }

    /// Whether the file states another part of the body than the spine.
    #[must_use]
    pub const fn is_other_body_part(&self) -> bool {
        matches!(self, Self::OtherBodyPart { .. })
    }
}

fn colour_words(largest_difference: u8) -> String {
    match largest_difference {
        0 => "the picture was stored in colour, but all pixels are grey".to_owned(),
        _ => format!(
            "the picture was in colour (channels differ by up to {largest_difference} of 255); its luminance is used"
        ),
    }
}
