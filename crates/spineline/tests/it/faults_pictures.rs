//! Films in pixels give angles and no lengths; lateral films give the sagittal profile; films that do not fit their names
//! or were not stitched well get a warning.

#![expect(clippy::disallowed_methods, reason = "the oracle has its own formulas")]

use crate::common::{
    analyzed, assert_near, exact_case, film_mut, landmarks, measured, on_a_table, phantom,
    placement_film, refused, spacing, warned,
};
use spineline::analysis::{Analysis, Case};
use spineline::anatomy::{ImageSide, Level, Posture, SagittalProfile};
use spineline::cohort::{Cohort, CohortPatient};
use spineline::measure::{
    CornerFault, Corners, Film, ImageGeometry, LateralFilm, MeasureFault, Outline, Reading,
    ReadingId, Spacing, SpacingPlane, SpatialOutline,
};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::warning::{WarningCode, Warnings};
use spineline_phantom::{Readers, Scenario};

/// A case whose films have square pixels, and the same one without any spacing.
fn with_and_without() -> (Case, Case) {
    let mut with = exact_case(0);
    let mut without = with.clone();
    for film in &mut with.films {
        let spacing = spacing(landmarks(film).0);
        assert_eq!(spacing.column_mm, spacing.row_mm, "subject 1 has square pixels");
    }
    for film in &mut without.films {
        landmarks(film).0.spacing = None;
    }
    (with, without)
}

#[test]
fn a_film_without_spacing_gives_the_same_angles_and_no_model() {
    let (with, without) = with_and_without();
    let (with, without) = (analyzed(&with, &on_a_table()), analyzed(&without, &on_a_table()));
    assert!(!with.models.is_empty() && without.models.is_empty());
    assert!(
        without.warnings.has(WarningCode::NoSpacing) && without.warnings.has(WarningCode::NoScale)
    );
    for (a, b) in with.movement.clinical.iter().zip(&without.movement.clinical) {
        assert_eq!((a.ends, a.apex, a.convex), (b.ends, b.apex, b.convex));
        for ((posture, a_angle), (_, b_angle)) in a.ferguson.iter().zip(&b.ferguson) {
            assert_near(a_angle.rad(), b_angle.rad(), 1e-9, "Ferguson angle");
            let [a, b] = [a, b].map(|curve| curve.cobb_in(*posture).expect("corners"));
            assert_near(a.rad(), b.rad(), 1e-9, "Cobb angle");
        }
    }
    for (a, b) in with.movement.films.iter().zip(&without.movement.films) {
        assert_eq!(b.outline.scale.plane, SpacingPlane::Pixels);
        assert_near(a.outline.amplitude().rad(), b.outline.amplitude().rad(), 1e-9, "amplitude");
    }
}

#[test]
fn lengths_of_a_film_without_spacing_are_its_pixels() {
    let (with, without) = with_and_without();
    let (with, without) = (analyzed(&with, &on_a_table()), analyzed(&without, &on_a_table()));
    let spine = |analysis: &Analysis| analysis.movement.erect().outline.polygon_mm();
    let scale = without.movement.scale();
    assert_eq!(scale.mm(spine(&without)), None);
    // Pixels of 0.1 mm.
    let px = scale.px(spine(&without)).expect("a film in pixels");
    assert_near(px, spine(&with) / 0.1, 1e-6, "length of the spine in pixels");
    assert!(scale.text(spine(&without), 1).ends_with(" px"));
}

#[test]
fn one_film_without_spacing_leaves_the_others_their_millimetres() {
    let mut case = exact_case(0);
    landmarks(film_mut(&mut case, Posture::Traction)).0.spacing = None;
    let analysis = analyzed(&case, &on_a_table());
    assert_eq!(analysis.movement.scale().plane, SpacingPlane::Patient);
    assert!(analysis.models.is_empty());
    let differ = warned(&analysis, WarningCode::SpacingPlanesDiffer, None);
    assert!(differ.message.contains("the spine is taken to be as long as on the erect film"));
    assert_eq!(warned(&analysis, WarningCode::NoScale, None).posture, Some(Posture::Traction));
}

#[test]
fn films_without_spacing_are_neither_predicted_nor_pooled_in_millimetres() {
    let (with, without) = with_and_without();
    let mut one = with.clone();
    landmarks(film_mut(&mut one, Posture::Traction)).0.spacing = None;
    let [with, without, one] = [with, without, one].map(|case| analyzed(&case, &on_a_table()));
    let predicted = |analysis: &Analysis| -> Vec<Posture> {
        let films = analysis.comparison().films.iter();
        films.filter(|film| !film.baselines.is_empty()).map(|film| film.posture).collect()
    };
    assert!(predicted(&with).contains(&Posture::Traction) && predicted(&without).is_empty());
    assert!(predicted(&one).contains(&Posture::Neutral));
    assert!(!predicted(&one).contains(&Posture::Traction));
    let patients = [&with, &without].map(CohortPatient::of);
    let (alone, both) = (Cohort::of(&patients[..1], 1), Cohort::of(&patients, 1));
    assert_eq!((alone.without_scale, both.without_scale), (0, 1));
    let lengths = |cohort: &Cohort| {
        let pooled = [cohort.rmse_mm, cohort.inflection[0].distance_mm].map(|one| one.pooled);
        [cohort.segment_mm, pooled[0], pooled[1]].map(|one| one.n)
    };
    assert_eq!(lengths(&both), lengths(&alone));
    assert!(both.baselines.errors.iter().all(|errors| errors.location_mm.patients.n == 1));
    // Angles need no scale.
    assert_eq!(both.rotation_deg.patients.n, 2);
    let words = both.sentences().join(" ");
    assert!(words.contains("Films of 1 of 2 patients have no scale"), "{words}");
}

/// A lateral film of a spine with a given profile, by turning boxes: independent of what measures it.
fn lateral(
    profile: &SagittalProfile,
    anterior: ImageSide,
    column_mm: f64,
    row_mm: f64,
) -> LateralFilm {
    let (mut pitch, mut x, mut z) = (-10f64.to_radians(), 0.0, 0.0);
    let mut vertebrae = std::collections::BTreeMap::new();
    let place = |x: f64, z: f64| {
        let column = if anterior == ImageSide::Right { x } else { -x };
        Pixel::new(2000.0 + column / column_mm, 5000.0 - z / row_mm)
    };
    for (i, level) in Level::MODEL.into_iter().enumerate() {
        let corner = |ahead: f64, up: f64| {
            let (s, c) = pitch.sin_cos();
            place(x + ahead * c + up * s, z - ahead * s + up * c)
        };
        let places = [(17.0, 11.0), (-17.0, 11.0), (17.0, -11.0), (-17.0, -11.0)];
        vertebrae.insert(level, Corners::from(places.map(|(ahead, up)| corner(ahead, up))));
        if let Some(turn) = profile.turns_deg.get(i) {
            pitch += turn.to_radians();
            x += 28.0 * pitch.sin();
            z += 28.0 * pitch.cos();
        }
    }
    let spacing = Some(Spacing::stated(column_mm, row_mm, SpacingPlane::Unknown));
    LateralFilm {
        image: ImageGeometry { columns: 4000, rows: 6000, spacing, patient_left: anterior },
        simultaneous: false,
        readings: vec![Reading { id: ReadingId::new("A", 1), vertebrae }],
    }
}

/// The erect film of a straight spine, each vertebra as high as on the lateral film.
fn straight(lateral: &LateralFilm) -> (Film, Outline) {
    let outline = lateral.measure(&mut Warnings::default()).expect("a good film");
    let vertebrae = outline
        .vertebrae
        .iter()
        .map(|seen| (seen.level, Frontal::new(0.0, seen.location.z_mm), Angle::ZERO));
    let film = placement_film(Posture::Erect, vertebrae);
    let outline = measured(&film);
    (film, outline)
}

#[test]
fn a_lateral_film_gives_its_profile_for_either_direction_of_view() {
    let truth = SagittalProfile::template(40.0, 55.0);
    for anterior in [ImageSide::Left, ImageSide::Right] {
        for row_mm in [0.1, 0.2] {
            let film = lateral(&truth, anterior, 0.1, row_mm);
            let mut warnings = Warnings::default();
            let (erect, outline) = straight(&film);
            let found = SpatialOutline::measure(&erect, &outline, &film, &mut warnings);
            let found = found.expect("a good film").expect("marked");
            let found = found.profile(&SagittalProfile::default());
            for (found, truth) in found.turns_deg.iter().zip(truth.turns_deg) {
                assert_near(*found, truth, 1e-9, "turn of a joint in degrees");
            }
            assert!(warnings.all().is_empty());
        }
    }
}

#[test]
fn vertebrae_hidden_by_the_shoulders_have_the_populations_angles() {
    let truth = SagittalProfile::template(40.0, 55.0);
    let template = SagittalProfile::default();
    let mut film = lateral(&truth, ImageSide::Left, 0.1, 0.1);
    let (erect, outline) = straight(&film);
    film.readings[0].vertebrae.retain(|&level, _| level <= Level::T5);
    let mut warnings = Warnings::default();
    let mut measure =
        |film: &LateralFilm| SpatialOutline::measure(&erect, &outline, film, &mut warnings);
    let found = measure(&film).expect("good").expect("marked").profile(&template);
    // T5/T4, T4/T3 and T3/T2.
    assert_eq!(found.turns_deg[11..], template.turns_deg[11..]);
    assert_near(found.turns_deg[10], truth.turns_deg[10], 1e-9, "T6/T5");
    film.readings.clear();
    assert_eq!(measure(&film), Ok(None));
    assert!(
        warnings.has(WarningCode::LateralIncomplete) && warnings.has(WarningCode::LateralNotMarked)
    );
}

#[test]
fn the_models_spine_takes_the_profile_of_the_lateral_film() {
    let mut case = exact_case(0);
    let flat = analyzed(&case, &on_a_table());
    let curved = SagittalProfile::template(60.0, 70.0);
    case.lateral = Some(lateral(&curved, ImageSide::Left, 0.1, 0.1));
    let analysis = analyzed(&case, &on_a_table());
    assert!(analysis.movement.space.is_some() && flat.movement.space.is_none());
    // More kyphosis and lordosis put the mid-spine farther from the line L4-T2.
    let depth =
        |a: &Analysis| a.movement.spine.midpoints_mm.iter().fold(0.0f64, |m, p| m.max(p.x.abs()));
    assert!(depth(&analysis) > depth(&flat) + 1.0, "{} {}", depth(&analysis), depth(&flat));
}

/// A body under the names of the other side.
fn sides_exchanged(body: &Corners<Pixel>) -> Corners<Pixel> {
    let [front_up, back_up, front_down, back_down] = body.points();
    Corners::from([back_up, front_up, back_down, front_down])
}

#[test]
fn swapped_corners_on_a_lateral_film_are_reported_by_name() {
    let mut film = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    film.image.patient_left = ImageSide::Right;
    let error = film.measure(&mut Warnings::default());
    let error = error.expect_err("the patient looks the other way");
    let mirrored = MeasureFault::LateralMirrored { count: 15 };
    assert_eq!((error.at.level, &error.fault), (None, &mirrored));
    assert!(error.to_string().contains("all 15 vertebrae"), "{error}");
    assert!(error.help().contains("`patient_anterior`"), "{}", error.help());
    // Rows from the bottom exchange the sides too.
    let mut film = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    for body in film.readings[0].vertebrae.values_mut() {
        *body = body.map(|place| Pixel::new(place.column_px, 5999.0 - place.row_px));
    }
    let error = film.measure(&mut Warnings::default()).expect_err("the spine runs down");
    assert_eq!(error.fault, MeasureFault::RowsFromBottom { count: 15 });
    // One exchanged vertebra is named by itself.
    let mut film = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    let mut reversed = film.clone();
    let named = &mut reversed.readings[0].vertebrae;
    *named = named.keys().copied().zip(named.values().rev().copied().collect::<Vec<_>>()).collect();
    let error = reversed.measure(&mut Warnings::default()).expect_err("reversed names");
    assert_eq!(error.fault, MeasureFault::LevelsReversed { count: 15 });
    let t7 = film.readings[0].vertebrae.get_mut(&Level::T7).expect("marked");
    *t7 = sides_exchanged(t7);
    let error = film.measure(&mut Warnings::default()).expect_err("front and back");
    let fault = MeasureFault::LateralCorners { fault: CornerFault::SidesExchanged };
    assert_eq!((error.at.level, error.fault), (Some(Level::T7), fault));
    let mut film = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    let t7 = film.readings[0].vertebrae.get_mut(&Level::T7).expect("marked");
    std::mem::swap(&mut t7.superior_left, &mut t7.inferior_left);
    let error = film.measure(&mut Warnings::default());
    let text = error.expect_err("crossed").to_string();
    assert!(
        text.contains("lateral") && text.contains("T7") && text.contains("A (repeat 1)"),
        "{text}"
    );
}

#[test]
fn a_lateral_film_with_front_and_back_exchanged_is_doubted() {
    let doubts = |film: &LateralFilm| {
        let mut warnings = Warnings::default();
        film.measure(&mut warnings).expect("a sound film");
        warnings
    };
    let exchanged = |profile: &SagittalProfile| {
        let mut film = lateral(profile, ImageSide::Left, 0.1, 0.1);
        film.image.columns = 8000;
        assert!(doubts(&film).all().is_empty(), "{:?}", doubts(&film));
        film.image.patient_left = ImageSide::Right;
        film.readings[0].vertebrae.values_mut().for_each(|body| *body = sides_exchanged(body));
        film
    };
    // Oracle: the profile by which the film is made, T5 to T12 and L1 to L4, with the other sign.
    let profile = SagittalProfile::template(40.0, 43.0);
    let warnings = doubts(&exchanged(&profile));
    let [warning] = warnings.all() else { panic!("{warnings:?}") };
    assert_eq!(warning.code, WarningCode::LateralLooksMirrored);
    let text = &warning.message;
    for words in ["lateral film", "40° from T12 to T5", "25° from L4 to L1", "`patient_anterior`"]
    {
        assert!(text.contains(words), "{text}");
    }
    // A flat thoracic spine of scoliosis says nothing about the side.
    assert!(doubts(&exchanged(&SagittalProfile::template(5.0, 43.0))).all().is_empty());
}

#[test]
fn a_copied_reading_of_a_lateral_film_counts_once() {
    let one = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    let with_second = |columns: f64| {
        let mut film = one.clone();
        let mut other = Reading { id: ReadingId::new("B", 1), ..film.readings[0].clone() };
        for body in other.vertebrae.values_mut() {
            *body = body.map(|place| Pixel::new(place.column_px + columns, place.row_px));
        }
        film.readings.push(other);
        film
    };
    let mut warnings = Warnings::default();
    let alone = one.measure(&mut warnings).expect("a good film");
    assert_eq!((alone.corner_sd, warnings.all().len()), (None, 0));
    assert_eq!(with_second(0.004).measure(&mut warnings), Ok(alone));
    let [warning] = warnings.all() else { panic!("{warnings:?}") };
    assert_eq!(warning.code, WarningCode::ReadingsCopied);
    let text = &warning.message;
    let is_named = ["lateral film", "A (repeat 1)", "B (repeat 1)"].map(|one| text.contains(one));
    assert_eq!(is_named, [true; 3], "{text}");
    // Another reading shows the noise: a difference of 1 mm in one of two directions is a variance of 0.25 mm² of one reading, and half of
    // it of the mean.
    let mut warnings = Warnings::default();
    let both = with_second(10.0).measure(&mut warnings).expect("a good film");
    assert!(warnings.all().is_empty(), "{warnings:?}");
    assert_near(both.corner_sd.expect("read twice"), 0.125_f64.sqrt(), 1e-9, "corner");
}

#[test]
fn a_lateral_film_is_refused_for_what_a_frontal_one_is() {
    let good = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    let refused = |change: &dyn Fn(&mut LateralFilm)| {
        let mut film = good.clone();
        change(&mut film);
        let mut case = exact_case(0);
        case.lateral = Some(film);
        let error = refused(&case);
        assert!(error.to_string().contains("lateral film"), "{error}");
        error.code()
    };
    let t7 = |film: &mut LateralFilm, to: Pixel| {
        let body = film.readings[0].vertebrae.get_mut(&Level::T7).expect("marked");
        body.superior_left = to;
    };
    assert_eq!(refused(&|film| film.readings[0].id = ReadingId::new(" ", 1)), "observer");
    assert_eq!(refused(&|film| film.readings[0].id = ReadingId::new("A", 0)), "repeat");
    assert_eq!(refused(&|film| film.readings.push(film.readings[0].clone())), "duplicate_reading");
    for value in [0.0, -0.1, f64::NAN] {
        let change = |film: &mut LateralFilm| {
            film.image.spacing = Some(Spacing::stated(0.1, value, SpacingPlane::Unknown));
        };
        assert_eq!(refused(&change), "spacing");
    }
    assert_eq!(refused(&|film| t7(film, Pixel::new(-3.0, 900.0))), "off_image");
    assert_eq!(refused(&|film| t7(film, Pixel::new(f64::NAN, 900.0))), "not_finite");
    // T7 and T4 carry each other's name.
    let exchanged = |film: &mut LateralFilm| {
        let all = &mut film.readings[0].vertebrae;
        let (low, high) = (all[&Level::T7], all[&Level::T4]);
        all.extend([(Level::T7, high), (Level::T4, low)]);
    };
    assert_eq!(refused(&exchanged), "out_of_order");
}

#[test]
fn odd_corners_of_a_lateral_film_are_named() {
    let film = lateral(&SagittalProfile::default(), ImageSide::Left, 0.1, 0.1);
    for (part, repeats, code) in [
        (0.9, 1, WarningCode::BodySidesDiffer),
        (0.6, 1, WarningCode::CornerFarFromNeighbours),
        (0.4, 3, WarningCode::CornerFarFromReadings),
    ] {
        let mut film = film.clone();
        let first = film.readings[0].clone();
        film.readings = (1..=repeats)
            .map(|repeat| Reading { id: ReadingId::new("A", repeat), ..first.clone() })
            .collect();
        let body = film.readings[0].vertebrae.get_mut(&Level::T7).expect("marked");
        let (front, back) = (body.superior_left, body.superior_right);
        body.superior_left = Pixel::new(
            front.column_px + part * (back.column_px - front.column_px),
            front.row_px + part * (back.row_px - front.row_px),
        );
        let mut warnings = Warnings::default();
        assert!(film.measure(&mut warnings).is_ok());
        let warning = warnings.all().iter().find(|warning| warning.code == code);
        let text = &warning.unwrap_or_else(|| panic!("no {code:?}: {warnings:?}")).message;
        assert!(text.contains("lateral film") && text.contains("T7"), "{text}");
    }
}

/// The true corners of a phantom's film under the names of other vertebrae, `down` levels lower.
fn renamed(phantom: &spineline_phantom::Phantom, posture: Posture, down: usize) -> Case {
    let mut case = phantom.case.clone();
    let truth = phantom.film(posture).expect("every posture has a film");
    let (_, _, readings) = landmarks(film_mut(&mut case, posture));
    readings.truncate(1);
    for (place, level) in Level::ALL.into_iter().enumerate() {
        let Some(landmark) = readings[0].vertebrae.get_mut(&level) else { continue };
        landmark.corners = truth.vertebrae[&Level::ALL[place + down]];
        landmark.axis_clockwise = None;
    }
    case
}

#[test]
fn a_film_with_all_names_shifted_by_one_level_is_reported() {
    for (subject, scenario) in [(0, Scenario::Rod), (4, Scenario::Bend), (8, Scenario::Pull)] {
        let phantom = phantom(subject, scenario, &Readers::default());
        for posture in Posture::MOVED {
            let found = |down: usize| {
                let analysis = analyzed(&renamed(&phantom, posture, down), &on_a_table());
                let warnings = analysis.warnings.all().iter();
                let shifted: Vec<_> = warnings
                    .filter(|w| w.code == WarningCode::LevelsMayBeShifted)
                    .filter_map(|w| w.posture)
                    .collect();
                shifted
            };
            assert_eq!(found(0), [], "{subject} {posture}: named rightly");
            assert_eq!(found(1), [posture], "{subject} {posture}: T1 is called T2");
        }
    }
}

#[test]
fn a_gap_in_a_stitched_film_is_reported_between_two_vertebrae() {
    // Films of the whole spine are put together from two or three; here the upper one lies 25 mm too high.
    let mut case = exact_case(0);
    let (image, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let rows = 25.0 / spacing(image).row_mm;
    image.rows += rows as u32;
    for (level, landmark) in &mut readings[0].vertebrae {
        let lower = if *level <= Level::T10 { rows } else { 0.0 };
        landmark.corners = landmark.corners.map(|p| Pixel::new(p.column_px, p.row_px + lower));
    }
    let analysis = analyzed(&case, &on_a_table());
    // The gap is twice the usual distance.
    let warning = warned(&analysis, WarningCode::SpacingUnusual, None);
    assert_eq!((warning.posture, warning.level), (Some(Posture::Erect), Some(Level::T9)));
}
