//! Films that show another posture or another patient than they are named after.

use crate::common::{
    Draw, all_landmarks, analyzed, exact_case, film_mut, landmarks, mirrored, move_landmarks,
    on_a_table, warned,
};
use spineline::analysis::{Analysis, Case, analyze_movement};
use spineline::anatomy::Posture;
use spineline::cohort::{Cohort, CohortPatient};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::warning::{Severity, WarningCode};
use spineline_phantom::exchange_sides;

const BENDS: [Posture; 2] = [Posture::LeftBending, Posture::RightBending];

const CODES: [WarningCode; 5] = [
    WarningCode::AnotherPatient,
    WarningCode::BendKeepsShape,
    WarningCode::BendLeansLittle,
    WarningCode::ErectLeans,
    WarningCode::FilmsShowOneShape,
];

/// Warnings of this module by film.
fn doubts(analysis: &Analysis) -> Vec<(WarningCode, Option<Posture>)> {
    let warnings = analysis.warnings.all().iter().filter(|one| CODES.contains(&one.code));
    warnings.map(|one| (one.code, one.posture)).collect()
}

fn verdict(analysis: &Analysis) -> String {
    analysis.verdict().join(" ")
}

/// The case as it is, and with all its pictures mirrored.
fn both_ways(case: &Case) -> [Case; 2] {
    [case.clone(), mirrored(case)]
}

/// Gives a film the landmarks of another one, every corner moved at random by up to `by_px` pixels.
fn copy_landmarks(case: &mut Case, from: Posture, to: Posture, by_px: f64) {
    let copied = film_mut(case, from).landmarks.clone();
    let film = film_mut(case, to);
    film.landmarks = copied;
    let mut draw = Draw::new(7);
    for landmark in all_landmarks(film) {
        landmark.axis_clockwise = None;
        let moved = landmark.corners.points().map(|place| {
            let mut moved = || draw.between(-by_px, by_px);
            Pixel::new(place.column_px + moved(), place.row_px + moved())
        });
        landmark.corners = moved.into();
    }
}

#[test]
fn sound_films_are_not_doubted() {
    for subject in 0..18 {
        for case in both_ways(&exact_case(subject)) {
            let analysis = analyze_movement(&case, &on_a_table()).expect("a sound case");
            assert_eq!(doubts(&analysis), [], "subject {subject}");
        }
    }
}

#[test]
fn a_bend_with_the_erect_films_landmarks_is_not_evidence() {
    assert_eq!(WarningCode::BendKeepsShape.severity(), Severity::Contradiction);
    for bend in BENDS {
        let mut case = exact_case(0);
        // Pixels of 0.1 mm: a corner moves by half a millimetre at most.
        copy_landmarks(&mut case, Posture::Erect, bend, 5.0);
        for case in both_ways(&case) {
            let analysis = analyzed(&case, &on_a_table());
            assert_eq!(doubts(&analysis), [(WarningCode::BendKeepsShape, Some(bend))]);
            let verdict = verdict(&analysis);
            assert!(verdict.contains(&format!("The {bend} film may be wrong")), "{verdict}");
            assert!(verdict.contains("no result of this patient is evidence"), "{verdict}");
            assert!(!verdict.contains("are consistent with"), "{verdict}");
            let side = if bend == Posture::LeftBending { "left" } else { "right" };
            assert!(!verdict.contains(&format!("joints turn to the {side}.")), "{verdict}");
        }
    }
}

#[test]
fn a_film_that_a_person_compared_with_the_records_is_not_in_doubt() {
    let mut case = exact_case(0);
    copy_landmarks(&mut case, Posture::Erect, Posture::LeftBending, 5.0);
    film_mut(&mut case, Posture::LeftBending).checked = true;
    let analysis = analyzed(&case, &on_a_table());
    assert!(!analysis.has_doubted_film());
    assert!(!verdict(&analysis).contains("no result of this patient is evidence"));
    let note = warned(&analysis, WarningCode::FilmChecked, None);
    assert_eq!((note.code.severity(), note.posture), (Severity::Note, Some(Posture::LeftBending)));
    assert!(note.message.contains("is not in doubt: "), "{}", note.message);
    // Another film stays in doubt.
    copy_landmarks(&mut case, Posture::Erect, Posture::RightBending, 4.0);
    assert!(analyzed(&case, &on_a_table()).has_doubted_film());
}

#[test]
fn a_bend_with_the_mirrored_erect_film_is_reported() {
    let mut case = exact_case(0);
    let erect = mirrored(&case);
    let from = erect.film(Posture::Erect).expect("erect");
    film_mut(&mut case, Posture::RightBending).landmarks = from.landmarks.clone();
    // The picture is mirrored without notice: the sides and the side of the picture come from the other film.
    let film = film_mut(&mut case, Posture::RightBending);
    exchange_sides(film);
    all_landmarks(film).for_each(|landmark| landmark.axis_clockwise = None);
    for case in both_ways(&case) {
        let analysis = analyzed(&case, &on_a_table());
        assert_eq!(doubts(&analysis), [(WarningCode::BendKeepsShape, Some(Posture::RightBending))]);
        assert!(verdict(&analysis).contains("mirrored erect shape"));
    }
}

#[test]
fn one_film_for_two_lying_postures_is_reported() {
    let mut case = exact_case(0);
    copy_landmarks(&mut case, Posture::Neutral, Posture::Traction, 2.0);
    for case in both_ways(&case) {
        let analysis = analyzed(&case, &on_a_table());
        assert_eq!(doubts(&analysis), [(WarningCode::FilmsShowOneShape, Some(Posture::Traction))]);
        assert!(verdict(&analysis).contains("shape of the neutral film"));
    }
}

#[test]
fn a_leaning_erect_film_is_reported_and_a_turned_one_with_crests_is_not() {
    for turn in [-26.0, 26.0] {
        let mut case = Case { synthetic: false, ..exact_case(0) };
        let erect = film_mut(&mut case, Posture::Erect);
        move_landmarks(erect, Angle::from_deg(turn), Frontal::default());
        for case in both_ways(&case) {
            assert_eq!(doubts(&analyzed(&case, &on_a_table())), [], "crests turn with the spine");
        }
        *landmarks(film_mut(&mut case, Posture::Erect)).1 = None;
        for case in both_ways(&case) {
            let analysis = analyzed(&case, &on_a_table());
            assert_eq!(doubts(&analysis), [(WarningCode::ErectLeans, Some(Posture::Erect))]);
            let verdict = verdict(&analysis);
            assert!(verdict.contains("limit 15°") && !verdict.contains("are consistent with"));
        }
    }
}

#[test]
fn bodies_of_another_shape_are_reported_and_another_magnification_is_not() {
    for posture in Posture::MOVED {
        let shaped = |height: f64, width: f64| {
            let mut case = exact_case(0);
            for landmark in all_landmarks(film_mut(&mut case, posture)) {
                let points = landmark.corners.points();
                let mean = |of: fn(&Pixel) -> f64| points.iter().map(of).sum::<f64>() / 4.0;
                let middle = Pixel::new(mean(|p| p.column_px), mean(|p| p.row_px));
                let tilt = (points[1].row_px - points[0].row_px)
                    .atan2(points[1].column_px - points[0].column_px);
                let (sin, cos) = tilt.sin_cos();
                landmark.corners = landmark.corners.map(|p| {
                    let (x, y) = (p.column_px - middle.column_px, p.row_px - middle.row_px);
                    let across = width * (x * cos + y * sin);
                    let along = height * (y * cos - x * sin);
                    Pixel::new(
                        middle.column_px + across * cos - along * sin,
                        middle.row_px + across * sin + along * cos,
                    )
                });
            }
            case
        };
        for case in both_ways(&shaped(0.6, 1.0)) {
            let analysis = analyzed(&case, &on_a_table());
            assert_eq!(doubts(&analysis), [(WarningCode::AnotherPatient, Some(posture))]);
            assert!(verdict(&analysis).contains("same patient"));
        }
        for case in both_ways(&shaped(1.15, 1.15)) {
            assert_eq!(doubts(&analyzed(&case, &on_a_table())), []);
        }
    }
}

#[test]
fn a_cohort_counts_patients_with_doubted_films_and_does_not_test_them() {
    let sound = analyzed(&exact_case(1), &on_a_table());
    let mut case = exact_case(0);
    copy_landmarks(&mut case, Posture::Erect, Posture::LeftBending, 5.0);
    let doubted = analyzed(&case, &on_a_table());
    let cohort = Cohort::of(&[&sound, &doubted].map(CohortPatient::of), 1);
    assert_eq!(cohort.doubted, 1);
    for line in &cohort.outcomes {
        let counts =
            [line.patients, line.bends].map(|all| (all.tested() + all.not_tested, all.doubted));
        assert_eq!(counts, [(1, 1), (2, 2)], "{line:?}");
    }
    assert!(cohort.verdict()[0].starts_with("Films of 1 of 2 patients"), "{:?}", cohort.verdict());
    assert!(cohort.verdict()[0].contains(&format!("{} (left bending)", doubted.case_id)));
    let film = &cohort.doubted_films[0];
    assert_eq!((&film.case_id, film.posture), (&doubted.case_id, Some(Posture::LeftBending)));
    let cohort = Cohort::of(&[CohortPatient::of(&sound)], 1);
    assert!(cohort.doubted_films.is_empty());
    assert_eq!(cohort.doubted, 0);
}
