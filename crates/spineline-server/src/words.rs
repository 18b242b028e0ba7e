//! Texts of the library's values.

use spineline::anatomy::{Level, Posture, Side};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane, SpacingSource};
use spineline::number::fixed;
use spineline_store::CurrentCase;

use crate::api::{FilmImage, Wire};

/// A film's picture with its texts.
pub fn image_of(image: &ImageGeometry, is_lateral: bool, inverted: bool) -> FilmImage {
    FilmImage {
        columns: image.columns,
        rows: image.rows,
        pixel_aspect: pixel_aspect(image.spacing),
        is_lateral,
        patient_left: Wire(image.patient_left),
        plane: Wire(image.spacing.map_or(SpacingPlane::Pixels, |spacing| spacing.plane)),
        spacing_text: spacing_text(image.spacing),
        inverted,
    }
}

/// Height of a pixel over its width, 1 where unknown.
pub fn pixel_aspect(spacing: Option<Spacing>) -> f64 {
    spacing.map_or(1.0, |spacing| spacing.aspect())
}

/// Text of a spacing with source and uncertainty.
pub fn spacing_text(spacing: Option<Spacing>) -> String {
    let Some(spacing) = spacing else { return "no scale: angles only".to_owned() };
    if !spacing.has_millimetres() {
        let aspect = spacing.aspect();
        return format!(
            "no scale: angles only, with pixels {} times as high as wide",
            fixed(aspect, 3)
        );
    }
    let Spacing { column_mm, row_mm, plane, source, relative_sd } = spacing;
    let mut text = format!("{} × {} {}", fixed(column_mm, 3), fixed(row_mm, 3), plane.unit());
    if source != SpacingSource::Stated {
        text.push_str(&format!(", {source}"));
    }
    if let Some(sd) = relative_sd {
        text.push_str(&format!(" (± {} %)", fixed(100.0 * sd, 1)));
    }
    text
}

/// Text of the patient's side, such as `the patient's right`.
pub fn patients(side: Side) -> String {
    format!("the patient's {side}")
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

/// Text of the number of vertebrae, such as `12 of 15 vertebrae; T4, T3 and T2 are missing`.
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

/// Progress of the erect film, which all results need.
pub fn progress(current: &CurrentCase) -> String {
    match current.films.get(&Posture::Erect) {
        None => "the erect film is missing".to_owned(),
        Some(film) if film.readings == 0 => "no finished reading of the erect film".to_owned(),
        Some(film) => format!("the erect film has {}", marked_text(&film.missing())),
    }
}
