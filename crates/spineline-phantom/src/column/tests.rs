//! Columns against closed forms, and against the derivative of their energy on independent kinematics.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use spineline::spatial::{Angle, Frontal};

use super::{Acting, Anatomy, Column, ElasticSample, Link, Shape, Spring};
use crate::{Build, Construction, SUBJECTS};

fn drawn(construction: Construction) -> Anatomy {
    let mut rng = ChaCha12Rng::seed_from_u64(3);
    let build = Build { construction, joint_log_sd: 0.12 };
    Anatomy::draw(&SUBJECTS[4], &build, &mut rng).expect("a spine")
}

/// A straight elastica of 400 mm and 1e6 N·mm², in eight links.
fn uniform(steps: usize) -> Column {
    let sample = ElasticSample { curvature_per_mm: 0.0, per_nmm2: 1e-6 };
    let link = Link::Elastic { length_mm: 50.0, samples: vec![sample; 2 * steps + 1] };
    Column { links: vec![link; 8], vertebrae: (0..=8).collect(), inflections: [2, 6] }
}

#[test]
fn an_end_moment_bends_an_elastica_into_an_arc() {
    // Oracle: an arc of the curvature M/B, to the left of which the force-free top lies.
    let moment_nmm = 3000.0;
    let acting = [Acting { station: 8, force: Frontal::default(), couple_nmm: moment_nmm }];
    let shape = uniform(8).bend(&acting, &mut 0.0).expect("an equilibrium");
    let turn = 400.0 * moment_nmm * 1e-6;
    let radius_mm = 400.0 / turn;
    let top = Frontal::new(-radius_mm * (1.0 - f64::cos(turn)), radius_mm * f64::sin(turn));
    let place = shape.places[8];
    assert!((place.tilt_rad - turn).abs() < 1e-9, "{}", place.tilt_rad);
    // The fourth-order error of steps of 6 mm.
    assert!(place.point.distance_mm(top) < 1e-4, "{:?}", place.point);
}

#[test]
fn the_first_integral_of_an_elastica_is_constant() {
    // Oracle: B θ'²/2 + F cos of the angle between force and tangent is constant along a uniform elastica [love].
    let force = Frontal::new(12.0, -20.0);
    let acting = [Acting { station: 8, force, couple_nmm: 0.0 }];
    let shape = uniform(16).bend(&acting, &mut 0.0).expect("an equilibrium");
    let top = shape.places[8].point;
    let integral = |station: usize| {
        let at = shape.places[station];
        let moment_nmm = (top - at.point).cross(force);
        0.5e-6 * moment_nmm.powi(2) + force.dot(Frontal::leaning(Angle::from_rad(at.tilt_rad)))
    };
    assert!(shape.places[8].tilt_rad.abs() > 0.5, "{}", shape.places[8].tilt_rad);
    for station in 0..8 {
        assert!((integral(station) - integral(8)).abs() < 1e-5, "{station}");
    }
}

#[test]
fn a_stiffening_spring_carries_its_moment() {
    // Oracle: the cubic itself, k φ (1 + φ²/φ₁²).
    let spring = Spring { nmm_per_rad: 1e5, stiffening_rad: 0.14 };
    for turn in [-0.3, -0.05, 0.0, 0.01, 0.14, 0.6_f64] {
        let moment_nmm = 1e5 * turn * (1.0 + (turn / 0.14).powi(2));
        assert!((spring.turn_rad(moment_nmm) - turn).abs() < 1e-12, "{turn}");
    }
}

/// A hinge in a shape.
struct TurnedHinge {
    station_below: usize,
    point: Frontal,
    turn_rad: f64,
    spring: Spring,
}

fn hinges(column: &Column, shape: &Shape) -> Vec<TurnedHinge> {
    let of = |(station_below, link): (usize, &Link)| {
        let Link::Hinge { to_hinge, turn_rad, spring, .. } = link else { return None };
        let [low, high] = [station_below, station_below + 1].map(|s| shape.places[s]);
        let point = low.point + to_hinge.rotated(Angle::from_rad(low.tilt_rad));
        let turn_rad = high.tilt_rad - low.tilt_rad - turn_rad;
        Some(TurnedHinge { station_below, point, turn_rad, spring: *spring })
    };
    column.links.iter().enumerate().filter_map(of).collect()
}

/// Energy that is gained per turn of one hinge, in N·mm: of its spring, and of the forces on what a rigid turn moves.
fn unbalance_nmm(acting: &[Acting], shape: &Shape, hinge: &TurnedHinge) -> f64 {
    const H: f64 = 1e-4;
    let energy = |by: f64| {
        let turn = hinge.turn_rad + by;
        let quartic = turn.powi(4) / (2.0 * hinge.spring.stiffening_rad.powi(2));
        let stored = 0.5 * hinge.spring.nmm_per_rad * (turn * turn + quartic);
        let above = acting.iter().filter(|one| one.station > hinge.station_below);
        let gained = above.map(|one| {
            let point = shape.places[one.station].point;
            let moved = hinge.point + (point - hinge.point).rotated(Angle::from_rad(by));
            one.force.dot(moved - point) + one.couple_nmm * by
        });
        stored - gained.sum::<f64>()
    };
    (energy(H) - energy(-H)) / (2.0 * H)
}

fn in_balance(column: &Column, acting: &[Acting], shape: &Shape) {
    let hinges = hinges(column, shape);
    assert_eq!(hinges.len(), 14);
    for hinge in &hinges {
        // Against moments of thousands.
        let off_nmm = unbalance_nmm(acting, shape, hinge);
        assert!(off_nmm.abs() < 1e-2, "{off_nmm}");
    }
}

#[test]
fn the_energy_of_hinged_bodies_is_stationary() {
    // Oracle: virtual work of independent rigid turns about each hinge, by central differences.
    for construction in [Construction::Wedges, Construction::Stiffening] {
        let column = drawn(construction).column;
        let acting = [
            Acting { station: 16, force: Frontal::new(9.0, -15.0), couple_nmm: 800.0 },
            Acting { station: 7, force: Frontal::new(-14.0, 2.0), couple_nmm: -300.0 },
        ];
        let shape = column.bend(&acting, &mut 0.0).expect("an equilibrium");
        assert!(column.turns_from(&shape, &column.erect()).deg() > 3.0);
        in_balance(&column, &acting, &shape);
        // The same for a force along the line through the inflections, which acts on the top's body.
        let mut base = [0.0, 0.0];
        let shape = column.bend_through_inflections(30.0, &mut base).expect("an equilibrium");
        let force = Frontal::leaning(Angle::from_rad(base[0])) * 30.0;
        let [low, high] = column.inflections.map(|station| shape.places[station].point);
        assert!((high - low).cross(force).abs() < 1e-4);
        let couple_nmm = (low - shape.places[16].point).cross(force);
        let on_top = [Acting { station: 16, force, couple_nmm }];
        in_balance(&column, &on_top, &shape);
    }
}

#[test]
fn hinges_lie_in_their_discs_and_beside_the_midline() {
    // Oracle: the stated distribution; a mean square of 9 mm² over many hinges.
    let mut squares = Vec::new();
    for seed in 0..40 {
        let mut rng = ChaCha12Rng::seed_from_u64(seed);
        let build = Build { construction: Construction::Wedges, joint_log_sd: 0.0 };
        let column = Anatomy::draw(&SUBJECTS[0], &build, &mut rng).expect("a spine").column;
        let erect = column.erect();
        for (joint, hinge) in hinges(&column, &erect).iter().enumerate() {
            let [low, high] = [joint, joint + 1].map(|v| erect.places[column.vertebrae[v]].point);
            let along = high - low;
            let part = along.dot(hinge.point - low) / along.dot(along);
            assert!((0.15..0.85).contains(&part), "{part}");
            squares.push((along.cross(hinge.point - low) / along.norm_mm()).powi(2));
        }
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    // 560 squares: a standard error of 6 %.
    assert!((7.2..10.8).contains(&mean), "{mean}");
}

#[test]
fn the_steps_of_the_elastica_are_fine_enough() {
    // Oracle: the same spine with twice as many steps; Runge-Kutta's error falls by 16.
    let fine = drawn(Construction::Elastica).column;
    let mut coarse = fine.clone();
    for link in &mut coarse.links {
        let Link::Elastic { samples, .. } = link else { panic!("an elastica") };
        *samples = samples.iter().copied().step_by(2).collect();
    }
    let acting = [Acting { station: 16, force: Frontal::new(12.0, 0.0), couple_nmm: 0.0 }];
    let [a, b] = [fine, coarse]
        .map(|column| column.bend(&acting, &mut 0.0).expect("an equilibrium").places[16].point);
    assert!(a.distance_mm(b) < 1e-3, "{}", a.distance_mm(b));
}
