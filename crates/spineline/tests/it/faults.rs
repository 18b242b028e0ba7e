//! Cases whose films do not fit together, spines without two inflections, and films that are missing.

use std::mem::swap;

use crate::common::{
    analyzed, case_of, exact_case, film_mut, graph_film, landmarks, move_places, on_a_table,
    other_side, refused, spacing, turn_axes, warned,
};
use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::chain::{Chain, ChainError, SEGMENT_WINDOW};
use spineline::curve::{CurveError, InflectionChoice, OrderRule, Site};
use spineline::error::{CaseError, Error};
use spineline::measure::{IliacCrests, MeasureFault};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::warning::{Step, WarningCode};
use spineline_phantom::exchange_sides;

fn kinds(analysis: &Analysis) -> Vec<LineKind> {
    analysis.models.iter().map(|model| model.kind).collect()
}

/// A spine of `curves` equal curves that turn by about `turn` each, with or without its two bends.
fn wavy(curves: u32, turn: Angle, bends: bool) -> Case {
    const HEIGHT_MM: f64 = 390.0;
    let waves = f64::from(curves) * std::f64::consts::PI / HEIGHT_MM;
    let size = 0.5 * turn.rad().tan();
    // y'' = a sin(waves z): inflections at equal distances, none at the ends.
    let wave =
        move |z: f64| (size * (z - (waves * z).sin() / waves), size * (1.0 - (waves * z).cos()));
    let bent = move |sign: f64| {
        move |z: f64| (wave(z).0 + sign * 7e-4 * z * z, wave(z).1 + sign * 14e-4 * z)
    };
    let mut films = vec![graph_film(Posture::Erect, HEIGHT_MM, wave)];
    if bends {
        films.push(graph_film(Posture::LeftBending, HEIGHT_MM, bent(1.0)));
        films.push(graph_film(Posture::RightBending, HEIGHT_MM, bent(-1.0)));
    }
    case_of(films)
}

#[test]
fn swapped_bends_are_refused_with_both_lateral_tilts() {
    // Oracle: a left bend leans to the left of a right bend.
    let mut case = exact_case(0);
    for film in &mut case.films {
        film.posture = other_side(film.posture);
    }
    let error = refused(&case);
    assert_eq!(error.step(), Step::Measure);
    let text = error.to_string();
    assert!(text.contains("left bending") && text.contains("right bending") && text.contains('°'));
    match error {
        Error::Case(CaseError::BendsExchanged { left, right }) => assert!(left > right),
        other => panic!("{other:?}"),
    }
}

#[test]
fn bends_that_lean_to_one_side_are_not_exchanged() {
    // Oracle: of two films that lean to the right, one leans to the wrong side under either name.
    let straight = |by: f64| move |z: f64| (by * z * z, 2.0 * by * z);
    let wave = |z: f64| (8.0 * (z / 62.0).sin(), 8.0 / 62.0 * (z / 62.0).cos());
    let film = |posture, by: f64| {
        let bend = straight(by);
        graph_film(posture, 390.0, move |z| (wave(z).0 + bend(z).0, wave(z).1 + bend(z).1))
    };
    // At T2 a bend to the right is one to negative values.
    for (left, right) in [(-2e-4, -0.3e-4), (0.3e-4, 2e-4)] {
        let case = case_of(vec![
            film(Posture::Erect, 0.0),
            film(Posture::LeftBending, left),
            film(Posture::RightBending, right),
        ]);
        let analysis = analyzed(&case, &on_a_table());
        warned(&analysis, WarningCode::BendLeansLittle, None);
        assert!(!analysis.has_doubted_film(), "{:?}", analysis.warnings.all());
    }
}

#[test]
fn lines_that_the_bends_reject_have_their_contradictions_in_the_result_alone() {
    // Oracle: all joints turn to one side, so that no force through the inflections bent the spine.
    let analysis = analyzed(&exact_case(0), &on_a_table());
    let rejected = analysis.model(LineKind::Inflection).expect("two inflections");
    assert!(analysis.compatibility(rejected).rejects());
    assert!(
        rejected.simulations.iter().any(|film| film.contradicted.iter().any(|j| j.beyond_noise))
    );
    let warnings = analysis.warnings.all().iter().filter(|one| one.line == Some(rejected.kind));
    for code in [WarningCode::JointsContradictLine, WarningCode::MultiplierAtBound] {
        assert!(!warnings.clone().any(|one| one.code == code), "{code:?}");
    }
}

#[test]
fn two_films_of_one_posture_are_refused() {
    // Oracle: a posture has one film.
    for posture in Posture::ALL {
        let mut case = exact_case(0);
        let film = film_mut(&mut case, posture).clone();
        case.films.push(film);
        let error = refused(&case);
        assert_eq!(error, CaseError::PostureTwice { posture }.into());
        assert!(error.to_string().contains(&posture.to_string()));
    }
}

#[test]
fn a_case_without_an_erect_film_is_refused() {
    // Oracle: everything is measured against the erect posture.
    let mut case = exact_case(0);
    case.films.retain(|film| film.posture != Posture::Erect);
    assert_eq!(refused(&case), CaseError::NoErectFilm.into());
    assert!(refused(&case).to_string().contains("erect"));
    assert_eq!(refused(&case_of(Vec::new())), CaseError::NoErectFilm.into());
}

#[test]
fn a_neutral_film_with_the_wrong_side_is_reported_as_mirrored() {
    // Oracle: lying down does not turn a curve into its mirror image.
    for posture in [Posture::Neutral, Posture::Traction] {
        let mut case = exact_case(0);
        exchange_sides(film_mut(&mut case, posture));
        let analysis = analyzed(&case, &on_a_table());
        assert_eq!(
            warned(&analysis, WarningCode::FilmLooksMirrored, Some(posture)).code.step(),
            Step::Measure
        );
        assert!(
            !analyzed(&exact_case(0), &on_a_table()).warnings.has(WarningCode::FilmLooksMirrored)
        );
    }
}

#[test]
fn a_bending_film_with_the_wrong_side_tilts_to_the_other_side() {
    // Oracle: a left bend leans to the left of the erect spine.
    for posture in [Posture::LeftBending, Posture::RightBending] {
        let mut case = exact_case(0);
        exchange_sides(film_mut(&mut case, posture));
        match analyze(&case, &on_a_table()) {
            // A mirrored bend of a spine that leans when erect may lean to its side even so.
            Ok(analysis) => assert!(
                [WarningCode::BendLeansAway, WarningCode::FilmLooksMirrored].iter().any(|code| {
                    let mut doubts = analysis.film_doubts();
                    doubts.any(|one| one.code == *code && one.posture == Some(posture))
                }),
                "{:?}",
                analysis.warnings.all()
            ),
            Err(error) => {
                assert!(
                    matches!(error, Error::Case(CaseError::BendsExchanged { .. })),
                    "{error:?}"
                );
            }
        }
    }
}

#[test]
fn a_film_of_another_spacing_is_detected_by_its_length() {
    // Oracle: a spine does not grow by 40 %.
    let mut case = exact_case(0);
    let (image, _, _) = landmarks(film_mut(&mut case, Posture::Traction));
    spacing(image).column_mm *= 1.4;
    spacing(image).row_mm *= 1.4;
    let analysis = analyzed(&case, &on_a_table());
    let warning = warned(&analysis, WarningCode::LengthsDiffer, Some(Posture::Traction));
    assert!(warning.message.contains("40.") && warning.message.contains("% longer"), "{warning:?}");
    assert!(!analyzed(&exact_case(0), &on_a_table()).warnings.has(WarningCode::LengthsDiffer));
}

#[test]
fn a_curve_a_tenth_as_long_cannot_share_a_chain() {
    // Oracle: equal segments need curves of about equal length.
    let error = Error::from(Chain::fit(400.0, &[39.0], SEGMENT_WINDOW).expect_err("no chain"));
    assert_eq!(error.step(), Step::Chain);
    assert!(error.to_string().contains("mm"));
    assert!(matches!(error, Error::Chain(ChainError::TooShort { .. })), "{error:?}");
}

#[test]
fn iliac_crests_off_the_picture_or_coincident_are_refused_and_swapped_ones_reported() {
    // Oracle: two crests make a line only where they lie apart, and it runs about across L4.
    let with = |change: fn(&mut IliacCrests)| {
        let mut case = exact_case(0);
        let (_, crests, _) = landmarks(film_mut(&mut case, Posture::LeftBending));
        change(crests.as_mut().expect("phantoms have crests"));
        case
    };
    for case in [
        with(|c| c.left = c.right),
        with(|c| c.left.row_px = 9e9),
        with(|c| c.right.row_px = f64::NAN),
    ] {
        let error = refused(&case);
        assert!(error.to_string().contains("iliac crest"), "{error}");
    }
    let exchanged = analyzed(&with(|c| swap(&mut c.left, &mut c.right)), &on_a_table());
    warned(&exchanged, WarningCode::IliacLineUnusual, Some(Posture::LeftBending));
    // The left crest is lifted by the distance between both, so their line turns by 45°.
    let lifted = with(|c| c.left.row_px -= (c.right.column_px - c.left.column_px).abs());
    let lifted = analyzed(&lifted, &on_a_table());
    let found = warned(&lifted, WarningCode::IliacLineUnusual, Some(Posture::LeftBending));
    assert!(found.message.contains("check the tips"), "{found:?}");
}

#[test]
fn iliac_crests_where_no_pelvis_is_are_doubted() {
    // Oracle: on phantoms both crests lie beside L4, 0.1 mm a pixel; L2 is 7 cm higher, T2 about 35 cm.
    let doubt = |change: fn(&mut IliacCrests)| {
        let mut case = exact_case(0);
        let (image, crests, _) = landmarks(film_mut(&mut case, Posture::Erect));
        image.rows += 3000;
        change(crests.as_mut().expect("phantoms have crests"));
        let analysis = analyzed(&case, &on_a_table());
        let mut all = analysis.warnings.all().iter();
        let found = all.find(|one| one.code == WarningCode::IliacLineUnusual);
        found.map(|one| one.message.clone()).unwrap_or_default()
    };
    assert_eq!(doubt(|_| ()), "");
    assert_eq!(doubt(|crests| crests.left.row_px += 300.0), "", "an oblique pelvis");
    let above = doubt(|crests| {
        crests.left.row_px -= 3000.0;
        crests.right.row_px -= 3000.0;
    });
    assert!(above.contains("above L2"), "{above}");
    let below = doubt(|crests| {
        crests.left.row_px += 2000.0;
        crests.right.row_px += 2000.0;
    });
    assert!(below.contains("below L4 (limit 150 mm)"), "{below}");
    let beside = doubt(|crests| {
        let middle = 0.5 * (crests.left.column_px + crests.right.column_px);
        crests.right.column_px += 1.4 * (middle - crests.right.column_px);
    });
    assert!(beside.contains("on one side of L4"), "{beside}");
}

#[test]
fn a_film_upside_down_is_measured_like_any_other() {
    // Oracle: the same film turned by half a turn; angles near 180° must not average to 0°.
    let case = exact_case(0);
    let mut turned = case.clone();
    let film = film_mut(&mut turned, Posture::Erect);
    let (image, ..) = landmarks(film);
    let (columns, rows) = (f64::from(image.columns) - 1.0, f64::from(image.rows) - 1.0);
    move_places(film, |p| Pixel::new(columns - p.column_px, rows - p.row_px));
    turn_axes(film, |axis| (axis + Angle::from_deg(180.0)).wrapped());
    // Half a turn carries the patient's left to the other side of the picture and back: corners keep their names.
    let (a, b) = (analyzed(&case, &on_a_table()), analyzed(&turned, &on_a_table()));
    for (x, y) in
        a.movement.erect().outline.vertebrae.iter().zip(&b.movement.erect().outline.vertebrae)
    {
        assert!(x.location.distance_mm(y.location) < 1e-9 && (x.tilt - y.tilt).rad().abs() < 1e-12);
    }
}

#[test]
fn tilts_of_the_wrong_sign_are_detected_by_the_curve() {
    // Oracle: locations and tilts of one spine belong to one curve.
    let mut case = wavy(2, Angle::from_deg(25.0), true);
    for film in &mut case.films {
        if let spineline::measure::FilmLandmarks::Placements { readings, .. } = &mut film.landmarks
        {
            for placement in readings.iter_mut().flat_map(|r| r.vertebrae.values_mut()) {
                placement.tilt = -placement.tilt;
            }
        }
    }
    let error = analyze(&case, &on_a_table()).expect_err("tilts of the wrong sign");
    let Error::Measure(error) = error else { panic!("{error}") };
    assert_eq!((error.at.film, error.fault), (Posture::Erect.into(), MeasureFault::TiltsReversed));
}

#[test]
fn a_straight_spine_still_has_an_iliac_and_an_estimated_line() {
    // Oracle: a line without curvature has no inflection.
    let analysis = analyzed(&wavy(2, Angle::ZERO, true), &on_a_table());
    assert_eq!(
        (analysis.movement.inflections.all.len(), analysis.movement.inflections.pair),
        (0, None)
    );
    assert_eq!(kinds(&analysis), [LineKind::Iliac, LineKind::Estimated]);
    warned(&analysis, WarningCode::InflectionsNotTwo, Some(Posture::Erect));
    warned(&analysis, WarningCode::NoLine, None);
    warned(&analysis, WarningCode::UsualRegions, None);
    assert_eq!(analysis.movement.inflection_segments, None);
    for curve in &analysis.movement.clinical {
        assert!(curve.erect_size().abs() < Angle::from_deg(0.01));
        assert_eq!(curve.flexibility, None);
    }
}

#[test]
fn one_inflection_gives_all_results_except_the_inflection_line() {
    // Oracle: two curves meet in one inflection, half way up.
    let analysis = analyzed(&wavy(2, Angle::from_deg(30.0), true), &on_a_table());
    assert_eq!(
        (analysis.movement.inflections.all.len(), analysis.movement.inflections.curves.len()),
        (1, 2)
    );
    assert_eq!(analysis.movement.inflections.pair, None);
    // The curve is a sine fitted by a polynomial: a percent of its length.
    assert!((analysis.movement.inflections.all[0].t_mm - 195.0).abs() < 4.0);
    assert_eq!(kinds(&analysis), [LineKind::Iliac, LineKind::Estimated]);
    let warning = warned(&analysis, WarningCode::InflectionsNotTwo, Some(Posture::Erect));
    assert!(warning.message.contains("one inflection "), "{}", warning.message);
}

#[test]
fn of_three_inflections_two_carry_the_line() {
    // Oracle: four curves meet in three inflections, at quarters of the height.
    let analysis = analyzed(&wavy(4, Angle::from_deg(30.0), true), &on_a_table());
    let found: Vec<f64> =
        analysis.movement.inflections.all.iter().map(|i| i.t_mm / 390.0).collect();
    assert_eq!(found.len(), 3, "{found:?}");
    for (found, expected) in found.iter().zip([0.25, 0.5, 0.75]) {
        assert!((found - expected).abs() < 0.02, "{found}");
    }
    let pair =
        analysis.movement.inflections.pair.expect("a pair around the largest lobe between two");
    assert!(analysis.movement.inflections.all.windows(2).any(|neighbours| neighbours == pair));
    assert_eq!(kinds(&analysis), [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated]);
    warned(&analysis, WarningCode::InflectionsNotTwo, Some(Posture::Erect));
}

#[test]
fn inflections_picked_in_one_place_give_no_line() {
    // Oracle: one point gives no direction.
    let site = Site { inferior: Level::T9, superior: Level::T8 };
    let inflections = InflectionChoice::ByHand([site, site]);
    let analysis = analyzed(&exact_case(0), &AnalysisOptions { inflections, ..on_a_table() });
    assert_eq!(kinds(&analysis), [LineKind::Iliac, LineKind::Estimated]);
    warned(&analysis, WarningCode::InflectionsByHand, None);
    let warning = warned(&analysis, WarningCode::NoLine, Some(Posture::LeftBending));
    assert!(warning.message.contains("0.0 mm") && warning.message.contains("20 mm"));
    assert!(analysis.movement.inflections.pair.is_some());
}

#[test]
fn inflections_picked_by_hand_carry_the_line() {
    // Oracle: the line runs through the two sites, in whichever order they were given.
    let sites = [Level::T12, Level::T6].map(|level| Site { inferior: level, superior: level });
    for sites in [sites, [sites[1], sites[0]]] {
        let inflections = InflectionChoice::ByHand(sites);
        let analysis = analyzed(&exact_case(0), &AnalysisOptions { inflections, ..on_a_table() });
        let erect = &analysis.movement.erect().outline;
        let picked = [Level::T12, Level::T6].map(|level| {
            let vertebra = erect.vertebra(level).expect("a level of the model");
            vertebra.location
        });
        let pair = analysis.movement.inflections.pair.expect("picked");
        for (found, place) in pair.iter().zip(picked) {
            // The exact readers' curve meets the vertebrae to a hundredth of a millimetre.
            assert!(found.erect.distance_mm(place) < 0.01);
        }
        assert!(kinds(&analysis).contains(&LineKind::Inflection));
    }
}

#[test]
fn an_erect_film_alone_gives_curve_inflections_and_cobb_angles() {
    // Oracle: Table 1 says 49° for the main curve of subject 1.
    let mut case = exact_case(0);
    case.films.retain(|film| film.posture == Posture::Erect);
    let analysis = analyzed(&case, &on_a_table());
    assert!(analysis.models.is_empty());
    assert_eq!(analysis.movement.inflections.all.len(), 2);
    // Vertebral tilts miss the largest tilt of the curve between them by up to a degree.
    assert!((analysis.movement.clinical[1].erect_size().abs().deg() - 49.0).abs() < 1.0);
    assert_eq!((analysis.movement.lenke, analysis.movement.mean_least_segments), (None, None));
    assert_eq!(warned(&analysis, WarningCode::NoBendingFilm, None).code.step(), Step::Personalize);
    assert!(analysis.movement.erect().fit.rmse_mm < 0.01);
}

#[test]
fn one_bend_alone_gives_models_fitted_to_it() {
    // Oracle: only films that are there can be fitted.
    let mut case = exact_case(0);
    case.films.retain(|film| [Posture::Erect, Posture::RightBending].contains(&film.posture));
    let analysis = analyzed(&case, &on_a_table());
    assert_eq!(kinds(&analysis), [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated]);
    for model in &analysis.models {
        let postures: Vec<(Posture, bool)> =
            model.simulations.iter().map(|s| (s.shape.posture, s.fitted)).collect();
        assert_eq!(postures, [(Posture::RightBending, true)]);
    }
    assert_eq!((analysis.movement.lenke, analysis.movement.mean_least_segments), (None, None));
}

#[test]
fn an_order_beyond_four_to_twelve_is_refused() {
    // Oracle: the documented range.
    for order in [0, 3, 13] {
        let options = AnalysisOptions { order_rule: OrderRule::Fixed(order), ..on_a_table() };
        let error = analyze(&exact_case(0), &options).expect_err("an order out of range");
        assert_eq!(error, CurveError::Order { order, limit: 12 }.into());
        assert_eq!(error.step(), Step::Curve);
        let text = error.to_string();
        assert!(text.contains(&order.to_string()) && text.contains("4 to 12"), "{text}");
        assert!(!error.help().is_empty());
    }
}

#[test]
fn a_window_without_segments_is_refused() {
    // Oracle: no whole number lies in it, a chain without segments would, or links are finer than any film.
    #[allow(clippy::reversed_empty_ranges, reason = "this is the fault")]
    let windows = [10..=9, 0..=5, 1..=u32::MAX];
    for window in windows {
        let (from, to) = (*window.start(), *window.end());
        let refused = Chain::fit(400.0, &[], window).expect_err("an empty window");
        assert_eq!(refused, ChainError::Window { from, to });
        let error = Error::from(refused);
        assert_eq!(error.step(), Step::Chain);
        assert!(error.to_string().contains(&from.to_string()) && !error.help().is_empty());
    }
}

#[test]
fn a_line_given_for_one_bend_is_fitted_to_that_bend() {
    // Oracle: the user gave no line for the other films, which is said.
    let line = spineline::action::LineOfAction::leaning(Frontal::new(30.0, 150.0), Angle::ZERO);
    let given_lines = vec![(Posture::LeftBending, line)];
    let analysis = analyzed(&exact_case(0), &AnalysisOptions { given_lines, ..on_a_table() });
    let model = analysis.model(LineKind::Given).expect("a given line");
    assert_eq!(model.simulations.len(), 1);
    warned(&analysis, WarningCode::NoLine, Some(Posture::RightBending));
}
