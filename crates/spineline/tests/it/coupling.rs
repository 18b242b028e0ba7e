//! Coupling of lateral bending and axial rotation: hand-made chains, differences, and the general solver.

use spineline::anatomy::Levels;
use spineline::multibody::{
    BodyLoad, GeneralStatics, Goal, JointGroups, Loading, Parameter, PathOptions, Solution,
    SpineModel, Statics, StiffnessLibrary, StiffnessTable, Support, Wrench, coupled_matrix,
};
use spineline::spatial::{Mat3, Vec3};

use crate::common::chain::straight;
use crate::common::{Draw, assert_near, spine};

fn coupled() -> StiffnessLibrary {
    StiffnessTable::Coupled.library()
}

fn solved(statics: &Statics<'_>, wrench: &Wrench) -> Solution {
    let mut solution = Solution::default();
    statics.march(wrench, &[], &[], &mut solution);
    solution
}

/// The energy follows the formula, and is positive for every coupling that is accepted.
#[test]
fn the_energy_is_positive() {
    let mut draw = Draw::new(7);
    for _ in 0..200 {
        let k = [0, 1, 2].map(|_| draw.between(1e3, 5e5));
        let ratio = draw.between(-2.0, 2.0);
        let matrix = coupled_matrix(k, ratio);
        assert!(matrix.cholesky().is_some(), "{k:?} {ratio}");
        let [x, y, z] = [0, 1, 2].map(|_| draw.between(-0.3, 0.3));
        let by_hand =
            0.5 * (k[0] * x * x + k[1] * y * y + k[2] * (z - ratio * x) * (z - ratio * x));
        let angles = Vec3::new(x, y, z);
        let energy = 0.5 * angles.dot(&(matrix * angles));
        assert_near(energy / by_hand, 1.0, 1e-12, "energy");
    }
}

/// Pure lateral moment on one joint: `θx = m / kx`, `θz = r θx`, exactly and at any size.
#[test]
fn a_lateral_moment_turns_a_joint_axially_by_the_ratio() {
    let model = straight(&[0.0, 30.0], &[15.0]);
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let library = coupled();
    let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Free);
    let row = &library.rows()[0];
    for moment_nmm in [-60_000.0, 100.0, 30_000.0] {
        let wrench = Wrench { force_n: Vec3::zeros(), moment_nmm: Vec3::x() * moment_nmm };
        let [x, y, z] = solved(&statics, &wrench).deformed.hinges_rad[0];
        assert_near(x, moment_nmm / row.nmm_per_rad[0], 1e-14, "lateral");
        assert_near(y, 0.0, 1e-14, "flexion");
        assert_near(z, row.axial_per_lateral * x, 1e-14, "axial");
    }
}

/// Oracle: made backwards. For any angles of two joints under any wrench the springs follow from the three equations of each joint;
/// draws with a spring that pulls are left out.
#[test]
fn two_joints_stand_where_they_were_put() {
    let mut draw = Draw::new(11);
    let model = straight(&[0.0, 40.0, 75.0], &[20.0, 55.0]);
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let mut tried = 0;
    while tried < 40 {
        let mut vector = |size: f64| Vec3::from_fn(|_, _| draw.between(-size, size));
        let (force_n, moment_nmm) = (vector(300.0), vector(40_000.0));
        let angles = [vector(0.3), vector(0.3)];
        let ratios = [vector(0.6).x, vector(0.6).x];
        let mut rows = coupled().rows().to_vec();
        let (mut axes, mut centre) = (Mat3::identity(), Vec3::new(0.0, 0.0, 20.0));
        let mut sound = true;
        for (row, (turn, ratio)) in rows.iter_mut().zip(angles.iter().zip(ratios)) {
            let (s, c) = (turn.map(f64::sin), turn.map(f64::cos));
            let moment = axes.transpose() * (moment_nmm - centre.cross(&force_n));
            let [e2, e3] = [Vec3::new(0.0, c.x, s.x), Vec3::new(s.y, -s.x * c.y, c.x * c.y)];
            let axial = moment.dot(&e3);
            row.nmm_per_rad = [
                (moment.x + ratio * axial) / turn.x,
                moment.dot(&e2) / turn.y,
                axial / (turn.z - ratio * turn.x),
            ];
            // Soft springs have more than one equilibrium.
            sound &= row.nmm_per_rad.iter().all(|k| *k > 6e4);
            // A table has a largest lateral stiffness.
            sound &= row.nmm_per_rad[0] < 1e7;
            row.axial_per_lateral = ratio;
            let x = Mat3::new(1.0, 0.0, 0.0, 0.0, c.x, -s.x, 0.0, s.x, c.x);
            let y = Mat3::new(c.y, 0.0, s.y, 0.0, 1.0, 0.0, -s.y, 0.0, c.y);
            let z = Mat3::new(c.z, -s.z, 0.0, s.z, c.z, 0.0, 0.0, 0.0, 1.0);
            axes *= x * y * z;
            centre += axes * Vec3::new(0.0, 0.0, 35.0);
        }
        if !sound {
            continue;
        }
        tried += 1;
        let library = StiffnessLibrary::from_rows(rows).expect("positive springs");
        let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Free);
        let found = solved(&statics, &Wrench { force_n, moment_nmm }).deformed;
        for (hinges, angles) in found.hinges_rad.iter().zip(angles) {
            let off = (Vec3::from(*hinges) - angles).amax();
            assert!(off < 1e-9, "{off:e} at {angles:?}");
        }
        assert!((found.axes[2] - axes).amax() < 1e-9);
    }
}

fn top_wrench(model: &SpineModel, force_n: Vec3) -> Wrench {
    Wrench::at(model.midpoints_mm[14], force_n)
}

#[test]
fn derivatives_agree_with_differences() {
    const STEP: f64 = 1e-5;
    let (_, model) = spine(0);
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let library = coupled();
    let at = |logs: &[f64], force_n: Vec3| {
        let statics = Statics::new(&model, &library, &groups, logs, Support::Free);
        solved(&statics, &top_wrench(&model, force_n)).deformed
    };
    let force_n = Vec3::new(4.0, 30.0, -20.0);
    let logs = [0.1; 14];
    let parameters = [Parameter::Load(0), Parameter::LogStiffness(2), Parameter::LogStiffness(9)];
    let unit = top_wrench(&model, Vec3::y());
    let mut solution = Solution::default();
    Statics::new(&model, &library, &groups, &logs, Support::Free).march(
        &top_wrench(&model, force_n),
        &[unit],
        &parameters,
        &mut solution,
    );
    let varied = |parameter: Parameter, step: f64| match parameter {
        Parameter::Load(_) => at(&logs, force_n + Vec3::y() * (1e3 * step)),
        Parameter::LogStiffness(group) => {
            let mut logs = logs;
            logs[group] += step;
            at(&logs, force_n)
        }
    };
    for (p, parameter) in parameters.into_iter().enumerate() {
        let per = if matches!(parameter, Parameter::Load(_)) { 1e3 } else { 1.0 };
        let [more, less] = [STEP, -STEP].map(|step| varied(parameter, step));
        for i in 1..15 {
            let numeric = (more.midpoints_mm[i] - less.midpoints_mm[i]) / (2.0 * STEP * per);
            let off = (solution.midpoint_rates[p][i] - numeric).norm();
            assert!(off < 1e-6 * (1.0 + numeric.norm()), "{parameter:?} {i}: {off:e}");
            let spin = (more.axes[i] - less.axes[i]) / (2.0 * STEP * per);
            let turned = solution.turn_rates[p][i].cross_matrix() * solution.deformed.axes[i];
            assert!((turned - spin).amax() < 1e-7, "{parameter:?} {i}");
        }
    }
}

/// An independent engine: the general solver, which knows a matrix and no ratio.
#[test]
fn the_general_solver_finds_the_same_shape() {
    let (_, model) = spine(0);
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let library = coupled();
    let force_n = Vec3::new(3.0, 25.0, -30.0);
    let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Free);
    let marched = solved(&statics, &top_wrench(&model, force_n)).deformed;
    let matrices =
        library.rows().iter().map(|row| coupled_matrix(row.nmm_per_rad, row.axial_per_lateral));
    let general = GeneralStatics::new(&model, matrices, Support::Free).expect("positive");
    let wrench = top_wrench(&model, force_n);
    // The same wrench, fixed in space: a force through a point that does not move.
    let load = BodyLoad::ForceOnLine { point_mm: model.midpoints_mm[14], force_n: wrench.force_n };
    let loading = Loading::single(14, load);
    let path = general.follow(&loading, Goal::FullLoad, &PathOptions::default()).expect("sound");
    let found = &path.result().expect("an equilibrium").deformed;
    for (one, other) in found.midpoints_mm.iter().zip(&marched.midpoints_mm) {
        assert!((one - other).norm() < 1e-7, "{one} {other}");
    }
}

#[test]
fn a_frontal_support_leaves_no_coupling() {
    let (_, model) = spine(0);
    let groups = JointGroups::per_joint(Levels::COMPLETE);
    let wrench = top_wrench(&model, Vec3::y() * 20.0);
    let [with, without] = [coupled(), StiffnessLibrary::default()].map(|library| {
        let statics = Statics::new(&model, &library, &groups, &[0.0; 14], Support::Frontal);
        solved(&statics, &wrench)
    });
    assert_eq!(with, without);
}

/// As the sources say: thoracic vertebrae turn to the side of a bend, T12 on L1 away from it.
#[test]
fn bends_turn_vertebrae_to_the_measured_sides() {
    for (joint, row) in coupled().rows().iter().enumerate() {
        // Right bending is positive, and a turn of the front to the left is positive.
        let is_ipsilateral = row.axial_per_lateral < 0.0;
        assert_eq!(is_ipsilateral, joint >= 4, "{}", row.inferior);
        assert!(row.source.contains("coupling"), "{}", row.source);
    }
}
