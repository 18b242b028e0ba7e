//! One reading of one film.

use serde::{Deserialize, Serialize};
use spineline_store::{Corner, CrestSide, Event};
use utoipa::ToSchema;

use super::{ImageSideName, LiveView, LostChangeView, Notice, PlaneName, PostureName, Problem};

/// A new reading of a film by whoever asks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewReading {
    /// Which time, from 1.
    pub repeat: u32,
}

/// A reading as it stands, with what follows from it at once.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadingView {
    /// Reading. Its pixels are at `/api/readings/{reading}/pixels`.
    pub reading: i64,
    /// Study; absent where the reading is blinded.
    pub study: Option<String>,
    /// Film; absent where the reading is blinded.
    pub film: Option<i64>,
    /// Posture; absent where the reading is blinded.
    pub posture: Option<PostureName>,
    /// Name of the film for this reading, where it is blinded.
    pub code: Option<String>,
    /// Who reads.
    pub observer: String,
    /// Which time; absent where the reading is blinded.
    pub repeat: Option<u32>,
    /// Whether it is the asker's own; only then it can be changed.
    pub mine: bool,
    /// Whether it is finished, and so never changes.
    pub finished: bool,
    /// Whether films are made up.
    pub synthetic: bool,
    /// The picture.
    pub image: ReadingImage,
    /// Number of events: to be sent with the next one.
    pub revision: u64,
    /// How many changes can be undone.
    pub undoable: usize,
    /// How many can be done again.
    pub redoable: usize,
    /// Vertebrae with a mark, caudal first.
    pub vertebrae: Vec<VertebraView>,
    /// Superior tips of the iliac crests.
    pub crests: CrestsView,
    /// Notes, oldest first.
    pub notes: Vec<String>,
    /// All levels in the guided order: L4 to T2, then the optional T1 and L5.
    pub order: Vec<String>,
    /// What is to be marked next in the guided order.
    pub next: Option<NextMark>,
    /// Where the next vertebra is to be expected: shown, and counted only when somebody has touched it.
    pub proposal: Option<Proposal>,
    /// What is wrong with the marks: crossed or swapped corners, off the film, out of order.
    pub faults: Vec<Notice>,
    /// Changes that lost a race and are kept; in a [`ConflictAnswer`], those of the request alone.
    pub conflicts: Vec<LostChangeView>,
}

/// The picture of a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadingImage {
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Height of a pixel over its width as the film is to be shown.
    pub pixel_aspect: f64,
    /// Side of the picture on which the patient's left is.
    pub patient_left: ImageSideName,
    /// What lengths are measured in.
    pub plane: PlaneName,
    /// Spacing in words with its source.
    pub spacing_text: String,
    /// Whether it is shown with dark and bright exchanged.
    pub inverted: bool,
}

/// What is marked of a vertebra, and what follows from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct VertebraView {
    /// Level, such as `T12`.
    pub level: String,
    /// Corners placed so far.
    pub corners: Vec<CornerView>,
    /// Whether all four are placed.
    pub complete: bool,
    /// Where the diagonals cross.
    pub midpoint_px: Option<[f64; 2]>,
    /// The axis through the midpoint, as a line to draw and to turn.
    pub axis: Option<AxisView>,
}

/// A placed corner.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CornerView {
    /// Which one.
    pub corner: Corner,
    /// Where.
    pub px: [f64; 2],
}

/// The axis of a vertebra.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AxisView {
    /// Caudal end of the line to draw.
    pub from_px: [f64; 2],
    /// Cranial end.
    pub to_px: [f64; 2],
    /// Against the image's vertical, positive clockwise as seen.
    pub axis_deg: f64,
    /// Whether it was turned by hand; else it follows the corners.
    pub by_hand: bool,
    /// In words, such as `tilt 4.2° to the patient's right`.
    pub text: String,
}

/// Superior tips of the iliac crests.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CrestsView {
    /// The patient's left.
    pub left_px: Option<[f64; 2]>,
    /// The patient's right.
    pub right_px: Option<[f64; 2]>,
}

/// What is to be marked next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum NextMark {
    /// A corner.
    Corner {
        /// Level.
        level: String,
        /// Which corner.
        corner: Corner,
    },
    /// An iliac crest.
    Crest {
        /// The patient's side.
        side: CrestSide,
    },
}

/// A vertebra extrapolated from what is marked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Proposal {
    /// Level.
    pub level: String,
    /// Its four corners, in the order of marking.
    pub corners: Vec<CornerView>,
}

/// An event for a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewEvent {
    /// Revision that the one who asks has seen.
    pub expected_revision: u64,
    /// The events, all recorded or none; an accepted proposal is four of them.
    pub events: Vec<Event>,
}

/// A finish of a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Finish {
    /// Revision that the one who asks has seen.
    pub expected_revision: u64,
}

/// What would follow from events that are not recorded: while a corner is dragged.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PreviewRequest {
    /// Events upon the reading as it stands.
    pub events: Vec<Event>,
    /// An axis that is turned towards a place of the pointer; the answer's axis is rounded to 0.1°.
    pub turn_axis: Option<TurnAxis>,
}

/// An axis turned by the pointer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnAxis {
    /// Level, such as `T12`.
    pub level: String,
    /// Where the axis is to point: its cranial end.
    pub towards_px: [f64; 2],
}

/// A reading with what follows from it: the answer to a preview, and to events that were recorded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Preview {
    /// The reading with the events.
    pub reading: ReadingView,
    /// What follows for the film and the study; absent where the reading is blinded, or where it cannot be computed.
    pub live: Option<LiveView>,
}

/// A change that lost a race: it is kept, and here is how things stand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConflictAnswer {
    /// What happened.
    pub problem: Problem,
    /// The reading as it stands, to go on from; its `conflicts` are those of this request alone.
    pub reading: ReadingView,
}
