//! One reading of one film.

use serde::{Deserialize, Serialize};
use spineline::anatomy::Side;
use spineline::measure::Origin;
use spineline_store::{Corner, Event};
use utoipa::ToSchema;

use super::{
    CornerName, FilmViewName, ImageSideName, LiveView, LostChangeView, Notice, OriginName, Problem,
    SideName, SpacingPlaneName,
};

/// A new reading of a film by the requester.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewReading {
    /// Number of the repeat, from 1.
    pub repeat: u32,
}

/// The current state of a reading, with derived values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadingView {
    /// Reading. Its pixels are at `/api/readings/{reading}/pixels`.
    pub reading: i64,
    /// Study; absent where the reading is blinded.
    pub study: Option<String>,
    /// Film; absent where the reading is blinded.
    pub film: Option<i64>,
    /// Posture, or `lateral`; absent where the reading is blinded.
    pub posture: Option<FilmViewName>,
    /// Name of the film for this reading, where it is blinded.
    pub code: Option<String>,
    /// Observer.
    pub observer: String,
    /// Number of the repeat; absent where the reading is blinded.
    pub repeat: Option<u32>,
    /// Whether it belongs to the requester; only then it can be changed.
    pub mine: bool,
    /// Whether it is finished and can no longer be changed.
    pub finished: bool,
    /// Why it no longer counts; it can no longer be changed then.
    pub withdrawn: Option<WithdrawalView>,
    /// The reading that it corrects, and replaces when it is finished.
    pub corrects: Option<i64>,
    /// Whether films are synthetic.
    pub synthetic: bool,
    /// The picture.
    pub image: FilmImage,
    /// Number of events; to be sent with the next event.
    pub revision: u64,
    /// Number of changes that can be undone.
    pub undoable: usize,
    /// Number of changes that can be redone.
    pub redoable: usize,
    /// Vertebrae with landmarks, caudal first.
    pub vertebrae: Vec<VertebraView>,
    /// Superior tips of the iliac crests.
    pub crests: SidesView,
    /// Notes, oldest first.
    pub notes: Vec<String>,
    /// All levels in the guided order: L4 to T2, then the optional T1 and L5.
    pub order: Vec<String>,
    /// The next landmark in the guided order.
    pub next: Option<ExpectedLandmark>,
    /// The next landmark where vertebrae are marked by their walls.
    pub next_by_walls: Option<ExpectedLandmark>,
    /// Whether vertebrae may be proposed and accepted; a plan of blinded readings may forbid it.
    pub proposals_allowed: bool,
    /// Expected corners of the vertebrae without corners, in the guided order. They become part of the reading only
    /// when a person accepts or moves them.
    pub proposals: Vec<Proposal>,
    /// Errors of the landmarks: crossed or swapped corners, places off the film, wrong order.
    pub faults: Vec<Notice>,
    /// Refused changes that are kept; in a [`ConflictAnswer`], only the changes of the request.
    pub conflicts: Vec<LostChangeView>,
    /// The finished reading of the erect film, whose lengths complete this film; absent on the erect and the lateral film.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub erect: Option<i64>,
}

/// The picture of a film, as it is to be shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmImage {
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Height of a pixel over its width as the film is to be shown.
    pub pixel_aspect: f64,
    /// Whether it is the lateral film, on which vertebrae have front and back corners.
    pub is_lateral: bool,
    /// Side of the picture on which the patient's left is; of the lateral film, the patient's front.
    pub patient_left: ImageSideName,
    /// Unit and plane of lengths.
    pub plane: SpacingPlaneName,
    /// Spacing and its source as text, such as `0.143 × 0.143 mm (patient), by a ball (± 0.6 %)`.
    pub spacing_text: String,
    /// Whether it is shown with grey levels inverted relative to its file.
    pub inverted: bool,
}

/// Landmarks of a vertebra and derived values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct VertebraView {
    /// Level, such as `T12`.
    pub level: String,
    /// Corners placed so far.
    pub corners: Vec<CornerView>,
    /// Midpoints of its walls, where it was marked by them.
    pub walls: SidesView,
    /// Centres of its pedicles, as far as they are marked.
    pub pedicles: SidesView,
    /// Whether all four corners are placed.
    pub complete: bool,
    /// Intersection of the diagonals.
    pub midpoint_px: Option<[f64; 2]>,
    /// The axis through the midpoint.
    pub axis: Option<AxisView>,
    /// Its width in percent of the width on the erect film; where a film has no scale, over the median of all vertebrae.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub erect_width_percent: Option<f64>,
}

/// A corner, placed or proposed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CornerView {
    /// Name of the corner.
    #[schema(value_type = CornerName)]
    pub corner: Corner,
    /// Place.
    pub px: [f64; 2],
    /// How the place came about.
    #[schema(value_type = OriginName)]
    pub origin: Origin,
}

/// The axis of a vertebra.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AxisView {
    /// Caudal end of the line to draw.
    pub from_px: [f64; 2],
    /// Cranial end.
    pub to_px: [f64; 2],
    /// Angle to the image's vertical, positive clockwise with square pixels (in millimetres, not in columns and rows).
    pub axis_deg: f64,
    /// Whether it was rotated by hand; else it is computed from the corners.
    pub by_hand: bool,
    /// Text, such as `tilt 4.2° to the patient's right`.
    pub text: String,
}

/// A landmark on both sides.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SidesView {
    /// The patient's left.
    pub left_px: Option<[f64; 2]>,
    /// The patient's right.
    pub right_px: Option<[f64; 2]>,
}

/// The next landmark.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum ExpectedLandmark {
    /// A corner.
    Corner {
        /// Level.
        level: String,
        /// Which corner.
        #[schema(value_type = CornerName)]
        corner: Corner,
    },
    /// The midpoint of a wall.
    Wall {
        /// Level.
        level: String,
        /// The patient's side.
        #[schema(value_type = SideName)]
        side: Side,
    },
    /// An iliac crest.
    Crest {
        /// The patient's side.
        #[schema(value_type = SideName)]
        side: Side,
    },
}

/// A vertebra as predicted from all landmarks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Proposal {
    /// Level.
    pub level: String,
    /// Its four corners in the guided order.
    pub corners: Vec<CornerView>,
    /// Standard deviation of a corner in percent of the vertebra's height.
    pub sd_percent: f64,
    /// The same as a part of the height, to be accepted with the corners, where they were found in the picture.
    pub sd_share: Option<f64>,
    /// Whether it may be accepted without a click on it: the erect film and the reader's clicks determine it, or it is clearly found in
    /// the picture.
    pub is_sure: bool,
}

/// Vertebrae found in a picture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct DetectionView {
    /// Why nothing is proposed, as text.
    pub refused: Option<String>,
    /// How sure the levels are, as text: their probability, or their match to a finished erect film.
    pub levels: String,
    /// Whether a person has to check the levels first.
    pub are_levels_doubtful: bool,
    /// Remarks on the proposals beside the levels, as texts.
    pub remarks: Vec<String>,
    /// The vertebrae, caudal first.
    pub proposals: Vec<Proposal>,
}

/// Proposals that the picture contradicts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MisfitView {
    /// Levels of the sure proposals whose corners do not lie on the edges of the picture.
    pub levels: Vec<String>,
}

/// Events for a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewEvent {
    /// Revision that the requester has seen.
    pub expected_revision: u64,
    /// The events, all recorded or none.
    pub events: Vec<Event>,
}

/// A reading that is finished.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FinishedReading {
    /// Always true.
    pub finished: bool,
    /// Its last revision.
    pub revision: u64,
    /// Its landmarks; absent while a plan hides them, because its film is read again.
    pub reading: Option<ReadingView>,
}

/// A finish of a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Finish {
    /// Revision that the requester has seen.
    pub expected_revision: u64,
    /// Whether the film shows no vertebra that can be marked: a planned reading without vertebrae needs this.
    #[serde(default)]
    pub nothing_to_mark: bool,
}

/// A withdrawal of a reading.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewWithdrawal {
    /// Why, such as `T6 was placed on T7`.
    pub reason: String,
}

/// Why a reading no longer counts.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct WithdrawalView {
    /// Person who withdrew or corrected it.
    pub who: String,
    /// Time in ms since 1970-01-01 UTC.
    pub at_ms: i64,
    /// Why; absent where a correction replaces the reading.
    pub reason: Option<String>,
}

/// Events to be evaluated without recording, for a drag.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PreviewRequest {
    /// Events on the current reading.
    pub events: Vec<Event>,
    /// An axis that is rotated towards the pointer; the axis in the answer is rounded to 0.1°.
    pub turn_axis: Option<TurnAxis>,
}

/// An axis rotated by the pointer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnAxis {
    /// Level, such as `T12`.
    pub level: String,
    /// Place to which the cranial end of the axis points.
    pub towards_px: [f64; 2],
}

/// A reading with its results: the answer to a preview and to recorded events.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Preview {
    /// The reading with the events.
    pub reading: ReadingView,
    /// Results for the film and the study; absent where the reading is blinded or they cannot be computed.
    pub live: Option<LiveView>,
}

/// Answer to a change that was based on an old revision: the change is kept, and the current reading is returned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ConflictAnswer {
    /// The error.
    pub problem: Problem,
    /// The current reading; its `conflicts` are only the changes of this request.
    pub reading: ReadingView,
}
