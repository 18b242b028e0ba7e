//! The general solver on one and two joints and on rods, where the answer can be written down.

use crate::common::chain::{
    self, constant, dead, equilibrium, follow, loads, pendulum, proportional, root, springs,
    with_rods,
};
use crate::common::everything::draw_vector;
use crate::common::{Draw, assert_near};
use spineline::multibody::{
    BodyLoad, Loading, PathEnding, PathOptions, Rod, Solution, SpineModel, Statics, Support,
    Timing, Wrench,
};
use spineline::spatial::{Angle, Mat3, Vec3, rotation_x, rotation_y, rotation_z};

/// Newton ends with a step below 1e-9 rad, whose square is left; then it is rounding.
const BALANCED_RAD: f64 = 1e-12;
const LENGTH_MM: f64 = 100.0;
const K: f64 = 1e5;

/// Three hinges in series.
fn turned(angles: &Vec3) -> Mat3 {
    let [x, y, z] = [angles.x, angles.y, angles.z].map(Angle::from_rad);
    rotation_x(x) * rotation_y(y) * rotation_z(z)
}

/// The single hinge angle about x of a pendulum under a loading.
fn lateral_turn(loading: &Loading) -> f64 {
    let model = pendulum(LENGTH_MM);
    let found = equilibrium(&model, &springs(&model, [K; 3]), Support::Free, loading);
    let [x, y, z] = found.deformed.hinges_rad[0];
    assert_near(y.abs() + z.abs(), 0.0, BALANCED_RAD, "hinges that carry nothing");
    x
}

#[test]
fn coupled_springs_balance_the_constructed_moment() {
    // Oracle: made backwards. For any hinge angles q the moments about the three axes e_x, R_x e_y, R_x R_y e_z must be
    // K q, which gives the one moment that does it: fixed in space, or in the vertebra's axes.
    let mut draw = Draw::new(3);
    let model = pendulum(LENGTH_MM);
    for _ in 0..50 {
        let root = Mat3::from_fn(|_, _| draw.between(-1.0, 1.0));
        let stiffness = (root * root.transpose() + Mat3::identity()) * K;
        let angles = draw_vector(&mut draw, 0.4);
        let (s, c) = (angles.map(f64::sin), angles.map(f64::cos));
        let axes = Mat3::new(1.0, 0.0, 0.0, 0.0, c.x, s.x, s.y, -s.x * c.y, c.x * c.y);
        let moment = axes.lu().solve(&(stiffness * angles)).expect("hinges that are not aligned");
        let in_vertebra = turned(&angles).transpose() * moment;
        for load in [
            BodyLoad::Moment { moment_nmm: moment },
            BodyLoad::FollowerMoment { moment_in_vertebra_nmm: in_vertebra },
        ] {
            let found = equilibrium(&model, &[stiffness], Support::Free, &Loading::single(1, load));
            let off = (Vec3::from(found.deformed.hinges_rad[0]) - angles).amax();
            assert_near(off, 0.0, BALANCED_RAD, "hinges");
        }
    }
}

#[test]
fn a_transverse_follower_force_rotates_one_joint_by_force_times_length() {
    // Oracle: its arm is the length at every angle, k θ = F L; a dead one's arm is L cos θ. It tips towards -y.
    for size_n in [-600.0, 50.0, 1000.0] {
        let force = Vec3::y() * -size_n;
        let follower = BodyLoad::FollowerForce {
            force_in_vertebra_n: force,
            point_in_vertebra_mm: Vec3::zeros(),
        };
        let turn = lateral_turn(&Loading::single(1, follower));
        assert_near(turn, size_n * LENGTH_MM / K, BALANCED_RAD, "follower");
        let turn = lateral_turn(&Loading::single(1, dead(force)));
        let exact = root(-1.5, 1.5, |turn| K * turn - size_n * LENGTH_MM * turn.cos());
        assert_near(turn, exact, BALANCED_RAD, "dead");
    }
}

#[test]
fn a_force_off_the_midpoint_and_one_on_a_line_have_their_lever_arms() {
    // Oracle: a dead force across at (0, b, c) of the vertebra has the arm of that point as it turns,
    // (L + c) cos θ + b sin θ; along a line at the height h it keeps the arm h.
    let (size_n, b, c, h) = (300.0, 25.0, -10.0, 70.0);
    let force_n = Vec3::y() * -size_n;
    let point_in_vertebra_mm = Vec3::new(0.0, b, c);
    let at_point = BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm };
    let exact =
        root(-1.0, 1.5, |turn| K * turn - size_n * ((LENGTH_MM + c) * turn.cos() + b * turn.sin()));
    assert_near(lateral_turn(&Loading::single(1, at_point)), exact, BALANCED_RAD, "at a point");
    let on_line = BodyLoad::ForceOnLine { force_n, point_mm: Vec3::new(0.0, 500.0, h) };
    let turn = lateral_turn(&Loading::single(1, on_line));
    assert_near(turn, size_n * h / K, BALANCED_RAD, "on a line");
}

#[test]
fn a_pad_and_a_strap_on_one_joint() {
    // Oracle: a pad towards -y presses with n (a - L sin θ) at the arm L cos θ. A strap from (-R, 0) pulls with
    // n (l - l₀ + s), l² = L² + R² - 2 L R sin θ, at the arm L R cos θ / l.
    let (n, way, reach) = (20.0, 30.0, 150.0);
    let point_in_vertebra_mm = Vec3::zeros();
    let direction = -Vec3::y();
    let pad = BodyLoad::Pad { point_in_vertebra_mm, direction, n_per_mm: n, advance_mm: way };
    let press = |turn: f64| n * (way - LENGTH_MM * turn.sin());
    let turn = root(0.0, 1.5, |turn| K * turn - press(turn) * LENGTH_MM * turn.cos());
    let length = |turn: f64| {
        (LENGTH_MM * LENGTH_MM + reach * reach - 2.0 * LENGTH_MM * reach * turn.sin()).sqrt()
    };
    let pull = |turn: f64| n * (length(turn) - length(0.0) + way);
    let strap = BodyLoad::Strap {
        point_in_vertebra_mm,
        anchor_mm: Vec3::y() * -reach,
        n_per_mm: n,
        shortening_mm: way,
    };
    let arm = |turn: f64| LENGTH_MM * reach * turn.cos() / length(turn);
    let pulled = root(0.0, 1.5, |turn| K * turn - pull(turn) * arm(turn));
    let model = pendulum(LENGTH_MM);
    for (load, turn, force) in [(pad, turn, press(turn)), (strap, pulled, pull(pulled))] {
        let loading = Loading::single(1, load);
        let found = equilibrium(&model, &springs(&model, [K; 3]), Support::Free, &loading);
        assert_near(found.deformed.hinges_rad[0][0], turn, BALANCED_RAD, "turn");
        assert_eq!(found.spring_forces_n.len(), 1);
        // A newton per 1e-4 rad.
        assert_near(found.spring_forces_n[0].1, force, 1e4 * BALANCED_RAD, "spring force");
    }
}

#[test]
fn a_heavy_pendulum_under_a_small_push_follows_its_closed_form() {
    // Oracle: k θ = W L sin θ + m, for weights on both sides of the one, k / L, at which it would buckle.
    for share in [-1.5, 0.6, 0.95, 1.3] {
        let weight = share * K / LENGTH_MM;
        let moment_nmm = Vec3::x() * (0.05 * K);
        let push = constant(1, BodyLoad::Moment { moment_nmm });
        let loading = loads([push, proportional(1, dead(Vec3::z() * -weight))]);
        let exact =
            root(0.0, 3.0, |turn| K * turn - weight * LENGTH_MM * turn.sin() - moment_nmm.x);
        // Its slope near the buckling load is a tenth.
        assert_near(lateral_turn(&loading), exact, 10.0 * BALANCED_RAD, "lean");
    }
}

#[test]
fn two_joints_under_a_dead_force_at_the_top() {
    // Oracle: with both springs k, bars L and a force F across, k (2 φ₁ - φ₂) = F L cos φ₁ and k (φ₂ - φ₁) = F L cos φ₂ in
    // the turns of the bars; the second gives φ₁, the first is then one equation.
    let model = chain::straight(&[0.0, LENGTH_MM, 2.0 * LENGTH_MM], &[0.0, LENGTH_MM]);
    let size_n = 250.0;
    let load = size_n * LENGTH_MM / K;
    let first = |second: f64| second - load * second.cos();
    let second = root(0.3, 1.4, |second| 2.0 * first(second) - second - load * first(second).cos());
    let loading = Loading::single(2, dead(Vec3::x() * size_n));
    let found = equilibrium(&model, &springs(&model, [K; 3]), Support::Free, &loading);
    let [a, b] = [0, 1].map(|joint| found.deformed.hinges_rad[joint][1]);
    assert_near(a, first(second), BALANCED_RAD, "lower");
    assert_near(b, second - first(second), BALANCED_RAD, "upper");
}

/// A crooked chain with joints off the line of the midpoints, so that its hinges reach every pose nearby.
fn crooked(draw: &mut Draw, joints: usize) -> SpineModel {
    let upright = |i: usize| Vec3::new(0.0, 0.0, 30.0 * i as f64);
    let midpoints = (0..=joints).map(|i| upright(i) + draw_vector(draw, 8.0)).collect();
    let axes = (0..=joints).map(|_| turned(&draw_vector(draw, 0.3))).collect();
    let centres: Vec<Vec3> =
        (0..joints).map(|_| Vec3::new(-15.0, 0.0, 14.0) + draw_vector(draw, 5.0)).collect();
    SpineModel::from_poses(midpoints, axes, &centres)
}

#[test]
fn a_rod_that_keeps_the_erect_pose_keeps_what_it_spans() {
    // Oracle: with nothing between its ends, the joints under the rod stay, the rod carries the force from above, and the
    // joints below and above turn as if the spanned part were one bone.
    let mut draw = Draw::new(17);
    let model = crooked(&mut draw, 6);
    let stiffness = springs(&model, [1.2e5, 1e5, 2e5]);
    let bone = SpineModel::from_poses(
        [0, 1, 4, 5, 6].map(|i| model.midpoints_mm[i]).to_vec(),
        [0, 1, 4, 5, 6].map(|i| model.axes[i]).to_vec(),
        &[0, 1, 4, 5].map(|i| model.joints[i].centre_in_inferior_mm),
    );
    let rod = Rod::locking(1, 4, Timing::Constant);
    let force = Vec3::new(30.0, -60.0, -80.0);
    let loading = with_rods(vec![proportional(6, dead(force))], vec![rod]);
    let found = equilibrium(&model, &stiffness, Support::Free, &loading);
    for joint in 1..4 {
        for angle in found.deformed.hinges_rad[joint] {
            assert_near(angle, 0.0, BALANCED_RAD, "a spanned joint");
        }
    }
    let (reaction, moment) = found.rod_reactions[0];
    assert_near((reaction + force).norm(), 0.0, 1e-9, "force of the rod");
    let arm = found.deformed.midpoints_mm[6] - found.deformed.midpoints_mm[4];
    // N·mm; the pose of the rod is met to 1e-6 mm.
    assert_near((moment + arm.cross(&force)).norm(), 0.0, 1e-4, "moment of the rod");
    // The joint above vertebra 1 is locked: a bone from there to vertebra 4 in place of its joint.
    let mut locked = springs(&bone, [1.2e5, 1e5, 2e5]);
    locked[1] *= 1e9;
    let as_bone = Loading::single(4, dead(force));
    let expected = equilibrium(&bone, &locked, Support::Free, &as_bone).deformed;
    for (ours, theirs) in [0, 1, 4, 5, 6].into_iter().zip(&expected.midpoints_mm) {
        // The locked joint gives way by 1e-10 rad.
        assert_near((found.deformed.midpoints_mm[ours] - theirs).norm(), 0.0, 1e-6, "midpoint");
    }
}

/// By way of the quaternion, which loses nothing at small angles.
fn rotation_vector(turn: Mat3) -> Vec3 {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(turn);
    nalgebra::UnitQuaternion::from_rotation_matrix(&rotation).scaled_axis()
}

#[test]
fn a_rod_has_the_wrench_that_gives_the_same_joint_angles() {
    // Oracle: made backwards by the march: a wrench on the upper vertebra bends three to six joints; a rod that prescribes
    // the pose so reached finds the same hinges and the same wrench. Two joints would not do: ball joints keep the
    // distance of their centres, so that they reach five dimensions of six.
    let mut draw = Draw::new(23);
    for joints in [3, 4, 6] {
        let model = crooked(&mut draw, joints);
        let rows: Vec<[f64; 3]> =
            (0..joints).map(|_| [(); 3].map(|()| draw.between(0.8e5, 2e5))).collect();
        let point = model.midpoints_mm[joints];
        let force_n = draw_vector(&mut draw, 150.0);
        let at_point = Wrench::at(point, force_n);
        let moment_nmm = at_point.moment_nmm + draw_vector(&mut draw, 1e4);
        let wrench = Wrench { moment_nmm, force_n };
        let mut solution = Solution::default();
        let groups = vec![0; joints];
        Statics::from_stiffness(&model, rows.clone(), &groups, Support::Free).march(
            &wrench,
            &[],
            &[],
            &mut solution,
        );
        let bent = &solution.deformed;
        let back = model.axes[0].transpose();
        let turn = back * bent.axes[joints] * model.axes[joints].transpose() * model.axes[0];
        let rod = Rod {
            inferior: 0,
            superior: joints,
            shift_mm: back * (bent.midpoints_mm[joints] - point),
            turn_rad: rotation_vector(turn),
            timing: Timing::Proportional,
        };
        let stiffness: Vec<Mat3> =
            rows.iter().map(|row| Mat3::from_diagonal(&Vec3::from(*row))).collect();
        let loading = with_rods(Vec::new(), vec![rod]);
        let options = PathOptions { look_beyond: false, ..PathOptions::default() };
        let path = follow(&model, &stiffness, Support::Free, &loading, &options);
        assert_eq!(path.ending, PathEnding::Converged, "{joints} joints");
        let found = path.result().expect("converged");
        // The pose is met to about 1e-12; a nearly singular rod passes on a thousand times as much.
        for (ours, theirs) in found.deformed.hinges_rad.iter().zip(&bent.hinges_rad) {
            for (angle, expected) in ours.iter().zip(theirs) {
                assert_near(*angle, *expected, 1e-9, "hinge");
            }
        }
        let (force, moment) = found.rod_reactions[0];
        let about_origin = moment + bent.midpoints_mm[joints].cross(&force);
        assert_near((force - wrench.force_n).norm(), 0.0, 1e-5, "force, N");
        assert_near((about_origin - wrench.moment_nmm).norm(), 0.0, 1e-3, "moment, N·mm");
    }
}
