//! Keypoints in the format of COCO.
//!
//! A category is a vertebra with the keypoints `superior_left`, `superior_right`, `inferior_left` and `inferior_right`, or
//! one thing with keypoints named as in Slicer's lists, such as `T12_superior_left`. Sides are the patient's. Places count from
//! the centre of the first pixel, as in Spineline. Keypoints of visibility 0 were not placed.
//!
//! `keypoint_scores` of an annotation are confidences of its keypoints from 0 to 1, and `score` is one for all of them.
//! Files of Spineline name the film of an image and the observer and repeat of an annotation in `spineline`. Where a person did not
//! click all corners of a vertebra, the `attributes` of its annotation are `superior_left_origin` and so on.

mod read;
mod write;

pub use read::parse_coco;
pub(super) use write::{CocoFilm, write};

use spineline::measure::CornerName;

/// The attribute of an annotation with the origin of a corner.
fn origin_key(corner: CornerName) -> String {
    format!("{}_origin", corner.key())
}
