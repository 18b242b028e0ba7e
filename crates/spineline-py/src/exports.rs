//! Landmarks of a case as a table, and in the files of other programs.

use std::collections::BTreeMap;

use pyo3::prelude::*;
use pyo3::types::PyBytes;
use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::Posture;
use spineline_files::{unguarded, whole_number};
use spineline_landmarks::{
    LandmarkTarget, SourceImage, export_landmarks, landmark_rows, lateral_rows, openable_pictures,
    parse_film_source, read_film_source,
};
use spineline_tables::{NumberFormat, Series, Table as Columns, Values};

use crate::case::Case;
use crate::fault::Fault;
use crate::films::view;
use crate::landmarks::Source;
use crate::table::Table;

/// The landmarks of all frontal films of a case, or of its lateral film, as a table.
#[pyfunction]
pub fn landmark_table(case: &Case, is_lateral: bool) -> Result<Table, Fault> {
    let rows = if is_lateral { lateral_rows(&case.case) } else { landmark_rows(&case.case) };
    let mut rows = rows.map_err(|error| Fault::of(&error))?;
    let heading = rows.remove(0);
    let columns = heading.into_iter().enumerate();
    let columns = columns.map(|(place, name)| column(name, rows.iter().map(|row| &*row[place])));
    let row = "one vertebra, or the iliac crests, in one reading of a film";
    Ok(Table::new(Columns { name: "landmarks", row, columns: columns.collect() }))
}

/// A column of the table of landmarks from its cells.
fn column<'a>(name: String, cells: impl Iterator<Item = &'a str>) -> Series {
    let (unit, meaning) = meaning(&name);
    let values = match &*name {
        "repeat" => Values::Count(cells.map(|cell| whole_number(cell).map(i64::from)).collect()),
        _ if unit.is_empty() => {
            let text = |cell: &str| (!cell.is_empty()).then(|| unguarded(cell).to_owned());
            Values::Text(cells.map(text).collect())
        }
        _ => Values::Number(cells.map(|cell| cell.parse().ok()).collect()),
    };
    Series { name, unit, meaning, values, format: NumberFormat::Shortest }
}

/// Unit and meaning of a column of landmarks; names of corners and sides tell the place.
fn meaning(name: &str) -> (&'static str, &'static str) {
    match name {
        "posture" => ("", "the film"),
        "observer" => ("", "code of the observer"),
        "repeat" => ("", "number of the repeat of this observer, from 1"),
        "vertebra" => (
            "",
            "the vertebra, or iliac_crests, with the left and the right tip as superior corners",
        ),
        "axis_clockwise_deg" => {
            ("deg", "axis that was set by hand, clockwise from the vertical of the picture")
        }
        "corner_sd_share" => {
            ("1", "standard deviation of a detected corner, as a part of the height of the body")
        }
        "location_left_mm" => {
            ("mm", "midpoint to the patient's left, in any frontal frame of the film")
        }
        "location_cranial_mm" => ("mm", "midpoint in the cranial direction, in the same frame"),
        "tilt_right_deg" => ("deg", "tilt to the patient's right, in the same frame"),
        _ if name.ends_with("_column_px") => ("px", "column from the centre of the first pixel"),
        _ if name.ends_with("_row_px") => ("px", "row from the centre of the first pixel"),
        _ if name.ends_with("_confidence") => {
            ("1", "confidence of a program in this corner, from 0 to 1")
        }
        _ => ("", "origin of this corner; clicked where empty"),
    }
}

/// Files of landmarks for another program, by name, and notes on what they lack.
type Exported<'py> = (Vec<(String, Bound<'py, PyBytes>)>, Vec<String>);

/// Writes the landmarks of one film or of all frontal films. `dicom` has the DICOM files of films, and `written` date and time, for
/// DICOM reports.
#[pyfunction]
pub fn landmark_files<'py>(
    py: Python<'py>,
    case: &Case,
    format: &str,
    film: Option<&str>,
    dicom: BTreeMap<String, Source>,
    written: [String; 2],
) -> Result<Exported<'py>, Fault> {
    let posture = film.map(posture).transpose()?;
    let pictures = openable_pictures(&case.file, &case.case);
    let (sources, curves);
    let mut notes = Vec::new();
    let target = match format {
        "csv" => LandmarkTarget::Csv,
        "slicer" => LandmarkTarget::Slicer,
        "labelme" => LandmarkTarget::Labelme { pictures: &pictures },
        "coco" => LandmarkTarget::Coco { pictures: &pictures },
        _ => {
            sources = dicom_sources(case, posture, &dicom)?;
            curves = match analyze(&case.case, &AnalysisOptions::default()) {
                Ok(found) => found.movement.end_vertebrae(),
                Err(error) => {
                    notes.push(format!("the reports have no Cobb angles: {error}"));
                    Vec::new()
                }
            };
            let [date, time] = &written;
            LandmarkTarget::DicomSr { sources: &sources, curves: &curves, written: [date, time] }
        }
    };
    let files = export_landmarks(&case.case, posture, target).map_err(|error| Fault::of(&error))?;
    let left_out = target.left_out(&case.case).into_iter();
    notes.extend(
        left_out.map(|part| format!("this format has no place for {part}; the case keeps them")),
    );
    let files = files.into_iter().map(|file| (file.name, PyBytes::new(py, &file.bytes)));
    Ok((files.collect(), notes))
}

fn posture(film: &str) -> Result<Posture, Fault> {
    view(film)?.posture().ok_or_else(|| {
        let text = "this format is for frontal films only";
        Fault::new(text, "take `case.film(\"lateral\").landmarks`")
    })
}

/// The DICOM files of the films of a posture or of all.
fn dicom_sources(
    case: &Case,
    only: Option<Posture>,
    dicom: &BTreeMap<String, Source>,
) -> Result<BTreeMap<Posture, SourceImage>, Fault> {
    let given = dicom.iter().map(|(name, source)| Ok((posture(name)?, source)));
    let given: BTreeMap<Posture, &Source> = given.collect::<Result<_, Fault>>()?;
    let mut sources = BTreeMap::new();
    for film in case.case.films.iter().filter(|film| only.is_none_or(|p| p == film.posture)) {
        let (posture, key) = (film.posture, film.posture.key());
        let source = given.get(&posture).ok_or_else(|| {
            let text = format!("{posture} film: its DICOM file is missing");
            let help = format!("give its path, as in `dicom={{\"{key}\": \"{key}.dcm\"}}`");
            Fault::new(text, help).on_film(Some(posture.into()))
        })?;
        let stated = case.file.source(posture).unwrap_or_default();
        let read = match source {
            Source::Bytes(bytes) => {
                parse_film_source(posture, &stated, bytes, &format!("{posture} film"))
            }
            Source::Path(path) => read_film_source(posture, &stated, path),
        };
        let read = read.map_err(|error| Fault::of(&error).on_film(Some(posture.into())))?;
        sources.insert(posture, read);
    }
    Ok(sources)
}
