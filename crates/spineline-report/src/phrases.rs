//! Phrases that reports of patients and of cohorts share.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole, FreeNumbers};
use spineline::cohort::{Clustered, ComparisonOutcome, PairedComparison};

pub use spineline::number::none;
use spineline::number::{fixed, interval, p_value};

/// The lines of action that every patient with a bend is fitted with.
pub const LINES: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];

/// A line without the word: `inflection`.
pub fn line_in_short(kind: LineKind) -> String {
    kind.to_string().replace(" line", "")
}

/// Note on errors on held-out films.
pub const HELD_OUT: &str = "No model was fitted to these films.";
/// Note on errors on fitted films.
pub const FITTED: &str = "The stiffness was fitted to these films: a small error here shows how well a line adapts to the data, and is not evidence for it.";

/// Note on errors on bends that are left out of the fit in turn.
pub const LEFT_OUT: &str = "Each bend is predicted with the stiffness fitted to the other bend, so this takes both bends. Only films on which all lines have a result count.";

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
    let outlines = analysis.movement.films.iter().map(|posture| &posture.outline);
    let without = outlines.filter(|outline| !outline.scale.has_millimetres());
    let names: Vec<String> = without.map(|outline| outline.posture.to_string()).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Why a patient has no personalised model.
pub fn no_model_reason(analysis: &Analysis) -> String {
    if let Some(films) = films_without_scale(analysis) {
        return format!("films without a scale ({films})");
    }
    let reason = match analysis.movement.bends().next() {
        None => "no bending film",
        Some(_) => "no line of action on any bend",
    };
    reason.to_owned()
}

/// Why a patient has no personalised model, and what to add for a model.
pub fn no_model(analysis: &Analysis) -> String {
    let scale = films_without_scale(analysis).map(|_| format!(" {GIVE_SCALE}"));
    format!(
        "The patient has no personalised model: {}.{}",
        no_model_reason(analysis),
        scale.unwrap_or_default()
    )
}

/// How a film gets a scale.
pub const GIVE_SCALE: &str =
    "A pixel spacing, or a ball or ruler of known size on the film, gives a scale.";

/// The mean over patients with its 95 % interval.
pub(crate) fn mean_words(found: &Clustered, places: usize) -> String {
    with_interval(found.patients.mean, found.bootstrap, places)
}

/// The mean difference over patients with its 95 % interval, with one decimal.
pub(crate) fn difference_words(found: &PairedComparison) -> String {
    with_interval(found.mean_difference, found.bootstrap, 1)
}

/// A p value after Holm's correction; patients may be too few for a test.
pub(crate) fn holm_p(p: Option<f64>) -> String {
    p.map_or_else(|| ComparisonOutcome::NotTested.to_string(), |p| p_value(Some(p)))
}

/// A mean with its 95 % interval over patients.
pub(crate) fn with_interval(mean: f64, ends: Option<[f64; 2]>, places: usize) -> String {
    if !mean.is_finite() {
        return none();
    }
    let ends = ends.map_or_else(String::new, |ends| format!(" ({})", interval(ends, places)));
    format!("{}{ends}", fixed(mean, places))
}
