//! Loads that are sought by the lateral tilt that they must give, for the general solver.

use crate::common::chain::{root, springs, straight};
use crate::common::{Draw, assert_near, spine};
use spineline::action::LineOfAction;
use spineline::multibody::{
    BodyLoad, Equilibrium, EquilibriumPath, ForceSign, GeneralStatics, Goal, Load, Loading,
    PathEnding, PathOptions, Residual, SpineModel, Statics, Support, amplitude_matches,
};
use spineline::spatial::{Angle, Frontal, Mat3, Vec3};

/// A factor of one, in N: the path counts a factor as a tenth of a radian.
const UNIT_N: f64 = 100.0;
/// Both searches end within 1e-9 rad of a lateral tilt.
const TILT_RAD: f64 = 1e-9;
/// The largest hinge angle that either solver follows.
const MAX_HINGE_RAD: f64 = 0.8;

/// All that meets a lateral tilt under a force along a line fixed in space, of one sign.
fn path_to_tilt(
    (model, rows, support): (&SpineModel, &[[f64; 3]], Support),
    line: &LineOfAction,
    (tilt, sign, largest_n): (Angle, ForceSign, f64),
) -> EquilibriumPath {
    let diagonal = rows.iter().map(|row| Mat3::from_diagonal(&Vec3::from(*row)));
    let solver = GeneralStatics::new(model, diagonal, support).expect("sound springs");
    let load = BodyLoad::ForceOnLine {
        force_n: Vec3::new(0.0, line.direction.y_mm, line.direction.z_mm) * UNIT_N,
        point_mm: Vec3::new(0.0, line.point.y_mm, line.point.z_mm),
    };
    let largest_factor = largest_n / UNIT_N;
    let options = PathOptions { sign, largest_factor, ..PathOptions::default() };
    let loading = Loading::single(model.joints.len(), load);
    solver.follow(&loading, Goal::LateralTilt(tilt), &options).expect("sound loads")
}

/// The forces of either sign, in the order of the paths.
fn forces_n(
    problem: (&SpineModel, &[[f64; 3]], Support),
    line: &LineOfAction,
    tilt: Angle,
    largest_n: f64,
) -> Vec<f64> {
    let counts = |found: &&Equilibrium| {
        let force_n = found.factor.abs() * UNIT_N;
        let off = (found.deformed.lateral_tilt() - tilt).wrapped().rad().abs();
        // Another test covers the opposite direction.
        assert!(off < TILT_RAD || std::f64::consts::PI - off < TILT_RAD, "off by {off} rad");
        off < TILT_RAD
            && found.deformed.largest_hinge_rad() <= MAX_HINGE_RAD
            && force_n <= largest_n
    };
    let mut forces = Vec::new();
    for sign in ForceSign::ALL {
        let path = path_to_tilt(problem, line, (tilt, sign, largest_n));
        assert!(path.events.is_empty(), "the march has one shape for every force");
        forces.extend(path.equilibria.iter().filter(counts).map(|found| found.factor * UNIT_N));
    }
    forces
}

#[test]
fn the_forces_of_a_lateral_tilt_equal_those_of_the_march() {
    // Oracle: the march's own search along the force, verified against other programs elsewhere. A force is known to the
    // lateral tilt's 1e-9 rad over its rate, some 1e-3 rad/N.
    const SAME_FORCE: f64 = 1e-6;
    let mut draw = Draw::new(71);
    let (mut several, mut of_sign) = (0, [0, 0]);
    for _ in 0..40 {
        let (_, model) = spine(draw.below(3));
        let rows: Vec<[f64; 3]> =
            (0..14).map(|_| [1.3e5, 1.3e5, 2e5].map(|k| k * draw.between(0.3, 2.0))).collect();
        let support = if draw.below(2) == 0 { Support::Free } else { Support::Frontal };
        let place = Frontal::new(draw.between(-60.0, 60.0), draw.between(100.0, 380.0));
        let line = LineOfAction::leaning(place, Angle::from_deg(draw.between(-40.0, 40.0)));
        let tilt = model_tilt(&model) + Angle::from_deg(draw.between(-15.0, 15.0));
        let statics = Statics::from_stiffness(&model, rows.clone(), &[0; 14], support);
        let largest_n = 1500.0 / 144_000.0 * statics.mean_lateral_nmm_per_rad();
        let march = amplitude_matches(&statics, &Load::along(line, 0.0), tilt);
        let expected: Vec<f64> = march
            .iter()
            .filter(|found| found.status == PathEnding::Converged)
            .filter(|found| matches!(found.residual, Residual::Amplitude(off) if off.rad().abs() < TILT_RAD))
            .filter(|found| found.solution.deformed.largest_hinge_rad() <= MAX_HINGE_RAD)
            .map(|found| found.force_n)
            .collect();
        let found = forces_n((&model, &rows, support), &line, tilt, largest_n);
        assert_eq!(found.len(), expected.len(), "{found:?} instead of {expected:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_near(*found, *expected, SAME_FORCE * expected.abs(), "force");
            of_sign[usize::from(*expected > 0.0)] += 1;
        }
        several += usize::from(expected.len() > 1);
    }
    println!("{of_sign:?} forces of either sign, several in {several} cases");
    assert!(of_sign[0] > 5 && of_sign[1] > 5 && several > 2);
}

fn model_tilt(model: &SpineModel) -> Angle {
    let top = model.midpoints_mm[model.midpoints_mm.len() - 1];
    Frontal::new(top.y, top.z).lateral_tilt()
}

/// Two joints 200 mm apart and a top 100 mm above, under a vertical force at 20 mm to the left: pressed down, the lower
/// joint carries the upper one past the line, and the upper one turns back.
struct TwoBars;

impl TwoBars {
    const K: f64 = 1e5;
    const LINE_MM: f64 = 20.0;

    /// The hinges under a force upwards along the line.
    fn hinges(force_n: f64) -> [f64; 2] {
        let first = force_n * Self::LINE_MM / Self::K;
        [first, force_n * (Self::LINE_MM + 200.0 * first.sin()) / Self::K]
    }

    /// The lateral tilt under a force upwards along the line.
    fn lateral_tilt(force_n: f64) -> f64 {
        let [first, upper] = Self::hinges(force_n);
        let ((s, c), second) = (first.sin_cos(), first + upper);
        // A turn tips towards -y.
        (200.0 * s + 100.0 * second.sin()).atan2(200.0 * c + 100.0 * second.cos())
    }

    /// Every force within limits that gives a lateral tilt, from zero outwards: signs of a fine scan, then bisection.
    fn forces(tilt: f64, largest_n: f64) -> Vec<f64> {
        const STEPS: usize = 20_000;
        let at = |i: usize| largest_n * i as f64 / STEPS as f64;
        (0..STEPS)
            .filter(|&i| {
                (Self::lateral_tilt(at(i)) - tilt) * (Self::lateral_tilt(at(i + 1)) - tilt) < 0.0
            })
            .map(|i| {
                let (low, high) = (at(i).min(at(i + 1)), at(i).max(at(i + 1)));
                root(low, high, |force| Self::lateral_tilt(force) - tilt)
            })
            .filter(|&force| Self::hinges(force).iter().all(|turn| turn.abs() <= MAX_HINGE_RAD))
            .collect()
    }
}

#[test]
fn every_force_of_a_returning_lateral_tilt_is_listed_in_order() {
    // Oracle: the closed form of two joints, k θ₁ = F Y and k θ₂ = F (Y + L sin θ₁). Pressed, it leans left and comes
    // back, so that a lateral tilt to the left has two forces until the upper hinge reaches its limit.
    let model = straight(&[0.0, 200.0, 300.0], &[0.0, 200.0]);
    let rows = [[TwoBars::K; 3]; 2];
    let line = LineOfAction::leaning(Frontal::new(TwoBars::LINE_MM, 100.0), Angle::from_rad(0.0));
    let stiffness = springs(&model, rows[0]);
    assert_eq!(stiffness.len(), 2);
    let most: f64 = (0..2000).map(|i| -TwoBars::lateral_tilt(-f64::from(i))).fold(0.0, f64::max);
    for (tilt, counts) in [(-0.9 * most, [2, 0]), (-0.3 * most, [1, 0]), (0.3 * most, [0, 1])] {
        let [pressed, pulled] = [-2000.0, 2000.0].map(|largest| TwoBars::forces(tilt, largest));
        let expected: Vec<f64> = [pulled.clone(), pressed.clone()].concat();
        println!("tilt {tilt}: {expected:?}");
        let support = Support::Frontal;
        let found = forces_n((&model, &rows, support), &line, Angle::from_rad(tilt), 2000.0);
        assert_eq!(found.len(), expected.len(), "{found:?} instead of {expected:?}");
        assert_eq!([pressed.len(), pulled.len()], counts);
        for (found, expected) in found.iter().zip(&expected) {
            // A lateral tilt is met to 1e-10 rad; it changes by at least 1e-5 rad/N here.
            assert_near(*found, *expected, 1e-5, "force, N");
        }
        let problem = (&model, &rows[..], support);
        let path =
            path_to_tilt(problem, &line, (Angle::from_rad(tilt), ForceSign::Negative, 2000.0));
        let ending = match pressed.len() {
            0 => PathEnding::Unreachable,
            1 => PathEnding::Converged,
            _ => PathEnding::SeveralEquilibria,
        };
        assert_eq!(path.ending, ending);
        if let Some(first) = path.result() {
            assert_near(first.factor * UNIT_N, pressed[0], 1e-5, "the first one counts");
        }
    }
}

#[test]
fn a_lateral_tilt_beyond_any_force_is_unreachable() {
    // Oracle: pressed, the closed form leans left by no more than its maximum.
    let model = straight(&[0.0, 200.0, 300.0], &[0.0, 200.0]);
    let rows = [[TwoBars::K; 3]; 2];
    let line = LineOfAction::leaning(Frontal::new(TwoBars::LINE_MM, 100.0), Angle::from_rad(0.0));
    let most: f64 = (0..2000).map(|i| -TwoBars::lateral_tilt(-f64::from(i))).fold(0.0, f64::max);
    for (share, ending) in
        [(1.001, PathEnding::Unreachable), (0.999, PathEnding::SeveralEquilibria)]
    {
        let wanted = (Angle::from_rad(-share * most), ForceSign::Negative, 2000.0);
        let path = path_to_tilt((&model, &rows, Support::Frontal), &line, wanted);
        assert_eq!(path.ending, ending, "{share} of the most");
        assert_eq!(path.result().is_some(), share < 1.0);
    }
}

#[test]
fn a_lateral_tilt_opposite_to_the_target_is_not_an_equilibrium() {
    // Oracle: an end moment rolls 14 equal joints into an arc whose chord leans by half of all turns, from 0 to 2.9 rad;
    // the other way it never leans.
    let heights: Vec<f64> = (0..15).map(|i| 20.0 * f64::from(i)).collect();
    let centres: Vec<f64> = heights[..14].iter().map(|z| z + 10.0).collect();
    let model = straight(&heights, &centres);
    let solver = GeneralStatics::new(&model, springs(&model, [1e5; 3]), Support::Frontal);
    let moment_nmm = Vec3::x() * (1e5 * 5.8 / 14.0);
    let loading = Loading::single(14, BodyLoad::Moment { moment_nmm });
    let options = PathOptions { largest_factor: 1.0, ..PathOptions::default() };
    let goal = Goal::LateralTilt(Angle::from_rad(-0.5));
    let path = solver.expect("sound").follow(&loading, goal, &options).expect("sound");
    assert!(
        path.equilibria.is_empty(),
        "leans by {:?}",
        path.equilibria[0].deformed.lateral_tilt()
    );
    assert_eq!(path.ending, PathEnding::Unreachable);
}
