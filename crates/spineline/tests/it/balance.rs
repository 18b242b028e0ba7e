//! Balance over the pelvis, against the pixels of films and against mirrored and turned ones.

use crate::common::{analyzed, exact_case, film_mut, landmarks, move_landmarks, on_a_table};
use spineline::analysis::Case;
use spineline::anatomy::{Level, Posture, Region};
use spineline::clinical::{Balance, SacralReference, sacral_line_offset_mm};
use spineline::spatial::{Angle, Frontal};

/// Places are computed from pixels in doubles.
const ROUNDING: f64 = 1e-7;

fn balance(case: &Case) -> Balance {
    analyzed(case, &on_a_table()).movement.balance.expect("a film with a vertical")
}

#[test]
fn distances_equal_the_films_in_millimetres() {
    // Oracle: columns of the erect film times their spacing; subject 3 has non-square pixels, subject 5 is seen from the front.
    for subject in [0, 2, 4] {
        let mut case = exact_case(subject);
        let analysis = analyzed(&case, &on_a_table());
        let found = analysis.movement.balance.as_ref().expect("a film with a vertical");
        assert_eq!(found.reference, SacralReference::IliacCrests);
        assert_eq!(found.plumb_level, Level::T2);
        let (image, crests, readings) = landmarks(film_mut(&mut case, Posture::Erect));
        let crests = crests.as_ref().expect("phantoms have crests");
        let left_mm = |column: f64| {
            let middle = 0.5 * (crests.left.column_px + crests.right.column_px);
            let sense = (crests.left.column_px - crests.right.column_px).signum();
            (column - middle) * sense * image.spacing.expect("a spacing").column_mm
        };
        let centre = |level: Level| {
            let body = readings[0].vertebrae[&level].corners.map(|p| image.frontal(p));
            image.pixel(body.measure_location().expect("a body")).column_px
        };
        assert!((found.coronal_balance_mm - left_mm(centre(Level::T2))).abs() < ROUNDING);
        for curve in &analysis.movement.clinical {
            let mm = found.apical_translation_mm[curve.region.index()];
            assert!((mm - left_mm(centre(curve.apex))).abs() < ROUNDING, "{}", curve.region);
        }
    }
}

#[test]
fn the_offset_of_any_point_equals_the_balance() {
    let analysis = analyzed(&exact_case(0), &on_a_table());
    let (erect, balance) = (
        &analysis.movement.erect().outline,
        analysis.movement.balance.as_ref().expect("a vertical"),
    );
    let top = erect.vertebrae.last().expect("vertebrae").location;
    let offset_mm = |point| sacral_line_offset_mm(erect, point).expect("a vertical");
    assert!((offset_mm(top) - balance.coronal_balance_mm).abs() < ROUNDING);
    // Along the vertical of the film nothing changes; across it, every millimetre counts.
    let vertical = erect.vertical.expect("a vertical");
    let up = Frontal::new(0.0, 50.0).rotated(vertical);
    let left = Frontal::new(7.0, 0.0).rotated(vertical);
    assert!((offset_mm(top + up) - offset_mm(top)).abs() < ROUNDING);
    assert!((offset_mm(top + left) - offset_mm(top) - 7.0).abs() < ROUNDING);
}

#[test]
fn a_turned_film_turns_every_tilt_against_the_horizontal() {
    // Oracle: the picture is turned by 4° about its own plane, as a patient who stands on a block.
    let case = exact_case(0);
    let mut turned = case.clone();
    let turn = Angle::from_deg(4.0);
    move_landmarks(film_mut(&mut turned, Posture::Erect), turn, Frontal::default());
    let [a, b] = [balance(&case), balance(&turned)];
    let change = |x: Option<Angle>, y: Option<Angle>| (y.expect("known") - x.expect("known")).deg();
    assert!((change(a.l4_tilt, b.l4_tilt) - 4.0).abs() < ROUNDING);
    assert!((change(a.pelvic_obliquity, b.pelvic_obliquity) - 4.0).abs() < ROUNDING);
    // To the right, by the sine of what T2 stands above the crests.
    assert!(b.coronal_balance_mm < a.coronal_balance_mm - 15.0);
}

#[test]
fn a_balance_and_an_obliquity_that_round_to_zero_have_no_side() {
    let mut case = exact_case(0);
    let (image, crests, readings) = landmarks(film_mut(&mut case, Posture::Erect));
    let top = readings[0].vertebrae[&Level::T2].corners.map(|p| image.frontal(p));
    let middle = image.pixel(top.measure_location().expect("a body")).column_px;
    let crests = crests.as_mut().expect("phantoms have crests");
    let reach = 500.0 * (crests.left.column_px - crests.right.column_px).signum();
    crests.left.column_px = middle + reach;
    crests.right.column_px = middle - reach;
    crests.right.row_px = crests.left.row_px;
    let words = analyzed(&case, &on_a_table()).balance_words();
    assert!(words.starts_with("Plumb line of T2 0 mm from the vertical line"), "{words}");
    assert!(words.contains("pelvic obliquity 0.0°; "), "{words}");
}

#[test]
fn without_crests_the_line_runs_through_the_lowest_vertebra_and_no_obliquity_is_given() {
    let mut case = exact_case(0);
    for film in &mut case.films {
        let (_, crests, _) = landmarks(film);
        *crests = None;
    }
    let analysis = analyzed(&case, &on_a_table());
    let found = analysis.movement.balance.as_ref().expect("a vertical");
    assert_eq!((found.reference, found.pelvic_obliquity), (SacralReference::Base, None));
    assert_eq!(found.t1_tilt, None, "T1 was not marked");
    assert!(analysis.balance_words().contains("through the lowest vertebra"));
    let apex = analysis.movement.regions.bounds[Region::MainThoracic.index()].apex;
    assert!(found.stable.model_index().expect("a level of the model") < apex);
}
