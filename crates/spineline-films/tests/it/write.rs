//! Written films, read back with the DICOM library; `validation/films` reads them with another program.

use dicom_dictionary_std::tags;
use dicom_object::{DefaultDicomObject, from_reader};
use dicom_pixeldata::PixelDecoder;
use spineline::analysis::{Sex, Subject};
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
use spineline_films::{
    DicomFilm, Encoding, FilmPolarity, WriteFilmError, pixels_sha256, write_dicom,
};

const COLUMNS: u32 = 301;
const ROWS: u32 = 203;

/// Ramps, long runs and pairs, with an odd number of columns.
fn pixels() -> Vec<u16> {
    (0..COLUMNS * ROWS)
        .map(|k| match k / COLUMNS % 4 {
            0 => (k * 37 % 4096) as u16,
            1 => 4095,
            2 => (k / 2 % 4096) as u16,
            _ => u16::from(k % 3 == 0),
        })
        .collect()
}

fn subject() -> Subject {
    Subject { sex: Some(Sex::Female), age_years: Some(13.0), lenke: None }
}

fn film<'a>(subject: &'a Subject, pixels: &'a [u16]) -> DicomFilm<'a> {
    DicomFilm {
        case_id: "phantom-rod-01",
        subject,
        posture: Posture::LeftBending,
        image: ImageGeometry {
            columns: COLUMNS,
            rows: ROWS,
            spacing: Some(Spacing::stated(0.1, 0.125, SpacingPlane::Patient)),
            patient_left: ImageSide::Left,
        },
        magnification: 1.1,
        polarity: FilmPolarity::Monochrome2,
        bits_stored: 12,
        pixels,
        encoding: Encoding::Plain,
    }
}

fn read(film: &DicomFilm) -> DefaultDicomObject {
    let bytes = write_dicom(film).unwrap();
    assert_eq!(&bytes[128..132], b"DICM");
    from_reader(&bytes[..]).unwrap()
}

fn value(object: &DefaultDicomObject, tag: dicom_core::Tag) -> String {
    object.element(tag).unwrap().to_str().unwrap().into_owned()
}

#[test]
fn every_encoding_round_trips_every_pixel() {
    let (subject, pixels) = (subject(), pixels());
    for encoding in [Encoding::Plain, Encoding::Rle] {
        let object = read(&DicomFilm { encoding, ..film(&subject, &pixels) });
        assert_eq!(object.meta().transfer_syntax(), encoding.transfer_syntax());
        let decoded = object.decode_pixel_data().unwrap();
        let stored: Vec<u16> = decoded
            .data()
            .chunks_exact(2)
            .map(|pair| u16::from_le_bytes([pair[0], pair[1]]))
            .collect();
        assert!(stored == pixels, "{encoding:?}");
    }
    let object = read(&DicomFilm { encoding: Encoding::JpegLs, ..film(&subject, &pixels) });
    let stream = &object.element(tags::PIXEL_DATA).unwrap().fragments().unwrap()[0];
    assert_eq!(stream.len() % 2, 0);
    assert!(jpegls::decode(stream, COLUMNS, ROWS).unwrap().0 == pixels);
}

#[test]
fn spacing_is_written_row_first_and_with_its_plane() {
    let (subject, pixels) = (subject(), pixels());
    let mut film = film(&subject, &pixels);
    let object = read(&film);
    assert_eq!(value(&object, tags::PIXEL_SPACING), "0.125\\0.1");
    assert_eq!(value(&object, tags::PIXEL_SPACING_CALIBRATION_TYPE), "GEOMETRY");
    assert_eq!(value(&object, tags::IMAGER_PIXEL_SPACING), "0.1375\\0.11");
    film.image.spacing = Some(Spacing::stated(0.1, 0.125, SpacingPlane::Detector));
    let object = read(&film);
    assert!(object.get(tags::PIXEL_SPACING).is_none());
    assert_eq!(value(&object, tags::IMAGER_PIXEL_SPACING), "0.125\\0.1");
    film.image.spacing = Some(Spacing::stated(0.1, 0.125, SpacingPlane::Unknown));
    let object = read(&film);
    assert!(
        object.get(tags::PIXEL_SPACING).is_none()
            && object.get(tags::IMAGER_PIXEL_SPACING).is_none()
    );
}

#[test]
fn sides_polarity_and_position_are_written() {
    let (subject, pixels) = (subject(), pixels());
    let mut film = film(&subject, &pixels);
    let object = read(&film);
    assert_eq!(value(&object, tags::PATIENT_ORIENTATION), "R\\F");
    assert_eq!(value(&object, tags::VIEW_POSITION), "PA");
    assert_eq!(value(&object, tags::PHOTOMETRIC_INTERPRETATION), "MONOCHROME2");
    assert_eq!(value(&object, tags::PRESENTATION_LUT_SHAPE), "IDENTITY");
    let position = |object: &DefaultDicomObject| {
        let items = object.element(tags::PATIENT_ORIENTATION_CODE_SEQUENCE).unwrap();
        let code = items.items().unwrap()[0].element(tags::CODE_VALUE).unwrap();
        code.to_str().unwrap().into_owned()
    };
    assert_eq!(position(&object), "102538003");
    film.image.patient_left = ImageSide::Right;
    film.polarity = FilmPolarity::Monochrome1;
    film.posture = Posture::Erect;
    let object = read(&film);
    assert_eq!(value(&object, tags::PATIENT_ORIENTATION), "L\\F");
    assert_eq!(value(&object, tags::VIEW_POSITION), "AP");
    assert_eq!(value(&object, tags::PHOTOMETRIC_INTERPRETATION), "MONOCHROME1");
    assert_eq!(value(&object, tags::PRESENTATION_LUT_SHAPE), "INVERSE");
    assert_eq!(position(&object), "10904000");
}

#[test]
fn a_film_is_labelled_synthetic_with_its_patient_identifier() {
    let (subject, pixels) = (subject(), pixels());
    let object = read(&film(&subject, &pixels));
    assert_eq!(value(&object, tags::PATIENT_NAME), "PHANTOM^ROD01");
    assert_eq!(value(&object, tags::PATIENT_ID), "phantom-rod-01");
    assert_eq!(value(&object, tags::PATIENT_AGE), "013Y");
    for tag in [tags::SERIES_DESCRIPTION, tags::STUDY_DESCRIPTION, tags::IMAGE_COMMENTS] {
        assert!(value(&object, tag).starts_with("SYNTHETIC"));
    }
}

#[test]
fn equal_films_give_equal_files_and_films_of_a_case_share_only_the_study() {
    let (subject, pixels) = (subject(), pixels());
    let one = film(&subject, &pixels);
    assert!(write_dicom(&one).unwrap() == write_dicom(&one).unwrap());
    let other = read(&DicomFilm { posture: Posture::Traction, ..one });
    let one = read(&one);
    let same = |tag| value(&one, tag) == value(&other, tag);
    assert!(same(tags::STUDY_INSTANCE_UID));
    assert!(!same(tags::SERIES_INSTANCE_UID) && !same(tags::SOP_INSTANCE_UID));
}

#[test]
fn values_that_cannot_be_written_are_refused_by_value() {
    let (subject, pixels) = (subject(), pixels());
    let film = film(&subject, &pixels);
    let refused = |film: &DicomFilm| write_dicom(film).unwrap_err();
    let short = refused(&DicomFilm { pixels: &pixels[1..], ..film });
    assert!(matches!(short, WriteFilmError::PixelCount { found: 61_102, .. }), "{short}");
    let bits = refused(&DicomFilm { bits_stored: 8, ..film });
    assert!(matches!(bits, WriteFilmError::Bits { greatest: 4095, bits_stored: 8, .. }), "{bits}");
    for (columns, rows) in [(0, ROWS), (65_536, 1)] {
        let image = ImageGeometry { columns, rows, ..film.image };
        let size = refused(&DicomFilm { image, ..film });
        assert!(matches!(size, WriteFilmError::Size { .. }), "{size}");
    }
    for spacing in [0.0, -0.1, f64::NAN, f64::INFINITY] {
        let image = ImageGeometry {
            spacing: Some(Spacing::stated(0.1, spacing, SpacingPlane::Patient)),
            ..film.image
        };
        let length = refused(&DicomFilm { image, ..film });
        assert!(length.to_string().contains("row spacing"), "{length}");
    }
}

#[test]
fn the_digest_is_computed_from_little_endian_words() {
    // SHA-256 of the three bytes `abc` is in FIPS 180-4; of `ab` and `abcd` by sha256sum.
    let ab = pixels_sha256(&[u16::from_le_bytes(*b"ab")]);
    assert_eq!(ab, "fb8e20fc2e4c3f248c60c39bd652f3c1347298bb977b8b4d5903b85055620603");
}
