//! Lengths, tilts and fractions in other units than they should be, and scales that no patient fits.

use crate::common::{all_landmarks, exact_case, film_mut, graph_film, landmarks, refused, spacing};
use spineline::analysis::Case;
use spineline::anatomy::{ImageSide, Posture};
use spineline::error::Error;
use spineline::measure::{
    Corners, Film, FilmLandmarks, IliacCrests, ImageGeometry, LateralFilm, MeasureError,
    MeasureFault, Reading, ReadingId, Spacing, SpacingPlane, SpacingSource, SuspectedUnit,
    TiltRule, check_landmarks, judge_landmarks, measure_film,
};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::warning::{WarningCode, Warnings};

/// A spine 385 mm high that waves by 20 mm: tilts up to 18°, and 392 mm along its midpoints.
fn waving() -> Film {
    let (wave_mm, height_mm) = (20.0, 385.0);
    graph_film(Posture::Erect, height_mm, move |z| {
        let phase = 2.0 * std::f64::consts::PI * z / height_mm;
        let slope = wave_mm * 2.0 * std::f64::consts::PI / height_mm * phase.cos();
        (wave_mm * phase.sin(), slope)
    })
}

/// The film with other locations and tilts.
fn changed(mut film: Film, change: impl Fn(Frontal, Angle) -> (Frontal, Angle)) -> Film {
    if let FilmLandmarks::Placements { readings, .. } = &mut film.landmarks {
        for placement in readings.iter_mut().flat_map(|one| one.vertebrae.values_mut()) {
            (placement.location, placement.tilt) = change(placement.location, placement.tilt);
        }
    }
    film
}

fn in_unit(factor: f64) -> Film {
    changed(waving(), |location, tilt| (location * factor, tilt))
}

#[track_caller]
fn error_of(film: &Film) -> MeasureError {
    check_landmarks(film).expect_err("a film that no patient has")
}

#[test]
fn locations_in_another_unit_are_refused_and_the_unit_is_named() {
    // Oracle: the definition of the units.
    for (factor, unit) in [
        (1e-3, SuspectedUnit::Metres),
        (0.1, SuspectedUnit::Centimetres),
        (1.0 / 25.4, SuspectedUnit::Inches),
        (1e3, SuspectedUnit::Micrometres),
        (1.0 / 0.143, SuspectedUnit::Pixels),
    ] {
        let error = error_of(&in_unit(factor));
        assert_eq!(error.at, Posture::Erect.into());
        let MeasureFault::Length { size } = &error.fault else { panic!("{unit}: {error}") };
        assert_eq!(size.suspected(), Some(unit), "{size}");
        let text = error.to_string();
        assert!(text.contains(&format!("look like {unit}")), "{text}");
        assert!(text.contains("L4 to T2"), "{text}");
        assert_eq!(error.help(), "give the locations in millimetres");
    }
    assert!(check_landmarks(&waving()).is_ok());
    assert!(judge_landmarks(&waving()).all().is_empty());
}

#[test]
fn a_spine_of_half_or_one_and_a_half_times_the_length_is_doubted_and_a_childs_is_not() {
    for (factor, is_doubted) in [(0.49, true), (0.55, false), (1.35, false), (1.5, true)] {
        let film = in_unit(factor);
        assert!(check_landmarks(&film).is_ok(), "{factor}");
        assert_eq!(judge_landmarks(&film).has(WarningCode::LengthUnusual), is_doubted, "{factor}");
    }
}

#[test]
fn a_part_of_a_spine_is_judged_by_that_part() {
    // Oracle: the share of the vertebrae from L2 to T6, a little over half of L4 to T2.
    let part = |factor: f64| {
        let mut film = in_unit(factor);
        if let FilmLandmarks::Placements { readings, .. } = &mut film.landmarks {
            let vertebrae = &mut readings[0].vertebrae;
            *vertebrae = std::mem::take(vertebrae).into_iter().skip(2).take(9).collect();
        }
        film
    };
    assert!(judge_landmarks(&part(1.0)).all().is_empty());
    for factor in [0.48, 1.6] {
        let doubts = judge_landmarks(&part(factor));
        let text = doubts.all().first().map(|one| one.message.clone()).unwrap_or_default();
        assert!(text.starts_with("L2 to T6 are "), "{factor}: {text}");
    }
    assert_eq!(error_of(&part(0.1)).code(), "length");
}

#[test]
fn one_tilt_for_all_vertebrae_of_a_curve_is_refused() {
    // Oracle: the tangent of this curve turns by 36°.
    for tilt in [0.0, -4.5].map(Angle::from_deg) {
        let error = error_of(&changed(waving(), |location, _| (location, tilt)));
        assert!(matches!(error.fault, MeasureFault::TiltsEqual), "{error}");
        let straight =
            changed(waving(), |location, _| (Frontal::new(0.0, location.z_mm).rotated(tilt), tilt));
        assert!(check_landmarks(&straight).is_ok(), "{tilt}");
        // Noise of 1 mm, by which the direction from a vertebra to the next one turns by more than 5°.
        let noisy = changed(straight, |location, tilt| {
            let off_mm = if location.z_mm.rem_euclid(3.0) < 1.5 { 1.0 } else { -1.0 };
            (location + Frontal::new(off_mm, 0.0), tilt)
        });
        assert!(check_landmarks(&noisy).is_ok(), "{tilt}");
    }
}

#[test]
fn tilts_in_radians_or_to_the_other_side_are_refused() {
    let radians = changed(waving(), |location, tilt| (location, Angle::from_deg(tilt.rad())));
    let error = error_of(&radians);
    assert!(matches!(error.fault, MeasureFault::TiltsInRadians), "{error}");
    let reversed = changed(waving(), |location, tilt| (location, -tilt));
    let error = error_of(&reversed);
    assert!(matches!(error.fault, MeasureFault::TiltsReversed), "{error}");
    // Oracle: a film of an upright spine has its tilts in any order of the coordinates.
    let exchanged =
        changed(waving(), |location, tilt| (Frontal::new(location.z_mm, location.y_mm), tilt));
    let error = error_of(&exchanged);
    assert!(matches!(error.fault, MeasureFault::LocationsExchanged), "{error}");
    let downwards =
        changed(waving(), |location, tilt| (Frontal::new(location.y_mm, -location.z_mm), tilt));
    let error = error_of(&downwards);
    assert!(matches!(error.fault, MeasureFault::LocationsDownwards), "{error}");
    // The wrong sign on a film that was held by another angle.
    let turn = Angle::from_deg(90.0);
    let held = changed(waving(), |location, tilt| (location.rotated(turn), turn - tilt));
    assert!(matches!(error_of(&held).fault, MeasureFault::TiltsReversed));
    // A whole film held by another angle has the same spine.
    for turn in [90.0, 179.0].map(Angle::from_deg) {
        let turned =
            changed(waving(), |location, tilt| (location.rotated(turn), (tilt + turn).wrapped()));
        assert!(check_landmarks(&turned).is_ok(), "{turn}");
    }
}

#[test]
fn a_deviation_of_a_scale_in_percent_is_refused_with_the_fraction() {
    let with = |sd: f64| {
        let mut film = waving();
        if let FilmLandmarks::Placements { scale_relative_sd, .. } = &mut film.landmarks {
            *scale_relative_sd = Some(sd);
        }
        film
    };
    let error = error_of(&with(3.3));
    assert!(error.to_string().contains("3.3 % are 0.033"), "{error}");
    for wrong in [-0.01, f64::NAN, 0.5] {
        assert_eq!(error_of(&with(wrong)).code(), "scale_sd", "{wrong}");
    }
    assert!(check_landmarks(&with(0.033)).is_ok());
    let mut case = exact_case(0);
    spacing(landmarks(film_mut(&mut case, Posture::Erect)).0).relative_sd = Some(1.5);
    let error = refused(&case);
    assert!(
        matches!(&error, Error::Measure(error) if matches!(error.fault, MeasureFault::ScaleSd { .. })),
        "{error}"
    );
}

/// The erect film of a phantom at another spacing.
fn at_spacing(columns: f64, rows: f64) -> Film {
    let mut case = exact_case(0);
    let film = film_mut(&mut case, Posture::Erect);
    let spacing = spacing(landmarks(film).0);
    (spacing.column_mm, spacing.row_mm) = (columns * spacing.column_mm, rows * spacing.row_mm);
    film.clone()
}

#[test]
fn a_spacing_that_is_three_times_too_large_is_refused_and_half_of_it_doubted() {
    let error = error_of(&at_spacing(2.4, 2.4));
    assert!(matches!(error.fault, MeasureFault::Length { .. }), "{error}");
    assert!(error.help().contains("--spacing"), "{}", error.help());
    for (factor, code) in [(0.45, WarningCode::LengthUnusual), (1.6, WarningCode::LengthUnusual)] {
        let doubts = judge_landmarks(&at_spacing(factor, factor));
        assert!(doubts.has(code), "{factor}: {doubts:?}");
    }
    assert!(judge_landmarks(&at_spacing(1.0, 1.0)).all().is_empty());
}

#[test]
fn bodies_that_are_twice_as_wide_or_high_as_usual_tell_of_pixels_that_are_not_square() {
    for (columns, rows) in [(2.0, 1.0), (1.0, 2.0), (0.5, 1.0)] {
        let doubts = judge_landmarks(&at_spacing(columns, rows));
        assert!(doubts.has(WarningCode::BodiesStretched), "{columns} {rows}: {doubts:?}");
    }
    // It needs no scale.
    let mut film = at_spacing(1.0, 1.0);
    let image = landmarks(&mut film).0;
    image.spacing = None;
    assert!(judge_landmarks(&film).all().is_empty());
    landmarks(&mut film).0.spacing = Some(Spacing::of_aspect(0.5, SpacingSource::Stated));
    assert!(judge_landmarks(&film).has(WarningCode::BodiesStretched));
}

#[test]
fn a_film_in_pixels_is_not_judged_in_millimetres() {
    let mut film = at_spacing(1.0, 1.0);
    landmarks(&mut film).0.spacing = None;
    let square = measure_film(&film, TiltRule::default(), &mut Warnings::default()).expect("sound");
    landmarks(&mut film).0.spacing = Some(Spacing::of_aspect(1.0, SpacingSource::Stated));
    let stated = measure_film(&film, TiltRule::default(), &mut Warnings::default()).expect("sound");
    assert_eq!(stated.vertebrae, square.vertebrae);
    assert_eq!(stated.scale.plane, SpacingPlane::Pixels);
    assert!(stated.scale.text(100.0, 0).ends_with("px"));
}

#[test]
fn a_stated_shape_of_pixels_gives_the_angles_of_the_same_film_in_millimetres() {
    // Oracle: rows at half the distance hold the same film in twice as many rows.
    let wanted = measure_film(&at_spacing(1.0, 1.0), TiltRule::default(), &mut Warnings::default())
        .expect("sound");
    let mut film = at_spacing(1.0, 1.0);
    let (image, ..) = landmarks(&mut film);
    image.rows *= 2;
    image.spacing = Some(Spacing::of_aspect(0.5, SpacingSource::PixelAspect));
    for landmark in all_landmarks(&mut film) {
        landmark.corners = landmark.corners.map(|c| Pixel::new(c.column_px, 2.0 * c.row_px));
    }
    let mut warnings = Warnings::default();
    let found = measure_film(&film, TiltRule::default(), &mut warnings).expect("sound");
    for (a, b) in found.vertebrae.iter().zip(&wanted.vertebrae) {
        assert!((a.tilt - b.tilt).abs() < Angle::from_deg(1e-9), "{}", a.level);
    }
    let text = &warnings.all()[0].message;
    assert!(text.contains("0.500 times as high as wide, as stated"), "{text}");
}

#[test]
fn a_lateral_film_has_the_same_limits() {
    let lateral = |mm: f64| {
        let vertebrae =
            spineline::anatomy::Level::MODEL.into_iter().enumerate().map(|(i, level)| {
                let row = 1101.5 - 60.0 * i as f64;
                let at = |[column, row]: [f64; 2]| Pixel::new(column, row);
                let places = [[203.0, row - 40.0], [263.0, row - 40.0], [203.0, row], [263.0, row]];
                (level, Corners::from(places.map(at)))
            });
        let spacing = Some(Spacing::stated(mm, mm, SpacingPlane::Patient));
        let patient_left = ImageSide::Left;
        LateralFilm {
            image: ImageGeometry { columns: 500, rows: 1200, spacing, patient_left },
            simultaneous: false,
            readings: vec![Reading { id: ReadingId::new("A", 1), vertebrae: vertebrae.collect() }],
        }
    };
    // 14 steps of 60 pixels.
    let mut warnings = Warnings::default();
    assert!(lateral(0.45).measure(&mut warnings).is_ok());
    assert!(warnings.all().is_empty(), "{warnings:?}");
    assert!(lateral(0.22).measure(&mut warnings).is_ok());
    assert!(warnings.has(WarningCode::LengthUnusual), "{warnings:?}");
    let error = lateral(0.045).measure(&mut Warnings::default()).expect_err("centimetres");
    assert!(
        matches!(&error.fault, MeasureFault::Length { size } if size.suspected() == Some(SuspectedUnit::Centimetres)),
        "{error}"
    );
}

#[test]
fn a_crest_outside_of_the_picture_is_named_with_the_size_of_the_picture() {
    let mut case: Case = exact_case(0);
    let (image, crests, _) = landmarks(film_mut(&mut case, Posture::Erect));
    let size = [image.columns, image.rows];
    let inside = Pixel::new(10.0, 10.0);
    *crests = Some(IliacCrests { left: Pixel::new(99_999.0, 10.0), right: inside });
    let text = refused(&case).to_string();
    assert!(text.contains("column 99999, row 10"), "{text}");
    assert!(text.contains(&format!("{} × {} picture", size[0], size[1])), "{text}");
}

#[test]
fn a_confidence_or_deviation_in_percent_is_refused_with_the_fraction() {
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let mark = readings[0].vertebrae.values_mut().next().expect("a vertebra");
    mark.confidence = Some(mark.corners.map(|_| 95.0));
    let text = refused(&case).to_string();
    assert!(text.contains("95 % are 0.95"), "{text}");
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let mark = readings[0].vertebrae.values_mut().next().expect("a vertebra");
    (mark.confidence, mark.sd_share) = (None, Some(8.0));
    let text = refused(&case).to_string();
    assert!(text.contains("8 % are 0.08"), "{text}");
}
