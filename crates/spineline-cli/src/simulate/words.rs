//! Loads and sides in words.

use spineline::multibody::Timing;
use spineline_io::{AppliedLoad, TimingKey};

/// Parts of a vector below this part of the largest are not worth a word.
const SMALLEST_PART: f64 = 0.005;

/// A force or place by its parts, such as `49.2 left, 8.0 caudal`.
pub fn vector_words(vector: [f64; 3]) -> String {
    parts(vector, [["anterior", "posterior"], ["left", "right"], ["cranial", "caudal"]])
}

/// A moment on a vertebra by what it does, such as `5000.0 bending right, 200.0 flexing`.
pub fn moment_words(moment: [f64; 3]) -> String {
    let words = [
        ["bending right", "bending left"],
        ["flexing", "extending"],
        ["turning left", "turning right"],
    ];
    parts(moment, words)
}

/// Each part with the word for its sign.
fn parts(vector: [f64; 3], words: [[&str; 2]; 3]) -> String {
    let largest = vector.iter().fold(0.0, |most: f64, part| most.max(part.abs()));
    let said = vector.iter().zip(words).filter(|(part, _)| part.abs() > SMALLEST_PART * largest);
    let said: Vec<String> = said
        .map(|(part, [positive, negative])| {
            let word = if *part > 0.0 { positive } else { negative };
            // Small forces keep their digits.
            let places = if largest < 1.0 { 4 } else { 1 };
            format!("{:.places$} {word}", part.abs())
        })
        .collect();
    if said.is_empty() { "0".to_owned() } else { said.join(", ") }
}

/// `held` or `growing`.
pub const fn timing_word(timing: Timing) -> &'static str {
    match timing {
        Timing::Held => "held",
        Timing::Growing => "growing",
    }
}

/// One load in words.
pub fn load_words(load: &AppliedLoad) -> String {
    let words = match load {
        AppliedLoad::ForceOnLine { level, force_n, .. } => {
            format!("force on {}, along a line fixed in space: {}", level.0, vector_words(*force_n))
        }
        AppliedLoad::ForceAtPoint { level, force_n, .. } => {
            format!("force at {}: {}", level.0, vector_words(*force_n))
        }
        AppliedLoad::FollowerForce { level, force_in_vertebra_n, .. } => format!(
            "force at {} that turns with it: {} of the vertebra",
            level.0,
            vector_words(*force_in_vertebra_n)
        ),
        AppliedLoad::Moment { level, moment_nmm, .. } => {
            format!("moment on {} (force × mm): {}", level.0, moment_words(*moment_nmm))
        }
        AppliedLoad::FollowerMoment { level, moment_in_vertebra_nmm, .. } => format!(
            "moment on {} that turns with it (force × mm): {}",
            level.0,
            moment_words(*moment_in_vertebra_nmm)
        ),
        AppliedLoad::Gravity { body_weight_n, .. } => {
            format!("weight of trunk, head and arms of a body of {body_weight_n}")
        }
        AppliedLoad::Pad { level, direction, n_per_mm, advance_mm, .. } => format!(
            "pad on {}, advanced (mm) {}, with {n_per_mm} per mm",
            level.0,
            vector_words(direction.map(|part| part * advance_mm))
        ),
        AppliedLoad::Strap { level, n_per_mm, shortening_mm, .. } => {
            format!("strap on {}, shortened by {shortening_mm} mm, {n_per_mm} per mm", level.0)
        }
        AppliedLoad::Rod { inferior, superior, shift_mm, turn_deg, .. } => {
            let still = shift_mm.iter().chain(turn_deg).all(|part| *part == 0.0);
            let how =
                if still { "keeps their erect pose" } else { "moves them against each other" };
            format!("rod from {} to {}: {how}", inferior.0, superior.0)
        }
    };
    match load.timing() {
        TimingKey::Held => format!("{words} (held)"),
        TimingKey::Growing => words,
    }
}
