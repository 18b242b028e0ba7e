//! Phrases that reports of patients and of cohorts share.

use spineline::analysis::{Analysis, FilmRole, FreeNumbers};
use spineline::measure::SpacingPlane;

/// Note on errors on held-out films.
pub const HELD_OUT: &str = "No model was fitted to these films.";
/// Note on errors on fitted films.
pub const FITTED: &str = "The stiffness was fitted to these films: a small error here shows how well a line adapts to the data, and is no evidence for it.";

/// Text in place of a missing number.
pub fn none() -> String {
    "–".to_owned()
}

/// Text of the numbers that a line takes from films.
pub fn numbers(numbers: &FreeNumbers, role: FilmRole) -> String {
    let FreeNumbers { multipliers, forces, line, per_predicted_film } = *numbers;
    match role {
        FilmRole::Fitted => {
            format!("{multipliers} + {forces} + {line} = {} fitted", numbers.fitted())
        }
        _ => format!("{per_predicted_film} per film"),
    }
}

/// A word with a capital at its start.
pub fn sentence_case(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Films of a patient whose lengths are pixels, as text such as `erect, left bending`; `None` where all have a scale.
pub fn films_without_scale(analysis: &Analysis) -> Option<String> {
    let outlines = analysis.postures.iter().map(|posture| &posture.outline);
    let without = outlines.filter(|outline| outline.scale.plane == SpacingPlane::Pixels);
    let names: Vec<String> = without.map(|outline| outline.posture.to_string()).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Why a patient has no personalised model, and what would give one.
pub fn no_model(analysis: &Analysis) -> String {
    const NONE: &str = "There is no personalised model";
    if let Some(films) = films_without_scale(analysis) {
        return format!(
            "{NONE}: without a scale ({films}) lengths in millimetres are not known. {GIVE_SCALE}"
        );
    }
    if analysis.postures.iter().all(|p| p.outline.posture.bend().is_none()) {
        return format!("{NONE}: the stiffness is fitted to bending films, and there is none.");
    }
    format!("{NONE}: the warnings above give the reason.")
}

/// How a film gets a scale.
pub const GIVE_SCALE: &str =
    "A pixel spacing, or a ball or ruler of known size on the film, gives a scale.";
