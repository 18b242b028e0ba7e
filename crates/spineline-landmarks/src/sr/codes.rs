//! Coded concepts.

use spineline::anatomy::{Level, Posture, Region, Side};
use spineline::measure::{CornerName, Origin};

/// Designator of this program's coding scheme; its values have at most the 16 characters of a Code Value.
pub const SCHEME: &str = "99SPINELINE";
pub const SCHEME_NAME: &str = "Spineline";

/// A code: value, scheme, meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Code(pub &'static str, pub &'static str, pub &'static str);

// Document structure: DICOM PS3.16, TID 1500, 1501, 1600 and those that they include.
pub const REPORT: Code = Code("126000", "DCM", "Imaging Measurement Report");
pub const LANGUAGE: Code = Code("121049", "DCM", "Language of Content Item and Descendants");
pub const ENGLISH: Code = Code("en", "RFC5646", "English");
pub const OBSERVER_TYPE: Code = Code("121005", "DCM", "Observer Type");
pub const PERSON: Code = Code("121006", "DCM", "Person");
pub const DEVICE: Code = Code("121007", "DCM", "Device");
pub const PERSON_NAME: Code = Code("121008", "DCM", "Person Observer Name");
pub const DEVICE_UID: Code = Code("121012", "DCM", "Device Observer UID");
pub const DEVICE_NAME: Code = Code("121013", "DCM", "Device Observer Name");
pub const DEVICE_MODEL: Code = Code("121015", "DCM", "Device Observer Model Name");
pub const PROCEDURE: Code = Code("121058", "DCM", "Procedure reported");
pub const RADIOGRAPHY: Code = Code("168537006", "SCT", "Plain radiography");
pub const LIBRARY: Code = Code("111028", "DCM", "Image Library");
pub const LIBRARY_GROUP: Code = Code("126200", "DCM", "Image Library Group");
pub const MODALITY: Code = Code("121139", "DCM", "Modality");
pub const MEASUREMENTS: Code = Code("126010", "DCM", "Imaging Measurements");
pub const GROUP: Code = Code("125007", "DCM", "Measurement Group");
pub const TRACKING: Code = Code("112039", "DCM", "Tracking Identifier");
pub const TRACKING_UID: Code = Code("112040", "DCM", "Tracking Unique Identifier");
pub const SESSION: Code = Code("C67447", "NCIt", "Activity Session");
pub const FINDING: Code = Code("121071", "DCM", "Finding");
pub const SITE: Code = Code("363698007", "SCT", "Finding Site");
pub const METHOD: Code = Code("370129005", "SCT", "Measurement Method");
pub const SOURCE: Code = Code("121112", "DCM", "Source of Measurement");

// What is measured.
pub const COBB: Code = Code("285285000", "SCT", "Cobb angle");
pub const TILT: Code = Code("tilt", SCHEME, "Frontal tilt, positive to the patient's right");
pub const COLUMN: Code = Code("location-column", SCHEME, "Column of the crossing of the diagonals");
pub const ROW: Code = Code("location-row", SCHEME, "Row of the crossing of the diagonals");
pub const ILIAC_TILT: Code =
    Code("iliac-lean", SCHEME, "Tilt of the iliac line's normal, positive to the right");
pub const BY_HAND: Code = Code("axis-by-hand", SCHEME, "Axis of the body set by hand");
pub const BY_ENDPLATES: Code = Code("endplates", SCHEME, "Mean direction of both endplates");
pub const AXIS: Code =
    Code("axis", SCHEME, "Axis set by hand, clockwise from the image's vertical");
pub const POSTURE: Code = Code("posture", SCHEME, "Posture of the patient");
pub const CONVEXITY: Code = Code("convexity", SCHEME, "Side of convexity");
pub const VERTEBRA: Code = Code("vertebra", SCHEME, "Vertebral body by its four corners");
pub const ILIAC_LINE: Code =
    Code("iliac-line", SCHEME, "Line through the tips of the iliac crests");

// Places. Vertebrae: CID 7603.
pub const ILIAC_CREST: Code = Code("29850006", "SCT", "Iliac Crest");
pub const DEGREE: Code = Code("deg", "UCUM", "degree");
pub const PIXEL: Code = Code("{pixels}", "UCUM", "pixels");

/// A vertebra (CID 7603).
pub const fn vertebra(level: Level) -> Code {
    match level {
        Level::L5 => Code("49668003", "SCT", "L5 vertebra"),
        Level::L4 => Code("11994002", "SCT", "L4 vertebra"),
        Level::L3 => Code("36470004", "SCT", "L3 vertebra"),
        Level::L2 => Code("14293000", "SCT", "L2 vertebra"),
        Level::L1 => Code("66794005", "SCT", "L1 vertebra"),
        Level::T12 => Code("23215003", "SCT", "T12 vertebra"),
        Level::T11 => Code("12989004", "SCT", "T11 vertebra"),
        Level::T10 => Code("7610001", "SCT", "T10 vertebra"),
        Level::T9 => Code("82687006", "SCT", "T9 vertebra"),
        Level::T8 => Code("11068009", "SCT", "T8 vertebra"),
        Level::T7 => Code("62487009", "SCT", "T7 vertebra"),
        Level::T6 => Code("45296009", "SCT", "T6 vertebra"),
        Level::T5 => Code("56401006", "SCT", "T5 vertebra"),
        Level::T4 => Code("73071006", "SCT", "T4 vertebra"),
        Level::T3 => Code("1626008", "SCT", "T3 vertebra"),
        Level::T2 => Code("53733008", "SCT", "T2 vertebra"),
        Level::T1 => Code("64864005", "SCT", "T1 vertebra"),
    }
}

/// A posture.
pub const fn posture(posture: Posture) -> Code {
    match posture {
        Posture::Erect => Code("erect", SCHEME, "Erect"),
        Posture::LeftBending => Code("left_bending", SCHEME, "Bending to the left"),
        Posture::RightBending => Code("right_bending", SCHEME, "Bending to the right"),
        Posture::Neutral => Code("neutral", SCHEME, "Lying at rest"),
        Posture::Traction => Code("traction", SCHEME, "Lying under traction"),
    }
}

/// The name of the origin of a corner.
pub const fn origin_of(corner: CornerName) -> Code {
    match corner {
        CornerName::SuperiorLeft => Code("origin-sup-left", SCHEME, "Origin, superior left corner"),
        CornerName::SuperiorRight => {
            Code("origin-sup-right", SCHEME, "Origin, superior right corner")
        }
        CornerName::InferiorLeft => Code("origin-inf-left", SCHEME, "Origin, inferior left corner"),
        CornerName::InferiorRight => {
            Code("origin-inf-right", SCHEME, "Origin, inferior right corner")
        }
    }
}

/// How a corner came about.
pub const fn origin(origin: Origin) -> Code {
    match origin {
        Origin::Clicked => Code("clicked", SCHEME, "Clicked by a person"),
        Origin::Completed => Code("completed", SCHEME, "Completed from other landmarks"),
        Origin::Detected => Code("detected", SCHEME, "Found by a program in the picture"),
        Origin::Accepted => Code("accepted", SCHEME, "Proposed by a program, accepted by a person"),
        Origin::Adjusted => Code("adjusted", SCHEME, "Proposed by a program, moved by a person"),
    }
}

/// A region with a curve.
pub const fn region(region: Region) -> Code {
    match region {
        Region::ThoracolumbarLumbar => Code("curve-tl-l", SCHEME, "Thoracolumbar or lumbar curve"),
        Region::MainThoracic => Code("curve-mt", SCHEME, "Main thoracic curve"),
        Region::ProximalThoracic => Code("curve-pt", SCHEME, "Proximal thoracic curve"),
    }
}

/// A side of the patient.
pub const fn side(side: Side) -> Code {
    match side {
        Side::Left => Code("7771000", "SCT", "Left"),
        Side::Right => Code("24028007", "SCT", "Right"),
    }
}

/// A modality that takes radiographs (CID 29).
pub fn modality(value: &str) -> Option<Code> {
    match value {
        "DX" => Some(Code("DX", "DCM", "Digital Radiography")),
        "CR" => Some(Code("CR", "DCM", "Computed Radiography")),
        "RF" => Some(Code("RF", "DCM", "Radiofluoroscopy")),
        "OT" => Some(Code("OT", "DCM", "Other Modality")),
        _ => None,
    }
}
