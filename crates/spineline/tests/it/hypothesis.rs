//! Loads and bases beside the paper's line: derivatives, agreement with the march, and what no frame may change.

use crate::common::chain::{dead, proportional};
use crate::common::{case_of, landmarks, move_places, other_side};
use crate::properties::mirror_image;
use spineline::action::LineOfAction;
use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::anatomy::{Levels, Posture};
use spineline::evaluate::RotationPrior;
use spineline::hypothesis::{
    Hypothesis, HypothesisFilm, HypothesisFit, HypothesisScores, LoadShape, LostPrediction, Role,
    Spine, compare, fit_hypothesis,
};
use spineline::measure::{Outline, ProgramNoise};
use spineline::multibody::{
    BodyLoad, FittedSprings, ForceSign, GeneralStatics, JointGroups, Load, LoadItem, Loading,
    NewtonWork, PathEnding, ShapeParameter, Solution, Statics, StiffnessLibrary, Support, match_t2,
};
use spineline::personalize::{Base, FitSettings};
use spineline::spatial::{Angle, Frontal, Mat3, Pixel, Vec3};
use spineline::warning::{Warning, WarningCode};
use spineline_phantom::{Readers, Scenario, generate};

fn analysis() -> Analysis {
    let phantom = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("a phantom");
    analyze(&phantom.case, &AnalysisOptions::default()).expect("a sound case")
}

/// Dead forces on two vertebrae, a line and a moment on T2.
fn loads(times: [f64; 3]) -> Vec<LoadItem> {
    let (force_n, point_mm) = (Vec3::new(0.0, 8.0, 20.0) * times[1], Vec3::new(-5.0, 14.0, 90.0));
    vec![
        proportional(6, dead(Vec3::new(0.0, 12.0, -25.0) * times[0])),
        proportional(11, dead(Vec3::new(0.0, -6.0, -30.0) * times[0])),
        proportional(14, BodyLoad::ForceOnLine { force_n, point_mm }),
        proportional(14, BodyLoad::Moment { moment_nmm: Vec3::x() * (2000.0 * times[2]) }),
    ]
}

fn springs(landmarks: &[bool], log: f64) -> Vec<Mat3> {
    let rows = StiffnessLibrary::default();
    let of = |(row, &marked): (&spineline::multibody::JointStiffness, &bool)| {
        let [x, y, z] = row.nmm_per_rad;
        Mat3::from_diagonal(&Vec3::new(if marked { x * log.exp() } else { x }, y, z))
    };
    rows.rows().iter().zip(landmarks).map(of).collect()
}

#[test]
fn derivatives_of_a_shape_equal_finite_differences() {
    // Oracle: central differences of equilibria; their error is of the order of the step's square.
    let analysis = analysis();
    let landmarks: Vec<bool> = (0..14).map(|joint| (4..9).contains(&joint)).collect();
    let solved = |times: [f64; 3], log: f64| -> Vec<Vec3> {
        let statics =
            GeneralStatics::new(&analysis.movement.spine, springs(&landmarks, log), Support::Free)
                .expect("ok");
        let loading = Loading { items: loads(times), rods: Vec::new() };
        let mut work = statics.work(&loading).expect("sound loads");
        assert!(statics.solve_near(&loading, 1.0, &mut work));
        work.midpoints_mm().to_vec()
    };
    let statics =
        GeneralStatics::new(&analysis.movement.spine, springs(&landmarks, 0.3), Support::Free)
            .expect("ok");
    let loading = Loading { items: loads([1.0; 3]), rods: Vec::new() };
    let mut work: NewtonWork = statics.work(&loading).expect("sound loads");
    assert!(statics.solve_near(&loading, 1.0, &mut work));
    let all = loads([1.0; 3]);
    let parameters = [
        ShapeParameter::Loads(&all[..2]),
        ShapeParameter::Loads(&all[2..3]),
        ShapeParameter::Loads(&all[3..]),
        ShapeParameter::LogLateral(&landmarks),
    ];
    let mut solution = Solution::default();
    statics.differentiate(&loading, &mut work, &parameters, &mut solution);
    assert!(solution.converged);
    const STEP: f64 = 1e-4;
    for p in 0..parameters.len() {
        let moved = |by: f64| {
            let mut times = [1.0; 3];
            if p < 3 {
                times[p] += by;
            }
            solved(times, if p == 3 { 0.3 + by } else { 0.3 })
        };
        let (above, below) = (moved(STEP), moved(-STEP));
        for (v, (above, below)) in above.iter().zip(&below).enumerate() {
            let difference = (above - below) / (2.0 * STEP);
            let off = (solution.midpoint_rates[p][v] - difference).norm();
            assert!(off < 1e-5 * (1.0 + difference.norm()), "parameter {p}, vertebra {v}: {off}");
        }
    }
}

#[test]
fn a_line_alone_has_the_shape_and_derivatives_of_the_march() {
    // Oracle: the explicit march.
    let analysis = analysis();
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let library = StiffnessLibrary::default();
    let march =
        Statics::new(&analysis.movement.spine, &library, &groups, &[0.0; 14], Support::Free);
    let line = LineOfAction::leaning(Frontal::new(12.0, 100.0), Angle::from_deg(8.0));
    let mut expected = Solution::default();
    let parameters = [
        spineline::multibody::Parameter::Load(0),
        spineline::multibody::Parameter::LogStiffness(5),
    ];
    march.solve(&Load::along(line, 0.0), &[60.0], &parameters, &mut expected);
    let statics =
        GeneralStatics::new(&analysis.movement.spine, springs(&[false; 14], 0.0), Support::Free)
            .expect("sound springs");
    let force_n = Vec3::new(0.0, line.direction.y_mm, line.direction.z_mm);
    let point_mm = Vec3::new(0.0, line.point.y_mm, line.point.z_mm);
    let unit = proportional(14, BodyLoad::ForceOnLine { force_n, point_mm });
    let load = BodyLoad::ForceOnLine { force_n: force_n * 60.0, point_mm };
    let loading = Loading::single(14, load);
    let mut work = statics.work(&loading).expect("sound loads");
    assert!(statics.solve_near(&loading, 1.0, &mut work));
    let mut landmarks = [false; 14];
    landmarks[5] = true;
    let mut found = Solution::default();
    let parameters = [ShapeParameter::Loads(&[unit]), ShapeParameter::LogLateral(&landmarks)];
    statics.differentiate(&loading, &mut work, &parameters, &mut found);
    for v in 0..15 {
        assert!((found.deformed.midpoints_mm[v] - expected.deformed.midpoints_mm[v]).norm() < 1e-9);
        for p in 0..2 {
            assert!((found.midpoint_rates[p][v] - expected.midpoint_rates[p][v]).norm() < 1e-9);
            assert!((found.turn_rates[p][v] - expected.turn_rates[p][v]).norm() < 1e-11);
        }
    }
}

fn fitted(analysis: &Analysis, hypothesis: Hypothesis, turn: Angle) -> HypothesisFit {
    let groups = JointGroups::regional(&analysis.movement.regions);
    let springs = FittedSprings {
        model: &analysis.movement.spine,
        erect: &analysis.movement.erect().outline,
        library: &analysis.options.library,
        groups: &groups,
    };
    let settings = FitSettings::of_shapes(&analysis.movement.regions, Support::Frontal);
    let spine = Spine {
        springs,
        settings,
        rotations: &RotationPrior::published(analysis.movement.levels()),
        depth_mm: 0.0,
        apex: 7,
    };
    let outlines: Vec<(Outline, Option<[Frontal; 2]>)> = analysis
        .movement
        .films
        .iter()
        .filter(|p| p.outline.posture != Posture::Erect)
        .map(|p| {
            // L4's axis read otherwise: all that lies above turns about L4.
            let mut outline = p.outline.clone();
            for vertebra in outline.vertebrae.iter_mut().skip(1) {
                vertebra.location = vertebra.location.rotated(turn);
                vertebra.tilt = vertebra.tilt + turn;
            }
            outline.iliac_normal = outline.iliac_normal.map(|normal| normal + turn);
            outline.l4_on_film = outline.l4_on_film - turn;
            (outline, p.inflection_points.map(|pair| pair.map(|point| point.rotated(turn))))
        })
        .collect();
    let films: Vec<HypothesisFilm<'_>> = outlines
        .iter()
        .map(|(outline, inflections)| HypothesisFilm::new(outline, *inflections, springs))
        .collect();
    fit_hypothesis(hypothesis, &spine, &films).expect("bends with lines")
}

#[test]
fn on_a_free_base_another_axis_of_l4_changes_the_base_only() {
    // Oracle: a rotation of the film about L4 is a rotation of the base.
    let analysis = analysis();
    let turn = Angle::from_deg(5.0);
    for load in [LoadShape::InflectionLine, LoadShape::Weight, LoadShape::Couple] {
        let hypothesis = Hypothesis { load, base: Base::Free };
        let [still, turned] = [Angle::ZERO, turn].map(|turn| fitted(&analysis, hypothesis, turn));
        let change = turned.criteria.chi_squared / still.criteria.chi_squared - 1.0;
        assert!(change.abs() < 1e-3, "{load:?}: {change}");
        for (a, b) in still.of_role(Role::Fitted).zip(turned.of_role(Role::Fitted)) {
            let (a_deg, b_deg) = (a.base.deg(), (b.base - turn).deg());
            assert!((a_deg - b_deg).abs() < 0.05, "{load:?}: {a_deg} {b_deg}");
            for i in 1..14 {
                let joint = |tilts: &[Angle]| (tilts[i + 1] - tilts[i]).deg();
                assert!((joint(&a.tilts) - joint(&b.tilts)).abs() < 0.05, "{load:?}, joint {i}");
            }
        }
    }
}

#[test]
fn on_a_free_base_the_noise_of_its_tilt_does_not_weaken_the_tilt_of_t2() {
    // Oracle: whatever L4's axis is, the angle of the base takes it up.
    let mut analysis = analysis();
    let hypothesis = Hypothesis { load: LoadShape::InflectionLine, base: Base::Free };
    let bend = |analysis: &Analysis| {
        let fit = fitted(analysis, hypothesis, Angle::ZERO);
        let mut found = fit.of_role(Role::LeftOutWithTilt);
        let found = found.find(|one| one.shape.posture == Posture::LeftBending);
        found.expect("a prediction").shape.locations.clone()
    };
    let sure = bend(&analysis);
    for film in &mut analysis.movement.films {
        if film.outline.posture == Posture::LeftBending {
            film.outline.vertebrae[0].program = Some(ProgramNoise {
                location_mm: 0.0,
                tilt: Angle::from_deg(20.0),
                placed_share: 1.0,
                placed_tilt_share: 1.0,
                is_reviewed: true,
            });
        }
    }
    for (a, b) in sure.iter().zip(bend(&analysis)) {
        assert!(a.distance_mm(b) < 0.01, "{a:?} {b:?}");
    }
}

#[test]
fn t2_of_a_held_out_film_is_met_by_the_force_that_the_march_finds() {
    // Oracle: the search along the explicit march, which `nearest_t2` compares with a scan of the whole path.
    let analysis = analysis();
    let groups = JointGroups::regional(&analysis.movement.regions);
    let library = &analysis.options.library;
    let mut compared = 0;
    for load in [LoadShape::InflectionLine, LoadShape::IliacLine] {
        let fit = fitted(&analysis, Hypothesis::of(load), Angle::ZERO);
        let logs = &fit.log_multipliers;
        let statics =
            Statics::new(&analysis.movement.spine, library, &groups, logs, Support::Frontal);
        for found in fit.of_role(Role::HeldOut) {
            let film = analysis.movement.film(found.shape.posture).expect("the film was analysed");
            let t2 = film.outline.vertebrae[14].location;
            let line = match load {
                LoadShape::InflectionLine => {
                    let [caudal, cranial] = film.inflection_points.expect("it has a line");
                    LineOfAction::through(caudal, cranial).expect("they are apart")
                }
                _ => LineOfAction::along_iliac(t2, film.outline.iliac_normal),
            };
            let expected = match_t2(&statics, &Load::along(line, 0.0), &ForceSign::ALL, t2);
            let (force_n, expected_n) = (found.components[0], expected.force_n);
            let off = (force_n - expected_n).abs() / expected_n.abs();
            assert!(off < 1e-6, "{load:?}, {}: {force_n} {expected_n}", found.shape.posture);
            compared += 1;
        }
    }
    assert_eq!(compared, 4);
}

#[test]
fn a_picture_that_is_shifted_or_mirrored_gives_the_same_predictions() {
    // Oracle: the place in a picture is not the patient's, and left and right are names only. T2 gives two of three components.
    const RELATIVE: f64 = 1e-3;
    let case = generate(0, Scenario::Rod, &Readers::default(), 1).expect("a phantom").case;
    let mut shifted = case.clone();
    for film in &mut shifted.films {
        let (image, ..) = landmarks(film);
        image.columns += 300;
        image.rows += 300;
        move_places(film, |place| Pixel::new(place.column_px + 137.0, place.row_px + 41.0));
    }
    let image = case_of(case.films.iter().map(mirror_image).collect());
    let hypothesis = Hypothesis { load: LoadShape::FreeLine, base: Base::Noisy };
    let options = AnalysisOptions { hypotheses: vec![hypothesis], ..Default::default() };
    let [found, shifted, image] = [case, shifted, image]
        .map(|case| analyze(&case, &options).expect("a sound case").hypotheses.remove(0));
    let roles = [Role::HeldOut, Role::LeftOut];
    let predicted: Vec<_> = roles.into_iter().flat_map(|role| found.of_role(role)).collect();
    assert_eq!(predicted.len(), 4);
    for (other, side) in [(&shifted, 1.0), (&image, -1.0)] {
        for one in &predicted {
            let posture = one.shape.posture;
            let same = if side < 0.0 { other_side(posture) } else { posture };
            let other = other.of_role(one.role).find(|other| other.shape.posture == same);
            let other = other.expect("the same film");
            let mm = one.shape.mean_location_error_mm();
            let off_mm = (other.shape.mean_location_error_mm() - mm).abs();
            assert!(off_mm < RELATIVE * mm, "{posture}, {side}: off by {off_mm} of {mm} mm");
            // Across, along the spine, and a couple.
            for (i, sign) in [side, 1.0, side].into_iter().enumerate() {
                let (a, b) = (one.components[i], sign * other.components[i]);
                assert!((a - b).abs() < RELATIVE * a.abs(), "{posture}, {side}: {a} {b}");
            }
        }
    }
}

#[test]
fn a_fitted_shape_beyond_human_range_has_no_result() {
    // Every joint of both bends turns by 8°, which each could; all together reach 112°.
    let mut analysis = analysis();
    let erect = analysis.movement.erect().outline.vertebrae.clone();
    for posture in &mut analysis.movement.films {
        let degrees = match posture.outline.posture {
            Posture::LeftBending => -8.0,
            Posture::RightBending => 8.0,
            _ => continue,
        };
        let vertebrae = &mut posture.outline.vertebrae;
        for i in 1..erect.len() {
            let step = erect[i].location - erect[i - 1].location;
            let half = Angle::from_deg(degrees * (i as f64 - 0.5));
            vertebrae[i].location = vertebrae[i - 1].location + step.rotated(half);
            vertebrae[i].tilt = erect[i].tilt + Angle::from_deg(degrees * i as f64);
        }
    }
    let fit = fitted(&analysis, Hypothesis::of(LoadShape::Couple), Angle::ZERO);
    assert!(!fit.is_converged());
    assert_eq!(fit.ending_key(), "beyond_human_range");
    assert_eq!(fit.of_role(Role::Fitted).count(), 0);
    for posture in [Posture::LeftBending, Posture::RightBending] {
        let reason = PathEnding::BeyondHumanRange;
        let lost = LostPrediction { posture, role: Role::Fitted, reason };
        assert!(fit.lost.contains(&lost), "{posture}: {:?}", fit.lost);
    }
    // Films that were not fitted show what a spine can do.
    assert_eq!(fit.of_role(Role::HeldOut).count(), 2);
}

#[test]
fn a_fit_that_does_not_converge_predicts_no_film() {
    // Joints that all turn to one side, by any amount, are far from what the weight of the trunk does.
    let case = generate(3, Scenario::Bend, &Readers::default(), 1).expect("a phantom").case;
    let hypotheses = [LoadShape::InflectionLine, LoadShape::Weight].map(Hypothesis::of).to_vec();
    let options = AnalysisOptions { hypotheses, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a sound case");
    let fit = &analysis.hypotheses[1];
    assert_eq!(fit.ending_key(), "stalled", "the test means something");
    for role in [Role::Fitted, Role::HeldOut] {
        assert_eq!(fit.of_role(role).count(), 0, "{role}");
        let lost = fit.lost.iter().filter(|lost| lost.role == role);
        assert_eq!(lost.filter(|lost| lost.reason == PathEnding::FitNotConverged).count(), 2);
    }
    let said = |warning: &&Warning| {
        warning.code == WarningCode::FitNotConverged && warning.message.starts_with("weight")
    };
    let warnings: Vec<&Warning> = analysis.warnings.all().iter().filter(said).collect();
    assert_eq!(warnings.iter().filter(|warning| warning.posture.is_none()).count(), 1);
    let blocks = compare(&[&HypothesisScores::all(&analysis.hypotheses)[..]]);
    let [block] = &blocks[..] else { panic!("one block") };
    let [line, weight] = &block.hypotheses[..] else { panic!("two loads") };
    assert_eq!((line.aicc_difference, weight.aicc_difference.is_nan()), (0.0, true));
}

#[test]
fn names_round_trip_and_wrong_ones_are_refused() {
    for hypothesis in Hypothesis::compared() {
        assert_eq!(hypothesis.key().parse(), Ok(hypothesis));
        assert_eq!(hypothesis.key().replace('_', "-").parse(), Ok(hypothesis));
    }
    let refused = "inflection+free".parse::<Hypothesis>().expect_err("an unknown name");
    assert!(refused.to_string().contains("inflection_line"));
}

#[test]
fn only_requested_hypotheses_are_fitted() {
    assert!(analysis().hypotheses.is_empty());
}
