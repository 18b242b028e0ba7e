//! Refusals and their errors.

use spineline::anatomy::ImageSide;
use spineline::measure::IliacCrests;
use spineline::spatial::Pixel;
use spineline_detect::{Picture, Refusal, detect};

fn refused(columns: usize, rows: usize, value: impl Fn(usize, usize) -> f32) -> Refusal {
    let values: Vec<f32> =
        (0..columns * rows).map(|index| value(index % columns, index / columns)).collect();
    let patient_left = ImageSide::Right;
    let picture = Picture { columns, rows, pixel_aspect: 1.0, patient_left, values: &values };
    // Crests far beyond the picture are passed over.
    for column_px in [1e300, f64::NAN] {
        let crest = Pixel::new(column_px, 10.0);
        let crests = IliacCrests { left: crest, right: crest };
        assert_eq!(detect(&picture, Some(crests)), detect(&picture, None));
    }
    detect(&picture, None).expect_err("no spine")
}

#[test]
fn blank_films_ramps_noise_and_stripes_are_refused() {
    let noise = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 251) as f32;
    let pictures: [&dyn Fn(usize, usize) -> f32; 5] = [
        &|_, _| 0.0,
        &|_, _| 65535.0,
        &|x, y| (x + y) as f32,
        &noise,
        // A ladder of rungs like vertebrae, without a spine.
        &|_, y| if y % 60 < 30 { 200.0 } else { 40.0 },
    ];
    for (number, picture) in pictures.into_iter().enumerate() {
        let refusal = refused(600, 1500, picture);
        assert!(matches!(refusal, Refusal::NoSpine { .. }), "picture {number}: {refusal:?}");
    }
}

#[test]
fn pictures_that_are_not_films_are_refused_at_once() {
    let picture = |columns: usize, rows: usize, pixel_aspect: f64, values: &[f32]| {
        let patient_left = ImageSide::Left;
        detect(&Picture { columns, rows, pixel_aspect, patient_left, values }, None)
    };
    let values = vec![1.0; 100 * 200];
    let no_film = |found| matches!(found, Err(Refusal::NoFilm { .. }));
    assert!(no_film(picture(63, 200, 1.0, &values[..63 * 200])));
    assert!(no_film(picture(100, 201, 1.0, &values)), "a row is missing");
    assert!(no_film(picture(100, 200, f64::NAN, &values)));
    assert!(no_film(picture(usize::MAX, 200, 1.0, &values)));
    // NaN values give a refusal, not a panic.
    assert!(picture(100, 200, 1.0, &vec![f32::NAN; 100 * 200]).is_err());
    assert!(picture(100, 200, 1.0, &vec![f32::INFINITY; 100 * 200]).is_err());
}
