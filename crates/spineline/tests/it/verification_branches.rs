//! Singular points of the general solver's path: where the load turns back, and where other branches cross.

use crate::common::assert_near;
use crate::common::chain::{
    Plane, constant, dead, events, far, follow, loads, pendulum, proportional, root, springs,
    straight, with_rods,
};
use spineline::multibody::{
    BodyLoad, BranchEventKind, EquilibriumPath, Loading, PathEnding, PathOptions, Rod, SpineModel,
    Support, Timing,
};
use spineline::spatial::Vec3;

/// A singular point is bisected thirty times within a step.
const SINGULAR_POINT: f64 = 1e-8;

/// A bar of 100 mm on a weak hinge, and a strap from its top to an anchor at an angle from it.
///
/// The moment that holds the bar at an angle is `k θ + n (ℓ₀ - ℓ) L R sin(φ - θ) / ℓ`: it rises while the strap is
/// pressed, falls, and rises again once the bar has passed the anchor.
struct Snap {
    model: SpineModel,
}

const BAR_MM: f64 = 100.0;
const ANCHOR_MM: f64 = 140.0;
const ANCHOR_RAD: f64 = 0.5;
const HINGE_NMM: f64 = 2e3;
const STRAP_N_PER_MM: f64 = 5.0;

impl Snap {
    fn new() -> Self {
        Self { model: pendulum(BAR_MM) }
    }

    fn moment(angle: f64) -> f64 {
        let length = |angle: f64| {
            let c = (ANCHOR_RAD - angle).cos();
            (BAR_MM * BAR_MM + ANCHOR_MM * ANCHOR_MM - 2.0 * BAR_MM * ANCHOR_MM * c).sqrt()
        };
        let pressed = length(0.0) - length(angle);
        let arm = BAR_MM * ANCHOR_MM * (ANCHOR_RAD - angle).sin() / length(angle);
        HINGE_NMM * angle + STRAP_N_PER_MM * pressed * arm
    }

    /// The moment's derivative, by central differences.
    fn slope(angle: f64) -> f64 {
        (Self::moment(angle + 1e-5) - Self::moment(angle - 1e-5)) / 2e-5
    }

    /// Where it has its maximum and its minimum, and their moments.
    fn turns() -> [(f64, f64); 2] {
        [(0.0, ANCHOR_RAD), (ANCHOR_RAD, 1.2)].map(|(low, high)| {
            // The extrema lie where the slope crosses zero on either side of the anchor.
            let at = root(low, high.min(low + 0.499_999), Self::slope);
            (at, Self::moment(at))
        })
    }

    fn path(&self, plane: Plane, moment_nmm: f64, options: &PathOptions) -> EquilibriumPath {
        let strap = BodyLoad::Strap {
            point_in_vertebra_mm: Vec3::zeros(),
            anchor_mm: plane.point(ANCHOR_MM * ANCHOR_RAD.sin(), ANCHOR_MM * ANCHOR_RAD.cos()),
            n_per_mm: STRAP_N_PER_MM,
            shortening_mm: 0.0,
        };
        let moment = BodyLoad::Moment { moment_nmm: plane.axis() * moment_nmm };
        let loading = loads([proportional(1, strap), proportional(1, moment)]);
        // The other hinges hold the bar in its plane, whatever the strap presses.
        let mut stiffness = [1e7; 3];
        stiffness[plane.hinge()] = HINGE_NMM;
        let stiffness = springs(&self.model, stiffness);
        follow(&self.model, &stiffness, Support::Free, &loading, options)
    }
}

#[test]
fn a_bar_that_snaps_past_a_strap_has_the_limit_points_of_its_closed_form() {
    // Oracle: maximum and minimum of the moment as a function of the angle. A limit point is where the factor's change is
    // zero, so that its own error is of the square of the place's.
    let snap = Snap::new();
    let [(_, most), (_, least)] = Snap::turns();
    println!("moment between {least} and {most} N·mm");
    assert!(most > 0.0 && least < most);
    for plane in Plane::BOTH {
        let full = 1.5 * most;
        let path = snap.path(plane, full, &PathOptions { largest_factor: 1.5, ..far() });
        assert_eq!(path.ending, PathEnding::LimitPoint);
        assert!(path.result().is_none());
        let turns = events(&path, BranchEventKind::LimitPoint);
        assert_eq!((turns.len(), path.events.len()), (2, 2), "{:?}", path.events);
        assert_near(turns[0] * full, most, SINGULAR_POINT * most, "the most");
        assert_near(turns[1] * full, least, SINGULAR_POINT * most, "the least");
        // Beyond the snap there is one equilibrium with the full load.
        let angle = root(ANCHOR_RAD, 2.9, |angle| Snap::moment(angle) - full);
        assert_eq!(path.equilibria.len(), 1);
        let found = &path.equilibria[0];
        assert_eq!((found.limit_points, found.branch_points), (2, 0));
        assert_near(found.deformed.hinges_rad[0][plane.hinge()], angle, 1e-12, "beyond");
        // Every point is on the curve, and the path covers all of it.
        let angle_of = |i: usize| path.points[i].deformed.hinges_rad[0][plane.hinge()];
        for i in 0..path.points.len() {
            let moment = Snap::moment(angle_of(i));
            assert_near(path.points[i].factor * full, moment, 1e-9 * most, "on the curve");
            let step = if i > 0 { angle_of(i) - angle_of(i - 1) } else { 0.0 };
            assert!((0.0..0.26).contains(&step), "a jump by {step} rad");
        }
    }
}

#[test]
fn below_the_limit_load_the_first_of_three_equilibria_is_the_result() {
    // Oracle: the three angles at which the closed form takes one moment, in the order of the path.
    let snap = Snap::new();
    let [(rising, most), (falling, least)] = Snap::turns();
    let full = 0.6 * most;
    assert!(least < full && most < 2.0 * full && -least < 2.0 * full);
    let path = snap.path(Plane::Lateral, full, &far());
    assert_eq!(path.ending, PathEnding::SeveralEquilibria);
    let brackets = [(0.0, rising), (rising, falling), (falling, 2.9)];
    assert_eq!(path.equilibria.len(), 3);
    for (number, (found, (low, high))) in path.equilibria.iter().zip(brackets).enumerate() {
        let angle = root(low, high, |angle| Snap::moment(angle) - full);
        assert_near(found.deformed.hinges_rad[0][0], angle, 1e-12, "angle");
        assert_eq!(found.limit_points, number);
        // The scaled tangent of one hinge is the slope of the moment over the spring; the others hold.
        let slope = Snap::slope(angle).abs() / HINGE_NMM;
        let expected = slope.min(found.smallest_singular_value.max(0.99));
        assert_near(found.smallest_singular_value, expected, 1e-4, "singular value");
    }
}

#[test]
fn a_pendulum_tilted_forward_buckles_sideways_at_the_closed_form() {
    // Oracle: with the top at L (sin b, -sin a cos b, cos a cos b), a force (λ H, 0, -λ P) gives the balances
    // ky b = λ L (H cos b + P sin b) and kx a = λ P L sin a cos b: a branch with a ≠ 0 leaves where kx = λ P L cos b.
    // The branch itself is bent: the point is found by steps of Newton beside a singular tangent.
    let (length, kx, ky) = (100.0, 1e5, 2e5);
    let (h, p) = (300.0, 1000.0);
    let factor = |b: f64| ky * b / (length * (h * f64::cos(b) + p * f64::sin(b)));
    let tilt = root(1e-6, 0.9, |b| factor(b) * p * length * b.cos() - kx);
    let model = pendulum(length);
    let loading = Loading::single(1, dead(Vec3::new(h, 0.0, -p)));
    let path = follow(&model, &springs(&model, [kx, ky, 1e5]), Support::Free, &loading, &far());
    let points = events(&path, BranchEventKind::BranchPoint);
    assert_eq!(points.len(), path.events.len(), "{:?}", path.events);
    assert_near(points[0], factor(tilt), SINGULAR_POINT, "buckling");
    let first = &path.equilibria[0];
    assert_eq!(first.is_on_erect_branch(), factor(tilt) > 1.0);
}

/// An upright pendulum of 100 mm on springs about x and y under twice the load that buckles the weaker.
fn twice_the_buckling_load(kx: f64, ky: f64) -> EquilibriumPath {
    let model = pendulum(100.0);
    let loading = Loading::single(1, dead(Vec3::z() * (-2.0 * kx.min(ky) / 100.0)));
    follow(&model, &springs(&model, [kx, ky, 1e5]), Support::Free, &loading, &far())
}

#[test]
fn two_branch_points_within_a_step_are_both_found() {
    // Oracle: the pendulum buckles about x at 0.5 of the load and about y at 0.55 of it.
    let path = twice_the_buckling_load(1e5, 1.1e5);
    assert_eq!(events(&path, BranchEventKind::BranchPoint).len(), 2, "{:?}", path.events);
    assert_eq!(path.ending, PathEnding::BranchPoint);
}

#[test]
fn a_round_column_buckles() {
    // Oracle: equally stiff about x and y, it buckles to all sides at half the load; two eigenvalues cross zero at once.
    let path = twice_the_buckling_load(1e5, 1e5);
    assert_eq!(path.ending, PathEnding::BranchPoint, "{:?}", path.events);
}

#[test]
fn a_round_column_with_a_small_tilt_does_not_stay_upright() {
    // Oracle: under a sideways moment m the pendulum follows kx θ = W L sin θ + m from zero. At twice the buckling load
    // it leans by some 1.9 rad; the upright solution belongs to another branch, which the path must not step to unsaid.
    let (length, k, m) = (100.0, 1e5, 100.0);
    let weight = 2.0 * k / length;
    let model = pendulum(length);
    let moment = BodyLoad::Moment { moment_nmm: Vec3::x() * m };
    let loading = loads([constant(1, moment), proportional(1, dead(Vec3::z() * -weight))]);
    for ky in [1e5, 1.05e5, 3e5] {
        let path = follow(&model, &springs(&model, [k, ky, 1e5]), Support::Free, &loading, &far());
        let expected = root(0.5, 3.0, |angle| k * angle - weight * length * angle.sin() - m);
        match path.result() {
            Some(found) => {
                assert_near(found.deformed.hinges_rad[0][0], expected, 1e-9, "lean");
            }
            None => assert_eq!(path.ending, PathEnding::BranchPoint, "ky = {ky}"),
        }
    }
}

#[test]
fn a_column_with_a_rod_buckles_below_the_rod_on_a_table() {
    // Oracle: a rod from the first to the fourth vertebra leaves one hinge, which buckles at P = k / L. In a frontal support
    // the rod asks two things of three hinges, and what it leaves them buckles at twelve times that.
    let z: Vec<f64> = (0..5).map(|i| 30.0 * f64::from(i)).collect();
    let model = straight(&z, &z[..4]);
    let k = 1e5;
    let rod = Rod::locking(1, 4, Timing::Constant);
    let load = proportional(4, dead(Vec3::z() * (-1.5 * k / 120.0)));
    let loading = with_rods(vec![load], vec![rod]);
    let path = follow(&model, &springs(&model, [k; 3]), Support::Frontal, &loading, &far());
    assert_eq!(path.ending, PathEnding::BranchPoint, "{:?}", path.events);
    let points = events(&path, BranchEventKind::BranchPoint);
    assert_near(points[0], 1.0 / 1.5, SINGULAR_POINT, "buckling");
}
