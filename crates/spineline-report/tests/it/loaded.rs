//! The figure of a spine under loads has labels, and shapes without a result are drawn differently.

use spineline::action::LineKind;
use spineline::analysis::PersonalisedModel;
use spineline::anatomy::Level;
use spineline::multibody::{Goal, PathEnding, SpineModel, Support, Timing};
use spineline::response::go_on;
use spineline::spatial::{Mat3, Vec3};
use spineline_files::{AppliedLoad, LoadFile, Simulated};
use spineline_report::figures::loaded_spine;

/// Vertebrae upon one another, bent a little to the left.
fn model(synthetic: bool) -> PersonalisedModel {
    let place = |i: usize| Vec3::new(0.0, 0.02 * (14.0 - i as f64) * i as f64, 25.0 * i as f64);
    let midpoints = (0..15).map(place).collect();
    PersonalisedModel {
        case_id: "test <1> & co".to_owned(),
        synthetic,
        line: LineKind::Inflection,
        absolute: false,
        carried_body_mass_kg: None,
        levels: Level::MODEL.to_vec(),
        pitch_from: vec![None; 15],
        axial_from: vec![None; 15],
        widths_mm: vec![None; 15],
        spine: SpineModel::from_poses(
            midpoints,
            vec![Mat3::identity(); 15],
            &[Vec3::new(-15.0, 0.0, 10.0); 14],
        ),
        stiffness_nmm_per_rad: vec![[1.5e5; 3]; 14],
        stiffness: vec![Mat3::identity() * 1.5e5; 14],
        curves: None,
        support: Support::Free,
        loads: Vec::new(),
        doubts: Vec::new(),
    }
}

fn picture(synthetic: bool, load: &AppliedLoad, ending: Option<PathEnding>) -> String {
    let loads = LoadFile::new(vec![load.clone()]);
    let (goal, limit) = (Goal::FullLoad, Some(2.0));
    let found = Simulated::of(model(synthetic), loads, goal, limit, Vec::new(), &mut go_on);
    let mut found = found.expect("sound loads");
    found.response.ending = ending.unwrap_or(found.response.ending);
    loaded_spine(&found)
}

fn loads() -> [(AppliedLoad, &'static str); 4] {
    let (level, timing) = (Level::T2, Timing::Proportional);
    let (force_n, zero) = ([0.0, 20.0, 0.0], [0.0; 3]);
    [
        (
            AppliedLoad::ForceAtPoint { level, force_n, point_in_vertebra_mm: zero, timing },
            "arrows in proportion",
        ),
        (
            AppliedLoad::ForceOnLine { level, force_n, point_mm: [0.0, 0.0, 300.0], timing },
            "fixed in space",
        ),
        (AppliedLoad::Moment { level, moment_nmm: [2000.0, 0.0, 0.0], timing }, "moment"),
        (
            AppliedLoad::Strap {
                level,
                point_in_vertebra_mm: zero,
                anchor_mm: [0.0, 150.0, 300.0],
                n_per_mm: 1.0,
                shortening_mm: 9.0,
                timing,
            },
            "strap",
        ),
    ]
}

#[test]
fn every_kind_of_load_is_drawn_and_named() {
    for (load, words) in loads() {
        let svg = picture(true, &load, None);
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"), "{words}");
        assert_eq!(svg.matches("<g").count(), svg.matches("</g>").count(), "{words}");
        for words in [
            words,
            "synthetic data",
            "(mm)",
            "Seen from behind",
            "LEFT",
            "FRONT",
            "not newtons",
            "T2",
            "Load 1:",
        ] {
            assert!(svg.contains(words), "{words}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("not a result"));
        assert_eq!(svg, picture(true, &load, None), "the same input makes the same bytes");
        assert!(!picture(false, &load, None).contains("synthetic"));
    }
}

#[test]
fn shapes_without_a_result_are_drawn_differently() {
    for (load, _) in loads() {
        let (good, bad) =
            (picture(true, &load, None), picture(true, &load, Some(PathEnding::LimitPoint)));
        assert_eq!(bad.matches(">not a result (limit_point)<").count(), 2, "on both panels");
        assert!(bad.contains("Not a result (limit_point)") && good.contains(">under load<"));
        assert!(!bad.contains(">under load<"));
    }
}
