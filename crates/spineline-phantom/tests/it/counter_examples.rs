//! Counter-examples move as stated, and readers of one phantom differ only in the size of their errors.

use spineline::anatomy::Posture;
use spineline::spatial::{Angle, Pixel};
use spineline_phantom::{Phantom, Readers, SUBJECTS, Scenario, generate, generate_read};

use crate::recovery::exact;

fn turns_rad(phantom: &Phantom, posture: Posture) -> Vec<f64> {
    let tilts = &phantom.posture(posture).expect("five postures").tilts;
    tilts.windows(2).map(|pair| (pair[1] - pair[0]).rad()).collect()
}

/// How far every joint turns from the erect posture.
fn rotations_rad(phantom: &Phantom, posture: Posture) -> Vec<f64> {
    let erect = turns_rad(phantom, Posture::Erect);
    turns_rad(phantom, posture).iter().zip(erect).map(|(moved, erect)| moved - erect).collect()
}

/// A reader with independent corner errors.
fn rough(corner_sd_mm: f64) -> Readers {
    Readers { corner_sd_mm, ..Readers::exact() }
}

fn corners(phantom: &Phantom) -> Vec<Pixel> {
    let readings = phantom.case.films.iter().flat_map(|film| film.landmarks.corner_readings());
    readings
        .flat_map(|r| r.vertebrae.values())
        .flat_map(|landmark| landmark.corners.points())
        .collect()
}

#[test]
fn a_flattened_spine_keeps_the_shape_of_its_curvature() {
    // Oracle: by definition, each turn is multiplied by one number per posture.
    let phantom = exact(3, Scenario::Flatten);
    let erect = turns_rad(&phantom, Posture::Erect);
    for posture in Posture::MOVED {
        let moved = turns_rad(&phantom, posture);
        let factor = moved[5] / erect[5];
        assert!((factor - 1.0).abs() > 0.05, "{posture} moves");
        // The joint above L4 begins in the half segment at the clamped base.
        for (moved, erect) in moved.iter().zip(&erect).skip(1) {
            assert!((moved - factor * erect).abs() < 1e-12);
        }
    }
}

#[test]
fn a_line_beside_the_inflections_rotates_joints_by_their_lever_arms() {
    // Oracle: a joint with both ends on one side of the line turns to that side; springs do not push back.
    for index in [0, 10, 17] {
        let phantom = exact(index, Scenario::Offset);
        for posture in Posture::MOVED {
            let moved = phantom.posture(posture).expect("five postures");
            let line = moved.line.expect("a force has a line");
            let arms: Vec<f64> = moved.locations.iter().map(|&l| line.lever_arm_mm(l)).collect();
            let rotations = rotations_rad(&phantom, posture);
            let mut seen = 0;
            for (arms, rotation) in arms.windows(2).zip(rotations) {
                // Between two vertebrae the spine bows by a few millimetres at most.
                if arms[0] * arms[1] > 0.0 && arms[0].abs().min(arms[1].abs()) > 3.0 {
                    assert!(arms[0] * moved.force_n * rotation > 0.0);
                    seen += 1;
                }
            }
            assert!(seen > 3, "subject {}, {posture}: {seen} joints beside the line", index + 1);
            let off = moved.inflections.map(|place| line.lever_arm_mm(place).abs());
            assert!(off.into_iter().fold(0.0, f64::max) > 1.0, "the line misses the inflections");
        }
    }
}

#[test]
fn a_distributed_horizontal_load_rotates_every_joint_to_its_side_and_the_lowest_most() {
    // Oracle: its moment has one sign and increases towards L4, because everything above adds to it.
    let phantom = exact(0, Scenario::Spread);
    for (posture, sense) in [(Posture::LeftBending, -1.0), (Posture::RightBending, 1.0)] {
        let moved = phantom.posture(posture).expect("five postures");
        assert!(moved.force_n * sense < 0.0, "+y is the patient's left");
        assert!(rotations_rad(&phantom, posture).iter().all(|turn| turn * sense > 0.0));
        let tilt =
            |posture| phantom.posture(posture).expect("five postures").locations[14].lateral_tilt();
        let change: Angle = tilt(posture) - tilt(Posture::Erect);
        assert!((14.9..25.1).contains(&(sense * change.deg())), "{posture}: {change}");
    }
}

#[test]
fn random_rotations_have_both_signs_and_bends_have_their_sides() {
    // Oracle: 14 independent normal turns have one sign once in 8000 times.
    for index in 0..SUBJECTS.len() {
        let phantom = exact(index, Scenario::Random);
        let tilt =
            |posture| phantom.posture(posture).expect("five postures").locations[14].lateral_tilt();
        assert!(tilt(Posture::LeftBending) < tilt(Posture::RightBending));
        let rotations = rotations_rad(&phantom, Posture::Traction);
        assert!(rotations.iter().any(|r| *r > 0.0) && rotations.iter().any(|r| *r < 0.0));
    }
}

#[test]
fn phantoms_of_a_subject_share_anatomy_in_every_scenario() {
    // Oracle: the erect posture is drawn before anything moves.
    for index in 0..SUBJECTS.len() {
        let erect = Scenario::ALL.map(|scenario| {
            exact(index, scenario).posture(Posture::Erect).expect("an erect posture").clone()
        });
        assert!(erect.iter().all(|other| *other == erect[0]));
    }
}

#[test]
fn readers_of_one_phantom_err_in_the_same_directions() {
    // Oracle: twice the deviation gives twice the error, to the rounding of a pixel's coordinate.
    let readers = [rough(0.0), rough(0.1), rough(0.2)];
    let read = generate_read(2, 0, Scenario::Bend, &readers, 5).expect("a phantom");
    let [none, some, twice] = [0, 1, 2].map(|i| corners(&read[i]));
    assert_eq!(none.len(), 5 * 15 * 4);
    for ((none, some), twice) in none.iter().zip(&some).zip(&twice) {
        let error = |a: f64, b: f64, c: f64| (c - a - 2.0 * (b - a)).abs();
        assert!(error(none.column_px, some.column_px, twice.column_px) < 1e-9);
        assert!(error(none.row_px, some.row_px, twice.row_px) < 1e-9);
    }
}

#[test]
fn copies_are_different_patients_of_the_same_table_row() {
    // Oracle: copy 0 is the phantom itself; a copy has its row's main angle and another length.
    let readers = Readers::default();
    let first = generate(1, Scenario::Rod, &readers, 3).expect("a phantom");
    let copies =
        [0, 1].map(|copy| generate_read(1, copy, Scenario::Rod, &[readers], 3).expect("a phantom"));
    assert_eq!(copies[0], std::slice::from_ref(&first));
    assert_eq!(copies[1][0].case.subject, first.case.subject);
    assert_ne!(copies[1][0].case.id, first.case.id);
    assert_ne!(copies[1][0].postures[0].locations, first.postures[0].locations);
}
