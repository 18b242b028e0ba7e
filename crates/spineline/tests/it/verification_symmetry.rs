//! What the general solver must not change, or change in a known way: mirrored and moved problems.

use crate::common::chain::{self, equilibrium, follow, proportional};
use crate::common::everything::{Problem, draw_loads, draw_spine, draw_springs, draw_vector};
use crate::common::{Draw, assert_near};
use spineline::multibody::{Equilibrium, Loading, PathOptions, Support, Timing};
use spineline::spatial::{Mat3, Vec3};

/// Rounding on a different path: Newton ends with a step below 1e-9 rad, whose square is left, at half a metre.
const SAME_MM: f64 = 1e-9;
/// N and N·mm of rods, which are stiff: what 1e-9 mm changes, times the springs over the lever squared.
const SAME_REACTION: f64 = 1e-5;
/// Hinges, likewise.
const SAME_RAD: f64 = 1e-11;
const JOINTS: usize = 8;

fn solved(problem: &Problem, support: Support) -> Equilibrium {
    equilibrium(&problem.model, &problem.stiffness, support, &problem.loading)
}

/// Every kind of load alone, and all together.
fn problems(draw: &mut Draw) -> Vec<Problem> {
    let (model, stiffness) = (draw_spine(draw, JOINTS), draw_springs(draw, JOINTS));
    let alone = |loading| Problem { model: model.clone(), stiffness: stiffness.clone(), loading };
    let mut problems: Vec<Problem> =
        draw_loads(draw).map(|load| alone(Loading::single(JOINTS, load))).to_vec();
    problems.push(Problem::draw(draw, JOINTS));
    problems
}

/// A rod alone, and one with every kind of load.
fn problems_with_a_rod(draw: &mut Draw) -> Vec<Problem> {
    let all = Problem::draw(draw, JOINTS).with_rod(draw);
    let mut alone = all.clone();
    alone.loading.items.clear();
    vec![alone, all]
}

/// Panics unless a shape is another one with its vectors mapped; `inside` maps a vertebra's own axes.
#[track_caller]
fn assert_mapped(
    ours: &Equilibrium,
    theirs: &Equilibrium,
    place: impl Fn(&Vec3) -> Vec3,
    (polar, inside): (&Mat3, &Mat3),
) {
    let (ours_shape, theirs_shape) = (&ours.deformed, &theirs.deformed);
    for (a, b) in ours_shape.midpoints_mm.iter().zip(&theirs_shape.midpoints_mm) {
        assert_near((place(a) - b).norm(), 0.0, SAME_MM, "midpoint");
    }
    for (a, b) in ours_shape.axes.iter().zip(&theirs_shape.axes) {
        assert_near((polar * a * inside - b).norm(), 0.0, SAME_MM, "axes");
    }
    let axial = polar * polar.determinant();
    for (a, b) in ours.rod_reactions.iter().zip(&theirs.rod_reactions) {
        assert_near((polar * a.0 - b.0).norm(), 0.0, SAME_REACTION, "force of a rod");
        assert_near((axial * a.1 - b.1).norm(), 0.0, 100.0 * SAME_REACTION, "moment of a rod");
    }
    for (a, b) in ours.spring_forces_n.iter().zip(&theirs.spring_forces_n) {
        assert_near(a.1, b.1, SAME_REACTION, "spring force");
    }
    let (ours, theirs) = (ours.smallest_singular_value, theirs.smallest_singular_value);
    // Beside rods it lies on a null space of products of lever arms, which depend on the origin.
    assert_near(ours, theirs, 1e-7, "smallest singular value");
}

/// Oracle: the sagittal mirror y → -y. Hinges x and z change their sign, y does not: in series they mirror exactly,
/// since the mirror of Rx Ry Rz is Rx(-a) Ry(b) Rz(-c).
fn check_mirrored(problem: &Problem, support: Support) {
    let mirror = Mat3::from_diagonal(&Vec3::new(1.0, -1.0, 1.0));
    let (ours, theirs) = (solved(problem, support), solved(&problem.mirrored(), support));
    assert!(ours.deformed.largest_hinge_rad() > 1e-3, "nothing moves");
    assert_mapped(&ours, &theirs, |place| mirror * place, (&mirror, &mirror));
    for (a, b) in ours.deformed.hinges_rad.iter().zip(&theirs.deformed.hinges_rad) {
        let off = (a[0] + b[0]).abs() + (a[1] - b[1]).abs() + (a[2] + b[2]).abs();
        assert_near(off, 0.0, SAME_RAD, "hinges");
    }
}

#[test]
fn a_mirrored_problem_has_the_mirrored_solution() {
    let mut draw = Draw::new(31);
    for support in [Support::Frontal, Support::Free, Support::Free, Support::Free] {
        problems(&mut draw).iter().for_each(|problem| check_mirrored(problem, support));
    }
}

#[test]
fn a_mirrored_rod_has_the_mirrored_solution() {
    let mut draw = Draw::new(32);
    for _ in 0..10 {
        let problems = problems_with_a_rod(&mut draw);
        problems.iter().for_each(|problem| check_mirrored(problem, Support::Free));
    }
}

/// Oracle: no direction or place of space is special; hinges do not change at all.
fn check_moved(problem: &Problem, draw: &mut Draw) {
    let turn = nalgebra::Rotation3::new(draw_vector(draw, 1.8)).into_inner();
    let shift = draw_vector(draw, 300.0);
    let ours = solved(problem, Support::Free);
    let theirs = solved(&problem.moved(&turn, &shift), Support::Free);
    assert_mapped(&ours, &theirs, |place| turn * place + shift, (&turn, &Mat3::identity()));
    for (a, b) in ours.deformed.hinges_rad.iter().zip(&theirs.deformed.hinges_rad) {
        assert_near((Vec3::from(*a) - Vec3::from(*b)).amax(), 0.0, SAME_RAD, "hinges");
    }
}

#[test]
fn a_moved_problem_has_the_moved_solution() {
    let mut draw = Draw::new(37);
    for _ in 0..4 {
        let problems = problems(&mut draw);
        problems.iter().for_each(|problem| check_moved(problem, &mut draw));
    }
}

#[test]
fn a_moved_rod_has_the_moved_solution() {
    let mut draw = Draw::new(38);
    for _ in 0..10 {
        let problems = problems_with_a_rod(&mut draw);
        problems.iter().for_each(|problem| check_moved(problem, &mut draw));
    }
}

#[test]
fn equal_scaling_of_loads_and_springs_keeps_the_shape() {
    // Oracle: only their quotient enters equilibrium.
    let mut draw = Draw::new(41);
    let problem = Problem::draw(&mut draw, JOINTS);
    let mut scaled = problem.clone();
    const SCALE: f64 = 37.0;
    scaled.stiffness.iter_mut().for_each(|k| *k *= SCALE);
    for item in &mut scaled.loading.items {
        use spineline::multibody::BodyLoad as L;
        match &mut item.load {
            L::ForceOnLine { force_n: v, .. }
            | L::ForceAtPoint { force_n: v, .. }
            | L::FollowerForce { force_in_vertebra_n: v, .. }
            | L::Moment { moment_nmm: v }
            | L::FollowerMoment { moment_in_vertebra_nmm: v } => *v *= SCALE,
            L::Pad { n_per_mm, .. } | L::Strap { n_per_mm, .. } => *n_per_mm *= SCALE,
        }
    }
    let (ours, theirs) = (solved(&problem, Support::Free), solved(&scaled, Support::Free));
    for (a, b) in ours.deformed.midpoints_mm.iter().zip(&theirs.deformed.midpoints_mm) {
        assert_near((a - b).norm(), 0.0, SAME_MM, "midpoint");
    }
}

#[test]
fn order_and_timing_of_loads_do_not_change_the_final_shape() {
    // Oracle: without friction or an event on the way, equilibrium knows no history.
    let mut draw = Draw::new(43);
    for _ in 0..5 {
        let problem = Problem::draw(&mut draw, JOINTS);
        let ours = solved(&problem, Support::Free);
        let mut other = problem.clone();
        other.loading.items.reverse();
        for item in &mut other.loading.items {
            item.timing = match item.timing {
                Timing::Constant => Timing::Proportional,
                Timing::Proportional => Timing::Constant,
            };
        }
        let theirs = solved(&other, Support::Free);
        for (a, b) in ours.deformed.midpoints_mm.iter().zip(&theirs.deformed.midpoints_mm) {
            assert_near((a - b).norm(), 0.0, SAME_MM, "midpoint");
        }
    }
}

#[test]
fn a_load_in_another_unit_of_its_factor_is_found_on_its_branch() {
    // Oracle: a force of 1 N followed up to a factor of 60 and one of 60 N up to one are one load.
    let mut draw = Draw::new(47);
    let (model, stiffness) = (draw_spine(&mut draw, JOINTS), draw_springs(&mut draw, JOINTS));
    let loading =
        |size: f64| Loading::single(JOINTS, chain::dead(Vec3::new(0.3, 0.9, -0.3) * size));
    let unit = PathOptions { largest_factor: 60.0, ..PathOptions::default() };
    let path = follow(&model, &stiffness, Support::Free, &loading(1.0), &unit);
    assert!(path.points.len() < 100, "{} points", path.points.len());
    for point in path.points.iter().filter(|point| point.factor > 0.0) {
        let same = Loading {
            items: vec![proportional(
                JOINTS,
                chain::dead(Vec3::new(0.3, 0.9, -0.3) * point.factor),
            )],
            rods: Vec::new(),
        };
        let alone = equilibrium(&model, &stiffness, Support::Free, &same);
        let off =
            (alone.deformed.midpoints_mm[JOINTS] - point.deformed.midpoints_mm[JOINTS]).norm();
        assert_near(off, 0.0, SAME_MM, "the top");
    }
}
