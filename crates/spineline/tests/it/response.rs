//! Which shape a spine takes for a wanted lateral tilt, and where its angles are measured.

use crate::common::chain::{dead, proportional};
use crate::common::spine;
use spineline::anatomy::{Levels, Side};
use spineline::clinical::CurvePlaces;
use spineline::multibody::{
    BodyLoad, ForceSign, GeneralStatics, Goal, LoadItem, Loading, MAX_HUMAN_COLUMN,
    MAX_HUMAN_JOINT, PathEnding, Rod, SpineModel, Support, Timing,
};
use spineline::response::{
    ActingKind, CurveChange, OtherLoads, OtherLoadsError, PadEffect, PadTrial, Response, Verdict,
    acting_loads, erect_shape, go_on, largest_factor, measure_angles, respond, try_pad,
};
use spineline::spatial::{Angle, Mat3, Vec3};

fn load_top(
    model: &SpineModel,
    springs: &[Mat3],
    load: BodyLoad,
    goal: Goal,
) -> (Loading, Response) {
    let statics =
        GeneralStatics::new(model, springs.to_vec(), Support::Free).expect("sound springs");
    let loading = Loading::single(model.joints.len(), load);
    let most = largest_factor(model, springs, &loading);
    let response = respond(&statics, &loading, goal, most, &mut go_on).expect("sound loads");
    (loading, response)
}

fn push(model: &SpineModel, springs: &[Mat3], force_n: Vec3, goal: Goal) -> (Loading, Response) {
    load_top(model, springs, dead(force_n), goal)
}

fn springs(model: &SpineModel) -> Vec<Mat3> {
    vec![Mat3::from_diagonal(&Vec3::new(1.44e5, 1.4e5, 3e5)); model.joints.len()]
}

#[test]
fn reversing_the_force_reverses_the_factor() {
    let model = spine(0).1;
    let springs = springs(&model);
    let goal = Goal::LateralTilt(Angle::from_deg(-20.0));
    let along = push(&model, &springs, Vec3::new(0.0, 100.0, 0.0), goal).1;
    let against = push(&model, &springs, Vec3::new(0.0, -100.0, 0.0), goal).1;
    let factor = |response: &Response| response.result().expect("a result").factor;
    assert!(factor(&along) > 0.0 && (factor(&along) + factor(&against)).abs() < 1e-9);
    assert_eq!(
        (along.equilibria[0].sign, against.equilibria[0].sign),
        (ForceSign::Positive, ForceSign::Negative)
    );
    // Twice the force needs half the factor: the same shape.
    let twice = push(&model, &springs, Vec3::new(0.0, 200.0, 0.0), goal).1;
    assert!((2.0 * factor(&twice) - factor(&along)).abs() < 1e-9);
}

#[test]
fn the_chosen_shape_is_the_least_loaded_one_on_the_erect_branch() {
    let model = spine(0).1;
    let springs = springs(&model);
    let mut several = 0;
    for tilt in [-12.0, -6.0, -3.0, -2.0, 1.0, 4.0, 9.0, 15.0] {
        // A pull along a line fixed in space beside the joints bends first one way, then the other.
        let (force_n, point_mm) = (Vec3::new(0.0, 64.5, 290.5), Vec3::new(-16.0, -8.0, 115.6));
        let load = BodyLoad::ForceOnLine { force_n, point_mm };
        let (_, response) =
            load_top(&model, &springs, load, Goal::LateralTilt(Angle::from_deg(tilt)));
        several += usize::from(response.equilibria.len() > 1);
        if let Some(result) = response.result() {
            assert_eq!(response.equilibria[0].verdict, Verdict::Reached);
            assert!(result.is_on_erect_branch());
            for met in response.equilibria.iter().filter(|met| met.equilibrium.is_on_erect_branch())
            {
                assert!(met.equilibrium.factor.abs() >= result.factor.abs());
            }
        }
        for met in &response.equilibria {
            let found = met.equilibrium.deformed.lateral_tilt();
            assert!((found.deg() - tilt).abs() < 1e-7, "every reported shape has the wanted tilt");
        }
    }
    assert!(several > 0, "the test means something");
}

#[test]
fn an_existing_lateral_tilt_needs_no_load_and_is_met_once() {
    let model = spine(0).1;
    let tilt = erect_shape(&model).lateral_tilt();
    let (_, response) =
        push(&model, &springs(&model), Vec3::new(0.0, 50.0, 0.0), Goal::LateralTilt(tilt));
    assert_eq!(response.equilibria.iter().filter(|met| met.equilibrium.factor == 0.0).count(), 1);
    assert!(response.result().is_some_and(|result| result.factor == 0.0));
}

#[test]
fn the_largest_factor_scales_with_springs_and_against_loads() {
    let model = spine(0).1;
    let loading = |n: f64| Loading::single(14, dead(Vec3::new(0.0, n, 0.0)));
    let springs = springs(&model);
    let soft: Vec<Mat3> = springs.iter().map(|k| k * 0.5).collect();
    // 1500 N for this mean lateral stiffness.
    assert!((largest_factor(&model, &springs, &loading(100.0)) - 15.0).abs() < 1e-9);
    assert!((largest_factor(&model, &soft, &loading(300.0)) - 2.5).abs() < 1e-9);
    assert!((largest_factor(&model, &springs, &Loading::default()) - 2.0).abs() < 1e-12);
}

#[test]
fn an_interrupted_or_unreachable_search_has_no_result() {
    let model = spine(0).1;
    let goal = Goal::LateralTilt(Angle::from_deg(-89.0));
    let (_, response) = push(&model, &springs(&model), Vec3::new(0.0, 100.0, 0.0), goal);
    assert_eq!(response.ending, PathEnding::Unreachable);
    assert!(response.result().is_none() && response.nearest().is_some());
}

#[test]
fn angles_and_acting_loads_belong_to_the_shape() {
    let model = spine(0).1;
    let (loading, response) =
        push(&model, &springs(&model), Vec3::new(0.0, 30.0, 0.0), Goal::FullLoad);
    let result = response.result().expect("a small force");
    let [load] = acting_loads(&loading, &result.deformed, result.factor, &[])[..] else {
        panic!("one")
    };
    assert_eq!(load.kind, ActingKind::Force(Vec3::new(0.0, 30.0, 0.0)));
    assert!((load.point_mm - result.deformed.midpoints_mm[14]).norm() < 1e-12);
    let erect = erect_shape(&model);
    let locations: Vec<_> = (0..15).map(|i| erect.location(i)).collect();
    let tilts: Vec<_> = (0..15).map(|i| erect.tilt(i)).collect();
    let places = CurvePlaces::usual(Levels::COMPLETE, &locations, &tilts).expect("L4 to T2");
    assert!(CurvePlaces::usual(Levels::COMPLETE, &locations[1..], &tilts[1..]).is_none());
    // A force to the left at the top turns the spine to the left all along: every curve gains the same way.
    let (before, after) =
        (measure_angles(&erect, &places), measure_angles(&result.deformed, &places));
    for (now, then) in after.curves.iter().zip(&before.curves) {
        assert!(now.ends.tilt_range < then.ends.tilt_range, "{}", now.region);
    }
    assert!(after.lateral_tilt < before.lateral_tilt);
}

#[test]
fn the_unit_of_loads_does_not_change_the_shape() {
    // Oracle: a force is a force, in newtons or in units of ten micronewtons.
    let model = spine(0).1;
    let springs = springs(&model);
    let goal = Goal::LateralTilt(Angle::from_deg(-20.0));
    let shape = |size: f64| {
        let response = push(&model, &springs, Vec3::new(0.0, size, 0.0), goal).1;
        let factor = response.result().expect("a result").factor;
        let points: usize = response.paths.iter().map(|signed| signed.path.points.len()).sum();
        (factor * size, points)
    };
    let ((force_n, _), (small_n, points)) = (shape(100.0), shape(1e-5));
    assert!((force_n - small_n).abs() < 1e-6 * force_n, "{force_n} and {small_n}");
    assert!(points < 500, "{points} points");
}

#[test]
fn the_lateral_tilt_of_the_unloaded_spine_is_met_once() {
    // Oracle: no load at all meets it; along and against a force that is the same shape.
    let model = spine(0).1;
    let springs = springs(&model);
    let top = model.midpoints_mm[14];
    let goal = Goal::LateralTilt(Angle::from_sin_cos(-top.y, top.z));
    let response = push(&model, &springs, Vec3::new(0.0, 50.0, 0.0), goal).1;
    let unloaded = response.equilibria.iter().filter(|met| met.equilibrium.factor.abs() < 1e-6);
    assert_eq!(unloaded.count(), 1, "{:?}", response.ending);
}

#[test]
fn a_straight_column_that_must_buckle_to_tilt_is_reported() {
    // Oracle: pressed along its axis it stays straight up to the first branch point, and only that branch leans.
    let midpoints = (0..15).map(|i| Vec3::new(0.0, 0.0, 28.0 * f64::from(i))).collect();
    let centres = [Vec3::new(0.0, 0.0, 14.0); 14];
    let model = SpineModel::from_poses(midpoints, vec![Mat3::identity(); 15], &centres);
    let springs = springs(&model);
    let goal = Goal::LateralTilt(Angle::from_deg(-10.0));
    let response = push(&model, &springs, Vec3::new(0.0, 0.0, -300.0), goal).1;
    assert_eq!(response.ending, PathEnding::BranchPoint);
    assert!(response.result().is_none());
}

#[test]
fn a_path_lost_beyond_its_result_is_reported_as_incomplete() {
    // Oracle: joints do not stretch, so a rod cannot push its vertebrae 20 mm apart; the lateral tilt half-way there is met before.
    let model = spine(0).1;
    let springs = springs(&model);
    let statics = GeneralStatics::new(&model, springs, Support::Free).expect("sound springs");
    let shift_mm = Vec3::new(0.0, 0.0, 20.0);
    let stretched = Rod {
        inferior: 4,
        superior: 10,
        shift_mm,
        turn_rad: Vec3::zeros(),
        timing: Timing::Proportional,
    };
    let loading = Loading { items: Vec::new(), rods: vec![stretched] };
    let answer = |goal| respond(&statics, &loading, goal, 1.0, &mut go_on).expect("sound");
    let full = answer(Goal::FullLoad);
    assert!(full.result().is_none(), "{:?}", full.ending);
    assert!(matches!(full.ending, PathEnding::NotConverged | PathEnding::Unreachable));
    let points = &full.paths[0].path.points;
    let tilt = points[points.len() / 3].deformed.lateral_tilt();
    let found = answer(Goal::LateralTilt(tilt));
    assert!(!found.equilibria.is_empty());
    // The same path is lost at the same place, result or not.
    assert!(!full.is_complete() && !found.is_complete());
}

#[test]
fn loads_that_fold_the_spine_end_beyond_the_human_range() {
    // Oracle: the sum of healthy ranges of lateral bending from L4 to T2 is 91°, of one joint at most 9° [white-panjabi-1990].
    let model = spine(0).1;
    let springs = springs(&model);
    let mut endings = Vec::new();
    for force_n in [10.0, 60.0, 600.0, 1400.0] {
        let load = Vec3::new(0.0, force_n, 0.0);
        let response = push(&model, &springs, load, Goal::FullLoad).1;
        if let Some(result) = response.result() {
            assert!(result.deformed.beyond_human_range(&model).is_none(), "{force_n} N");
        }
        if response.ending == PathEnding::BeyondHumanRange {
            let shape = response.shape().expect("the folded one");
            let beyond = shape.beyond_human_range(&model).expect("beyond");
            assert!(beyond.rotation > beyond.limit);
            let (factor, reached) = response.last_reached(&model).expect("the part within");
            assert!(factor < 1.0 && reached.beyond_human_range(&model).is_none());
        }
        endings.push(response.ending);
    }
    assert_eq!(endings[0], PathEnding::Converged);
    assert_eq!(endings[2..], [PathEnding::BeyondHumanRange; 2]);
}

#[test]
fn a_wanted_lateral_tilt_of_a_folded_spine_has_no_result() {
    let model = spine(0).1;
    let goal = Goal::LateralTilt(Angle::from_deg(-75.0));
    let response = push(&model, &springs(&model), Vec3::new(0.0, 100.0, 0.0), goal).1;
    assert_eq!(response.ending, PathEnding::BeyondHumanRange);
    assert!(response.result().is_none());
    assert!(response.equilibria.iter().all(|met| met.verdict != Verdict::Reached));
}

#[test]
fn the_range_counts_rotations_from_the_erect_shape_of_any_axis() {
    // Oracle: a rotation of every vertebra by k times one angle about one axis.
    let model = spine(0).1;
    let axis = nalgebra::Unit::new_normalize(Vec3::new(1.0, 2.0, -0.5));
    let bent = |per_joint_deg: f64| {
        let mut shape = erect_shape(&model);
        for (k, axes) in shape.axes.iter_mut().enumerate() {
            let turn = Angle::from_deg(per_joint_deg * k as f64).rad();
            *axes = nalgebra::Rotation3::from_axis_angle(&axis, turn).matrix() * *axes;
        }
        shape.beyond_human_range(&model)
    };
    assert_eq!(bent(0.0), None);
    assert_eq!(bent(6.4), None, "14 joints of 6.4° are 89.6°");
    let column = bent(6.6).expect("14 joints of 6.6° are 92.4°");
    assert_eq!((column.vertebrae, column.limit), ([0, 14], MAX_HUMAN_COLUMN));
    assert!((column.rotation.deg() - 92.4).abs() < 1e-9);
    let joint = bent(27.1).expect("beyond the limit of a joint");
    assert_eq!((joint.vertebrae[1] - joint.vertebrae[0], joint.limit), (1, MAX_HUMAN_JOINT));
}

fn usual_places(model: &SpineModel) -> [CurvePlaces; 3] {
    let erect = erect_shape(model);
    let locations: Vec<_> = (0..15).map(|i| erect.location(i)).collect();
    let tilts: Vec<_> = (0..15).map(|i| erect.tilt(i)).collect();
    CurvePlaces::usual(Levels::COMPLETE, &locations, &tilts).expect("L4 to T2")
}

/// A tried pad as a spring that ends with its force.
fn spring_of(effect: &PadEffect) -> BodyLoad {
    let n_per_mm = 3.0;
    BodyLoad::Pad {
        point_in_vertebra_mm: Vec3::zeros(),
        direction: effect.trial.direction(),
        n_per_mm,
        advance_mm: effect.advance_mm(n_per_mm).expect("a result"),
    }
}

/// A pad has its stiffness and its displacement, and a trial has its force: both must be the same equilibrium.
#[test]
fn a_tried_pad_pushes_with_its_force_once_it_is_a_spring() {
    /// Of the force, in newtons, and of angles, in degrees: Newton ends far below.
    const SAME: f64 = 1e-6;
    let model = spine(0).1;
    let springs = springs(&model);
    let statics =
        GeneralStatics::new(&model, springs.clone(), Support::Frontal).expect("sound springs");
    let erect = erect_shape(&model);
    let places = usual_places(&model);
    let trials = PadTrial::all(15, 40.0, 2);
    let none = OtherLoads::new(&statics, Loading::default(), &mut go_on);
    let none = none.expect("no load is valid");
    assert_eq!(trials.len(), 14 * 2 * 2);
    let (mut found, mut corrected, mut worsened) = (0, 0, 0);
    for trial in trials {
        let effect = try_pad(&statics, &none, &places, trial, &mut go_on).expect("a sound load");
        let Some(reached) = effect.reached else { continue };
        let loading = Loading::single(trial.vertebra, spring_of(&effect));
        let response =
            respond(&statics, &loading, Goal::FullLoad, 1.0, &mut go_on).expect("a sound load");
        let result = response.result().expect("the pad only makes the spine stiffer");
        let [(_, force_n)] = result.spring_forces_n[..] else { panic!("one pad") };
        assert!((force_n - trial.force_n).abs() < SAME, "{trial:?}: {force_n}");
        let [before, after] =
            [&erect, &result.deformed].map(|shape| measure_angles(shape, &places));
        let own = CurveChange::between(&before, &after).expect("three curves");
        let tried = reached.curve.expect("three curves");
        assert!((own.after - tried.after).deg().abs() < SAME, "{trial:?}");
        found += 1;
        corrected += usize::from(tried.growth().deg() < 0.0);
        worsened += usize::from(tried.growth().deg() > 0.0);
    }
    assert!(found > 40 && corrected > 10 && worsened > 10, "{found} {corrected} {worsened}");
}

/// Oracle: all loads in one plan, with the pad as a spring.
#[test]
fn a_pad_beside_other_loads_is_a_load_of_their_plan() {
    const SAME: f64 = 1e-6;
    let model = spine(0).1;
    let springs = springs(&model);
    let statics = GeneralStatics::new(&model, springs, Support::Frontal).expect("sound springs");
    let places = usual_places(&model);
    let trial = PadTrial { vertebra: 9, towards: Side::Left, force_n: 25.0 };
    for timing in [Timing::Constant, Timing::Proportional] {
        let item = LoadItem { vertebra: 14, load: dead(Vec3::new(0.0, 3.0, 8.0)), timing };
        let traction = Loading { items: vec![item], rods: Vec::new() };
        let others = OtherLoads::new(&statics, traction.clone(), &mut go_on).expect("a result");
        let effect = try_pad(&statics, &others, &places, trial, &mut go_on).expect("a sound load");
        let mut plan = traction.clone();
        plan.items.push(proportional(9, spring_of(&effect)));
        let [before, after] = [&traction, &plan].map(|loading| {
            let goal = Goal::FullLoad;
            let response = respond(&statics, loading, goal, 1.0, &mut go_on).expect("sound loads");
            let shape = &response.result().expect("small loads").deformed;
            measure_angles(shape, &places)
        });
        let unloaded = measure_angles(&erect_shape(&model), &places);
        let own = CurveChange::of_largest(&unloaded, [&before, &after]).expect("three curves");
        let tried = effect.reached.and_then(|reached| reached.curve).expect("three curves");
        for (a, b) in [(own.before, tried.before), (own.after, tried.after)] {
            assert!((a - b).deg().abs() < SAME, "{timing:?}: {own:?} {tried:?}");
        }
    }
    let snapping = Loading::single(14, dead(Vec3::new(0.0, 0.0, -1e6)));
    let refused = OtherLoads::new(&statics, snapping, &mut go_on).expect_err("no spine bears this");
    assert!(matches!(refused, OtherLoadsError::NoResult { .. }), "{refused}");
}

#[test]
fn the_reached_shapes_grow_up_to_the_result_or_end_before_the_spine_snaps() {
    let model = spine(0).1;
    let springs = springs(&model);
    let goal = Goal::FullLoad;
    let (_, bent) = push(&model, &springs, Vec3::new(0.0, 50.0, 0.0), goal);
    let result = bent.result().expect("a small load");
    let factors: Vec<f64> = bent.reached_points(&model).map(|point| point.factor).collect();
    assert!(factors.len() > 1 && factors.is_sorted() && factors[0] == 0.0, "{factors:?}");
    assert!(factors.iter().all(|factor| *factor < result.factor));
    assert_eq!(bent.last_reached(&model).map(|(factor, _)| factor), Some(result.factor));
    let (_, folded) = push(&model, &springs, Vec3::new(0.0, 0.0, -5000.0), goal);
    assert!(folded.result().is_none());
    let last = folded.reached_points(&model).last().expect("the unloaded spine");
    assert!(last.factor < 1.0 && last.deformed.beyond_human_range(&model).is_none());
}

#[test]
fn the_largest_erect_curve_is_measured_before_and_after() {
    let model = spine(0).1;
    let erect = erect_shape(&model);
    let places = usual_places(&model);
    let angles = measure_angles(&erect, &places);
    let same = CurveChange::between(&angles, &angles).expect("three curves");
    let sizes = angles.curves.iter().map(|curve| curve.ends.size().abs().deg());
    assert!((same.before.deg() - sizes.fold(0.0, f64::max)).abs() < 1e-12);
    assert_eq!((same.before, same.growth().deg()), (same.after, 0.0));
    assert!((angles.top_offset_mm - erect.midpoints_mm[14].y).abs() < 1e-12);
    assert_eq!(CurveChange::between(&measure_angles(&erect, &[]), &angles), None);
}
