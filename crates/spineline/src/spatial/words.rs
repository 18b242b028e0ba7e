//! Vectors of `G` as text: sides, never signs.

use crate::number::fixed;

/// Parts of a vector below this part of the largest are not shown.
const MIN_PART: f64 = 0.005;
/// Senses of right-handed moments and rotations about the axes.
const TURNS: [[&str; 2]; 3] = [
    ["bending right", "bending left"],
    ["flexing", "extending"],
    ["turning left", "turning right"],
];

/// A force or place by its parts, such as `49.2 left, 8.0 caudal`.
///
/// ```
/// assert_eq!(spineline::spatial::vector_words([0.01, 49.2, -8.0]), "49.2 left, 8.0 caudal");
/// ```
#[must_use]
pub fn vector_words(vector: [f64; 3]) -> String {
    parts(vector, "", [["anterior", "posterior"], ["left", "right"], ["cranial", "caudal"]])
}

/// A displacement by its parts, such as `10.0 mm to the left, 2.0 mm cranial`.
#[must_use]
pub fn displacement_words(shift_mm: [f64; 3]) -> String {
    let words = [["anterior", "posterior"], ["to the left", "to the right"], ["cranial", "caudal"]];
    parts(shift_mm, " mm", words)
}

/// A distance to one side, such as `12.3 mm left`.
#[must_use]
pub fn sideways_words(left_mm: f64) -> String {
    let size = fixed(left_mm.abs(), 1);
    match size.as_str() {
        // A distance that rounds to zero has no side.
        "0.0" => format!("{size} mm"),
        _ if left_mm < 0.0 => format!("{size} mm right"),
        _ => format!("{size} mm left"),
    }
}

/// A moment on a vertebra by what it does, such as `5000.0 bending right, 200.0 flexing`.
#[must_use]
pub fn moment_words(moment: [f64; 3]) -> String {
    parts(moment, "", TURNS)
}

/// A rotation vector by its parts, such as `5.0° bending left`.
#[must_use]
pub fn rotation_words(turn_deg: [f64; 3]) -> String {
    parts(turn_deg, "°", TURNS)
}

/// Each part with its unit and the word for its sign.
fn parts(vector: [f64; 3], unit: &str, words: [[&str; 2]; 3]) -> String {
    let largest = vector.iter().fold(0.0, |most: f64, part| most.max(part.abs()));
    let named = vector.iter().zip(words).filter(|(part, _)| part.abs() > MIN_PART * largest);
    let named: Vec<String> = named
        .map(|(part, [positive, negative])| {
            let word = if *part > 0.0 { positive } else { negative };
            // Small forces keep their digits.
            let places = if largest < 1.0 { 4 } else { 1 };
            format!("{}{unit} {word}", fixed(part.abs(), places))
        })
        .collect();
    if named.is_empty() { format!("0{unit}") } else { named.join(", ") }
}
