//! Studies and their films.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{CalibratorName, ImageSideName, Notice, PlaneName, PostureName, RoleName, SideName};

/// How far a study has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum StudyStatus {
    /// No film is marked.
    ToMark,
    /// Marking has begun, and the erect film lacks vertebrae.
    Marking,
    /// The curve and its angles are known; a model is not.
    Measured,
    /// Models are fitted and all of them converged.
    Modelled,
    /// Something did not converge.
    NotConverged,
    /// The marks contradict one another.
    Refused,
    /// Films are read blinded, and results wait until all are read.
    Blinded,
}

/// A study in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudySummary {
    /// Identifier, without the patient's name.
    pub id: String,
    /// Free text of whoever leads the study.
    pub label: Option<String>,
    /// Whether the films are made up.
    pub synthetic: bool,
    /// What the one who asks may do.
    pub role: RoleName,
    /// How far it has come.
    pub status: StudyStatus,
    /// The status in words, such as `12 of 15 vertebrae on the erect film`.
    pub status_text: String,
    /// Films by posture.
    pub films: Vec<FilmSummary>,
    /// The curve, once it is measured.
    pub curve: Option<CurveSummary>,
    /// Number of warnings of its analysis.
    pub warnings: usize,
    /// Number of notices with severity `contradiction`.
    pub contradictions: usize,
    /// Last change, in ms since 1970-01-01 UTC.
    pub changed_ms: i64,
}

/// The largest curve of a study's erect film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveSummary {
    /// Lenke's type as far as the films tell it, such as `1`.
    pub lenke: Option<String>,
    /// Cobb angle.
    pub cobb_deg: f64,
    /// Region in words.
    pub region: String,
    /// The patient's side to which it is convex.
    pub convex: Option<SideName>,
    /// All in words, such as `Lenke 1, main thoracic 48.2° convex right (T5–T12)`.
    pub text: String,
}

/// A film in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmSummary {
    /// Film.
    pub film: i64,
    /// Posture.
    pub posture: PostureName,
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Height of a pixel over its width as the film is to be shown.
    pub pixel_aspect: f64,
    /// What lengths are measured in.
    pub plane: PlaneName,
    /// Distance between neighbouring rows in the film's plane; null where the scale is unknown.
    pub row_mm: Option<f64>,
    /// Spacing in words with its source, such as `0.143 mm × 0.143 mm, patient mm, by a ball (± 0.6 %)`.
    pub spacing_text: String,
    /// Side of the picture on which the patient's left is.
    pub patient_left: ImageSideName,
    /// Whether it is shown with dark and bright exchanged, against what its file says.
    pub inverted: bool,
    /// Number of edits so far, to be sent with the next one.
    pub revision: u64,
    /// Readings of it that the one who asks may see.
    pub readings: Vec<ReadingSummary>,
}

/// A reading in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadingSummary {
    /// Reading.
    pub reading: i64,
    /// Who reads.
    pub observer: String,
    /// Which time, from 1.
    pub repeat: u32,
    /// Whether it is the asker's own.
    pub mine: bool,
    /// Whether it is finished, and so never changes.
    pub finished: bool,
    /// Vertebrae of L4 to T2 with four corners.
    pub complete_levels: u32,
}

/// One study with everything that its first screen shows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudyDetail {
    /// As in the list.
    pub summary: StudySummary,
    /// Changes that lost a race and are kept.
    pub conflicts: Vec<LostChangeView>,
    /// The blinded plan, if there is one.
    pub plan: Option<PlanView>,
}

/// A change that was based on an old revision: kept, not applied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LostChangeView {
    /// Who.
    pub who: String,
    /// When, in ms since 1970-01-01 UTC.
    pub at_ms: i64,
    /// What, in words, such as `T12 superior left corner to (1203.4, 877.0)`.
    pub text: String,
    /// Revision that they saw.
    pub base_revision: u64,
    /// Revision that there was.
    pub found_revision: u64,
}

/// A plan of blinded readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct PlanView {
    /// Whether results still are hidden from this reader.
    pub blinded: bool,
    /// What this reader is to do next.
    pub next: NextReading,
}

/// What a blinded reader is to do next.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum NextReading {
    /// A film waits to be begun.
    Begin {
        /// Its name for this reading.
        code: String,
    },
    /// A reading was begun.
    Continue {
        /// Name of the film for this reading.
        code: String,
        /// Reading.
        reading: i64,
    },
    /// Nothing before a day.
    Wait {
        /// In ms since 1970-01-01 UTC.
        until_ms: i64,
    },
    /// Nothing more, or this observer is not in the plan.
    Done,
}

/// A new plan of blinded readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewPlan {
    /// Observers.
    pub observers: Vec<String>,
    /// How often each reads each film.
    pub repeats: u32,
    /// Days between two readings of a film by one observer.
    pub washout_days: u32,
    /// Seed of the order.
    pub seed: u64,
}

/// A picture that was dropped and is not in a study yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UploadView {
    /// To be named in [`NewStudy`]; forgotten after an hour. `GET /api/uploads/{upload}/thumbnail` shows it.
    pub upload: String,
    /// Format in words, such as `DICOM, JPEG 2000`.
    pub format: String,
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Height of a pixel over its width.
    pub pixel_aspect: f64,
    /// Posture that the file suggests, if any.
    pub posture: Option<PostureName>,
    /// Whether the file says that it is a view from the side, which a study does not take.
    pub is_lateral: bool,
    /// Whether the file says that it is a phantom's.
    pub is_synthetic: bool,
    /// Side of the picture on which the patient's left is, if the file says so.
    pub patient_left: Option<ImageSideName>,
    /// Spacing as the file supports it.
    pub spacing: Option<SpacingView>,
    /// What is odd about the file and has to be looked at, such as burned-in text.
    pub notices: Vec<Notice>,
}

/// A scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SpacingView {
    /// Distance between neighbouring columns.
    pub column_mm: f64,
    /// Distance between neighbouring rows.
    pub row_mm: f64,
    /// Plane of these millimetres.
    pub plane: PlaneName,
    /// With its source and uncertainty in words.
    pub text: String,
}

/// A new study of uploaded films.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewStudy {
    /// Identifier: 1 to 64 letters, digits, `.`, `-`, `_`.
    pub id: String,
    /// Free text.
    pub label: Option<String>,
    /// Films, one per posture.
    pub films: Vec<NewFilm>,
}

/// A film of a new study, as a person has confirmed it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewFilm {
    /// The upload.
    pub upload: String,
    /// Posture.
    pub posture: PostureName,
    /// Side of the picture on which the patient's left is.
    pub patient_left: ImageSideName,
    /// Which scale to use.
    pub scale: ScaleChoice,
    /// Whether dark and bright are exchanged.
    #[serde(default)]
    pub inverted: bool,
}

/// Which scale a film gets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ScaleChoice {
    /// As the file supports it; none where it supports none.
    File,
    /// Stated by whoever imports the film.
    Stated {
        /// Distance between neighbouring columns.
        column_mm: f64,
        /// Distance between neighbouring rows.
        row_mm: f64,
        /// Plane of these millimetres.
        plane: PlaneName,
    },
    /// None: angles only.
    Pixels,
}

/// A case file with the films that it names, uploaded before.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseImport {
    /// Text of the case file.
    pub text: String,
    /// Uploads by the file name that the case gives each film.
    pub films: Vec<NamedUpload>,
}

/// An upload and the name of its file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedUpload {
    /// Name of the file.
    pub name: String,
    /// The upload.
    pub upload: String,
}

/// A change of a film's record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FilmChange {
    /// Revision that the one who asks has seen.
    pub expected_revision: u64,
    /// What to change.
    pub edit: FilmEditName,
}

/// What of a film can be changed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum FilmEditName {
    /// It shows another posture.
    Posture {
        /// The right one.
        posture: PostureName,
    },
    /// Dark and bright are exchanged.
    Inverted {
        /// Whether they are.
        inverted: bool,
    },
    /// Its scale is read off a ball or a ruler in the picture.
    Scale {
        /// Two clicks.
        from_px: [f64; 2],
        /// The other one.
        to_px: [f64; 2],
        /// True distance.
        length_mm: f64,
        /// Standard deviation of that distance.
        length_sd_mm: f64,
        /// What was clicked.
        calibrator: CalibratorName,
    },
}

/// Something in a study has changed; sent as server-sent event `change`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Change {
    /// Who did it.
    pub who: String,
    /// Film that changed.
    pub film: Option<i64>,
    /// Reading that changed.
    pub reading: Option<i64>,
    /// Its new revision.
    pub revision: Option<u64>,
}
