//! The view of a film from the attributes of its file; missing or contradictory values become questions.

use serde::{Deserialize, Serialize};
use spineline::anatomy::{ImageSide, Posture};

/// A direction in the patient, as Patient Orientation (0020,0020) names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum PatientDirection {
    Left,
    Right,
    Anterior,
    Posterior,
    Head,
    Foot,
}

impl PatientDirection {
    /// The direction of a value of Patient Orientation: its first letter leads, as in `L`, `LF` or `PR`.
    #[must_use]
    pub fn from_dicom(value: &str) -> Option<Self> {
        Some(match value.trim().chars().next()? {
            'L' => Self::Left,
            'R' => Self::Right,
            'A' => Self::Anterior,
            'P' => Self::Posterior,
            'H' => Self::Head,
            'F' => Self::Foot,
            _ => return None,
        })
    }
}

/// View Position (0018,5101), with the values that matter here.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub enum ViewPosition {
    /// From the front to the back, or the reverse: `AP`, `PA`.
    Frontal,
    /// From side to side: `LL`, `RL`, `LATERAL` and the like.
    Lateral,
    /// Anything else.
    Other,
}

impl ViewPosition {
    /// The view of a value of the attribute, or of a View Code's meaning.
    #[must_use]
    pub fn from_dicom(value: &str) -> Self {
        let value = value.trim().to_ascii_uppercase();
        match value.as_str() {
            "AP" | "PA" => Self::Frontal,
            "LL" | "RL" | "LAT" => Self::Lateral,
            // Films of a patient lying on a side are mostly frontal; obliques are neither view.
            "LATERAL" | "LEFT LATERAL" | "RIGHT LATERAL" => Self::Lateral,
            _ if value.contains("ANTERO-POSTERIOR") || value.contains("POSTERO-ANTERIOR") => {
                Self::Frontal
            }
            _ => Self::Other,
        }
    }
}

/// The patient's orientation to gravity: Patient Orientation Code (0054,0410).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[allow(missing_docs)]
pub enum Stance {
    Erect,
    Recumbent,
}

/// The attributes of a radiograph about its view.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewEvidence {
    /// Patient Orientation: the direction of increasing columns, then of increasing rows.
    pub orientation: Option<[PatientDirection; 2]>,
    /// View Position.
    pub view_position: Option<ViewPosition>,
    /// Patient Orientation Code.
    pub stance: Option<Stance>,
}

/// Direction from which the patient is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From the front or the back.
    Frontal,
    /// From a side: for the sagittal profile only.
    Lateral,
}

/// Questions about a film.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ViewQuestion {
    /// It is not stated whether the view is frontal or lateral.
    #[error("the file does not say whether this is a frontal or a lateral view")]
    View,
    /// Patient Orientation and View Position name different views.
    #[error("Patient Orientation and View Position name different views")]
    ViewsDisagree,
    /// The side of the picture with the patient's left is not stated.
    #[error("the file does not say on which side of the picture the patient's left is")]
    PatientLeft,
    /// The side of a lateral picture with the patient's front is not stated.
    #[error("the file does not say on which side of the picture the patient's front is")]
    PatientAnterior,
    /// Rows do not run to the feet: the film is upside down, or on its side.
    #[error(
        "the rows of the picture go from the top towards {rows:?} of the patient, and should go towards the feet"
    )]
    NotUpright {
        /// Where they run to.
        rows: PatientDirection,
    },
    /// The stance in the file contradicts the film's posture.
    #[error("the file says that the patient was {}, and the film is called {posture}", if *stance == Stance::Erect { "erect" } else { "recumbent" })]
    Stance {
        /// As the file says.
        stance: Stance,
        /// The film's posture.
        posture: Posture,
    },
}

/// Statements of a file, and open questions.
#[derive(Debug, Clone, PartialEq)]
pub struct ViewJudgement {
    /// The view; `None` if it is missing or contradictory.
    pub view: Option<View>,
    /// The side of a frontal picture on which the patient's left is.
    pub patient_left: Option<ImageSide>,
    /// The side of a lateral picture on which the patient's front is.
    pub patient_anterior: Option<ImageSide>,
    /// Absences and contradictions.
    pub questions: Vec<ViewQuestion>,
}

/// Judges the statements of a file about its view.
///
/// View Position alone does not give the side: it is the direction of the beam, not the orientation of the picture.
///
/// # References
/// DICOM PS3.3, C.7.6.1.1.1 (Patient Orientation), C.8.4.1 and C.8.11.5 (View Position, Patient Orientation Code).
///
/// ```
/// use spineline::anatomy::ImageSide;
/// use spineline_marking::{PatientDirection, View, ViewEvidence, judge_view};
/// let evidence = ViewEvidence {
///     orientation: Some([PatientDirection::Left, PatientDirection::Foot]), ..Default::default()
/// };
/// let judgement = judge_view(&evidence, None);
/// assert_eq!(judgement.view, Some(View::Frontal));
/// assert_eq!(judgement.patient_left, Some(ImageSide::Right));
/// assert!(judgement.questions.is_empty());
/// ```
#[must_use]
pub fn judge_view(evidence: &ViewEvidence, posture: Option<Posture>) -> ViewJudgement {
    let mut questions = Vec::new();
    let columns = evidence.orientation.map(|[columns, _]| columns);
    let by_orientation = columns.and_then(|columns| match columns {
        PatientDirection::Left | PatientDirection::Right => Some(View::Frontal),
        PatientDirection::Anterior | PatientDirection::Posterior => Some(View::Lateral),
        PatientDirection::Head | PatientDirection::Foot => None,
    });
    let by_position = evidence.view_position.and_then(|position| match position {
        ViewPosition::Frontal => Some(View::Frontal),
        ViewPosition::Lateral => Some(View::Lateral),
        ViewPosition::Other => None,
    });
    let view = match (by_orientation, by_position) {
        (Some(a), Some(b)) if a != b => {
            questions.push(ViewQuestion::ViewsDisagree);
            None
        }
        (a, b) => a.or(b),
    };
    let rows =
        evidence.orientation.map(|[_, rows]| rows).filter(|&rows| rows != PatientDirection::Foot);
    if let Some(rows) = rows {
        questions.push(ViewQuestion::NotUpright { rows });
    }
    let side = |far: PatientDirection, near: PatientDirection| match columns {
        // A film that is not upright is not evidence for an upright one.
        _ if rows.is_some() => None,
        Some(direction) if direction == far => Some(ImageSide::Right),
        Some(direction) if direction == near => Some(ImageSide::Left),
        _ => None,
    };
    let frontal = view == Some(View::Frontal);
    let lateral = view == Some(View::Lateral);
    let patient_left = side(PatientDirection::Left, PatientDirection::Right).filter(|_| frontal);
    let patient_anterior =
        side(PatientDirection::Anterior, PatientDirection::Posterior).filter(|_| lateral);
    if view.is_none() && !questions.contains(&ViewQuestion::ViewsDisagree) {
        questions.push(ViewQuestion::View);
    }
    if !lateral && patient_left.is_none() {
        questions.push(ViewQuestion::PatientLeft);
    }
    if lateral && patient_anterior.is_none() {
        questions.push(ViewQuestion::PatientAnterior);
    }
    if let Some((stance, posture)) = evidence.stance.zip(posture) {
        let fits = match posture {
            Posture::Erect => stance == Stance::Erect,
            // Bends and traction are taken lying as in the paper, or standing and hanging.
            Posture::LeftBending | Posture::RightBending | Posture::Traction => true,
            Posture::Neutral => stance == Stance::Recumbent,
        };
        if !fits {
            questions.push(ViewQuestion::Stance { stance, posture });
        }
    }
    ViewJudgement { view, patient_left, patient_anterior, questions }
}
