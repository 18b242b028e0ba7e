use super::balance::{Balance, Factors, State};
use super::elimination::Elimination;
use super::stability::scaled_tangent;
use super::{BodyLoad, LoadItem, Loading, Timing};
use crate::multibody::{SpineModel, Support};
use crate::spatial::{Mat3, Vec3};

/// Numbers between -1 and 1 that look random (a linear congruential generator).
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        2.0 * (self.0 >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    }

    fn vector(&mut self, size: f64) -> Vec3 {
        Vec3::new(self.next(), self.next(), self.next()) * size
    }

    fn rotation(&mut self, size: f64) -> Mat3 {
        nalgebra::Rotation3::new(self.vector(size)).into_inner()
    }
}

fn spine(draw: &mut Draw, joints: usize) -> SpineModel {
    let midpoints = (0..=joints).map(|i| Vec3::new(0.0, 0.0, 30.0 * i as f64) + draw.vector(8.0));
    let midpoints = midpoints.collect();
    let axes = (0..=joints).map(|_| draw.rotation(0.4)).collect();
    let centres: Vec<Vec3> =
        (0..joints).map(|_| Vec3::new(-15.0, 0.0, 14.0) + draw.vector(3.0)).collect();
    SpineModel::from_poses(midpoints, axes, &centres)
}

/// One load of every kind, on different vertebrae.
fn every_load(draw: &mut Draw, joints: usize) -> Loading {
    let point_in_vertebra_mm = draw.vector(20.0);
    let loads = [
        BodyLoad::ForceOnLine { force_n: draw.vector(40.0), point_mm: draw.vector(200.0) },
        BodyLoad::ForceAtPoint { force_n: draw.vector(40.0), point_in_vertebra_mm },
        BodyLoad::FollowerForce { force_in_vertebra_n: draw.vector(40.0), point_in_vertebra_mm },
        BodyLoad::Moment { moment_nmm: draw.vector(3000.0) },
        BodyLoad::FollowerMoment { moment_in_vertebra_nmm: draw.vector(3000.0) },
        BodyLoad::Pad {
            point_in_vertebra_mm,
            direction: draw.vector(1.0).normalize(),
            n_per_mm: 3.0,
            advance_mm: 12.0,
        },
        BodyLoad::Strap {
            point_in_vertebra_mm,
            anchor_mm: Vec3::new(150.0, 200.0, 300.0),
            n_per_mm: 2.0,
            shortening_mm: 15.0,
        },
    ];
    let items = loads.into_iter().enumerate().map(|(i, load)| LoadItem {
        vertebra: 1 + (i * 5) % joints,
        load,
        timing: if i % 2 == 0 { Timing::Proportional } else { Timing::Constant },
    });
    Loading { items: items.collect(), rods: Vec::new() }
}

/// Springs that couple the hinges of a joint.
fn springs(draw: &mut Draw, joints: usize) -> Vec<Mat3> {
    let spring = |draw: &mut Draw| {
        let root = Mat3::from_fn(|_, _| draw.next());
        (root * root.transpose() + Mat3::identity()) * 1.2e5
    };
    (0..joints).map(|_| spring(draw)).collect()
}

const FACTORS: Factors = Factors { constant: 0.8, proportional: 0.6, varies: Timing::Proportional };

/// Residuals, divided by the roots of the springs, at hinge angles.
fn residual(balance: &Balance<'_>, hinges: &[Vec3], factors: &Factors) -> Vec<f64> {
    let mut state = State::new(balance);
    state.hinges.copy_from_slice(hinges);
    balance.evaluate(factors, &mut state);
    state.residual.iter().flat_map(|r| [r.x, r.y, r.z]).collect()
}

#[test]
fn the_tangent_is_the_derivative_of_the_residual() {
    // Oracle: central differences; a step of 1e-5 rad leaves about 1e-10 of the residual's third derivative, and rounding
    // 1e-16 / 1e-5 of the largest moments.
    let mut draw = Draw(3);
    let carried_n = [(); 6].map(|()| draw.vector(30.0));
    let model = spine(&mut draw, 6).carrying(&carried_n);
    let (loading, stiffness) = (every_load(&mut draw, 6), springs(&mut draw, 6));
    let balance =
        Balance { model: &model, stiffness: &stiffness, support: Support::Free, loading: &loading };
    let mut state = State::new(&balance);
    state.hinges.iter_mut().for_each(|hinge| *hinge = draw.vector(0.4));
    balance.evaluate(&FACTORS, &mut state);
    let tangent = scaled_tangent(&balance, &state);
    let root = |i: usize| stiffness[i / 3][(i % 3, i % 3)].sqrt();
    for column in 0..18 {
        const STEP: f64 = 1e-5;
        let moved = |step: f64| {
            let mut hinges = state.hinges.clone();
            hinges[column / 3][column % 3] += step;
            residual(&balance, &hinges, &FACTORS)
        };
        for (row, (plus, minus)) in moved(STEP).iter().zip(moved(-STEP)).enumerate() {
            let difference = (plus - minus) / (2.0 * STEP) / (root(row) * root(column));
            let off = (tangent[(row, column)] - difference).abs();
            assert!(off < 1e-8, "row {row}, column {column}: off by {off:e}");
        }
    }
    // And by each factor.
    for varies in [Timing::Proportional, Timing::Constant] {
        let factors = Factors { varies, ..FACTORS };
        balance.evaluate(&factors, &mut state);
        let at = |step: f64| {
            let mut moved = factors;
            moved.set_varied(factors.varied() + step);
            residual(&balance, &state.hinges, &moved)
        };
        let growth = state.growth.iter().flat_map(|g| [g.x, g.y, g.z]);
        for (growth, (plus, minus)) in growth.zip(at(0.01).iter().zip(at(-0.01))) {
            // Linear in the factor but for straps, whose force is linear too.
            assert!((growth + (plus - minus) / 0.02).abs() < 1e-6 * (1.0 + growth.abs()));
        }
    }
}

#[test]
fn elimination_solves_what_the_matrix_says() {
    // Oracle: LU of the whole tangent; some 40 unknowns of condition below 1e3.
    let mut draw = Draw(5);
    for (joints, support) in [(6, Support::Free), (14, Support::Free), (14, Support::Frontal)] {
        let model = spine(&mut draw, joints);
        let loading = every_load(&mut draw, joints);
        let mut stiffness = springs(&mut draw, joints);
        let per_joint = if support == Support::Frontal { 1 } else { 3 };
        if support == Support::Frontal {
            stiffness.iter_mut().for_each(|k| *k = Mat3::from_diagonal(&k.diagonal()));
        }
        let balance = Balance { model: &model, stiffness: &stiffness, support, loading: &loading };
        let mut state = State::new(&balance);
        for hinge in &mut state.hinges {
            *hinge = draw.vector(0.2);
            (per_joint..3).for_each(|locked| hinge[locked] = 0.0);
        }
        balance.evaluate(&FACTORS, &mut state);
        let mut moments: Vec<Vec3> = (0..joints).map(|_| draw.vector(1000.0)).collect();
        moments.iter_mut().for_each(|m| (per_joint..3).for_each(|locked| m[locked] = 0.0));
        let mut elimination = Elimination::new(joints);
        assert!(elimination.factor(&balance, &state));
        let mut turns = vec![Vec3::zeros(); joints];
        elimination.solve(|j| moments[j], &mut turns);

        let tangent = scaled_tangent(&balance, &state);
        let root = |i: usize| {
            let (joint, axis) = (i / per_joint, i % per_joint);
            (joint, axis, stiffness[joint][(axis, axis)].sqrt())
        };
        let scaled = nalgebra::DVector::from_fn(joints * per_joint, |i, _| {
            let (joint, axis, root) = root(i);
            moments[joint][axis] / root
        });
        let lu = tangent.lu();
        assert_eq!(lu.determinant() > 0.0, elimination.signs.has_positive_determinant());
        let expected = lu.solve(&scaled).expect("regular");
        for i in 0..joints * per_joint {
            let (joint, axis, root) = root(i);
            let off = (turns[joint][axis] - expected[i] / root).abs();
            assert!(off < 1e-12, "hinge {i}: off by {off:e}");
        }
    }
}
