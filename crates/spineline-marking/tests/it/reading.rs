//! Unfinished readings of phantoms: proposals and faults, which do not depend on the orientation of a film.

use std::collections::BTreeMap;

use spineline::anatomy::Level;
use spineline::measure::completion::provide_shape;
use spineline::measure::{CornerFault, CornerName, Corners, ImageGeometry, Origin};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline_marking::{
    MarkingFault, NextLandmark, PartialLandmarks, PartialReading, ProposedVertebra,
    turn_axis_towards,
};
use spineline_phantom::{Phantom, Readers, SUBJECTS, Scenario, generate};

/// A proposal's midpoint lies within this part of a level of the truth.
const NEAR: f64 = 0.35;

fn phantom(index: usize) -> Phantom {
    generate(index, Scenario::Rod, &Readers::exact(), 1).expect("a phantom")
}

fn marked(vertebrae: &BTreeMap<Level, Corners<Pixel>>, levels: &[Level]) -> PartialReading {
    provide_shape(spineline_weights::ERECT_SPINES);
    let landmarks = levels.iter().map(|&level| {
        (
            level,
            PartialLandmarks {
                corners: vertebrae[&level].map(Some),
                ..PartialLandmarks::default()
            },
        )
    });
    PartialReading { vertebrae: landmarks.collect(), crests: [None; 2] }
}

fn midpoint(image: &ImageGeometry, corners: &Corners<Pixel>) -> spineline::spatial::Frontal {
    corners.map(|corner| image.frontal(corner)).measure_location().expect("a body")
}

#[test]
fn proposals_are_near_the_true_corners_on_every_film() {
    for index in [0, 2, 4, SUBJECTS.len() - 1] {
        for film in &phantom(index).films {
            for count in 1..Level::MODEL.len() {
                let reading = marked(&film.vertebrae, &Level::MODEL[..count]);
                let next = Level::MODEL[count];
                let proposals = reading.propose(&film.image, Some(film.posture), None);
                let proposal = proposals.first().expect("a proposal");
                assert_eq!(proposal.level, next);
                let truth = midpoint(&film.image, &film.vertebrae[&next]);
                let before = midpoint(&film.image, &film.vertebrae[&Level::MODEL[count - 1]]);
                let off = midpoint(&film.image, &proposal.corners).distance_mm(truth);
                let part = off / truth.distance_mm(before);
                assert!(part < NEAR, "{} of a level at {next} of film {}", part, film.posture);
                assert!(proposal.corners.points().iter().all(|&p| film.image.contains(p)));
            }
            assert_eq!(marked(&film.vertebrae, &Level::MODEL).faults(&film.image), []);
        }
    }
}

#[test]
fn a_body_unlike_its_neighbours_is_named_and_they_are_not() {
    for film in &phantom(0).films {
        let image = film.image;
        let truth = film.vertebrae[&Level::T8].map(|corner| image.frontal(corner));
        let centre = truth.measure_location().expect("a body");
        let marked_with = |change: &dyn Fn(Frontal) -> Frontal| {
            let moved = truth.map(|corner| image.pixel(centre + change(corner - centre)));
            let mut reading = marked(&film.vertebrae, &Level::MODEL);
            let body = PartialLandmarks { corners: moved.map(Some), ..PartialLandmarks::default() };
            reading.vertebrae.insert(Level::T8, body);
            reading.faults(&image)
        };
        // Both about the middle of the body, so that its place is unchanged.
        for by in [0.5, 2.0] {
            let faults = marked_with(&|way| way * by);
            let [MarkingFault::Width { level: Level::T8, ratio }] = faults[..] else {
                panic!("{}: {faults:?}", film.posture)
            };
            assert!((ratio / by - 1.0).abs() < 0.15, "bodies widen caudally: {ratio}");
        }
        for turn in [Angle::from_deg(-40.0), Angle::from_deg(40.0)] {
            let faults = marked_with(&|way| way.rotated(turn));
            let [MarkingFault::Tilt { level: Level::T8, step }] = faults[..] else {
                panic!("{}: {faults:?}", film.posture)
            };
            assert!(
                (step - turn).abs().deg() < 10.0,
                "neighbours are tilted alike: {}",
                step.deg()
            );
        }
        assert_eq!(marked_with(&|way| way), []);
    }
}

#[test]
fn a_landmark_far_from_the_spine_is_doubted_and_a_true_one_is_not() {
    for film in &phantom(0).films {
        let with_one = |count: usize, level: Level, place: Pixel| {
            let mut reading = marked(&film.vertebrae, &Level::MODEL[..count]);
            let mut one = PartialLandmarks::default();
            one.corners.superior_left = Some(place);
            reading.vertebrae.insert(level, one);
            reading.faults(&film.image)
        };
        for (count, &level) in Level::MODEL.iter().enumerate().skip(1) {
            let true_place = film.vertebrae[&level].superior_left;
            assert_eq!(with_one(count, level, true_place), [], "{level} of {}", film.posture);
        }
        let Pixel { column_px, row_px } = film.vertebrae[&Level::T2].superior_left;
        let aside = if column_px > 700.0 { column_px - 700.0 } else { column_px + 700.0 };
        let faults = with_one(Level::MODEL.len(), Level::T1, Pixel::new(aside, row_px));
        let [MarkingFault::Far { level: Level::T1, near: Level::T2, ratio }] = faults[..] else {
            panic!("{}: {faults:?}", film.posture)
        };
        assert!(ratio > 1.5, "{ratio}");
    }
}

#[test]
fn a_mirrored_picture_has_mirrored_proposals_and_axes() {
    let film = &phantom(2).films[1];
    let image = film.image;
    let other = image.patient_left.opposite();
    let mirrored = ImageGeometry { patient_left: other, ..image };
    let flip = |p: Pixel| Pixel::new(f64::from(image.columns - 1) - p.column_px, p.row_px);
    let flipped = film.vertebrae.iter().map(|(&level, c)| (level, c.map(flip))).collect();
    let levels = &Level::MODEL[..5];
    let here = marked(&film.vertebrae, levels);
    let there = marked(&flipped, levels);
    let (a, b) = (here.propose(&image, None, None), there.propose(&mirrored, None, None));
    let (a, b) = (a.first().expect("a proposal"), b.first().expect("a proposal"));
    for (p, q) in a.corners.map(flip).points().into_iter().zip(b.corners.points()) {
        assert!((p.column_px - q.column_px).abs() < 1e-6 && (p.row_px - q.row_px).abs() < 1e-6);
    }
    for (landmark, twin) in here.vertebrae.values().zip(there.vertebrae.values()) {
        let (landmark, twin) = (landmark.body(&image), twin.body(&mirrored));
        let (landmark, twin) = (landmark.expect("a body"), twin.expect("a body"));
        assert!((landmark.axis_clockwise + twin.axis_clockwise).rad().abs() < 1e-9);
        assert!((landmark.tilt - twin.tilt).rad().abs() < 1e-9, "the patient did not move");
    }
}

#[test]
fn an_axis_rotated_towards_its_own_end_does_not_change() {
    // Subject 3 has pixels that are not square.
    for index in [0, 2] {
        let film = &phantom(index).films[0];
        for landmark in marked(&film.vertebrae, &Level::MODEL).vertebrae.values() {
            let body = landmark.body(&film.image).expect("a body");
            let turned = turn_axis_towards(&film.image, body.midpoint, body.axis[1]);
            let off = turned.expect("a direction").deg() - body.axis_clockwise.deg();
            assert!(off.abs() <= 0.05 + 1e-9, "{off}");
        }
    }
}

#[test]
fn swapped_corners_are_detected_with_three_and_four_corners() {
    let film = &phantom(0).films[0];
    let truth = film.vertebrae[&Level::T8];
    let mirrored = Corners {
        superior_left: truth.superior_right,
        superior_right: truth.superior_left,
        inferior_left: truth.inferior_right,
        inferior_right: truth.inferior_left,
    };
    let upside_down = Corners {
        superior_left: truth.inferior_left,
        superior_right: truth.inferior_right,
        inferior_left: truth.superior_left,
        inferior_right: truth.superior_right,
    };
    for (corners, fault) in
        [(mirrored, CornerFault::SidesExchanged), (upside_down, CornerFault::UpsideDown)]
    {
        for missing in CornerName::ORDER.into_iter().map(Some).chain([None]) {
            let mut reading = marked(&film.vertebrae, &[Level::L1, Level::T12]);
            let mut some = corners.map(Some);
            match missing {
                Some(CornerName::SuperiorLeft) => some.superior_left = None,
                Some(CornerName::SuperiorRight) => some.superior_right = None,
                Some(CornerName::InferiorRight) => some.inferior_right = None,
                Some(CornerName::InferiorLeft) => some.inferior_left = None,
                None => {}
            }
            let landmark = PartialLandmarks { corners: some, ..PartialLandmarks::default() };
            reading.vertebrae.insert(Level::T8, landmark);
            let expected = MarkingFault::Corners { level: Level::T8, fault };
            assert_eq!(reading.faults(&film.image).first(), Some(&expected), "{missing:?}");
        }
    }
}

#[test]
fn rows_that_count_from_the_bottom_do_not_blame_the_side() {
    let count = Level::MODEL.len();
    for film in &phantom(0).films {
        let image = film.image;
        let flip = |p: Pixel| Pixel::new(p.column_px, f64::from(image.rows - 1) - p.row_px);
        let flipped = film.vertebrae.iter().map(|(&level, c)| (level, c.map(flip))).collect();
        let faults = marked(&flipped, &Level::MODEL).faults(&image);
        assert_eq!(faults, [MarkingFault::RowsFromBottom { count }]);
        let other = ImageGeometry { patient_left: image.patient_left.opposite(), ..image };
        let faults = marked(&film.vertebrae, &Level::MODEL).faults(&other);
        assert_eq!(faults, [MarkingFault::Mirrored { count }]);
    }
}

#[test]
fn vertebrae_with_swapped_names_are_out_of_order() {
    let film = &phantom(0).films[0];
    let mut vertebrae = film.vertebrae.clone();
    vertebrae.insert(Level::T8, film.vertebrae[&Level::T9]);
    vertebrae.insert(Level::T9, film.vertebrae[&Level::T8]);
    let faults = marked(&vertebrae, &Level::MODEL).faults(&film.image);
    assert!(faults.iter().any(|fault| fault.code() == "out_of_order"), "{faults:?}");
}

#[test]
fn the_crests_follow_the_vertebrae() {
    let film = &phantom(0).films[0];
    let mut reading = PartialReading::default();
    let order = PartialReading::order(None);
    let first = NextLandmark::Corner(Level::L4, CornerName::SuperiorLeft);
    assert_eq!(reading.next(&order), Some(first));
    reading = marked(&film.vertebrae, &Level::MODEL);
    let optional = NextLandmark::Corner(Level::T1, CornerName::SuperiorLeft);
    assert_eq!(reading.next(&order), Some(optional));
    reading.crests[0] = Some(film.iliac_crests.left);
    assert!(
        matches!(reading.next(&order), Some(NextLandmark::Crest(_))),
        "T1 is skipped after a crest"
    );
    reading.crests[1] = Some(film.iliac_crests.right);
    assert_eq!(reading.next(&order), None);
}

#[test]
fn accepted_corners_are_no_evidence_for_the_next_proposals() {
    let film = &phantom(2).films[0];
    let (first, rest) = Level::MODEL.split_at(3);
    let mut reading = marked(&film.vertebrae, first);
    let before = reading.propose(&film.image, Some(film.posture), None);
    for proposal in &before {
        let accepted = PartialLandmarks {
            corners: proposal.corners.map(Some),
            origins: Corners::all(Origin::Accepted),
            ..PartialLandmarks::default()
        };
        reading.vertebrae.insert(proposal.level, accepted);
    }
    let last = before.last().expect("proposals").level;
    reading.vertebrae.remove(&last);
    let after = reading.propose(&film.image, Some(film.posture), None);
    let sd = |all: &[ProposedVertebra]| {
        all.iter().find(|one| one.level == last).map(|one| one.sd_share).expect("a proposal")
    };
    assert_eq!(sd(&before), sd(&after), "blind acceptance does not make the program surer");
    // Far from the clicks the program is too uncertain to propose anything.
    assert!(before.len() < rest.len() + 2);
}
