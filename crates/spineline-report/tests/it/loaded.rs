//! The figure of a spine under loads has labels, and shapes without a result are drawn differently.

use spineline::anatomy::Level;
use spineline::multibody::{
    BodyLoad, GeneralStatics, Goal, Loading, PathEnding, SpineModel, Support,
};
use spineline::response::{Response, go_on, respond};
use spineline::spatial::{Mat3, Vec3};
use spineline_report::figures::{LoadedSpine, loaded_spine};

/// Vertebrae upon one another, bent a little to the left.
fn model() -> SpineModel {
    let place = |i: usize| Vec3::new(0.0, 0.02 * (14.0 - i as f64) * i as f64, 25.0 * i as f64);
    let midpoints = (0..15).map(place).collect();
    SpineModel::from_poses(
        midpoints,
        vec![Mat3::identity(); 15],
        &[Vec3::new(-15.0, 0.0, 10.0); 14],
    )
}

fn response(model: &SpineModel, loading: &Loading) -> Response {
    let springs = vec![Mat3::identity() * 1.5e5; 14];
    let statics = GeneralStatics::new(model, springs, Support::Free).expect("sound springs");
    respond(&statics, loading, Goal::FullLoad, 2.0, &mut go_on).expect("sound loads")
}

fn picture(synthetic: bool, load: BodyLoad, ending: Option<PathEnding>) -> String {
    let (model, loading) = (model(), Loading::single(14, load));
    let mut response = response(&model, &loading);
    response.ending = ending.unwrap_or(response.ending);
    loaded_spine(&LoadedSpine {
        case_id: "test <1> & co",
        synthetic,
        force_unit: "relative units, not newtons",
        levels: &Level::MODEL,
        model: &model,
        loading: &loading,
        load_of_item: &[0],
        load_words: &["one load".to_owned()],
        response: &response,
    })
}

fn loads() -> [(BodyLoad, &'static str); 4] {
    let zero = Vec3::zeros();
    let left = Vec3::new(0.0, 20.0, 0.0);
    let (point_mm, anchor_mm) = (Vec3::new(0.0, 0.0, 300.0), Vec3::new(0.0, 150.0, 300.0));
    [
        (
            BodyLoad::ForceAtPoint { force_n: left, point_in_vertebra_mm: zero },
            "arrows in proportion",
        ),
        (BodyLoad::ForceOnLine { force_n: left, point_mm }, "fixed in space"),
        (BodyLoad::Moment { moment_nmm: Vec3::new(2000.0, 0.0, 0.0) }, "moment"),
        (
            BodyLoad::Strap {
                point_in_vertebra_mm: zero,
                anchor_mm,
                n_per_mm: 1.0,
                shortening_mm: 9.0,
            },
            "strap",
        ),
    ]
}

#[test]
fn every_kind_of_load_is_drawn_and_named() {
    for (load, words) in loads() {
        let svg = picture(true, load, None);
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
            "one load",
        ] {
            assert!(svg.contains(words), "{words}");
        }
        assert!(!svg.contains("NaN") && !svg.contains("not a result"));
        assert_eq!(svg, picture(true, load, None), "the same input makes the same bytes");
        assert!(!picture(false, load, None).contains("synthetic"));
    }
}

#[test]
fn shapes_without_a_result_are_drawn_differently() {
    for (load, _) in loads() {
        let (good, bad) =
            (picture(true, load, None), picture(true, load, Some(PathEnding::LimitPoint)));
        assert_eq!(bad.matches(">not a result (limit_point)<").count(), 2, "on both panels");
        assert!(bad.contains("Not a result (limit_point)") && good.contains(">under load<"));
        assert!(!bad.contains(">under load<"));
    }
}
