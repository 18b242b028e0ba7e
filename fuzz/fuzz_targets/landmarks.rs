//! Landmarks in any format that is told by its content: CSV, Slicer, labelme, COCO, MATLAB, reports.
#![no_main]

use libfuzzer_sys::fuzz_target;
use spineline::anatomy::{ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing, SpacingPlane};
use spineline_landmarks::{LandmarkHint, parse_landmarks};

fuzz_target!(|bytes: &[u8]| {
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
});
