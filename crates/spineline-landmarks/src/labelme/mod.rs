//! Annotations of labelme: points named as in Slicer's lists, or quadrilaterals named by their vertebra.
//!
//! labelme counts from the corner of the first pixel, so its coordinates are moved by half a pixel. A quadrilateral
//! does not name its corners: its superior endplate is its uppermost side, and the side of the picture with the
//! patient's left has to be known. A quadrilateral whose uppermost side is tilted by more than 40° is ambiguous and
//! refused; so is a mixture of points and quadrilaterals for one vertebra.
//!
//! A shape may have a `score`, the confidence of a program from 0 to 1, and one of the flags `origin_clicked`, `origin_completed`,
//! `origin_detected`, `origin_accepted` and `origin_adjusted`; without one it was clicked. Files of Spineline name film, observer and repeat in
//! `spineline`, which labelme keeps when it saves.

mod read;
mod write;

pub use read::parse_labelme;
pub(super) use write::write;

/// The start of a point's flag for its origin.
const FLAG: &str = "origin_";
