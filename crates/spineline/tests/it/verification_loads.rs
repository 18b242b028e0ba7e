//! Small loads, and virtual work of all loads at once, for the general solver.

use crate::common::chain::{self, dead, equilibrium, loads, proportional};
use crate::common::everything::{Problem, draw_spine, draw_springs, draw_vector};
use crate::common::independent::{Body, Matrix, product, stack, transposed};
use crate::common::{Draw, assert_near};
use nalgebra::UnitQuaternion;
use spineline::multibody::{BodyLoad, Equilibrium, Support, Timing};
use spineline::spatial::{Mat3, Vec3};

const JOINTS: usize = 8;

/// Displacements of all midpoints under loads, each multiplied by a size.
fn displacements(problem: &Problem, items: &[(usize, BodyLoad)], size: f64) -> Vec<Vec3> {
    let items = items.iter().map(|(vertebra, load)| proportional(*vertebra, scaled(load, size)));
    let found = solve(problem, items.collect::<Vec<_>>());
    let places = found.deformed.midpoints_mm.iter().zip(&problem.model.midpoints_mm);
    places.map(|(now, before)| now - before).collect()
}

fn solve(problem: &Problem, items: Vec<spineline::multibody::LoadItem>) -> Equilibrium {
    equilibrium(&problem.model, &problem.stiffness, Support::Free, &loads(items))
}

fn scaled(load: &BodyLoad, size: f64) -> BodyLoad {
    match *load {
        BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm } => {
            BodyLoad::ForceAtPoint { force_n: force_n * size, point_in_vertebra_mm }
        }
        BodyLoad::Moment { moment_nmm } => BodyLoad::Moment { moment_nmm: moment_nmm * size },
        BodyLoad::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm } => {
            BodyLoad::FollowerForce {
                force_in_vertebra_n: force_in_vertebra_n * size,
                point_in_vertebra_mm,
            }
        }
        _ => unreachable!("not used here"),
    }
}

fn unloaded(draw: &mut Draw) -> Problem {
    let (model, stiffness) = (draw_spine(draw, JOINTS), draw_springs(draw, JOINTS));
    Problem { model, stiffness, loading: Default::default() }
}

#[test]
fn small_loads_superpose_with_an_error_of_second_order() {
    // Oracle: Saint-Venant's superposition holds in the limit; what is left is quadratic in the loads, so that it falls
    // to a quarter with half the loads.
    let mut draw = Draw::new(53);
    for _ in 0..5 {
        let problem = unloaded(&mut draw);
        let force_n = draw_vector(&mut draw, 20.0);
        let point_in_vertebra_mm = draw_vector(&mut draw, 20.0);
        let force = (JOINTS, BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm });
        let moment = (5, BodyLoad::Moment { moment_nmm: draw_vector(&mut draw, 2000.0) });
        let follower = BodyLoad::FollowerForce {
            force_in_vertebra_n: draw_vector(&mut draw, 20.0),
            point_in_vertebra_mm,
        };
        let all = [force, moment, (3, follower)];
        let errors = [1.0, 0.5, 0.25, 0.125].map(|size| {
            let together = displacements(&problem, &all, size);
            let mut left = together.clone();
            for one in &all {
                let alone = displacements(&problem, &[*one], size);
                left.iter_mut().zip(alone).for_each(|(left, alone)| *left -= alone);
            }
            left.iter().map(|left| left.norm()).fold(0.0, f64::max)
        });
        let orders = chain::orders(&errors);
        println!("left of the sum: {errors:?} mm");
        // Third order at these loads, a twentieth of a radian, moves the observed order by less than 0.1.
        assert!(orders.iter().all(|order| (order - 2.0).abs() < 0.1), "orders {orders:?}");
    }
}

/// Displacement of a midpoint and rotation of a vertebra, per unit of a small load, by central differences.
fn small_answer(problem: &Problem, vertebra: usize, load: &BodyLoad, at: usize) -> (Vec3, Vec3) {
    const SMALL: f64 = 1e-3;
    let [plus, minus] = [SMALL, -SMALL]
        .map(|size| solve(problem, vec![proportional(vertebra, scaled(load, size))]).deformed);
    let moved = plus.midpoints_mm[at] - minus.midpoints_mm[at];
    let turned = plus.axes[at] * minus.axes[at].transpose();
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(turned);
    let turned = UnitQuaternion::from_rotation_matrix(&rotation).scaled_axis();
    (moved / (2.0 * SMALL), turned / (2.0 * SMALL))
}

#[test]
fn small_loads_are_reciprocal() {
    // Oracle: Maxwell-Betti. Loads that are a thousandth of 20 N turn joints by some 1e-5 rad; central differences leave
    // its square, and rounding 1e-13 mm of 1e-4 mm.
    const RECIPROCAL: f64 = 1e-7;
    let mut draw = Draw::new(59);
    for _ in 0..5 {
        let problem = unloaded(&mut draw);
        let (low, high) = (3, 7);
        let (f, g) = (draw_vector(&mut draw, 20.0), draw_vector(&mut draw, 20.0));
        let m = draw_vector(&mut draw, 2000.0);
        let force_force = small_answer(&problem, low, &dead(f), high).0.dot(&g);
        let other_way = small_answer(&problem, high, &dead(g), low).0.dot(&f);
        let scale = 0.5 * (force_force.abs() + other_way.abs()).max(0.1);
        assert_near(force_force, other_way, RECIPROCAL * scale, "force and force");
        let moment = BodyLoad::Moment { moment_nmm: m };
        let force_moment = small_answer(&problem, low, &dead(f), high).1.dot(&m);
        let other_way = small_answer(&problem, high, &moment, low).0.dot(&f);
        let scale = 0.5 * (force_moment.abs() + other_way.abs()).max(0.1);
        assert_near(force_moment, other_way, RECIPROCAL * scale, "force and moment");
    }
}

fn matrix(rows: &Matrix<f64>) -> Mat3 {
    Mat3::from_fn(|row, column| rows[row][column])
}

/// A body's motion: its midpoint's velocity and its spin.
struct Motion {
    midpoint: Vec3,
    velocity: Vec3,
    spin: Vec3,
}

impl Motion {
    fn of(now: &Body<f64>, before: &Body<f64>, after: &Body<f64>, step: f64) -> Self {
        let turn = product(&after.axes, &transposed(&before.axes));
        let spin = [turn[2][1] - turn[1][2], turn[0][2] - turn[2][0], turn[1][0] - turn[0][1]];
        let (after, before) = (Vec3::from(after.midpoint), Vec3::from(before.midpoint));
        Self {
            midpoint: now.midpoint.into(),
            velocity: (after - before) / (2.0 * step),
            spin: Vec3::from(spin) / (4.0 * step),
        }
    }

    /// Power of a force at a place of space, on the body's point there.
    fn power_at(&self, place: Vec3, force: Vec3) -> f64 {
        force.dot(&(self.velocity + self.spin.cross(&(place - self.midpoint))))
    }
}

/// Work per radian of one load when its vertebra moves; springs give their potential's loss, by their own definition.
fn work(load: &BodyLoad, erect: &Body<f64>, bodies: [&Body<f64>; 3], step: f64) -> f64 {
    let [before, now, after] = bodies;
    let motion = Motion::of(now, before, after, step);
    let place = |body: &Body<f64>, point: &Vec3| -> Vec3 {
        Vec3::from(body.midpoint) + matrix(&body.axes) * point
    };
    let loss = |energy: &dyn Fn(&Body<f64>) -> f64| (energy(before) - energy(after)) / (2.0 * step);
    match load {
        BodyLoad::ForceOnLine { force_n, point_mm } => motion.power_at(*point_mm, *force_n),
        BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm } => {
            motion.power_at(place(now, point_in_vertebra_mm), *force_n)
        }
        BodyLoad::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm } => {
            let force = matrix(&now.axes) * force_in_vertebra_n;
            motion.power_at(place(now, point_in_vertebra_mm), force)
        }
        BodyLoad::Moment { moment_nmm } => moment_nmm.dot(&motion.spin),
        BodyLoad::FollowerMoment { moment_in_vertebra_nmm } => {
            (matrix(&now.axes) * moment_in_vertebra_nmm).dot(&motion.spin)
        }
        BodyLoad::Pad { point_in_vertebra_mm: point, direction, n_per_mm, advance_mm } => {
            let energy = |body: &Body<f64>| {
                let gone = (place(body, point) - place(erect, point)).dot(direction);
                0.5 * n_per_mm * (advance_mm - gone).powi(2)
            };
            loss(&energy)
        }
        BodyLoad::Strap { point_in_vertebra_mm: point, anchor_mm, n_per_mm, shortening_mm } => {
            let length = |body: &Body<f64>| (anchor_mm - place(body, point)).norm();
            let energy = |body: &Body<f64>| {
                0.5 * n_per_mm * (length(body) - length(erect) + shortening_mm).powi(2)
            };
            loss(&energy)
        }
    }
}

/// Virtual work of every load and rod on every hinge that turns against the springs, under the full load.
fn check_virtual_work(problem: &Problem, support: Support) {
    // Differences with a step of 1e-4 rad leave 1e-8 of the third derivatives, and rounding 1e-16 / 1e-4.
    const STEP: f64 = 1e-4;
    const DIFFERENCE: f64 = 1e-7;
    let Problem { model, stiffness, loading } = problem;
    let found = equilibrium(model, stiffness, support, loading);
    let hinges = &found.deformed.hinges_rad;
    let bodies = |changed: (usize, usize), by: f64| {
        stack::<f64>(model, |j, _, _| {
            let mut angles = hinges[j];
            if j == changed.0 {
                angles[changed.1] += by;
            }
            angles
        })
    };
    let erect = stack::<f64>(model, |_, _, _| [0.0; 3]);
    let now = bodies((0, 0), 0.0);
    // Hinges that the support holds stand at zero.
    let moments: Vec<Vec3> =
        stiffness.iter().zip(hinges).map(|(k, angles)| k * Vec3::from(*angles)).collect();
    let largest = moments.iter().map(|moment| moment.amax()).fold(0.0, f64::max);
    for (j, moment) in moments.iter().enumerate() {
        let hinges = if support == Support::Frontal { 1 } else { 3 };
        for axis in 0..hinges {
            let (before, after) = (bodies((j, axis), -STEP), bodies((j, axis), STEP));
            let three = |v: usize| [&before[v], &now[v], &after[v]];
            let items = loading.items.iter();
            let mut total: f64 = items
                .map(|item| work(&item.load, &erect[item.vertebra], three(item.vertebra), STEP))
                .sum();
            for (rod, (force, couple)) in loading.rods.iter().zip(&found.rod_reactions) {
                let place = Vec3::from(now[rod.superior].midpoint);
                for (v, sign) in [(rod.superior, 1.0), (rod.inferior, -1.0)] {
                    let motion = Motion::of(&now[v], &before[v], &after[v], STEP);
                    total += sign * (motion.power_at(place, *force) + couple.dot(&motion.spin));
                }
            }
            let what = format!("joint {j}, axis {axis}");
            assert_near(moment[axis], total, DIFFERENCE * largest, &what);
        }
    }
    // The independent kinematics ends where the library does.
    let gap = Vec3::from(now[JOINTS].midpoint) - found.deformed.midpoints_mm[JOINTS];
    assert_near(gap.norm(), 0.0, 1e-10, "the top");
    for (rod, (inferior, superior)) in
        loading.rods.iter().map(|rod| (rod, (&now[rod.inferior], &now[rod.superior])))
    {
        // The rod's pose, from its definition: shift and turn in the lower vertebra's axes.
        let [low, high] = [rod.inferior, rod.superior].map(|v| matrix(&erect[v].axes));
        let apart = |lower: &Body<f64>, upper: &Body<f64>| {
            let between = Vec3::from(upper.midpoint) - Vec3::from(lower.midpoint);
            matrix(&lower.axes).transpose() * between
        };
        let place = apart(inferior, superior) - apart(&erect[rod.inferior], &erect[rod.superior]);
        let turn = UnitQuaternion::new(rod.turn_rad).to_rotation_matrix().into_inner();
        let wanted = turn * low.transpose() * high;
        let reached = matrix(&inferior.axes).transpose() * matrix(&superior.axes);
        if support == Support::Frontal {
            assert_near(place.y, rod.shift_mm.y, 1e-9, "the rod's lateral place");
            let tilt = |axes: Mat3| axes[(1, 2)] / axes[(2, 2)];
            assert_near(tilt(reached), tilt(wanted), 1e-10, "the rod's tilt");
            continue;
        }
        assert_near((place - rod.shift_mm).norm(), 0.0, 1e-9, "the rod's shift");
        assert_near((wanted - reached).norm(), 0.0, 1e-10, "the rod's turn");
    }
}

#[test]
fn every_hinge_is_in_equilibrium_under_all_loads_by_virtual_work() {
    // Oracle: springs' moments are the work of all loads per unit of a hinge's turn, by differences of another kinematics
    // and of the springs' energies; only the hinge angles of the solver are used.
    let mut draw = Draw::new(61);
    for _ in 0..10 {
        let problem = Problem::draw(&mut draw, JOINTS);
        assert!(problem.loading.items.iter().any(|item| item.timing == Timing::Constant));
        check_virtual_work(&problem, Support::Free);
    }
}

#[test]
fn every_hinge_is_in_equilibrium_with_a_rod_by_virtual_work() {
    // Oracle: as above, with the rod's reactions, and its pose by its definition.
    let mut draw = Draw::new(67);
    for _ in 0..10 {
        check_virtual_work(&Problem::draw(&mut draw, JOINTS).with_rod(&mut draw), Support::Free);
    }
}

#[test]
fn every_hinge_is_in_equilibrium_with_a_rod_in_a_frontal_support_by_virtual_work() {
    // Oracle: as above, over the hinges that the support leaves free. The vertebrae are pitched and turned, so that the rod's two
    // components lie aslant to the hinges.
    let mut draw = Draw::new(73);
    for _ in 0..10 {
        let mut problem = Problem::draw(&mut draw, JOINTS).with_rod(&mut draw);
        for rod in &mut problem.loading.rods {
            rod.shift_mm = Vec3::y() * rod.shift_mm.y;
            rod.turn_rad = Vec3::x() * rod.turn_rad.x;
        }
        check_virtual_work(&problem, Support::Frontal);
    }
}
