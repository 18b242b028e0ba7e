//! Checks for any input of the parsers: no panic, and a round trip of every value read.
//!
//! `cargo xtask fuzz` drives each check with random input. The tests of this crate replay the seeds, whole and damaged.

mod seeds;

pub use seeds::{Seed, seeds};

use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
use spineline_files::{CaseFile, parse_case, to_text};
use spineline_films::{DeidOptions, FilmLimits, deidentify, read_film};
use spineline_landmarks::{LandmarkHint, parse_landmarks};

/// A check of one parser; it panics if the check fails.
pub type Check = fn(&[u8]);

/// Every check with the name of its target.
pub const CHECKS: [(&str, Check); 6] = [
    ("case", case),
    ("deidentify", deidentified),
    ("film", film),
    ("landmarks", landmarks),
    ("other_files", other_files),
    ("report", report),
];

/// Limits for small pictures, so that a check takes milliseconds.
fn limits() -> FilmLimits {
    FilmLimits { pixels: 1 << 20, inflated_bytes: 4 << 20, ..FilmLimits::default() }
}

/// Case files: a case or an error, and the same case again from its own text.
///
/// # Panics
/// If the text of a case is not read as that case.
pub fn case(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Ok(case) = parse_case(text) {
        let once = to_text(&CaseFile::from_case(&case));
        let again = parse_case(&once).expect("our own text");
        assert_eq!(once, to_text(&CaseFile::from_case(&again)));
    }
}

/// De-identified films: the output is a film with as many pixels.
///
/// # Panics
/// If it is not.
pub fn deidentified(bytes: &[u8]) {
    let options =
        DeidOptions { case_id: "fuzz".to_owned(), salt: [7; 32], retain_sex_and_age: true };
    let Ok(clean) = deidentify(bytes, &options, &limits()) else { return };
    if let Ok(before) = read_film(bytes, &limits()) {
        let after = read_film(&clean.bytes, &limits()).expect("what was a film is one");
        assert_eq!(before.stored.len(), after.stored.len());
    }
}

/// Radiographs of any kind: pixels or a typed error, and a display of them.
///
/// # Panics
/// If the display has another number of pixels than the film.
pub fn film(bytes: &[u8]) {
    if let Ok(film) = read_film(bytes, &limits()) {
        let shown = film.display(None, false);
        assert_eq!(shown.grey.len(), film.stored.len());
    }
}

/// Landmarks in any format that is recognised by its content: CSV, Slicer, labelme, COCO, MATLAB, reports.
pub fn landmarks(bytes: &[u8]) {
    let image = ImageGeometry {
        columns: 3000,
        rows: 6000,
        spacing: Some(Spacing::stated(0.1, 0.125, SpacingPlane::Patient)),
        patient_left: ImageSide::Left,
    };
    for image in [None, Some(image)] {
        let hint = LandmarkHint { image, ..LandmarkHint::default() };
        let Ok(file) = parse_landmarks(bytes, &hint) else { continue };
        for film in file.films {
            let posture = film.posture.is_none().then_some(Posture::Erect);
            let _ = film.into_film(posture, image);
        }
    }
}

/// Analysis, model, load and stiffness files, and tables of readings.
pub fn other_files(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let _ = spineline_files::parse_analysis(text);
    let _ = spineline_files::parse_model(text);
    let _ = spineline_files::parse_load(text);
    let _ = spineline_files::parse_stiffness(text);
    let _ = spineline_files::parse_rotation_prior(text);
    let _ = spineline_files::parse_readings(text);
}

/// DICOM reports of landmarks.
pub fn report(bytes: &[u8]) {
    let _ = spineline_landmarks::read_sr(bytes);
}
