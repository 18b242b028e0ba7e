//! Statics that can be checked by hand, and equilibrium as virtual work.

use crate::common::chain::straight;
use crate::common::independent::{Body, add, apply, product, stack, subtract, transposed};
use crate::common::{Draw, assert_near, spine};
use spineline::action::LineOfAction;
use spineline::anatomy::Levels;
use spineline::multibody::{
    JointGroups, Load, Parameter, Solution, SpineModel, Statics, StiffnessLibrary, Support, Wrench,
};
use spineline::spatial::{Angle, Frontal, Vec3};

/// A handful of products of numbers of order one to a hundred.
const ROUNDING: f64 = 1e-12;
/// Central differences with a step of the cube root of eps, relative to the largest moment.
const DIFFERENCE: f64 = 1e-6;

fn solve(statics: &Statics<'_>, load: &Load, force_n: f64) -> Solution {
    let mut solution = Solution::default();
    statics.solve(load, &[force_n], &[Parameter::Load(0)], &mut solution);
    solution
}

#[test]
fn one_joint_rotates_by_force_times_lever_arm_over_stiffness() {
    // Oracle: k Δθ = d F, and the vertebra turns about the joint's centre.
    let model = straight(&[0.0, 40.0], &[15.0]);
    let k = 130_000.0;
    let line = LineOfAction::leaning(Frontal::new(25.0, 60.0), Angle::from_deg(20.0));
    for support in [Support::Free, Support::Frontal] {
        let statics = Statics::from_stiffness(&model, [[k, 1e5, 2e5]], &[0], support);
        for force_n in [-300.0, 80.0, 900.0] {
            // The joint lies at (0, 15); the line's direction is (-sin 20°, cos 20°).
            let (s, c) = Angle::from_deg(20.0).rad().sin_cos();
            let arm_mm = 25.0 * c - (60.0 - 15.0) * -s;
            assert_near(arm_mm, line.lever_arm_mm(Frontal::new(0.0, 15.0)), ROUNDING * 100.0, "d");
            let turn = force_n * arm_mm / k;
            let end = solve(&statics, &Load::along(line, 0.0), force_n);
            assert_near(end.deformed.hinges_rad[0][0], turn, ROUNDING, "Δθ");
            assert_near(end.deformed.tilt(1).rad(), turn, ROUNDING, "tilt");
            let place = end.deformed.location(1);
            assert_near(place.y_mm, -25.0 * turn.sin(), 25.0 * ROUNDING, "y");
            assert_near(place.z_mm, 15.0 + 25.0 * turn.cos(), 25.0 * ROUNDING, "z");
        }
    }
}

#[test]
fn two_joints_rotate_in_series() {
    // Oracle: θ1 = F d1 / k1; joint 2 moves with θ1; θ2 = F d2 / k2 with d2 at the place where joint 2 then is.
    let model = straight(&[0.0, 40.0, 80.0], &[15.0, 55.0]);
    let (k1, k2, force_n) = (120_000.0, 150_000.0, 400.0);
    let (point, tilt) = (Frontal::new(-30.0, 90.0), Angle::from_deg(-15.0));
    let statics = Statics::from_stiffness(
        &model,
        [[k1, 1.0, 1.0], [k2, 1.0, 1.0]],
        &[0, 0],
        Support::Frontal,
    );
    let end = solve(&statics, &Load::along(LineOfAction::leaning(point, tilt), 7.0), force_n);
    let (u, v) = (-tilt.rad().sin(), tilt.rad().cos());
    let arm = |y: f64, z: f64| (point.y_mm - y) * v - (point.z_mm - z) * u;
    let first = force_n * arm(0.0, 15.0) / k1;
    let (joint_y, joint_z) = (-40.0 * first.sin(), 15.0 + 40.0 * first.cos());
    let second = force_n * arm(joint_y, joint_z) / k2;
    let (top_y, top_z) =
        (joint_y - 25.0 * (first + second).sin(), joint_z + 25.0 * (first + second).cos());
    assert!(first.abs() > 0.05 && (arm(joint_y, joint_z) - arm(0.0, 55.0)).abs() > 1.0);
    assert_near(end.deformed.hinges_rad[0][0], first, ROUNDING, "θ1");
    assert_near(end.deformed.hinges_rad[1][0], second, ROUNDING, "θ2");
    assert_near(end.deformed.location(2).y_mm, top_y, 100.0 * ROUNDING, "y of the top");
    assert_near(end.deformed.location(2).z_mm, top_z, 100.0 * ROUNDING, "z of the top");
}

#[test]
fn a_force_moved_along_its_line_has_the_same_effect() {
    // Oracle: F u at p and at p + s u have one moment about every point.
    let (_, model) = spine(0);
    let (library, groups) = (StiffnessLibrary::default(), JointGroups::per_joint(Levels::COMPLETE));
    for support in [Support::Free, Support::Frontal] {
        let statics = Statics::new(&model, &library, &groups, &[0.0; 14], support);
        let line = LineOfAction::leaning(Frontal::new(20.0, 70.0), Angle::from_deg(12.0));
        let slid = LineOfAction { point: line.point + line.direction * 250.0, ..line };
        let [a, b] = [line, slid].map(|line| solve(&statics, &Load::along(line, 5.0), 110.0));
        assert_same_shape(&a, &b, 400.0 * ROUNDING);
    }
}

#[test]
fn equal_scaling_of_stiffness_and_force_keeps_the_shape() {
    // Oracle: only F / k enters equilibrium.
    let (_, model) = spine(3);
    let rows: Vec<[f64; 3]> =
        StiffnessLibrary::default().rows().iter().map(|row| row.nmm_per_rad).collect();
    let line = LineOfAction::leaning(Frontal::new(-20.0, 70.0), Angle::from_deg(-8.0));
    for support in [Support::Free, Support::Frontal] {
        for scale in [0.01, 3.7, 250.0] {
            let scaled = rows.iter().map(|row| row.map(|k| k * scale));
            let usual = Statics::from_stiffness(&model, rows.clone(), &[0; 14], support);
            let stiffer = Statics::from_stiffness(&model, scaled, &[0; 14], support);
            let a = solve(&usual, &Load::along(line, 5.0), 110.0);
            let b = solve(&stiffer, &Load::along(line, 5.0), 110.0 * scale);
            // Through 14 joints the rounding of the scaled quotients grows a little.
            assert_same_shape(&a, &b, 400.0 * ROUNDING);
        }
    }
}

#[test]
fn a_straight_spine_under_a_small_horizontal_force_rotates_by_height_over_stiffness() {
    // Oracle: first order, θ_i = F h_i / k_i with h_i the height of the force above joint i.
    let z: Vec<f64> = (0..15).map(|i| 26.0 * f64::from(i)).collect();
    let centres: Vec<f64> = z[..14].iter().map(|z| z + 12.0).collect();
    let model = straight(&z, &centres);
    let k = |j: usize| 1e5 * (1.0 + 0.1 * j as f64);
    let statics =
        Statics::from_stiffness(&model, (0..14).map(|j| [k(j), 1e5, 1e5]), &[0; 14], Support::Free);
    let line = LineOfAction::along_iliac(Frontal::new(0.0, z[14]), None);
    let force_n = 1e-4;
    let end = solve(&statics, &Load::along(line, 0.0), force_n);
    for (j, centre) in centres.iter().enumerate() {
        // A force to the left tips to the left, which is a negative turn.
        let first_order = -force_n * (z[14] - centre) / k(j);
        // The second order is smaller by the turns themselves, some 1e-6.
        assert_near(end.deformed.hinges_rad[j][0], first_order, 1e-5 * first_order.abs(), "θ");
    }
}

#[test]
fn every_hinge_is_in_equilibrium_by_virtual_work() {
    // Oracle: k θ = work of the wrench per unit of the hinge's turn, by differences of an independent kinematics.
    let mut draw = Draw::new(11);
    for support in [Support::Free, Support::Frontal] {
        for subject in [0, 9, 17] {
            let (_, model) = spine(subject);
            let rows: Vec<[f64; 3]> =
                (0..14).map(|_| [1e5, 1e5, 2e5].map(|k| k * draw.between(0.5, 2.0))).collect();
            let statics = Statics::from_stiffness(&model, rows.clone(), &[0; 14], support);
            let wrench = Wrench {
                force_n: Vec3::from_fn(|_, _| draw.between(-60.0, 60.0)),
                moment_nmm: Vec3::from_fn(|_, _| draw.between(-5000.0, 5000.0)),
            };
            let mut solution = Solution::default();
            statics.march(&wrench, &[], &[], &mut solution);
            check_virtual_work(&model, &rows, support, &wrench, &solution);
        }
    }
}

fn check_virtual_work(
    model: &SpineModel,
    rows: &[[f64; 3]],
    support: Support,
    wrench: &Wrench,
    solution: &Solution,
) {
    let hinges = &solution.deformed.hinges_rad;
    let top = |changed: (usize, usize), by: f64| -> Body<f64> {
        let bodies = stack(model, |j, _, _| {
            let mut angles = hinges[j];
            if j == changed.0 {
                angles[changed.1] += by;
            }
            angles
        });
        bodies[bodies.len() - 1]
    };
    let at_rest = top((0, 0), 0.0);
    let (force, moment): ([f64; 3], [f64; 3]) = (wrench.force_n.into(), wrench.moment_nmm.into());
    // The point of T2 that lies at the origin of space carries the force; the rest is a couple.
    let carried = apply(&transposed(&at_rest.axes), at_rest.midpoint.map(|x| -x));
    let largest = rows.iter().zip(hinges).map(|(k, a)| (k[0] * a[0]).abs()).fold(0.0, f64::max);
    for j in 0..14 {
        for axis in 0..3 {
            if support == Support::Frontal && axis > 0 {
                assert_eq!(hinges[j][axis], 0.0, "a locked hinge");
                continue;
            }
            const STEP: f64 = 1e-5;
            let (after, before) = (top((j, axis), STEP), top((j, axis), -STEP));
            let point = |body: &Body<f64>| add(body.midpoint, apply(&body.axes, carried));
            let velocity = subtract(point(&after), point(&before)).map(|x| x / (2.0 * STEP));
            // Rᵃ Rᵇᵀ - its transpose is twice the sine of the small turn.
            let turn = product(&after.axes, &transposed(&before.axes));
            let spin = [turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1]]
                .map(|x| x / (4.0 * STEP));
            let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
            let work = dot(force, velocity) + dot(moment, spin);
            let what = format!("joint {j}, axis {axis}");
            assert_near(rows[j][axis] * hinges[j][axis], work, DIFFERENCE * largest, &what);
        }
    }
    // The independent kinematics ends where the library ends.
    let gap = subtract(at_rest.midpoint, solution.deformed.midpoints_mm[14].into());
    assert_near(dot3(gap), 0.0, 1e-20, "T2");
}

fn dot3(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum()
}

fn assert_same_shape(a: &Solution, b: &Solution, tolerance_mm: f64) {
    for (p, q) in a.deformed.midpoints_mm.iter().zip(&b.deformed.midpoints_mm) {
        assert_near((p - q).norm(), 0.0, tolerance_mm, "midpoint");
    }
    for (p, q) in a.deformed.axes.iter().zip(&b.deformed.axes) {
        assert_near((p - q).norm(), 0.0, tolerance_mm / 100.0, "axes");
    }
    assert!((a.deformed.location(14) - a.deformed.location(0)).norm_mm() > 100.0);
}
