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

use serde::{Deserialize, Serialize};
use spineline::measure::{CornerName, Origin};

use crate::LandmarkError;
use crate::film::origin;
use crate::names::PointName;

/// Origins of the corners of a vertebra among the attributes of an annotation, which are texts and numbers in other programs.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct Origins {
    superior_left_origin: Option<String>,
    superior_right_origin: Option<String>,
    inferior_left_origin: Option<String>,
    inferior_right_origin: Option<String>,
}

impl From<[Origin; 4]> for Origins {
    fn from(origins: [Origin; 4]) -> Self {
        let key = |place: usize| Some(origins[place].key().to_owned());
        Self {
            superior_left_origin: key(0),
            superior_right_origin: key(1),
            inferior_left_origin: key(2),
            inferior_right_origin: key(3),
        }
    }
}

impl Origins {
    /// The origin of a keypoint, if stated.
    fn of(&self, name: PointName, at: &str) -> Result<Option<Origin>, LandmarkError> {
        let PointName::Corner(_, corner) = name else { return Ok(None) };
        let key = match corner {
            CornerName::SuperiorLeft => &self.superior_left_origin,
            CornerName::SuperiorRight => &self.superior_right_origin,
            CornerName::InferiorLeft => &self.inferior_left_origin,
            CornerName::InferiorRight => &self.inferior_right_origin,
        };
        key.as_ref().map(|key| origin(key, at)).transpose()
    }
}
