//! The vertebrae between which the amplitude of a film is measured.

use spineline::analysis::{AnalysisOptions, analyze_movement};
use spineline::anatomy::Level;
use spineline::measure::{AmplitudeEnds, Outline};
use spineline::spatial::{Angle, Frontal};
use spineline_phantom::{Readers, Scenario, generate};

/// An erect film with L5 and T1 at given places beside the model.
fn film(amplitude: AmplitudeEnds, l5: Frontal, t1: Frontal) -> Outline {
    let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("a phantom");
    let options = AnalysisOptions { amplitude, ..AnalysisOptions::default() };
    let movement = analyze_movement(&phantom.case, &options).expect("a sound case").movement;
    let mut film = movement.erect().outline.clone();
    let (base, top) = (film.vertebrae[0], film.vertebrae[14]);
    film.others = Vec::new();
    for (level, location, like) in [(Level::L5, l5, base), (Level::T1, t1, top)] {
        let mut vertebra = like;
        (vertebra.level, vertebra.location) = (level, location);
        film.others.push(vertebra);
    }
    film.iliac_normal = Some(Angle::from_deg(2.0));
    film
}

#[test]
fn the_amplitude_is_the_tilt_of_the_line_through_t1_and_l5_where_both_are_marked() {
    // Oracle: the angle of the line by hand; the patient's left is positive, a tilt to the right too.
    let (l5, t1) = (Frontal::new(5.0, -35.0), Frontal::new(-65.0, 365.0));
    let marked = film(AmplitudeEnds::T1L5, l5, t1);
    let expected_deg = Angle::from_rad((70.0_f64 / 400.0).atan()).deg() - 2.0;
    assert!((marked.amplitude().deg() - expected_deg).abs() < 1e-12);
    assert_eq!(marked.amplitude_levels(), [Level::L5, Level::T1]);

    let mirror = |at: Frontal| Frontal::new(-at.y_mm, at.z_mm);
    let mut mirrored = film(AmplitudeEnds::T1L5, mirror(l5), mirror(t1));
    mirrored.iliac_normal = Some(Angle::from_deg(-2.0));
    assert!((mirrored.amplitude().deg() + expected_deg).abs() < 1e-12);
}

#[test]
fn without_one_of_them_the_amplitude_is_that_of_the_model() {
    let (l5, t1) = (Frontal::new(5.0, -35.0), Frontal::new(-65.0, 365.0));
    let usual = film(AmplitudeEnds::Model, l5, t1);
    let mut alone = film(AmplitudeEnds::T1L5, l5, t1);
    alone.others.pop();
    for film in [usual, alone] {
        assert_eq!(film.amplitude_levels(), [Level::L4, Level::T2]);
        let expected = film.top().lateral_tilt() - Angle::from_deg(2.0);
        assert_eq!(film.amplitude(), expected);
    }
}
