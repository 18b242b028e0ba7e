//! Events: the entries of a reading's journal.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use spineline::anatomy::{FilmView, Level, Side};
use spineline::measure::{Corners, Origin};
use utoipa::ToSchema;

use crate::wire::{OriginName, SideName, Wire};

spineline::named! {
    /// A corner of a vertebral body, by endplate and by the patient's side on a frontal film, or by front and back on the lateral one.
    pub enum Corner {
        /// Superior endplate, patient's left.
        SuperiorLeft = "superior_left",
        /// Superior endplate, patient's right.
        SuperiorRight = "superior_right",
        /// Inferior endplate, patient's left.
        InferiorLeft = "inferior_left",
        /// Inferior endplate, patient's right.
        InferiorRight = "inferior_right",
        /// Superior endplate, front.
        SuperiorAnterior = "superior_anterior",
        /// Superior endplate, back.
        SuperiorPosterior = "superior_posterior",
        /// Inferior endplate, front.
        InferiorAnterior = "inferior_anterior",
        /// Inferior endplate, back.
        InferiorPosterior = "inferior_posterior",
    }
}

/// A corner with its schema.
pub type CornerName = Wire<Corner>;

impl Corner {
    /// Number of corners of a body on one film.
    pub const COUNT: usize = 4;

    /// The corners of a body on a frontal film.
    pub const FRONTAL: Corners<Self> = Corners {
        superior_left: Self::SuperiorLeft,
        superior_right: Self::SuperiorRight,
        inferior_left: Self::InferiorLeft,
        inferior_right: Self::InferiorRight,
    };

    /// The corners of a body on the lateral film, with the front in the place of the left, as
    /// [`parse_image`](spineline_files::parse_image) takes its picture.
    pub const LATERAL: Corners<Self> = Corners {
        superior_left: Self::SuperiorAnterior,
        superior_right: Self::SuperiorPosterior,
        inferior_left: Self::InferiorAnterior,
        inferior_right: Self::InferiorPosterior,
    };

    /// The corners of a body in a view.
    #[must_use]
    pub const fn of_view(view: FilmView) -> Corners<Self> {
        match view {
            FilmView::Frontal(_) => Self::FRONTAL,
            FilmView::Lateral => Self::LATERAL,
        }
    }

    /// Whether a film of this view shows it.
    pub(crate) fn is_seen_on(self, view: FilmView) -> bool {
        Self::of_view(view).points().contains(&self)
    }
}

/// A vertebra whose corners were expected by the program and accepted by the reader.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AcceptedVertebra {
    /// Vertebra.
    #[schema(value_type = String)]
    pub level: Level,
    /// Its corners, column and row in pixels.
    #[schema(value_type = std::collections::BTreeMap<String, [f64; 2]>)]
    pub corners: BTreeMap<Corner, [f64; 2]>,
    /// Standard deviation of a corner as a part of the height of the body, where a program found them in the picture; none
    /// where they were completed from other landmarks.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sd_share: Option<f64>,
}

/// One action of a reader, as JSON with a `kind`. Places are in pixels of the film, column and row, sub-pixel.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum Event {
    /// Place a corner, with or without an earlier place.
    PlaceCorner {
        /// Vertebra.
        #[schema(value_type = String)]
        level: Level,
        /// Which corner.
        #[schema(value_type = CornerName)]
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
        level: Level,
        /// Which corner.
        #[schema(value_type = CornerName)]
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
        level: Level,
        /// The patient's side.
        #[schema(value_type = SideName)]
        side: Side,
        /// Column.
        column_px: f64,
        /// Row.
        row_px: f64,
    },
    /// Place the centre of a pedicle, with or without an earlier place.
    PlacePedicle {
        /// Vertebra.
        #[schema(value_type = String)]
        level: Level,
        /// The patient's side.
        #[schema(value_type = SideName)]
        side: Side,
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
    /// Take a vertebra from a case file, with some corners from a program.
    TakeVertebra {
        /// Vertebra.
        #[schema(value_type = String)]
        level: Level,
        /// Its four corners, column and row in pixels.
        #[schema(value_type = std::collections::BTreeMap<String, [f64; 2]>)]
        corners: BTreeMap<Corner, [f64; 2]>,
        /// Origins of the corners that were not clicked.
        #[schema(value_type = std::collections::BTreeMap<String, OriginName>)]
        origins: BTreeMap<Corner, Origin>,
        /// Standard deviation of a corner as a part of the height of the body, where it is stated.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        sd_share: Option<f64>,
    },
    /// Set an axis by hand, or reset it to the corners.
    SetAxis {
        /// Vertebra.
        #[schema(value_type = String)]
        level: Level,
        /// Against the image's vertical, positive clockwise with square pixels (in millimetres, not in columns and rows);
        /// none to follow the corners.
        axis_deg: Option<f64>,
    },
    /// Remove the landmarks of a vertebra.
    RemoveVertebra {
        /// Vertebra.
        #[schema(value_type = String)]
        level: Level,
    },
    /// Give all vertebrae the level above, or below: all were counted one too low, or too high.
    ShiftLevels {
        /// Whether to the level above.
        up: bool,
    },
    /// The superior tip of an iliac crest.
    PlaceIliacCrest {
        /// The patient's side.
        #[schema(value_type = SideName)]
        side: Side,
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

impl Event {
    /// Whether a film of this view shows its landmark.
    pub(crate) fn fits(&self, view: FilmView) -> bool {
        match self {
            Self::PlaceCorner { corner, .. } | Self::MoveCorner { corner, .. } => {
                corner.is_seen_on(view)
            }
            Self::AcceptCorners { vertebrae } => vertebrae
                .iter()
                .flat_map(|one| one.corners.keys())
                .all(|corner| corner.is_seen_on(view)),
            Self::TakeVertebra { corners, .. } => {
                corners.keys().all(|corner| corner.is_seen_on(view))
            }
            Self::PlaceWall { .. }
            | Self::PlacePedicle { .. }
            | Self::SetAxis { .. }
            | Self::PlaceIliacCrest { .. } => view != FilmView::Lateral,
            Self::RemoveVertebra { .. }
            | Self::ShiftLevels { .. }
            | Self::Scale { .. }
            | Self::Invert { .. }
            | Self::Undo
            | Self::Redo
            | Self::Note { .. } => true,
        }
    }

    /// Whether it makes sense only where the program may propose corners.
    pub(crate) const fn needs_proposals(&self) -> bool {
        matches!(
            self,
            Self::AcceptCorners { .. } | Self::PlaceWall { .. } | Self::TakeVertebra { .. }
        )
    }
}
