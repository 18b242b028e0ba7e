//! Cobb angles between endplates, against closed forms and against the corners of films themselves.

use crate::common::{
    analyzed, exact_case, film_mut, landmarks, landmarks_mut, on_a_table, other_side, phantom,
    warned,
};
use spineline::analysis::{AnalysisOptions, Case};
use spineline::anatomy::{Level, Posture, Region, Side};
use spineline::clinical::{
    ClinicalCurve, CobbEnds, EndAngles, EndChoice, EndRule, UnmarkedNeighbour, lenke_type,
};
use spineline::measure::{
    FilmLandmarks, ImageGeometry, Placement, Reading, SpacingPlane, TiltRule, VertebraLandmarks,
};
use spineline::spatial::Angle;
use spineline::warning::WarningCode;
use spineline_phantom::{Readers, Scenario, exchange_sides};

/// Corners are pixels of doubles.
const ROUNDING_DEG: f64 = 1e-9;

/// Direction of an endplate on the film by its two corners, positive where its normal leans to the patient's right.
///
/// Written from the picture alone: columns and rows in millimetres, rows downwards.
fn endplate_deg(image: &ImageGeometry, landmark: &VertebraLandmarks, superior: bool) -> f64 {
    let c = &landmark.corners;
    let (left, right) = if superior {
        (c.superior_left, c.superior_right)
    } else {
        (c.inferior_left, c.inferior_right)
    };
    let spacing = image.spacing.expect("phantoms have a spacing");
    let up_mm = (right.row_px - left.row_px) * spacing.row_mm;
    let across_mm = ((left.column_px - right.column_px) * spacing.column_mm).abs();
    180.0 / std::f64::consts::PI * (up_mm / across_mm).atan()
}

fn cobb_by_corners(case: &Case, posture: Posture, ends: CobbEnds) -> f64 {
    let film = case.film(posture).expect("the film");
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else {
        panic!("phantoms have corners")
    };
    let of = |level, superior| endplate_deg(image, &readings[0].vertebrae[&level], superior);
    of(ends.superior, true) - of(ends.inferior, false)
}

#[test]
fn a_cobb_angle_is_the_angle_between_the_endplates_as_marked_on_every_film() {
    // Oracle: corners of exact readers, with wedged and tapered bodies; non-square pixels (subject 3, 6), films seen from
    // the front (subject 5).
    let mut far_from_tilts = 0.0_f64;
    for subject in [0, 2, 4, 5, 8] {
        let case = exact_case(subject);
        let analysis = analyzed(&case, &on_a_table());
        for curve in &analysis.movement.clinical {
            for (posture, angles) in &curve.angles {
                let cobb = angles.cobb.expect("corners are known").deg();
                let expected = cobb_by_corners(&case, *posture, curve.ends);
                assert!((cobb - expected).abs() < ROUNDING_DEG, "{subject} {posture}: {cobb}");
                far_from_tilts = far_from_tilts.max((cobb - angles.tilt_range.deg()).abs());
            }
        }
    }
    assert!(far_from_tilts > 1.0, "the bodies are wedged: {far_from_tilts}");
}

#[test]
fn a_mirrored_film_has_the_same_cobb_angle_to_the_other_side() {
    let case = exact_case(0);
    let mut mirrored = case.clone();
    for film in &mut mirrored.films {
        film.posture = other_side(film.posture);
        // The same picture of a patient who turned about: left becomes right.
        exchange_sides(film);
    }
    let [here, there] = [&case, &mirrored].map(|case| analyzed(case, &on_a_table()));
    for (a, b) in here.movement.clinical.iter().zip(&there.movement.clinical) {
        assert_eq!((a.ends, a.convex), (b.ends, b.convex.map(Side::opposite)));
        let [x, y] = [a, b].map(|curve| curve.cobb_in(Posture::Erect).expect("corners"));
        assert!((x + y).deg().abs() < ROUNDING_DEG);
    }
}

/// Shears every body, so that its axis leans by some degrees more than its endplates: every second one to the other side.
fn sheared(mut case: Case, degrees: f64) -> Case {
    for (i, level) in Level::MODEL.into_iter().enumerate() {
        for posture in [Posture::Erect, Posture::LeftBending, Posture::RightBending] {
            let way = if i % 2 == 0 { 1.0 } else { -1.0 };
            let c = &mut landmarks_mut(&mut case, posture, level).corners;
            let shift_px = way * Angle::from_deg(degrees).rad().tan() * 0.5;
            let height_px = c.inferior_left.row_px - c.superior_left.row_px;
            for (corner, up) in [
                (&mut c.superior_left, 1.0),
                (&mut c.superior_right, 1.0),
                (&mut c.inferior_left, -1.0),
                (&mut c.inferior_right, -1.0),
            ] {
                corner.column_px += up * shift_px * height_px;
            }
        }
    }
    case
}

#[test]
fn axes_that_lean_against_their_endplates_do_not_change_a_cobb_angle() {
    let plain = exact_case(0);
    let ends = |curve: &ClinicalCurve| curve.ends;
    let plain_result = analyzed(&plain, &on_a_table());
    let given: Vec<CobbEnds> = plain_result.movement.clinical.iter().map(ends).collect();
    let choice = EndChoice { given: [0, 1, 2].map(|i| Some(given[i])), ..EndChoice::default() };
    let shears = sheared(plain, 5.0);
    let options = |tilt| AnalysisOptions { tilt, ends: choice, ..on_a_table() };
    let [by_plates, by_axis] =
        [TiltRule::Endplates, TiltRule::Axis].map(|tilt| analyzed(&shears, &options(tilt)));
    for ((a, b), c) in plain_result
        .movement
        .clinical
        .iter()
        .zip(&by_plates.movement.clinical)
        .zip(&by_axis.movement.clinical)
    {
        // Columns move, and endplates are nearly level: their directions change little.
        let [a, b, c] = [a, b, c].map(|curve| curve.angles_in(Posture::Erect).expect("erect"));
        let [cobb, plates, axis] = [a, b, c].map(|angles| angles.cobb.expect("corners").deg());
        assert!((cobb - plates).abs() < 1.0 && (cobb - axis).abs() < 1.0, "{cobb} {plates} {axis}");
        assert!((a.tilt_range - b.tilt_range).deg().abs() < 1.0);
    }
    let off =
        by_axis.movement.clinical.iter().zip(&plain_result.movement.clinical).map(|(a, b)| {
            let [a, b] =
                [a, b].map(|curve| curve.angles_in(Posture::Erect).expect("erect").tilt_range);
            (a - b).deg().abs()
        });
    assert!(off.fold(0.0, f64::max) > 5.0, "axes follow the shear");
}

#[test]
fn without_corners_there_is_a_tilt_range_and_no_cobb_angle() {
    let case = exact_case(0);
    let analysis = analyzed(&case, &on_a_table());
    let mut placed = case.clone();
    for posture in analysis.movement.films.iter().map(|p| p.outline.posture) {
        let outline = &analysis.movement.film(posture).expect("measured").outline;
        let film = film_mut(&mut placed, posture);
        let (_, _, readings) = landmarks(film);
        let id = readings[0].id.clone();
        let vertebrae = outline.vertebrae.iter();
        let vertebrae = vertebrae.map(|v| (v.level, Placement::new(v.location, v.tilt))).collect();
        let readings = vec![Reading { id, vertebrae }];
        film.landmarks = FilmLandmarks::placed(SpacingPlane::Patient, readings);
    }
    let without = analyzed(&placed, &on_a_table());
    assert_eq!(without.movement.lenke, None, "Lenke's criteria are Cobb angles");
    for (a, b) in analysis.movement.clinical.iter().zip(&without.movement.clinical) {
        assert!(a.has_cobb() && !b.has_cobb());
        assert_eq!((a.size_name(), b.size_name()), ("Cobb angle", "tilt range"));
        assert_eq!(b.cobb_in(Posture::Erect), None);
        assert_eq!(b.erect_size(), b.angles_in(Posture::Erect).expect("erect").tilt_range);
    }
}

#[test]
fn end_vertebrae_are_kept_chosen_anew_or_given() {
    let case = phantom(0, Scenario::Bend, &Readers::exact()).case;
    let with = |ends| analyzed(&case, &AnalysisOptions { ends, ..on_a_table() });
    let kept = with(EndChoice::default());
    let anew = with(EndChoice { rule: EndRule::EachFilm, ..EndChoice::default() });
    for (a, b) in kept.movement.clinical.iter().zip(&anew.movement.clinical) {
        assert_eq!(a.angles[0], b.angles[0], "the erect film is the same");
        for ((_, x), (posture, y)) in a.angles.iter().zip(&b.angles).skip(1) {
            let size = |angle: Angle| angle * a.erect_size().rad().signum();
            let [x, y] = [x.size(), y.size()].map(size);
            // The most tilted ones of a film that keeps the curve's direction make the largest angle.
            assert!(y.rad() < 0.0 || y >= x - Angle::from_deg(1e-9), "{posture}: {x} {y}");
        }
    }
    let ends = CobbEnds { inferior: Level::L1, superior: Level::T6 };
    let index = Region::MainThoracic.index();
    let mut choice = EndChoice::default();
    choice.given[index] = Some(ends);
    let given = with(choice);
    assert_eq!(given.movement.clinical[index].ends, ends);
    let expected = cobb_by_corners(&case, Posture::LeftBending, ends);
    let found =
        given.movement.clinical[index].cobb_in(Posture::LeftBending).expect("corners").deg();
    assert!((found - expected).abs() < ROUNDING_DEG);
}

#[test]
fn given_end_vertebrae_are_noted_and_a_pair_beside_the_curve_gives_no_lenke_type() {
    let case = phantom(0, Scenario::Bend, &Readers::exact()).case;
    let index = Region::MainThoracic.index();
    let with = |ends| {
        let mut choice = EndChoice::default();
        choice.given[index] = ends;
        analyzed(&case, &AnalysisOptions { ends: choice, ..on_a_table() })
    };
    let found = with(None);
    assert!(!found.warnings.has(WarningCode::EndVertebraeByHand));
    let same = with(Some(found.movement.clinical[index].ends));
    assert!(same.warnings.has(WarningCode::EndVertebraeByHand));
    assert!(!same.warnings.has(WarningCode::EndVertebraeUnusual));
    assert_eq!(same.movement.lenke, found.movement.lenke);
    let beside = with(Some(CobbEnds { inferior: Level::L4, superior: Level::L3 }));
    assert!(beside.warnings.has(WarningCode::EndVertebraeByHand));
    let text = &warned(&beside, WarningCode::EndVertebraeUnusual, None).message;
    let apex = found.movement.clinical[index].apex.name();
    assert!(text.contains("L4/L3") && text.contains("main thoracic") && text.contains(apex));
    assert_eq!(beside.movement.lenke, None);
    // T1 is marked on no phantom of the paper.
    let unseen = with(Some(CobbEnds { inferior: Level::T12, superior: Level::T1 }));
    assert_eq!(unseen.movement.clinical[index].ends, found.movement.clinical[index].ends);
    let text = &warned(&unseen, WarningCode::EndVertebraeUnusual, None).message;
    assert!(text.contains("T12/T1"), "{text}");
}

/// A curve convex to the left with Cobb angles on the erect film and the left bend.
fn left_curve(region: Region, degrees: [f64; 2]) -> ClinicalCurve {
    let [erect, bent] = degrees.map(|degrees| {
        let angle = Angle::from_deg(degrees);
        EndAngles { tilt_range: angle, cobb: Some(angle) }
    });
    ClinicalCurve {
        region,
        ends: CobbEnds { inferior: Level::T9, superior: Level::T4 },
        apex: Level::T7,
        convex: Some(Side::Left),
        angles: vec![(Posture::Erect, erect), (Posture::LeftBending, bent)],
        ferguson: Vec::new(),
        flexibility: None,
        unmarked: Vec::new(),
    }
}

#[test]
fn a_curve_that_may_be_larger_leaves_a_lenke_type_only_where_it_changes_nothing() {
    // Oracle: the table of Lenke's types, by hand. Lumbar, main and proximal curve, each erect and bent.
    let (one, two) =
        ([[30.0, 10.0], [60.0, 40.0], [20.0, 10.0]], [[30.0, 10.0], [60.0, 40.0], [40.0, 30.0]]);
    let (three, five) =
        ([[40.0, 30.0], [60.0, 40.0], [20.0, 10.0]], [[60.0, 40.0], [40.0, 20.0], [20.0, 10.0]]);
    let [lumbar, main, proximal] = Region::ALL;
    for (degrees, doubted, posture, expected) in [
        (one, None, Posture::Erect, Some(1)),
        (one, Some(proximal), Posture::Erect, None),
        (one, Some(proximal), Posture::LeftBending, None),
        (one, Some(proximal), Posture::Traction, Some(1)),
        (one, Some(lumbar), Posture::Erect, None),
        (one, Some(main), Posture::Erect, Some(1)),
        (two, Some(proximal), Posture::Erect, Some(2)),
        (three, None, Posture::Erect, Some(3)),
        (three, Some(lumbar), Posture::Erect, None),
        (five, Some(lumbar), Posture::Erect, Some(5)),
        (five, Some(main), Posture::Erect, None),
    ] {
        let mut curves = [0, 1, 2].map(|i| left_curve(Region::ALL[i], degrees[i]));
        for curve in curves.iter_mut().filter(|curve| doubted == Some(curve.region)) {
            curve.unmarked.push(UnmarkedNeighbour { posture, end: Level::T4, level: Level::T3 });
        }
        let found = lenke_type(&curves).map(|lenke| lenke.number);
        assert_eq!(found, expected, "{degrees:?}, {doubted:?}, {posture}");
    }
}

#[test]
fn a_small_curve_has_no_flexibility() {
    let analysis = analyzed(&exact_case(0), &on_a_table());
    for curve in &analysis.movement.clinical {
        let large = curve.erect_size().abs() >= ClinicalCurve::MIN_FLEXIBLE;
        assert_eq!(curve.flexibility.is_some(), large, "{}", curve.region);
    }
}

#[test]
fn a_rigid_model_keeps_what_cobb_angle_and_tilt_range_differ_by() {
    let analysis = analyzed(&exact_case(0), &on_a_table());
    let erect = &analysis.movement.erect().outline;
    let tilts: Vec<Angle> = erect.vertebrae.iter().map(|vertebra| vertebra.tilt).collect();
    for (place, curve) in analysis.movement.curve_places().iter().zip(&analysis.movement.clinical) {
        let found = place.angles(&tilts).cobb.expect("corners");
        let cobb = curve.cobb_in(Posture::Erect).expect("corners");
        assert!((found - cobb).deg().abs() < ROUNDING_DEG);
    }
}
