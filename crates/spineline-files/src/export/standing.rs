//! The measured and the assumed data of a model's vertebrae, for every format.

use spineline::analysis::{AxialSource, PersonalisedModel, PitchSource};
use spineline::anatomy::{Level, Named};

/// Sentences on pitch and depth, on axial rotation, and on the drawn widths: the measured vertebrae, and the source for the others.
pub(super) fn sources(model: &PersonalisedModel) -> [String; 3] {
    let widths: Vec<bool> = model.widths_mm.iter().map(Option::is_some).collect();
    [
        told(model, "Pitch and depth", &model.pitch_from, |source| match source {
            Some(PitchSource::LateralFilm) => "MEASURED on the lateral film",
            Some(PitchSource::Population) => "ASSUMED, the profile of a population",
            None => "measured or assumed, which the model file does not say",
        }),
        told(model, "Axial rotation", &model.axial_from, |source| match source {
            Some(AxialSource::Pedicles) => "MEASURED from both pedicles on the erect film",
            Some(AxialSource::Unknown) => "NOT KNOWN, and zero here",
            None => "measured, or not known and zero, which the model file does not say",
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

/// The key of a source, for programs; empty where it is not stated.
pub(super) fn key<T: Named>(source: Option<T>) -> &'static str {
    source.map_or("", T::key)
}

/// Whether something was measured, as a number of a data array: 1 measured, 0 assumed or not known, -1 not stated.
pub(super) fn flag(is_measured: Option<bool>) -> &'static str {
    match is_measured {
        Some(true) => "1",
        Some(false) => "0",
        None => "-1",
    }
}

/// Every source with its vertebrae, in the order in which they come from the lowest vertebra on.
fn told<T: PartialEq + Copy>(
    model: &PersonalisedModel,
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
