//! Studies and their films.

use serde::{Deserialize, Serialize};
use spineline_store::{OpenPlan, StudyEdit};
use utoipa::ToSchema;

use super::{
    CalibratorName, FilmImage, FilmViewName, ImageSideName, Notice, PostureName, RoleName,
    SideName, SpacingPlaneName, WithdrawalView,
};

/// Status of a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum StudyStatus {
    /// No film has landmarks.
    ToMark,
    /// A reading was begun, and the erect film lacks vertebrae.
    Marking,
    /// The curve and its angles are measured, without a model.
    Measured,
    /// All fitted models converged, and the films support one of them.
    Modelled,
    /// All fitted models converged, but the films do not support any: the verdict says why.
    Unsupported,
    /// A model did not converge.
    NotConverged,
    /// Landmarks contradict each other.
    Refused,
    /// Blinded readings: results are hidden until all are finished.
    Blinded,
}

/// A study in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct StudySummary {
    /// Identifier, without the patient's name.
    pub id: String,
    /// Free text; absent while readings of the requester are blinded.
    pub label: Option<String>,
    /// Whether the films are synthetic.
    pub synthetic: bool,
    /// Whether the study is archived: it can be read and not changed.
    pub archived: bool,
    /// Number of edits of its label and archiving so far, to be sent with the next one.
    pub revision: u64,
    /// Permission of the requester.
    pub role: RoleName,
    /// Its results.
    #[serde(flatten)]
    pub results: ResultSummary,
    /// Films by posture.
    pub films: Vec<FilmSummary>,
    /// Last change, in ms since 1970-01-01 UTC; while readings of the requester are blinded, only of the plan or of
    /// these readings.
    pub changed_ms: i64,
}

/// The results of a study in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ResultSummary {
    /// Status.
    pub status: StudyStatus,
    /// The status as text, such as `12 of 15 vertebrae on the erect film`.
    pub status_text: String,
    /// The largest curve, if it is measured.
    pub curve: Option<CurveSummary>,
    /// Number of warnings of its analysis.
    pub warnings: usize,
    /// Number of notices with severity `contradiction`.
    pub contradictions: usize,
}

/// The largest curve of a study's erect film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CurveSummary {
    /// Lenke type as far as the films determine it, such as `1`.
    pub lenke: Option<String>,
    /// Cobb angle, or tilt range where corners are not known.
    pub size_deg: f64,
    /// Whether the size is a Cobb angle.
    pub is_cobb: bool,
    /// Name of the region.
    pub region: String,
    /// The patient's side to which it is convex.
    pub convex: Option<SideName>,
    /// All values as text, such as `Lenke 1, main thoracic 48.2° convex right (T5–T12)`.
    pub text: String,
}

/// A film in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FilmSummary {
    /// Film.
    pub film: i64,
    /// Posture, or `lateral`.
    pub posture: FilmViewName,
    /// The film's picture.
    pub image: FilmImage,
    /// Distance between neighbouring rows in the film's plane; null where the scale is unknown.
    pub row_mm: Option<f64>,
    /// Whether somebody compared it with the patient's records; checks then do not doubt it.
    pub checked: bool,
    /// Number of edits so far, to be sent with the next one.
    pub revision: u64,
    /// Its readings that the requester may see.
    pub readings: Vec<ReadingSummary>,
}

/// A reading in the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ReadingSummary {
    /// Reading.
    pub reading: i64,
    /// Observer.
    pub observer: String,
    /// Number of the repeat, from 1.
    pub repeat: u32,
    /// Whether it belongs to the requester.
    pub mine: bool,
    /// Whether it is finished and can no longer be changed.
    pub finished: bool,
    /// Why it no longer counts.
    pub withdrawn: Option<WithdrawalView>,
    /// The reading that it corrects.
    pub corrects: Option<i64>,
    /// Vertebrae of L4 to T2 with four corners.
    pub complete_levels: u32,
}

/// One study with the data of its first page.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct StudyDetail {
    /// Summary as in the list.
    pub summary: StudySummary,
    /// Changes that were based on an old revision: kept, not applied.
    pub conflicts: Vec<LostChangeView>,
    /// The blinded plan, if there is one.
    pub plan: Option<PlanView>,
}

/// A change that was based on an old revision: kept, not applied.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct LostChangeView {
    /// Person.
    pub who: String,
    /// Time in ms since 1970-01-01 UTC.
    pub at_ms: i64,
    /// Change as text, such as `T12 superior left corner to (1203.4, 877.0)`.
    pub text: String,
    /// Revision on which the change was based.
    pub base_revision: u64,
    /// Current revision at that time.
    pub found_revision: u64,
}

/// A plan of blinded readings.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct PlanView {
    /// Whether results are hidden from this reader.
    pub blinded: bool,
    /// Next step of this reader.
    pub next: NextReading,
    /// The plan itself, for an admin who does not read, until the first reading begins.
    pub change: Option<OpenPlan>,
}

/// Next step of a blinded reader.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum NextReading {
    /// Begin a film.
    Begin {
        /// Its name for this reading.
        code: String,
    },
    /// Continue a reading.
    Continue {
        /// Name of the film for this reading.
        code: String,
        /// Reading.
        reading: i64,
    },
    /// The next reading begins on a later day.
    Wait {
        /// In ms since 1970-01-01 UTC.
        until_ms: i64,
    },
    /// The observer has finished, or is not in the plan.
    Done,
    /// The observer may no longer place landmarks in the study.
    NotAllowed,
}

/// A new plan of blinded readings.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewPlan {
    /// Observers.
    pub observers: Vec<String>,
    /// Readings per film and observer.
    pub repeats: u32,
    /// Days between two readings of a film by one observer.
    pub washout_days: u32,
    /// Whether readers see vertebrae that the program proposes, and may accept them.
    #[serde(default)]
    pub proposals: bool,
    /// Number of the plan that it replaces; absent for the first plan.
    pub replaces: Option<i64>,
}

/// An uploaded film that is not part of a study yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UploadView {
    /// Key for [`NewStudy`]; valid for one hour. `GET /api/uploads/{upload}/thumbnail` shows it.
    pub upload: String,
    /// Format as text, such as `DICOM, JPEG 2000`.
    pub format: String,
    /// Pixels in a row.
    pub columns: u32,
    /// Rows.
    pub rows: u32,
    /// Height of a pixel over its width.
    pub pixel_aspect: f64,
    /// Posture in the file, if any, or `lateral` where the file describes a lateral view.
    pub posture: Option<FilmViewName>,
    /// Whether the file belongs to a phantom.
    pub is_synthetic: bool,
    /// Side of the picture on which the patient's left is, or of a lateral view the patient's front, if the file contains it.
    pub patient_left: Option<ImageSideName>,
    /// Spacing from the file.
    pub spacing: Option<SpacingView>,
    /// Warnings about the file, such as burned-in text.
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
    pub plane: SpacingPlaneName,
    /// Scale with its source and uncertainty as text.
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
    /// Films, one per posture and one lateral one at most.
    pub films: Vec<NewFilm>,
    /// Accept films whose files state another part of the body, or two patients, or contradict the values given here.
    #[serde(default)]
    pub accept_doubtful_films: bool,
}

/// Uploaded films that are added to a study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MoreFilms {
    /// Films of postures that the study does not have yet.
    pub films: Vec<NewFilm>,
    /// Accept films whose files state another part of the body, or two patients, or contradict the values given here.
    #[serde(default)]
    pub accept_doubtful_films: bool,
}

/// An uploaded film with confirmed values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NewFilm {
    /// The upload.
    pub upload: String,
    /// Posture, or `lateral`.
    pub posture: FilmViewName,
    /// Side of the picture on which the patient's left is; of the lateral film, the patient's front.
    pub patient_left: ImageSideName,
    /// Whether a lateral film was exposed together with the erect one, as biplanar scanners do.
    #[serde(default)]
    pub simultaneous: bool,
    /// Scale to use.
    pub scale: ScaleChoice,
    /// Whether grey levels are inverted.
    #[serde(default)]
    pub inverted: bool,
}

/// Source of a film's scale.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum ScaleChoice {
    /// From the file, or none where the file has none.
    File,
    /// Entered by the person who imports the film.
    Stated {
        /// Distance between neighbouring columns.
        column_mm: f64,
        /// Distance between neighbouring rows.
        row_mm: f64,
        /// Plane of these millimetres.
        plane: SpacingPlaneName,
    },
    /// No scale: angles only.
    Pixels,
}

/// A case file and its uploaded films.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CaseImport {
    /// Text of the case file.
    pub text: String,
    /// Uploads with the file names in the case.
    pub films: Vec<NamedUpload>,
    /// Accept films whose files state another part of the body, or two patients.
    #[serde(default)]
    pub accept_doubtful_films: bool,
}

/// An upload and its file name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct NamedUpload {
    /// Name of the file.
    pub name: String,
    /// The upload.
    pub upload: String,
}

/// A change of a study's record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct StudyChange {
    /// Revision that the requester has seen.
    pub expected_revision: u64,
    /// The change.
    pub edit: StudyEdit,
}

/// A change of a film's record.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct FilmChange {
    /// Revision that the requester has seen.
    pub expected_revision: u64,
    /// The change.
    pub edit: FilmEditName,
}

/// Kinds of change of a film.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum FilmEditName {
    /// Correct the posture.
    Posture {
        /// Correct posture.
        posture: PostureName,
    },
    /// Invert grey levels.
    Inverted {
        /// Whether they are inverted.
        inverted: bool,
    },
    /// State that somebody compared the film with the patient's records: patient, posture and levels are right.
    Checked {
        /// Whether this is so.
        checked: bool,
    },
    /// Correct the side of the picture on which the patient's left is; of the lateral film, the patient's front. The film must not have
    /// readings.
    PatientLeft {
        /// Correct side.
        patient_left: ImageSideName,
    },
    /// Set the scale to distances that are known.
    Stated {
        /// Distance between neighbouring columns.
        column_mm: f64,
        /// Distance between neighbouring rows.
        row_mm: f64,
        /// Plane of these millimetres.
        plane: SpacingPlaneName,
    },
    /// Set the scale with a ball or a ruler in the picture.
    Scale {
        /// First point.
        from_px: [f64; 2],
        /// Second point.
        to_px: [f64; 2],
        /// True distance.
        length_mm: f64,
        /// Standard deviation of that distance.
        length_sd_mm: f64,
        /// Object between the points.
        calibrator: CalibratorName,
    },
}

/// A change in a study; sent as server-sent event `change`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Change {
    /// Person who made the change.
    pub who: String,
    /// Film that changed.
    pub film: Option<i64>,
    /// Reading that changed.
    pub reading: Option<i64>,
    /// Its new revision.
    pub revision: Option<u64>,
}
