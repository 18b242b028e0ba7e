//! Texts of changes that were based on an old revision.

use serde_json::Value;
use spineline::measure::SpacingPlane;
use spineline::number::fixed;
use spineline_files::method_text::ChosenOptions;
use spineline_store::{FilmRecord, LostChange, Name, ReadingId, Store, StoreError};

use crate::api::LostChangeView;

pub fn of_reading(store: &Store, reading: ReadingId) -> Result<Vec<LostChangeView>, StoreError> {
    of_reading_from(store, reading, 0)
}

/// From this conflict on: the changes that one request lost.
pub fn of_reading_from(
    store: &Store,
    reading: ReadingId,
    first: i64,
) -> Result<Vec<LostChangeView>, StoreError> {
    Ok(store.conflicts_of_reading(reading, first)?.iter().map(view).collect())
}

pub fn of_film(store: &Store, film: &FilmRecord) -> Result<Vec<LostChangeView>, StoreError> {
    let named = |lost: &LostChange| {
        let lost = view(lost);
        LostChangeView { text: format!("{} film: {}", film.view, lost.text), ..lost }
    };
    Ok(store.conflicts_of_film(film.id)?.iter().map(named).collect())
}

pub fn of_study(store: &Store, study: &Name) -> Result<Vec<LostChangeView>, StoreError> {
    Ok(store.conflicts_of_study(study)?.iter().map(view).collect())
}

pub fn of_options(store: &Store, study: &Name) -> Result<Vec<LostChangeView>, StoreError> {
    let text = |chosen: ChosenOptions| match chosen.words() {
        words if words.is_empty() => "all model options at their defaults".to_owned(),
        words => format!("model options: {words}"),
    };
    let of_options = |lost: &LostChange| {
        worded(lost, serde_json::from_str(&lost.change).map_or_else(|_| String::new(), text))
    };
    Ok(store.conflicts_of_options(study)?.iter().map(of_options).collect())
}

fn view(lost: &LostChange) -> LostChangeView {
    worded(lost, serde_json::from_str(&lost.change).map_or_else(|_| String::new(), |c| words(&c)))
}

fn worded(lost: &LostChange, text: String) -> LostChangeView {
    LostChangeView {
        who: lost.who.to_string(),
        at_ms: lost.at.unix_ms(),
        text,
        base_revision: lost.base_revision,
        found_revision: lost.found_revision,
    }
}

/// Text of an event, edit or finish.
fn words(change: &Value) -> String {
    let word = |key: &str| change[key].as_str().unwrap_or_default().replace('_', " ");
    let place = || format!("({}, {})", change["column_px"], change["row_px"]);
    match change["kind"].as_str() {
        Some("place_corner" | "move_corner") => {
            format!("{} {} corner to {}", word("level"), word("corner"), place())
        }
        Some("place_wall") => {
            format!("{} {} wall to {}", word("level"), word("side"), place())
        }
        Some("place_pedicle") => {
            format!("{} {} pedicle to {}", word("level"), word("side"), place())
        }
        Some("accept_corners") => {
            let vertebrae = change["vertebrae"].as_array().map_or(&[][..], Vec::as_slice);
            let levels: Vec<&str> = vertebrae.iter().filter_map(|v| v["level"].as_str()).collect();
            format!("corners accepted of {}", levels.join(", "))
        }
        Some("take_vertebra") => format!("corners of {} as in a file", word("level")),
        Some("set_axis") => match &change["axis_deg"] {
            Value::Null => format!("{} axis reset to its corners", word("level")),
            axis => format!("{} axis to {axis}°", word("level")),
        },
        Some("shift_levels") if change["up"] == true => "all levels one up".to_owned(),
        Some("shift_levels") => "all levels one down".to_owned(),
        Some("remove_vertebra") => format!("{} removed", word("level")),
        Some("place_iliac_crest") => format!("{} iliac crest to {}", word("side"), place()),
        Some("scale") => format!("a scale of {} mm", change["length_mm"]),
        Some("invert") => inverted(&change["inverted"]),
        Some("note") => format!("note: {}", change["text"].as_str().unwrap_or_default()),
        Some(kind @ ("undo" | "redo" | "finish")) => kind.to_owned(),
        _ if !change["posture"].is_null() => format!("posture to {}", word("posture")),
        _ if !change["patient_left"].is_null() => {
            format!("patient's left on the {}", word("patient_left"))
        }
        _ if !change["inverted"].is_null() => inverted(&change["inverted"]),
        _ if change["archived"] == true => "study archived".to_owned(),
        _ if change["archived"] == false => "study restored".to_owned(),
        _ if change.get("label").is_some() => match &change["label"] {
            Value::String(label) => format!("label “{label}”"),
            _ => "label removed".to_owned(),
        },
        _ if change["checked"] == true => "compared with the patient's records".to_owned(),
        _ if change["checked"] == false => "not compared with the patient's records".to_owned(),
        _ => {
            let [column, row] = ["column_spacing_mm", "row_spacing_mm"]
                .map(|key| change[key].as_f64().unwrap_or(f64::NAN));
            if change["spacing_plane"] == SpacingPlane::Pixels.key() {
                return format!("pixels {} times as high as wide", fixed(row / column, 3));
            }
            format!("scale to {} mm × {} mm per pixel", fixed(column, 3), fixed(row, 3))
        }
    }
}

fn inverted(value: &Value) -> String {
    let how = if *value == true { "inverted" } else { "as in the file" };
    format!("grey values {how}")
}
