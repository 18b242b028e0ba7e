//! Events: the entries of a reading's journal.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use spineline::anatomy::Side;
use spineline_files::LevelKey;
use utoipa::ToSchema;

/// A corner of a vertebral body, by endplate and by the patient's side.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// Superior endplate, patient's left.
    SuperiorLeft,
    /// Superior endplate, patient's right.
    SuperiorRight,
    /// Inferior endplate, patient's left.
    InferiorLeft,
    /// Inferior endplate, patient's right.
    InferiorRight,
}

impl Corner {
    /// All four.
    pub const ALL: [Self; 4] =
        [Self::SuperiorLeft, Self::SuperiorRight, Self::InferiorLeft, Self::InferiorRight];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::SuperiorLeft => "superior_left",
            Self::SuperiorRight => "superior_right",
            Self::InferiorLeft => "inferior_left",
            Self::InferiorRight => "inferior_right",
        }
    }
}

/// A side of the patient.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum PatientSide {
    /// The patient's left.
    Left,
    /// The patient's right.
    Right,
}

impl From<PatientSide> for Side {
    fn from(side: PatientSide) -> Self {
        match side {
            PatientSide::Left => Self::Left,
            PatientSide::Right => Self::Right,
        }
    }
}

/// A vertebra whose corners were expected by the program and accepted by the reader.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AcceptedVertebra {
    /// Vertebra.
    #[schema(value_type = String)]
    pub level: LevelKey,
    /// Its corners, column and row in pixels.
    #[schema(value_type = std::collections::BTreeMap<String, [f64; 2]>)]
    pub corners: BTreeMap<Corner, [f64; 2]>,
}

/// How the corners of a vertebra came about.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum CornerOrigin {
    /// Every corner was clicked.
    #[default]
    Clicked,
    /// The reader accepted corners that the program expected.
    Accepted,
    /// The reader accepted them, and then moved a corner.
    Adjusted,
}

/// One action of a reader, as JSON with a `kind`. Places are in pixels of the film, column and row, sub-pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Event {
    /// Place a corner, with or without an earlier place.
    PlaceCorner {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Which corner.
        corner: Corner,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// Move a placed corner.
    MoveCorner {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Which corner.
        corner: Corner,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// Place the midpoint of a wall, with or without an earlier place.
    PlaceWall {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// The patient's side.
        side: PatientSide,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// Accept the corners that the program expects of vertebrae, as one change.
    AcceptCorners {
        /// The vertebrae, each with its four corners.
        vertebrae: Vec<AcceptedVertebra>,
    },
    /// Set an axis by hand, or reset it to the corners.
    SetAxis {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
        /// Against the image's vertical, positive clockwise as seen with square pixels, that is in millimetres and not in
        /// columns and rows; none to follow the corners.
        axis_deg: Option<f64>,
    },
    /// Remove the landmarks of a vertebra.
    RemoveVertebra {
        /// Vertebra.
        #[schema(value_type = String)]
        level: LevelKey,
    },
    /// The superior tip of an iliac crest.
    PlaceIliacCrest {
        /// The patient's side.
        side: PatientSide,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// The scale tool: a line of known length.
    Scale {
        /// One end.
        from_px: [f64; 2],
        /// The other end.
        to_px: [f64; 2],
        /// Length.
        length_mm: f64,
    },
    /// Invert grey levels for this reading, or not.
    Invert {
        /// Whether they are inverted.
        inverted: bool,
    },
    /// Undo the last edit; notes are not edits.
    Undo,
    /// Redo the last undone edit.
    Redo,
    /// Free text, part of the reading's state only.
    Note {
        /// Text.
        text: String,
    },
}
