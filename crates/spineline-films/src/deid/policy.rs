//! Attributes that a de-identified film keeps. A list of allowed attributes, because a list of forbidden ones is never
//! complete: all others are removed, including private groups, overlays, curves and comments.
//!
//! # References
//! DICOM PS3.15, annex E, table E.1-1. The codes are X (removed), Z (emptied), D (replaced), U (UID replaced), K (kept).

use crate::Attribute;
use crate::tags::RADIOGRAPHS;

/// Action on one attribute.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Rule {
    /// Kept if it is made of numbers only.
    Number,
    /// Kept if all its values are words of [`is_term`].
    Terms,
    /// Kept if it is a UID of the standard itself.
    StandardUid,
    /// Replaced consistently (U).
    Uid,
    /// Emptied (Z).
    Empty,
    /// Replaced by the identifier of the case (D).
    Case,
    /// Kept if its values are directions in the patient.
    Direction,
    /// Kept if its first item has a known code; the item is written anew.
    Code,
    /// Kept if its first item is a whole table.
    Table,
    /// Kept on request: sex.
    Sex,
    /// Kept on request: age, 90 years at most.
    Age,
    /// Removed (X).
    Remove,
}

/// The action on an attribute of a film.
pub(super) fn rule(attribute: Attribute) -> Rule {
    let Attribute(group, element) = attribute;
    match (group, element) {
        (0x0010, 0x0010 | 0x0020) => Rule::Case,
        (0x0010, 0x0040) => Rule::Sex,
        (0x0010, 0x1010) => Rule::Age,
        (0x0008, 0x0020 | 0x0030 | 0x0050 | 0x0070 | 0x0090)
        | (0x0010, 0x0030)
        | (0x0020, 0x0010) => Rule::Empty,
        (0x0008, 0x0016) => Rule::StandardUid,
        (0x0008, 0x0018) | (0x0020, 0x000D | 0x000E | 0x0052) => Rule::Uid,
        (0x0020, 0x0020) => Rule::Direction,
        (0x0054, 0x0220 | 0x0410) => Rule::Code,
        (0x0028, 0x3000 | 0x3010) => Rule::Table,
        _ if TERM_ATTRIBUTES.contains(&(group, element)) => Rule::Terms,
        _ if NUMBER_ATTRIBUTES.contains(&(group, element)) => Rule::Number,
        _ => Rule::Remove,
    }
}

/// Attributes whose values are defined terms: what the picture is, and how it was taken.
const TERM_ATTRIBUTES: [(u16, u16); 26] = [
    (0x0008, 0x0008), // Image Type
    (0x0008, 0x0060), // Modality
    (0x0008, 0x0064), // Conversion Type
    (0x0008, 0x0068), // Presentation Intent Type
    (0x0018, 0x0015), // Body Part Examined
    (0x0018, 0x1147), // Field of View Shape
    (0x0018, 0x1166), // Grid
    (0x0018, 0x1402), // Cassette Orientation
    (0x0018, 0x1508), // Positioner Type
    (0x0018, 0x1700), // Collimator Shape
    (0x0018, 0x5100), // Patient Position
    (0x0018, 0x5101), // View Position
    (0x0018, 0x7004), // Detector Type
    (0x0018, 0x7034), // Field of View Horizontal Flip
    (0x0020, 0x0060), // Laterality
    (0x0020, 0x0062), // Image Laterality
    (0x0028, 0x0004), // Photometric Interpretation
    (0x0028, 0x0300), // Quality Control Image
    (0x0028, 0x0301), // Burned In Annotation
    (0x0028, 0x0A02), // Pixel Spacing Calibration Type
    (0x0028, 0x1040), // Pixel Intensity Relationship
    (0x0028, 0x1054), // Rescale Type
    (0x0028, 0x1056), // VOI LUT Function
    (0x0028, 0x2110), // Lossy Image Compression
    (0x0028, 0x2114), // Lossy Image Compression Method
    (0x2050, 0x0020), // Presentation LUT Shape
];

/// Attributes of numbers: geometry, exposure, and how pixels are to be read.
const NUMBER_ATTRIBUTES: [(u16, u16); 57] = [
    (0x0018, 0x0060), // KVP
    (0x0018, 0x1110), // Distance Source to Detector
    (0x0018, 0x1111), // Distance Source to Patient
    (0x0018, 0x1114), // Estimated Radiographic Magnification Factor
    (0x0018, 0x1149), // Field of View Dimension(s)
    (0x0018, 0x1150), // Exposure Time
    (0x0018, 0x1151), // X-Ray Tube Current
    (0x0018, 0x1152), // Exposure
    (0x0018, 0x1153), // Exposure in µAs
    (0x0018, 0x1164), // Imager Pixel Spacing
    (0x0018, 0x1190), // Focal Spot(s)
    (0x0018, 0x1405), // Relative X-Ray Exposure
    (0x0018, 0x1411), // Exposure Index
    (0x0018, 0x1412), // Target Exposure Index
    (0x0018, 0x1413), // Deviation Index
    (0x0018, 0x1510), // Positioner Primary Angle
    (0x0018, 0x1511), // Positioner Secondary Angle
    (0x0018, 0x1530), // Detector Primary Angle
    (0x0018, 0x1531), // Detector Secondary Angle
    (0x0018, 0x1702), // Collimator Left Vertical Edge
    (0x0018, 0x1704), // Collimator Right Vertical Edge
    (0x0018, 0x1706), // Collimator Upper Horizontal Edge
    (0x0018, 0x1708), // Collimator Lower Horizontal Edge
    (0x0018, 0x2010), // Nominal Scanned Pixel Spacing
    (0x0018, 0x6000), // Sensitivity
    (0x0018, 0x7020), // Detector Element Physical Size
    (0x0018, 0x7022), // Detector Element Spacing
    (0x0018, 0x7030), // Field of View Origin
    (0x0018, 0x7032), // Field of View Rotation
    (0x0018, 0x8150), // Exposure Time in µs
    (0x0018, 0x8151), // X-Ray Tube Current in µA
    (0x0020, 0x0011), // Series Number
    (0x0020, 0x0013), // Instance Number
    (0x0028, 0x0002), // Samples per Pixel
    (0x0028, 0x0006), // Planar Configuration
    (0x0028, 0x0008), // Number of Frames
    (0x0028, 0x0010), // Rows
    (0x0028, 0x0011), // Columns
    (0x0028, 0x0030), // Pixel Spacing
    (0x0028, 0x0034), // Pixel Aspect Ratio
    (0x0028, 0x0100), // Bits Allocated
    (0x0028, 0x0101), // Bits Stored
    (0x0028, 0x0102), // High Bit
    (0x0028, 0x0103), // Pixel Representation
    (0x0028, 0x0106), // Smallest Image Pixel Value
    (0x0028, 0x0107), // Largest Image Pixel Value
    (0x0028, 0x0120), // Pixel Padding Value
    (0x0028, 0x0121), // Pixel Padding Range Limit
    (0x0028, 0x1041), // Pixel Intensity Relationship Sign
    (0x0028, 0x1050), // Window Center
    (0x0028, 0x1051), // Window Width
    (0x0028, 0x1052), // Rescale Intercept
    (0x0028, 0x1053), // Rescale Slope
    (0x0028, 0x2112), // Lossy Image Compression Ratio
    (0x0028, 0x3002), // LUT Descriptor
    (0x0028, 0x9001), // Data Point Rows
    (0x0028, 0x9002), // Data Point Columns
];

/// Whether the attributes above may hold a word. Other words are not needed for measuring, and may be names.
pub(super) fn is_term(word: &str) -> bool {
    RADIOGRAPHS.contains(&word) || TERMS.contains(&word)
}

const TERMS: &[&str] = &[
    // Image type, conversion, intent, intensity.
    "ORIGINAL",
    "DERIVED",
    "PRIMARY",
    "SECONDARY",
    "POST_PROCESSED",
    "CSA",
    "RT",
    "SINGLE PLANE",
    "BIPLANE A",
    "BIPLANE B",
    "STITCHED",
    "DV",
    "DI",
    "DF",
    "WSD",
    "SD",
    "SI",
    "DRW",
    "SYN",
    "FOR PRESENTATION",
    "FOR PROCESSING",
    "LIN",
    "LOG",
    "DISP",
    "OD",
    "HU",
    "US",
    // Parts of the body.
    "SPINE",
    "WHOLESPINE",
    "CSPINE",
    "TSPINE",
    "LSPINE",
    "LSSPINE",
    "TLSPINE",
    "SSPINE",
    "CTSPINE",
    "COCCYX",
    "CHEST",
    "ABDOMEN",
    "PELVIS",
    "HIP",
    "WHOLEBODY",
    "SKULL",
    "NECK",
    "HEAD",
    "RIB",
    "STERNUM",
    "SHOULDER",
    "CLAVICLE",
    "BREAST",
    "HAND",
    "WRIST",
    "KNEE",
    "LEG",
    "FOOT",
    "ANKLE",
    "ARM",
    "ELBOW",
    "FEMUR",
    "EXTREMITY",
    // Views and positions.
    "AP",
    "PA",
    "LL",
    "RL",
    "LAT",
    "LLD",
    "RLD",
    "LLO",
    "RLO",
    "LAO",
    "RAO",
    "LPO",
    "RPO",
    "CC",
    "MLO",
    "ML",
    "LM",
    "HFP",
    "HFS",
    "HFDR",
    "HFDL",
    "FFDR",
    "FFDL",
    "FFP",
    "FFS",
    "L",
    "R",
    "B",
    "U",
    // Devices.
    "PORTRAIT",
    "LANDSCAPE",
    "RECTANGULAR",
    "ROUND",
    "HEXAGONAL",
    "RECTANGLE",
    "CIRCULAR",
    "POLYGONAL",
    "FIXED",
    "FOCUSED",
    "RECIPROCATING",
    "PARALLEL",
    "CROSSED",
    "NONE",
    "CARM",
    "COLUMN",
    "MAMMOGRAPHIC",
    "PANORAMIC",
    "CEPHALOSTAT",
    "RIGID",
    "TABLETOP",
    "DIRECT",
    "SCINTILLATOR",
    "STORAGE",
    "FILM",
    // Pixels.
    "MONOCHROME1",
    "MONOCHROME2",
    "RGB",
    "YBR_FULL",
    "YBR_FULL_422",
    "YBR_RCT",
    "YBR_ICT",
    "GEOMETRY",
    "FIDUCIAL",
    "LINEAR",
    "LINEAR_EXACT",
    "SIGMOID",
    "IDENTITY",
    "INVERSE",
    "YES",
    "NO",
    "00",
    "01",
    "ISO_10918_1",
    "ISO_14495_1",
    "ISO_15444_1",
];
