//! Lines of action that pass through an end of the spine, miss the body or cross the curve often; lengths near zero;
//! results that rounding must not move.

use crate::common::{
    all_landmarks, analyzed, assert_near, case_of, exact_case, film_mut, graph_film, landmarks,
    on_a_table, placement_film, refused, warned,
};
use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::chain::{Chain, ChainError, SEGMENT_WINDOW};
use spineline::error::Error;
use spineline::evaluate::Simulation;
use spineline::spatial::{Angle, Frontal};
use spineline::warning::{Step, WarningCode};

/// The analysis of a patient whose left bend has a given line.
fn with_line(line: LineOfAction) -> Analysis {
    let given_lines = vec![(Posture::LeftBending, line)];
    analyzed(&exact_case(0), &AnalysisOptions { given_lines, ..on_a_table() })
}

/// The simulation of the left bend under its given line.
fn simulation(analysis: &Analysis) -> &Simulation {
    let model = analysis.model(LineKind::Given).expect("a model of the given line");
    model.simulation(Posture::LeftBending).expect("the bend that has the line")
}

/// Where a vertebra is in the left bend.
fn place(level: Level) -> Frontal {
    let analysis = analyzed(&exact_case(0), &on_a_table());
    let bend = analysis.movement.film(Posture::LeftBending).expect("a bend");
    bend.outline.vertebra(level).expect("a level of the model").location
}

/// A usable result has numbers; any other is marked as not a result.
#[track_caller]
fn check_ending(analysis: &Analysis) {
    let simulation = simulation(analysis);
    let numbers = [&simulation.shape.location_errors_mm[..], &[simulation.force_n]].concat();
    if simulation.is_usable() {
        assert!(numbers.iter().all(|number| number.is_finite()), "{numbers:?}");
    } else {
        let codes: Vec<WarningCode> = analysis.warnings.all().iter().map(|w| w.code).collect();
        let said = [WarningCode::ForceNotFound, WarningCode::FitNotConverged]
            .iter()
            .any(|c| codes.contains(c));
        assert!(said && !analysis.is_converged(), "{codes:?}");
    }
}

#[test]
fn f37_a_line_through_t2_or_l4_has_no_lever_arm_there_and_a_named_ending() {
    // Oracle: a force on a line through a point has no moment about it.
    for level in [Level::T2, Level::L4] {
        let through = place(level);
        for tilt_deg in [-60.0, 0.0, 35.0, 90.0] {
            let line = LineOfAction::leaning(through, Angle::from_deg(tilt_deg));
            assert_near(line.lever_arm_mm(through), 0.0, 1e-9, "lever arm");
            check_ending(&with_line(line));
        }
    }
}

#[test]
fn f37_a_line_outside_of_the_body_gives_a_warning_with_its_distance() {
    // Oracle: two metres to the side is beyond any trunk; through the apex is within.
    let far = LineOfAction::leaning(Frontal::new(2000.0, 0.0), Angle::ZERO);
    let analysis = with_line(far);
    check_ending(&analysis);
    let warning = warned(&analysis, WarningCode::GivenLineFar, None);
    assert_eq!((warning.code.step(), warning.posture), (Step::Action, Some(Posture::LeftBending)));
    assert!(warning.message.contains("mm from the nearest vertebra"), "{}", warning.message);
    let near = with_line(LineOfAction::leaning(place(Level::T8), Angle::ZERO));
    assert!(near.warnings.all().iter().all(|warning| warning.code != WarningCode::GivenLineFar));
}

#[test]
fn a_line_of_one_bend_is_rejected_or_kept_with_the_name_of_that_bend() {
    let analysis =
        with_line(LineOfAction::leaning(Frontal::new(0.0, 200.0), Angle::from_deg(10.0)));
    let words = analysis.headline(None).line;
    assert!(words.contains("the given line of the left bend"), "{words}");
    // Both bends test the others.
    assert!(words.starts_with("The bends ") && words.matches(" of the ").count() == 1, "{words}");
}

#[test]
fn f37_a_line_that_crosses_the_curve_three_times_has_a_named_ending() {
    // Oracle: the lever arm changes its sign at every crossing, here at the two inflections and between them.
    let wave = |z: f64| {
        let k = 3.0 * std::f64::consts::PI / 390.0;
        (18.0 * (k * z).sin() + 30.0, 18.0 * k * (k * z).cos())
    };
    let bend =
        |sign: f64| move |z: f64| (wave(z).0 + sign * 4e-4 * z * z, wave(z).1 + sign * 8e-4 * z);
    let case = case_of(vec![
        graph_film(Posture::Erect, 390.0, wave),
        graph_film(Posture::LeftBending, 390.0, bend(1.0)),
        graph_film(Posture::RightBending, 390.0, bend(-1.0)),
    ]);
    let first = analyzed(&case, &on_a_table());
    let outline = &first.movement.film(Posture::LeftBending).expect("a bend").outline;
    let (low, high) = (outline.vertebrae[1].location, outline.vertebrae[12].location);
    let line = LineOfAction::through(low, high).expect("far apart");
    let signs: Vec<bool> =
        outline.locations().map(|location| line.lever_arm_mm(location) > 1e-6).collect();
    let crossings = signs.windows(2).filter(|pair| pair[0] != pair[1]).count();
    assert!(crossings >= 3, "{crossings} crossings");
    let given_lines = vec![(Posture::LeftBending, line)];
    check_ending(&analyzed(&case, &AnalysisOptions { given_lines, ..on_a_table() }));
}

#[test]
fn f33_an_erect_curve_without_length_carries_no_chain() {
    // Oracle: a link of a chain is longer than nothing.
    for erect_mm in [0.0, -389.0, 1e-310, f64::NAN, f64::INFINITY] {
        let error = Chain::fit(erect_mm, &[389.0], SEGMENT_WINDOW).expect_err("no length");
        assert!(matches!(error, ChainError::NoLength { .. }), "{error}");
        assert!(!Error::from(error).help().is_empty());
    }
    for other_mm in [0.0, 1e-12, f64::NAN] {
        let error = Chain::fit(389.0, &[other_mm], SEGMENT_WINDOW).expect_err("no length");
        assert!(matches!(error, ChainError::TooShort { .. }), "{error}");
    }
}

#[test]
fn f33_coincident_or_nearly_coincident_vertebrae_are_refused() {
    // Oracle: bodies of centimetres do not lie a hair apart.
    for gap_mm in [0.0, 1e-9, 0.01] {
        let film = |posture, size: f64| {
            placement_film(
                posture,
                Level::MODEL.into_iter().enumerate().map(|(i, level)| {
                    let z = if level == Level::T8 {
                        26.0 * (i as f64 - 1.0) + gap_mm
                    } else {
                        26.0 * i as f64
                    };
                    (
                        level,
                        Frontal::new(size * z * z, z),
                        Angle::from_sin_cos(-2.0 * size * z, 1.0),
                    )
                }),
            )
        };
        let error = refused(&case_of(vec![
            film(Posture::Erect, 1e-4),
            film(Posture::LeftBending, 3e-4),
            film(Posture::RightBending, -3e-4),
        ]));
        let text = error.to_string();
        assert!(text.contains("T8") || text.contains("T9"), "{gap_mm}: {text}");
    }
}

#[test]
fn f35_postures_without_a_common_count_take_the_nearest_and_say_that_lengths_differ() {
    // Oracle: 389 mm and 350 mm have no common number of links in the window, and differ by 10 %.
    let chain = Chain::fit(389.0, &[350.0], SEGMENT_WINDOW).expect("two curves");
    assert!(SEGMENT_WINDOW.contains(&(chain.segments as u32)));
    assert!(chain.difference > 90, "{}", chain.difference);
    let mut case = exact_case(0);
    let (image, _, _) = landmarks(film_mut(&mut case, Posture::LeftBending));
    let spacing = crate::common::spacing(image);
    spacing.column_mm *= 0.9;
    spacing.row_mm *= 0.9;
    let analysis = analyzed(&case, &on_a_table());
    let warning = warned(&analysis, WarningCode::LengthsDiffer, None);
    assert_eq!(warning.posture, Some(Posture::LeftBending));
}

#[test]
fn f35_equal_sums_take_the_number_nearest_to_the_middle_of_the_window() {
    // Oracle: equal curves agree at every number of links; 998 is the middle of 993 to 1003.
    let chain = Chain::fit(400.0, &[400.0, 400.0], SEGMENT_WINDOW).expect("three curves");
    assert_eq!((chain.segments, chain.difference), (998, 0));
}

#[test]
fn f47_rounding_of_inputs_changes_results_within_tolerance_only() {
    // Oracle: another processor, compiler or fused operation rounds in the last place, as is done here to every corner.
    let options = on_a_table();
    let plain = analyzed(&exact_case(1), &options);
    let mut case = exact_case(1);
    for film in &mut case.films {
        for (i, landmark) in all_landmarks(film).enumerate() {
            let part = if i % 2 == 0 { 1.0 + f64::EPSILON } else { 1.0 - f64::EPSILON };
            landmark.corners = landmark.corners.map(|mut corner| {
                corner.column_px *= part;
                corner.row_px *= 2.0 - part;
                corner
            });
        }
    }
    let moved = analyze(&case, &options).expect("the same case");
    assert_eq!(plain.models.len(), moved.models.len());
    for (a, b) in plain.models.iter().zip(&moved.models) {
        for (x, y) in a.multipliers().zip(b.multipliers()) {
            assert_near(x, y, 1e-6 * x, "multiplier");
        }
        for (x, y) in a.simulations.iter().zip(&b.simulations).filter(|(x, _)| x.is_usable()) {
            assert_near(x.force_n, y.force_n, 1e-6 * x.force_n.abs(), "force");
            for (x, y) in x.shape.location_errors_mm.iter().zip(&y.shape.location_errors_mm) {
                assert_near(*x, *y, 1e-6, "location error in mm");
            }
        }
    }
}
