//! Words that several views share.

use spineline::anatomy::{Level, Posture};
use spineline::measure::{LengthScale, SpacingPlane};
use spineline_store::StandingCase;

/// The unit of lengths, such as `patient mm`.
pub const fn length_unit(scale: &LengthScale) -> &'static str {
    match scale.plane {
        SpacingPlane::Patient => "patient mm",
        SpacingPlane::Detector => "detector mm",
        SpacingPlane::Unknown => "mm of an unknown plane",
        SpacingPlane::Pixels => "pixels",
    }
}

/// Vertebrae and their verb, such as `T4, T3 and T2 are`.
pub fn listed(levels: &[Level], one: &str, many: &str) -> String {
    let names: Vec<&str> = levels.iter().map(|level| level.name()).collect();
    match names.split_last() {
        None => format!("none {one}"),
        Some((last, [])) => format!("{last} {one}"),
        Some((last, others)) => format!("{} and {last} {many}", others.join(", ")),
    }
}

/// Number of vertebrae in words, such as `12 of 15 vertebrae; T4, T3 and T2 are missing`.
pub fn marked_text(missing: &[Level]) -> String {
    let all = Level::MODEL.len();
    if missing.is_empty() {
        return format!("all {all} vertebrae");
    }
    let list = if missing.len() <= 5 {
        listed(missing, "is missing", "are missing")
    } else {
        let (first, last) = (missing[0], missing[missing.len() - 1]);
        format!("{} of {first} to {last} are missing", missing.len())
    };
    format!("{} of {all} vertebrae; {list}", all - missing.len())
}

/// How far the erect film is, on which all results wait.
pub fn progress(standing: &StandingCase) -> String {
    match standing.film(Posture::Erect) {
        None => "there is no erect film".to_owned(),
        Some(film) if film.readings == 0 => "no finished reading of the erect film".to_owned(),
        Some(film) => format!("the erect film has {}", marked_text(&film.missing())),
    }
}
