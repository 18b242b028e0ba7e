//! Rods in a frontal support, which leaves them tilt and lateral place.

use crate::common::chain::{dead, equilibrium, loads, proportional, springs, straight, with_rods};
use crate::common::everything::draw_vector;
use crate::common::{Draw, assert_near, spine};
use spineline::multibody::{
    BodyLoad, Deformed, GeneralStatics, Goal, Loading, LoadingFault, PathEnding, Rod, RodComponent,
    SpineModel, Support, Timing,
};
use spineline::response::{Response, go_on, respond};
use spineline::spatial::{Angle, Mat3, Vec3, rotation_x};

const K: f64 = 1.4e5;

fn rod(ends: [usize; 2], shift_mm: Vec3, turn_rad: Vec3) -> Rod {
    let [inferior, superior] = ends;
    Rod { inferior, superior, shift_mm, turn_rad, timing: Timing::Proportional }
}

fn only(rod: Rod) -> Loading {
    with_rods(Vec::new(), vec![rod])
}

fn under(model: &SpineModel, support: Support, rod: Rod) -> Response {
    let statics = GeneralStatics::new(model, springs(model, [K, 1.3e5, 3e5]), support);
    let statics = statics.expect("sound springs");
    respond(&statics, &only(rod), Goal::FullLoad, 2.0, &mut go_on).expect("a rod that fits")
}

/// Tilt of the upper vertebra and its lateral place, as they are seen along the lower one's anterior axis.
fn seen(midpoints: &[Vec3], axes: &[Mat3], [low, high]: [usize; 2]) -> (Angle, f64) {
    let from_below = axes[low].transpose();
    let up = from_below * axes[high].column(2);
    let place = from_below * (midpoints[high] - midpoints[low]);
    (Angle::from_sin_cos(-up.y, up.z), place.y)
}

/// How both change under a rod: towards the patient's right, and to the left in mm.
fn moved(erect: &SpineModel, shape: &Deformed, ends: [usize; 2]) -> (f64, f64) {
    let before = seen(&erect.midpoints_mm, &erect.axes, ends);
    let after = seen(&shape.midpoints_mm, &shape.axes, ends);
    ((after.0 - before.0).wrapped().deg(), after.1 - before.1)
}

#[test]
fn a_rod_that_turns_a_vertebra_has_a_result_in_a_frontal_support() {
    // Oracle: the pose that is prescribed, from the definition. A joint of a human spine turns by 27° at most, so that short rods
    // may end beyond the human range.
    for subject in [0, 4, 9, 13] {
        let model = spine(subject).1;
        for ends in [[3, 10], [0, 14], [6, 14], [0, 8], [4, 8], [2, 5], [1, 3]] {
            for degrees in (1..=30).flat_map(|angle| [angle, -angle]).map(f64::from) {
                let turn = Vec3::x() * Angle::from_deg(degrees).rad();
                let found = under(&model, Support::Frontal, rod(ends, Vec3::zeros(), turn));
                let what = format!("subject {subject}, {ends:?}, {degrees}°: {:?}", found.ending);
                let Some(result) = found.result() else {
                    let joints = (ends[1] - ends[0]) as f64;
                    assert_eq!(found.ending, PathEnding::BeyondHumanRange, "{what}");
                    assert!(degrees.abs() > 3.0 * joints, "{what}");
                    continue;
                };
                let (tilt_deg, left_mm) = moved(&model, &result.deformed, ends);
                assert_near(tilt_deg, degrees, 1e-6, &what);
                assert_near(left_mm, 0.0, 1e-5, &what);
            }
        }
    }
}

#[test]
fn a_rod_that_shifts_a_vertebra_has_a_result_in_a_frontal_support() {
    // Oracle: the pose that is prescribed. A rod that shifts alone keeps the tilt.
    let model = spine(4).1;
    for ends in [[3, 10], [0, 14], [6, 14]] {
        for left_mm in [-10.0, -1.0, 1.0, 5.0, 10.0] {
            let shift = Vec3::y() * left_mm;
            let found = under(&model, Support::Frontal, rod(ends, shift, Vec3::zeros()));
            let result = found.result().expect("within reach");
            let (tilt_deg, moved_mm) = moved(&model, &result.deformed, ends);
            assert_near(tilt_deg, 0.0, 1e-6, "tilt");
            assert_near(moved_mm, left_mm, 1e-5, "lateral place");
            let (force, _) = result.rod_reactions[0];
            let along = |axis: usize| force.dot(&result.deformed.axes[ends[0]].column(axis));
            assert_near(along(0).abs() + along(2).abs(), 0.0, 1e-6 * force.norm(), "the support's");
        }
    }
}

#[test]
fn a_small_turn_bends_a_straight_chain_as_a_beam() {
    // Oracle: equal springs at equal distances h whose turns add up to θ, and whose ends do not shift, take the turns that are
    // linear in the height z with the least Σ q²: q = a + b z with Σ q = θ and Σ q (L - z) = 0. Second order is left, 1e-4 of θ.
    let (joints, h, turn) = (6_usize, 30.0, 1e-3);
    let heights: Vec<f64> = (0..=joints).map(|i| h * i as f64).collect();
    let model = straight(&heights, &heights[..joints]);
    let found = equilibrium(
        &model,
        &springs(&model, [K, K, K]),
        Support::Frontal,
        &only(rod([0, joints], Vec3::zeros(), Vec3::x() * turn)),
    );
    let z = || heights[..joints].iter();
    let levers: Vec<f64> = z().map(|z| h * joints as f64 - z).collect();
    // q = c + d lever, by the two conditions.
    let (n, sum) = (joints as f64, levers.iter().sum::<f64>());
    let squares: f64 = levers.iter().map(|lever| lever * lever).sum();
    let d = turn / (sum - n * squares / sum);
    let c = -d * squares / sum;
    for (hinges, lever) in found.deformed.hinges_rad.iter().zip(&levers) {
        assert_near(hinges[0], c + d * lever, 1e-3 * turn, "a joint");
        assert!(hinges[1] == 0.0 && hinges[2] == 0.0, "held by the support");
    }
    let (force, moment) = found.rod_reactions[0];
    assert_near(force.y, -K * d, 1e-3 * K * d.abs(), "the force to the side");
    assert_near(moment.x, K * c, 1e-3 * K * c.abs(), "the moment on the upper vertebra");
}

#[test]
fn a_rod_in_the_plane_has_the_force_and_the_moment_that_give_its_pose() {
    // Oracle: made backwards: a lateral force and a moment about x bend a crooked chain that lies in one plane; a rod from the fixed
    // vertebra that prescribes the tilt and the lateral place so reached finds the same shape, force and moment.
    let mut draw = Draw::new(71);
    for joints in [2, 4, 9] {
        let (mut midpoints, mut axes) = (vec![Vec3::zeros()], vec![Mat3::identity()]);
        for _ in 0..joints {
            let step = draw_vector(&mut draw, 5.0);
            midpoints.push(midpoints[midpoints.len() - 1] + Vec3::new(0.0, step.y, 28.0));
            axes.push(rotation_x(Angle::from_deg(draw.between(-15.0, 15.0))));
        }
        let centres = vec![Vec3::new(-12.0, 1.0, 14.0); joints];
        let model = SpineModel::from_poses(midpoints, axes, &centres);
        let stiffness = springs(&model, [K, K, K]);
        let (force, moment) = (draw.between(-60.0, 60.0), draw.between(-4e3, 4e3));
        let bent = equilibrium(
            &model,
            &stiffness,
            Support::Frontal,
            &loads([
                proportional(joints, dead(Vec3::y() * force)),
                proportional(joints, BodyLoad::Moment { moment_nmm: Vec3::x() * moment }),
            ]),
        );
        let (tilt_deg, left_mm) = moved(&model, &bent.deformed, [0, joints]);
        let turn = Vec3::x() * Angle::from_deg(tilt_deg).rad();
        let rod = rod([0, joints], Vec3::y() * left_mm, turn);
        let found = equilibrium(&model, &stiffness, Support::Frontal, &only(rod));
        for (ours, theirs) in found.deformed.hinges_rad.iter().zip(&bent.deformed.hinges_rad) {
            assert_near(ours[0], theirs[0], 1e-9, "hinge");
        }
        let (reaction, couple) = found.rod_reactions[0];
        assert_near((reaction - Vec3::y() * force).norm(), 0.0, 1e-4, "force, N");
        assert_near((couple - Vec3::x() * moment).norm(), 0.0, 1e-2, "moment, N·mm");
        // The tangent under a load of given size is another one, but neither is near a singular point.
        assert!(found.smallest_singular_value > 0.5, "{}", found.smallest_singular_value);
    }
}

#[test]
fn a_column_that_slides_along_its_rod_buckles_between_its_ends() {
    // Oracle: by hand. Three hinges at distances h under a rod that keeps tilt and lateral place leave the turns (q, -2q, q): springs
    // of 6 k q²/2 against a thrust P over two links at q and -q: P = 6 k / (2 h).
    let (h, k) = (30.0, 1e5);
    let heights: Vec<f64> = (0..4).map(|i| h * f64::from(i)).collect();
    let model = straight(&heights, &heights[..3]);
    let load = proportional(3, dead(-Vec3::z() * (6.0 * k / h)));
    let loading = with_rods(vec![load], vec![Rod::locking(0, 3, Timing::Constant)]);
    let statics = GeneralStatics::new(&model, springs(&model, [k; 3]), Support::Frontal);
    let path = statics
        .expect("sound springs")
        .follow(&loading, Goal::FullLoad, &Default::default())
        .expect("sound loads");
    assert_eq!(path.ending, PathEnding::BranchPoint, "{:?}", path.events);
    assert_near(path.events[0].factor, 0.5, 1e-6, "buckling");
}

#[test]
fn a_rod_that_prescribes_what_the_support_holds_is_refused_by_its_component() {
    let model = spine(0).1;
    let refused = |ends, shift_mm: [f64; 3], turn_rad: [f64; 3], support| {
        let loading = only(rod(ends, shift_mm.into(), turn_rad.into()));
        loading.check(&model, support).err().map(|error| error.fault)
    };
    for (shift_mm, turn_rad, component, value) in [
        ([3.0, 0.0, 0.0], [0.0; 3], RodComponent::ShiftX, 3.0),
        ([0.0, 2.0, -4.0], [0.0; 3], RodComponent::ShiftZ, -4.0),
        ([0.0; 3], [0.1, 0.2, 0.0], RodComponent::TurnY, Angle::from_rad(0.2).deg()),
        ([0.0; 3], [0.0, 0.0, 0.1], RodComponent::TurnZ, Angle::from_rad(0.1).deg()),
    ] {
        let expected = LoadingFault::RodAgainstSupport { component, value };
        assert_eq!(refused([3, 9], shift_mm, turn_rad, Support::Frontal), Some(expected));
        assert_eq!(refused([3, 9], shift_mm, turn_rad, Support::Free), None);
    }
    let turn = [0.1, 0.0, 0.0];
    for (support, least) in [(Support::Frontal, 2), (Support::Free, 3)] {
        let few = LoadingFault::RodJoints { inferior: 4, superior: 5, joints: 1, least };
        assert_eq!(refused([4, 5], [0.0; 3], turn, support), Some(few));
        assert_eq!(refused([4, 4 + least], [0.0; 3], turn, support), None);
        assert_eq!(refused([4, 5], [0.0; 3], [0.0; 3], support), None, "it keeps the erect pose");
    }
}
