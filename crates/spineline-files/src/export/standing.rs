//! What of a model's vertebrae was measured, and what was assumed, for every format.

use spineline::analysis::{AxialSource, PitchSource};
use spineline::anatomy::Level;

use crate::StoredModel;

/// Sentences on pitch and depth, on axial rotation, and on the drawn widths: which vertebrae were measured, and what the others have.
pub(super) fn sources(model: &StoredModel) -> [String; 3] {
    let widths: Vec<bool> = model.widths_mm.iter().map(Option::is_some).collect();
    [
        told(model, "Pitch and depth", &model.pitch_from, |source| match source {
            PitchSource::LateralFilm => "MEASURED on the lateral film",
            PitchSource::Population => "ASSUMED, the profile of a population",
        }),
        told(model, "Axial rotation", &model.axial_from, |source| match source {
            AxialSource::Pedicles => "MEASURED from both pedicles on the erect film",
            AxialSource::Unknown => "NOT KNOWN, and zero here",
        }),
        told(model, "Drawn widths", &widths, |is_measured| {
            if is_measured {
                "MEASURED between the corners on the erect film"
            } else {
                "typical ones, scaled to the distances between vertebrae"
            }
        }),
    ]
}

/// Every source with its vertebrae, in the order in which they come from the lowest vertebra on.
fn told<T: PartialEq + Copy>(
    model: &StoredModel,
    what: &str,
    sources: &[T],
    words: impl Fn(T) -> &'static str,
) -> String {
    let mut kinds: Vec<(T, Vec<&[Level]>)> = Vec::new();
    let mut start = 0;
    for run in sources.chunk_by(|a, b| a == b) {
        let levels = &model.levels[start..start + run.len()];
        start += run.len();
        match kinds.iter_mut().find(|(kind, _)| *kind == run[0]) {
            Some((_, runs)) => runs.push(levels),
            None => kinds.push((run[0], vec![levels])),
        }
    }
    let parts: Vec<String> = kinds
        .into_iter()
        .map(|(kind, runs)| {
            let runs: Vec<String> = runs.into_iter().map(run_words).collect();
            format!("{} ({})", words(kind), runs.join(", "))
        })
        .collect();
    format!("{what}: {}.", parts.join("; "))
}

/// Neighbouring vertebrae, such as `L4 to T8`.
fn run_words(levels: &[Level]) -> String {
    match levels {
        [] => String::new(),
        [only] => only.to_string(),
        [first, .., last] => format!("{first} to {last}"),
    }
}
