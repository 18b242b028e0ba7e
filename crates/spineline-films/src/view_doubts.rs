//! Contradictions between the file of a film and the answers of a person: view, side and shape of a pixel.

use spineline::anatomy::{FilmView, ImageSide};
use spineline::measure::Spacing;
use spineline::number::fixed;
use spineline_marking::{View, ViewJudgement, ViewQuestion, pixels_agree};

/// Contradictions between what a film is called and its file, which may state no view.
#[must_use]
pub fn view_contradictions(film: FilmView, file: &ViewJudgement) -> Vec<String> {
    let wrong_view = match (film, file.view) {
        (FilmView::Frontal(_), Some(View::Lateral)) => {
            Some("the file says that this is a lateral view")
        }
        (FilmView::Lateral, Some(View::Frontal)) => {
            Some("the file says that this is a frontal view")
        }
        _ => None,
    };
    let others = file.questions.iter().filter(|question| {
        matches!(
            question,
            ViewQuestion::ViewsDisagree
                | ViewQuestion::NotUpright { .. }
                | ViewQuestion::Stance { .. }
        )
    });
    wrong_view.map(str::to_owned).into_iter().chain(others.map(ToString::to_string)).collect()
}

/// The file puts the patient's left (of a lateral film, the front) on the other side of the picture than a person does. `said` is the
/// person's side, and `whose` names it, such as `your option`.
///
/// ```
/// use spineline::anatomy::{FilmView, ImageSide, Posture};
/// use spineline_films::side_contradiction;
/// use spineline_marking::{PatientDirection, ViewEvidence, judge_view};
/// let orientation = Some([PatientDirection::Left, PatientDirection::Foot]);
/// let file = judge_view(&ViewEvidence { orientation, ..Default::default() }, None);
/// let erect = FilmView::Frontal(Posture::Erect);
/// assert!(side_contradiction(erect, &file, ImageSide::Right, "your option").is_none());
/// assert!(side_contradiction(erect, &file, ImageSide::Left, "your option").is_some());
/// ```
#[must_use]
pub fn side_contradiction(
    film: FilmView,
    file: &ViewJudgement,
    said: ImageSide,
    whose: &str,
) -> Option<String> {
    let (part, by_file) = match film {
        FilmView::Frontal(_) => ("left", file.patient_left),
        FilmView::Lateral => ("front", file.patient_anterior),
    };
    let by_file = by_file.filter(|side| *side != said)?;
    Some(format!(
        "Patient Orientation puts the patient's {part} on the {} of the picture, {whose} on the other side",
        if by_file == ImageSide::Left { "left" } else { "right" }
    ))
}

/// The file states another shape of a pixel than a person, whose spacing is `said`.
#[must_use]
pub fn shape_contradiction(file: &Spacing, said: &Spacing, whose: &str) -> Option<String> {
    (!pixels_agree(said.aspect(), file.aspect())).then(|| {
        format!(
            "{whose} has pixels {} times as high as wide, and the file {} times ({}); angles depend on it",
            fixed(said.aspect(), 3),
            fixed(file.aspect(), 3),
            file.source
        )
    })
}
