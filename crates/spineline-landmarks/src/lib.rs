//! Landmarks in the files of other programs, in and out.
//!
//! All formats are read into one intermediate, [`MarkedFilm`]: corners in pixels, named by the **patient's** sides, or,
//! for a file without a picture, locations and tilts. [`MarkedFilm::into_film`] makes a film of a case from it, which
//! the core checks. Nothing is assumed: data that a file does not contain come from the caller ([`LandmarkHint`]) or
//! are an error.
//!
//! Readers take bytes, never panic, and allocate memory in proportion to the bytes.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare with exact values"))]

mod aasce;
mod coco;
mod csv;
mod error;
mod export;
mod film;
mod foreign;
mod identity;
mod json;
mod labelme;
mod midline;
mod names;
mod number;
mod slicer;
mod sr;

use std::path::Path;

use spineline_files::decode_text;

pub use aasce::{
    AasceFault, AasceRow, AasceRows, AasceVerdict, image_sizes, judge_aasce, parse_mat,
    picture_names,
};
pub use coco::parse_coco;
pub use csv::{MAX_ROWS, parse_csv, parse_lateral_csv};
pub use error::{LandmarkError, LandmarkExportError};
pub use export::{
    ExportedFile, LandmarkTarget, export_landmarks, export_lateral, landmark_rows, lateral_rows,
    openable_pictures,
};
pub use film::{
    ColumnHint, LandmarkFile, LandmarkFormat, LandmarkHint, LandmarkReadings, MarkedFilm,
    SlicerFrame,
};
pub use labelme::parse_labelme;
pub use midline::parse_midlines;
pub use slicer::parse_slicer;
pub use sr::{
    ReportOf, SourceImage, parse_film_source, parse_source, read_film_source, read_source, read_sr,
    write_sr,
};

/// Maximum size of a file of landmarks.
pub const MAX_BYTES: u64 = 64 << 20;

/// Text about the formats that are read.
pub const LANDMARK_FORMATS: &str = "\
Landmark files, detected by their content:
  CSV           one row per vertebra: posture, observer, repeat, vertebra,
                superior_left_column_px, superior_left_row_px, and so on for superior_right,
                inferior_left, inferior_right; axis_clockwise_deg if set by hand. A row whose
                vertebra is iliac_crests has the left and right tip in the superior columns.
                Commas, or semicolons with decimal commas. At most 100000 rows. Confidences from
                0 to 1: superior_left_confidence, and so on. Pedicles: left_pedicle_column_px,
                and so on. A table of a lateral film (import --lateral-landmarks) has observer,
                repeat, vertebra, and superior_anterior_column_px, and so on for
                superior_posterior and the inferior ones.
  3D Slicer     point lists (.mrk.json) with labels such as T12_superior_left or T12 SL,
                iliac_crest_left and _right. coordinateSystem, LPS or RAS, has to be there.
  labelme       points with such labels, or polygons of four points labelled T12; `score` is a
                confidence.
  COCO          keypoints: a category per vertebra (superior_left, …), or names such as
                T12_superior_left. Confidences: `keypoint_scores`, or one `score` per
                annotation. Several films in one file are matched by `file_name`.
  Midlines      of the back surface, as JSON with `midlines`: for import --midlines only. Levels
                are placed by arc length.
  AASCE         a .mat file with p2, or the folder with filenames.csv and landmarks.csv, and the
                pictures or image_sizes.csv.
  DICOM SR      a report that `spineline export --to dicom-sr` wrote.
Landmarks that were not placed (empty, null, NaN, NA, visibility 0) are missing; a vertebra without any is passed over. \
Left and right are the patient's. AASCE and polygons name sides of the picture: --patient-left says on which side the patient's left is. \
Pixels count from the centre of the first pixel, which is 0.";

/// Reads landmarks of any known format from the bytes of a file, detected from the content.
pub fn parse_landmarks(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    if bytes.len() as u64 > MAX_BYTES {
        let (found, limit) = (bytes.len() as u64, MAX_BYTES);
        return Err(LandmarkError::TooLarge { what: "bytes", found, limit });
    }
    if bytes.get(128..132) == Some(b"DICM") {
        let film = read_sr(bytes)?;
        return Ok(LandmarkFile {
            format: LandmarkFormat::DicomSr,
            films: vec![film],
            remarks: Vec::new(),
        });
    }
    if bytes.starts_with(b"MATLAB 5.0 MAT-file") {
        return parse_mat(bytes, hint);
    }
    if let Some(error) = foreign::by_signature(bytes) {
        return Err(error);
    }
    let text = decode_text(bytes);
    let start = text.as_ref().map_or("", |text| text.trim_start());
    let is_other_json = text.is_none() && bytes.trim_ascii_start().starts_with(b"{");
    if is_other_json || start.starts_with(['{', '[']) {
        return parse_json_landmarks(bytes, hint);
    }
    if csv::looks_like_csv(bytes, &hint.columns) {
        return parse_csv(bytes, hint);
    }
    let foreign = text.as_ref().and_then(|text| foreign::by_text(text));
    Err(foreign.unwrap_or_else(|| LandmarkError::Unrecognised {
        reason: match &text {
            Some(text) => {
                let first = names::shown(text.trim_start().lines().next().unwrap_or_default());
                format!("it is not DICOM, MATLAB or JSON, and not a table with a column `vertebra`; its first line is `{first}`")
            }
            None => "it is not DICOM, MATLAB or JSON, and not text in UTF-8 or UTF-16".to_owned(),
        },
    }))
}

fn parse_json_landmarks(bytes: &[u8], hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let outline: json::Outline = json::parse_foreign(bytes)?;
    if outline.is_list {
        return Err(foreign::by_json_list(&outline));
    }
    let has = |key: &str| outline.has(key);
    if has("format") {
        let reason = "it is a Spineline file, not a landmark file".to_owned();
        return Err(LandmarkError::Unrecognised { reason });
    }
    if has("markups") {
        return parse_slicer(bytes, hint);
    }
    if has("shapes") {
        return parse_labelme(bytes, hint);
    }
    if has("midlines") {
        return parse_midlines(bytes, hint);
    }
    // Other programs than COCO have annotations too.
    match foreign::by_json(&outline).filter(|_| !(has("images") && has("annotations"))) {
        Some(error) => Err(error),
        None if has("annotations") => parse_coco(bytes, hint),
        None => Err(LandmarkError::Unrecognised {
            reason: "the JSON has no `markups`, `shapes`, `annotations` or `midlines`".to_owned(),
        }),
    }
}

/// Reads landmarks of any known format from a file, or from a folder of AASCE.
pub fn read_landmarks(path: &Path, hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    if path.is_dir() {
        return read_folder(path, hint);
    }
    parse_landmarks(&read_file(path)?, hint)
}

fn read_folder(folder: &Path, hint: &LandmarkHint) -> Result<LandmarkFile, LandmarkError> {
    let file = |missing: &'static str| {
        let path = folder.join(missing);
        if path.exists() { read_file(&path) } else { Err(LandmarkError::Folder { missing }) }
    };
    let (names, landmarks) = (file("filenames.csv")?, file("landmarks.csv")?);
    let sizes = image_sizes(&file("image_sizes.csv")?)?;
    let rows = AasceRows::new(&names, &landmarks, &sizes, hint)?;
    let films = rows.map(|row| row.map(|row| row.film)).collect::<Result<Vec<_>, _>>()?;
    if films.is_empty() {
        return Err(LandmarkError::missing("landmarks.csv", "a film"));
    }
    Ok(LandmarkFile { format: LandmarkFormat::AasceFolder, films, remarks: Vec::new() })
}

/// Reads a file of landmarks whole, if it has at most [`MAX_BYTES`].
///
/// # Errors
/// [`LandmarkError::File`].
pub fn read_file(path: &Path) -> Result<Vec<u8>, LandmarkError> {
    Ok(spineline_files::read_bytes(path, MAX_BYTES)?)
}
