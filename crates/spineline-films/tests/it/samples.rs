//! Public sample files against what pydicom 3.0.2 read from them: an independent program.

use std::collections::BTreeMap;
use std::path::PathBuf;

use sha1::{Digest, Sha1};
use spineline_films::{
    Codec, CodecFault, DeidOptions, FilmError, FilmFile, FilmLimits, deidentify,
};

use crate::reading::read;

fn folder() -> Option<PathBuf> {
    let Some(data) = std::env::var_os("SPINELINE_DATA") else {
        eprintln!("SPINELINE_DATA is not set: skipped");
        return None;
    };
    Some(PathBuf::from(data))
}

/// Expected errors of files that are not a single grey film.
fn expected_error(name: &str) -> Option<FilmError> {
    let modality = |text: &str| FilmError::Modality { modality: Some(text.to_owned()) };
    Some(match name {
        "CT_small.dcm" | "J2K_pixelrep_mismatch.dcm" => modality("CT"),
        "JPEG2000-embedded-sequence-delimiter.dcm" => modality("NM"),
        "MR_small.dcm" | "MR_small_implicit.dcm" => modality("MR"),
        "badVR.dcm" => modality("RTDOSE"),
        "no-pixel-data.dcm" => modality("SR"),
        "rtplan.dcm" => modality("RTPLAN"),
        "RG2_JPLY.dcm" | "RG3_JPLY.dcm" => {
            let fault = CodecFault::LossyPrecision { bits: 12 };
            FilmError::Codec { codec: Codec::Jpeg, fault }
        }
        _ => return None,
    })
}

/// The attributes of a film equal the list of the independent program.
fn assert_tags(film: &FilmFile, row: &BTreeMap<String, String>, name: &str) {
    let same = |column: &str, found: String| assert_eq!(found, row[column], "{name}: {column}");
    same("rows", film.rows.to_string());
    same("columns", film.columns.to_string());
    same("modality", film.tags.modality.clone().unwrap_or_default());
    same("photometric", film.tags.photometric.name().to_owned());
    same("bits_stored", film.tags.bits_stored.to_string());
    for (column, found) in [
        ("pixel_spacing", film.tags.spacing.pixel_mm),
        ("imager_pixel_spacing", film.tags.spacing.imager_mm),
    ] {
        let expected: Vec<f64> = row[column]
            .trim_matches(['[', ']'])
            .split(',')
            .filter_map(|text| text.trim().parse().ok())
            .collect();
        assert_eq!(found.map(Vec::from).unwrap_or_default(), expected, "{name}: {column}");
    }
    let magnification = row["est_radiographic_magnification"].parse().ok();
    assert_eq!(film.tags.spacing.magnification, magnification, "{name}");
}

#[test]
fn every_sample_is_read_like_by_the_independent_program() {
    let Some(data) = folder() else { return };
    let mut table = csv::Reader::from_path(data.join("dicom-samples/expected_tags.csv")).unwrap();
    let mut read_well = 0;
    for row in table.deserialize::<BTreeMap<String, String>>() {
        let row = row.unwrap();
        let path = data.join(&row["file"]);
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if name.ends_with(".zst") {
            eprintln!("{name}: compressed as a file; it has the pixels of RG3_RLE.dcm");
            continue;
        }
        let Ok(bytes) = std::fs::read(&path) else {
            eprintln!("{name}: not there");
            continue;
        };
        let film = match (read(&bytes), expected_error(&name)) {
            (Err(error), Some(expected)) => {
                assert_eq!(error, expected, "{name}");
                continue;
            }
            (Err(error), None) => {
                // Truncated, without pixels, or without its beginning: pydicom refuses its pixels too.
                let known =
                    ["MR_truncated.dcm", "nested_priv_SQ.dcm", "no_meta.dcm", "priv_SQ.dcm"];
                assert!(known.contains(&&*name), "{name}: {error}");
                assert!(row["decoded_pixels_by_pydicom"].starts_with("no pixels"), "{name}");
                continue;
            }
            (Ok(film), None) => film,
            (Ok(_), Some(expected)) => panic!("{name}: should be `{expected}`"),
        };
        assert_tags(&film, &row, &name);
        let mut sum = Sha1::new();
        for value in film.stored.iter() {
            sum.update(value.to_le_bytes());
        }
        let sum: String = sum.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        let expected = row["decoded_pixels_by_pydicom"].split("sha1 ").nth(1).unwrap_or("");
        // Lossy JPEG 2000 is decoded in floating point; a sum cannot allow its tolerance of one grey level.
        assert_eq!(&sum[..12], expected, "{name}: {}", row["decoded_pixels_by_pydicom"]);
        let options =
            DeidOptions { case_id: "a".to_owned(), salt: [1; 32], retain_sex_and_age: false };
        let clean = deidentify(&bytes, &options, &FilmLimits::default()).unwrap();
        let again = read(&clean.bytes).unwrap();
        assert_eq!((again.stored, again.look), (film.stored, film.look), "{name}");
        read_well += 1;
    }
    assert!(read_well >= 14, "{read_well}");
}
