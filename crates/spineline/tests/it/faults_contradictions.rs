//! Films and landmarks that contradict themselves.

use crate::common::{
    all_landmarks, analyzed, exact_case, film_mut, landmarks, landmarks_mut, mirrored, move_places,
    on_a_table, refused, spacing, warned,
};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture};
use spineline::measure::{
    Corners, Film, FilmLandmarks, FilmReadings, ImageGeometry, LateralFilm, Noise, Origin, Reading,
    ReadingId, SpacingPlane, TiltRule, VertebraLandmarks, judge_landmarks, judge_reading,
};
use spineline::spatial::{Angle, Pixel};
use spineline::warning::WarningCode;

/// The same patient on films of both kinds: as held, mirrored, and with pixels twice as high as wide.
fn variants() -> [Case; 3] {
    let plain = exact_case(0);
    let mut oblong = plain.clone();
    for film in &mut oblong.films {
        spacing(landmarks(film).0).row_mm *= 2.0;
        move_places(film, |place| Pixel::new(place.column_px, 0.5 * place.row_px));
    }
    [plain.clone(), mirrored(&plain), oblong]
}

/// Codes of the warnings of a sound case about one vertebra of one film.
fn codes(case: &Case, level: Level) -> Vec<WarningCode> {
    let analysis = analyzed(case, &on_a_table());
    let of = analysis.warnings.all().iter().filter(|one| one.level == Some(level));
    of.filter(|one| one.posture == Some(Posture::Erect)).map(|one| one.code).collect()
}

#[test]
fn the_same_landmarks_in_two_postures_are_one_film() {
    for mut case in variants() {
        let erect = film_mut(&mut case, Posture::Erect).clone();
        film_mut(&mut case, Posture::RightBending).landmarks = erect.landmarks;
        let error = refused(&case);
        assert_eq!(error.code(), "film_repeated");
        let text = error.to_string();
        assert!(text.contains("erect") && text.contains("right bending"), "{text}");
    }
}

#[test]
fn a_lateral_film_with_the_corners_of_a_frontal_film_is_refused() {
    for mut case in variants() {
        for posture in [Posture::Erect, Posture::LeftBending] {
            let (image, _, readings) = landmarks(film_mut(&mut case, posture));
            let (image, read) = (*image, readings[0].clone());
            for are_exchanged in [false, true] {
                // The same picture: the left of the patient, or the right, is taken for the front.
                let corners = read.vertebrae.iter().map(|(&level, landmark)| {
                    let [a, b, c, d] = landmark.corners.points();
                    let places = if are_exchanged { [b, a, d, c] } else { [a, b, c, d] };
                    (level, Corners::from(places))
                });
                let readings =
                    vec![Reading { id: ReadingId::new("B", 1), vertebrae: corners.collect() }];
                let patient_left =
                    if are_exchanged { image.patient_left.opposite() } else { image.patient_left };
                let image = ImageGeometry { patient_left, ..image };
                case.lateral = Some(LateralFilm { image, simultaneous: false, readings });
                let error = refused(&case);
                assert_eq!(error.code(), "film_repeated");
                let text = error.to_string();
                assert!(text.contains("lateral") && text.contains(&posture.to_string()), "{text}");
            }
        }
        case.lateral = None;
        analyzed(&case, &on_a_table());
    }
}

#[test]
fn one_reading_among_others_that_stands_on_two_films_makes_them_one() {
    let mut case = exact_case(0);
    let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let copied = Reading { id: ReadingId::new("B", 7), ..readings[0].clone() };
    landmarks(film_mut(&mut case, Posture::Neutral)).2.push(copied);
    assert_eq!(refused(&case).code(), "film_repeated");
}

#[test]
fn exchanged_columns_and_rows_are_named() {
    for mut case in variants() {
        let film = film_mut(&mut case, Posture::Erect);
        // On the film as it is, and on one that holds the exchanged landmarks too.
        let exchanged = |place: Pixel| Pixel::new(place.row_px, place.column_px);
        all_landmarks(film).for_each(|landmark| landmark.corners = landmark.corners.map(exchanged));
        let (image, ..) = landmarks(film);
        let side = image.columns.max(image.rows);
        assert_eq!(refused(&case).code(), "axes_exchanged");
        let (image, ..) = landmarks(film_mut(&mut case, Posture::Erect));
        (image.columns, image.rows) = (side, side);
        assert_eq!(refused(&case).code(), "axes_exchanged");
    }
}

#[test]
fn impossible_ages_nameless_observers_and_repeats_of_zero_are_refused() {
    for age in [-3.0, 240.0, f64::NAN] {
        let mut case = exact_case(0);
        case.subject.age_years = Some(age);
        assert_eq!(refused(&case).code(), "age");
    }
    let mut case = exact_case(0);
    landmarks(film_mut(&mut case, Posture::Neutral)).2[0].id = ReadingId::new("  ", 1);
    assert_eq!(refused(&case).code(), "observer");
    landmarks(film_mut(&mut case, Posture::Neutral)).2[0].id = ReadingId::new("A", 0);
    let error = refused(&case);
    assert_eq!((error.code(), error.place().limit), ("repeat", Some(1.0)), "{error}");
}

#[test]
fn a_body_with_unlike_sides_is_doubted() {
    for mut case in variants() {
        assert!(codes(&case, Level::T8).is_empty());
        let corners = &mut landmarks_mut(&mut case, Posture::Erect, Level::T8).corners;
        // The left side keeps a quarter of its height.
        let (upper, lower) = (corners.superior_left, corners.inferior_left);
        corners.superior_left = Pixel::new(
            lower.column_px + 0.25 * (upper.column_px - lower.column_px),
            lower.row_px + 0.25 * (upper.row_px - lower.row_px),
        );
        assert!(codes(&case, Level::T8).contains(&WarningCode::BodySidesDiffer));
    }
}

#[test]
fn an_axis_far_from_its_corners_is_doubted() {
    for mut case in variants() {
        landmarks_mut(&mut case, Posture::Erect, Level::T8).axis_clockwise =
            Some(Angle::from_deg(80.0));
        assert!(codes(&case, Level::T8).contains(&WarningCode::AxisAgainstCorners));
    }
}

#[test]
fn a_corner_far_from_the_other_readings_is_named_from_three_readings_on() {
    for mut case in variants() {
        for (readings, expected) in [(2, false), (3, true)] {
            let (_, _, all) = landmarks(film_mut(&mut case, Posture::Erect));
            let first = all[0].clone();
            *all = (1..=readings)
                .map(|repeat| Reading { id: ReadingId::new("A", repeat), ..first.clone() })
                .collect();
            let odd = all.last_mut().expect("two or three readings");
            let corners = &mut odd.vertebrae.get_mut(&Level::T8).expect("all are marked").corners;
            let (near, far) = (corners.superior_left, corners.superior_right);
            corners.superior_left.column_px += 0.3 * (near.column_px - far.column_px);
            let found = codes(&case, Level::T8).contains(&WarningCode::CornerFarFromReadings);
            assert_eq!(found, expected, "{readings} readings");
        }
    }
}

/// The erect film of a case with one corner moved, in columns, by a part of the body's width.
fn with_corner_moved(mut case: Case, level: Level, part: f64) -> Case {
    let corners = &mut landmarks_mut(&mut case, Posture::Erect, level).corners;
    let width = corners.superior_left.column_px - corners.superior_right.column_px;
    corners.superior_left.column_px += part * width;
    case
}

fn erect(case: &Case) -> &Film {
    case.film(Posture::Erect).expect("every case has one")
}

#[test]
fn a_corner_far_from_where_its_neighbours_put_it_is_named_in_one_reading() {
    for case in variants() {
        // In the middle, and at both ends, where two vertebrae of one side predict the third with more error.
        for (level, part, expected) in [
            (Level::T8, 0.7, true),
            (Level::T8, 0.15, false),
            (Level::L4, 1.5, true),
            (Level::T2, 1.5, true),
        ] {
            let moved = with_corner_moved(case.clone(), level, part);
            let warnings = judge_landmarks(erect(&moved));
            let found: Vec<_> = warnings
                .all()
                .iter()
                .filter(|warning| warning.code == WarningCode::CornerFarFromNeighbours)
                .collect();
            assert_eq!(!found.is_empty(), expected, "{level} {part}: {found:?}");
            for warning in found {
                assert_eq!((warning.level, warning.posture), (Some(level), Some(Posture::Erect)));
                assert!(warning.message.contains("superior left"), "{}", warning.message);
                assert!(warning.message.contains("limit"), "{}", warning.message);
            }
        }
        let moved = with_corner_moved(case, Level::T8, 0.7);
        assert!(codes(&moved, Level::T8).contains(&WarningCode::CornerFarFromNeighbours));
    }
}

#[test]
fn no_trend_is_seen_in_fewer_than_five_vertebrae() {
    for (count, expected) in [(4, false), (5, true)] {
        let mut case = with_corner_moved(exact_case(0), Level::T8, 0.8);
        let (_, _, readings) = landmarks(film_mut(&mut case, Posture::Erect));
        let first = Level::MODEL.into_iter().position(|level| level == Level::T10);
        let kept = &Level::MODEL[first.expect("a level of the model")..][..count];
        readings[0].vertebrae.retain(|level, _| kept.contains(level));
        let found = judge_landmarks(erect(&case)).has(WarningCode::CornerFarFromNeighbours);
        assert_eq!(found, expected, "{count} vertebrae");
    }
}

#[test]
fn a_body_that_lies_beside_its_neighbours_as_a_whole_has_no_odd_corner() {
    let mut case = exact_case(0);
    let corners = &mut landmarks_mut(&mut case, Posture::Erect, Level::T8).corners;
    *corners = corners.map(|place| Pixel::new(place.column_px + 60.0, place.row_px));
    assert!(!judge_landmarks(erect(&case)).has(WarningCode::CornerFarFromNeighbours));
}

#[test]
fn a_reading_is_compared_with_the_others_without_warnings_about_them() {
    let mut case = exact_case(0);
    let (_, _, all) = landmarks(film_mut(&mut case, Posture::Erect));
    let first = all[0].clone();
    *all = (1..=3)
        .map(|repeat| Reading { id: ReadingId::new("A", repeat), ..first.clone() })
        .collect();
    let corners = &mut all[2].vertebrae.get_mut(&Level::T8).expect("marked").corners;
    corners.superior_left.column_px += 100.0;
    let judged = |repeat| judge_reading(erect(&case), &ReadingId::new("A", repeat));
    assert!(judged(3).has(WarningCode::CornerFarFromReadings));
    assert!(judged(1).all().is_empty(), "{:?}", judged(1));
}

#[test]
fn readings_that_name_the_vertebrae_one_level_apart_doubt_the_film() {
    let shifted = |by: isize| {
        let mut case = exact_case(0);
        let (_, _, all) = landmarks(film_mut(&mut case, Posture::Erect));
        let names = |(&level, landmark): (&Level, &VertebraLandmarks)| {
            let place = Level::ALL.iter().position(|one| *one == level)?;
            let name = Level::ALL.get(place.checked_add_signed(by)?)?;
            // Equal readings would be copies.
            let moved = |place: Pixel| Pixel::new(place.column_px + 1.0, place.row_px);
            let corners = landmark.corners.map(moved);
            Some((*name, VertebraLandmarks { corners, ..*landmark }))
        };
        let vertebrae = all[0].vertebrae.iter().filter_map(names).collect();
        all.push(Reading { id: ReadingId::new("B", 1), vertebrae });
        let first = all[0].id.clone();
        (case, first)
    };
    assert!(judge_landmarks(erect(&shifted(0).0)).all().is_empty());
    for (by, words) in [(1, "one level higher"), (-1, "one level lower"), (2, "two levels higher")]
    {
        let (case, first) = shifted(by);
        let all = judge_landmarks(erect(&case));
        let found = all.all().iter().find(|one| one.code == WarningCode::LevelsMayBeShifted);
        let text = &found.expect("a doubt").message;
        assert!(text.starts_with("observer B (repeat 1) names") && text.contains(words), "{text}");
        // A reader sees it too, on this reading and on the other one.
        for id in [ReadingId::new("B", 1), first] {
            assert!(judge_reading(erect(&case), &id).has(WarningCode::LevelsMayBeShifted));
        }
    }
}

#[test]
fn readings_that_are_far_apart_are_reported() {
    let mut case = exact_case(0);
    let (image, _, all) = landmarks(film_mut(&mut case, Posture::Erect));
    let mm = image.spacing.expect("a spacing").column_mm;
    let mut other = all[0].clone();
    other.id = ReadingId::new("B", 1);
    for landmark in other.vertebrae.values_mut() {
        let moved = |place: Pixel| Pixel::new(place.column_px + 12.0 / mm, place.row_px);
        landmark.corners = landmark.corners.map(moved);
    }
    all.push(other);
    let found = judge_landmarks(erect(&case));
    assert!(found.has(WarningCode::ReadingsApart), "{:?}", found.all());
    assert!(!found.has(WarningCode::LevelsMayBeShifted));
}

/// The case with a second reading of every film: the first one, changed.
fn read_again(case: &Case, change: impl Fn(&mut Reading<VertebraLandmarks>)) -> Case {
    let mut case = case.clone();
    for film in &mut case.films {
        let (_, _, all) = landmarks(film);
        let mut other = Reading { id: ReadingId::new("Z", 1), ..all[0].clone() };
        change(&mut other);
        all.insert(0, other);
    }
    case
}

fn move_by(reading: &mut Reading<VertebraLandmarks>, columns: f64) {
    let moved = |place: Pixel| Pixel::new(place.column_px + columns, place.row_px);
    reading.vertebrae.values_mut().for_each(|mark| mark.corners = mark.corners.map(moved));
}

#[test]
fn a_copied_reading_counts_once_and_its_noise_is_not_measured() {
    // Oracle: the same case without the copy.
    for case in variants() {
        let alone = analyzed(&case, &on_a_table());
        assert!(!alone.warnings.has(WarningCode::ReadingsCopied));
        // As it was, and as another format rounds it.
        for columns in [0.0, 0.004] {
            let copied = read_again(&case, |reading| move_by(reading, columns));
            let found = analyzed(&copied, &on_a_table());
            for (film, alone) in found.movement.films.iter().zip(&alone.movement.films) {
                assert_eq!(film.outline, alone.outline);
                assert_eq!((film.outline.noise, film.outline.readings), (Noise::ONE_READING, 1));
                let posture = film.outline.posture;
                let text = &warned(&found, WarningCode::ReadingsCopied, Some(posture)).message;
                assert!(text.contains("A (repeat 1), Z (repeat 1)"), "{text}");
            }
            assert!(found.warnings.has(WarningCode::ReliabilityOneReading));
            assert!(found.reliability().is_empty());
        }
        // A reader who places the vertebrae again does not meet one of them within 0.01 pixels.
        let again = read_again(&case, |reading| move_by(reading, 0.5));
        let found = analyzed(&again, &on_a_table());
        assert!(!found.warnings.has(WarningCode::ReadingsCopied));
        assert!(found.movement.erect().outline.noise.is_measured());
        assert_eq!(found.movement.erect().outline.readings, 2);
    }
}

#[test]
fn a_copy_keeps_its_own_vertebrae_and_one_moved_vertebra_makes_another_reading() {
    let case = exact_case(0);
    // The original lacks T2, and the copy L4.
    let mut parted = read_again(&case, |reading| {
        reading.vertebrae.remove(&Level::L4);
    });
    for film in &mut parted.films {
        landmarks(film).2[1].vertebrae.remove(&Level::T2);
    }
    let [whole, parted] = [&case, &parted].map(|case| analyzed(case, &on_a_table()));
    assert_eq!(parted.movement.erect().outline, whole.movement.erect().outline);
    assert!(!parted.warnings.has(WarningCode::ReadingsIncomplete));
    let moved = read_again(&case, |reading| {
        let corners = &mut reading.vertebrae.get_mut(&Level::T8).expect("marked").corners;
        corners.superior_left.row_px += 0.1;
    });
    assert!(!judge_landmarks(erect(&moved)).has(WarningCode::ReadingsCopied));
    // A agrees with both others, because it lacks T8: only one of them is its copy.
    let mut three = moved.clone();
    let readings = landmarks(&mut three.films[0]).2;
    let whole = Reading { id: ReadingId::new("B", 1), ..readings[1].clone() };
    readings[1].vertebrae.remove(&Level::T8);
    readings.push(whole);
    let found = FilmReadings::measure(erect(&three), TiltRule::default()).expect("a sound film");
    let ids: Vec<&ReadingId> = found.readings.iter().map(|reading| &reading.id).collect();
    assert_eq!(ids, [&ReadingId::new("A", 1), &ReadingId::new("Z", 1)]);
    assert_eq!(found.copied, [ReadingId::new("B", 1)]);
    // Readers who accept a program's corners have the same ones.
    let accepted = read_again(&case, |reading| {
        let origins = Corners::all(Origin::Accepted);
        reading.vertebrae.values_mut().for_each(|mark| mark.origins = origins);
    });
    assert!(!judge_landmarks(erect(&accepted)).has(WarningCode::ReadingsCopied));
}

#[test]
fn copies_are_left_out_of_reliability_with_and_without_corners() {
    let case = read_again(&exact_case(0), |_| {});
    let rule = TiltRule::default();
    let film = erect(&case);
    let both = spineline::measure::measure_readings(film, rule).expect("a sound film");
    let placed = Film { landmarks: FilmLandmarks::placed(SpacingPlane::Patient, both), ..*film };
    for film in [film, &placed] {
        let found = FilmReadings::measure(film, rule).expect("a sound film");
        let ids: Vec<&ReadingId> = found.readings.iter().map(|reading| &reading.id).collect();
        assert_eq!(ids, [&ReadingId::new("A", 1)]);
        assert_eq!(found.copied, [ReadingId::new("Z", 1)]);
    }
    // Two readings of one name are refused, whether they are copies or not.
    let twice = read_again(&exact_case(0), |reading| reading.id = ReadingId::new("A", 1));
    assert_eq!(refused(&twice).code(), "duplicate_reading");
}

#[test]
fn films_with_placements_have_no_corners_to_judge() {
    let film = exact_case(0).films.remove(0);
    let readings =
        spineline::measure::measure_readings(&film, TiltRule::default()).expect("a sound film");
    let landmarks = FilmLandmarks::placed(SpacingPlane::Patient, readings);
    let film = Film { landmarks, ..film };
    assert!(judge_landmarks(&film).all().is_empty());
}
