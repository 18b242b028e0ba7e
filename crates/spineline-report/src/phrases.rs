//! Phrases that reports of patients and of cohorts share.

use spineline::analysis::{FilmRole, FreeNumbers};

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
