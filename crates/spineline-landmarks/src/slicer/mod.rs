//! Point lists of 3D Slicer (`.mrk.json`).
//!
//! # Frames
//! The file must state `LPS` or `RAS` in `coordinateSystem`: a file that is read in the wrong one is mirrored. Points
//! lie in one of two planes ([`SlicerFrame`]): the plane of a picture as Slicer loads one without a position in the
//! patient, or a coronal plane of the patient. Other points are refused.
//!
//! # Names
//! Control points are labelled `T12_superior_left`, by the patient's side (or `T12 SL`), and `iliac_crest_left`,
//! `iliac_crest_right`. Points that were never placed are skipped with a remark.
//!
//! # Descriptions of points
//! Slicer drops unknown keys when it saves a list, but keeps the description of every point. So the description
//! contains the data of the list as a small JSON object: film, observer, repeat, frame and pixel spacing, and the
//! origin of a point that was not clicked.
//!
//! # References
//! Slicer's schema of markups, version 1.0.3.

mod read;
mod write;

use serde::{Deserialize, Serialize};

pub use read::parse_slicer;
pub(super) use write::write;

use crate::film::SlicerFrame;

/// Description of every point in lists of Spineline.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    /// Version of this description.
    spineline: u32,
    film: String,
    observer: String,
    repeat: u32,
    frame: SlicerFrame,
    /// Column and row spacing of the coordinates, in the image's frame.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    spacing_mm: Option<[f64; 2]>,
    /// Origin of the point, if it was not clicked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    origin: Option<String>,
}

/// Points may be off their plane by rounding only.
const PLANE_TOLERANCE_MM: f64 = 0.1;
