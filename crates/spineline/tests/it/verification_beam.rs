//! The general solver on straight chains that stand for an elastic column: elastica, circle and buckling.
//!
//! A column of length `L` and bending stiffness `EI` is cut into `N` elements of length `h`, with a spring `EI/h` in the
//! middle of each. The vertebrae are the nodes between the elements: half an element below and above every joint.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::assert_near;
use crate::common::chain::{
    Plane, dead, equilibrium, events, far, follow, orders, root, springs, straight,
};
use crate::common::elastica::elastica;
use spineline::multibody::{
    BodyLoad, BranchEventKind, Loading, PathEnding, PathOptions, SpineModel, Support,
};
use spineline::spatial::{Mat3, Vec3};

const LENGTH_MM: f64 = 400.0;
/// Bending stiffness, N·mm²: as about fourteen joints of 130 N·m/rad.
const EI: f64 = 4e6;
/// Second order, less the next term at eight elements.
const MIN_ORDER: f64 = 1.9;

/// The column: nodes at whole elements, joints between.
fn column(elements: usize) -> SpineModel {
    let h = LENGTH_MM / elements as f64;
    let nodes: Vec<f64> = (0..=elements).map(|i| h * i as f64).collect();
    let joints: Vec<f64> = nodes[..elements].iter().map(|z| z + 0.5 * h).collect();
    straight(&nodes, &joints)
}

/// Hinges of the plane are springs of the column; the others are ten times as stiff, and need not turn.
fn column_springs(model: &SpineModel, plane: Plane) -> Vec<Mat3> {
    let k = EI * model.joints.len() as f64 / LENGTH_MM;
    let mut stiffness = [10.0 * k; 3];
    stiffness[plane.hinge()] = k;
    springs(model, stiffness)
}

/// The column's end under a load on its uppermost vertebra.
fn end_under(elements: usize, plane: Plane, load: BodyLoad) -> Vec3 {
    let model = column(elements);
    let loading = Loading::single(elements, load);
    let found = equilibrium(&model, &column_springs(&model, plane), Support::Free, &loading);
    found.deformed.midpoints_mm[elements]
}

/// How the end's distance from the elastica's falls, for 8, 16, 32 and 64 elements.
fn elastica_orders(plane: Plane, force_angle: f64, end_turn: f64, follower: bool) -> Vec<f64> {
    let exact = elastica(force_angle, end_turn);
    let size_n = exact.force * EI / (LENGTH_MM * LENGTH_MM);
    // What turns with the end acts at this angle to it.
    let angle = if follower { force_angle - end_turn } else { force_angle };
    let force_n = plane.point(angle.sin(), angle.cos()) * size_n;
    let load = if follower {
        BodyLoad::FollowerForce {
            force_in_vertebra_n: force_n,
            point_in_vertebra_mm: Vec3::zeros(),
        }
    } else {
        dead(force_n)
    };
    let end = plane.point(exact.across, exact.along) * LENGTH_MM;
    let errors = [8, 16, 32, 64].map(|elements| (end_under(elements, plane, load) - end).norm());
    println!("{plane:?} at {force_angle}, end turned {end_turn}: off by {errors:?} mm");
    // At 64 elements the elements are 6 mm long, and h²/L² is 2e-4.
    assert!(errors[3] < 2e-4 * LENGTH_MM, "off by {errors:?}");
    orders(&errors)
}

fn assert_second_order(orders: &[f64]) {
    assert!(orders.iter().all(|order| (MIN_ORDER..2.2).contains(order)), "orders {orders:?}");
}

#[test]
fn a_cantilever_under_an_end_load_converges_to_the_elastica_with_second_order() {
    // Oracle: elliptic integrals, for a load across, one that pulls, and one that presses, up to an end turned by 70°.
    for plane in Plane::BOTH {
        for (force_angle, end_turn) in [(FRAC_PI_2, 0.4), (FRAC_PI_2, 1.2), (0.9, 0.6), (2.5, 1.2)]
        {
            assert_second_order(&elastica_orders(plane, force_angle, end_turn, false));
        }
    }
}

#[test]
fn a_cantilever_under_a_follower_force_converges_to_the_elastica_with_second_order() {
    // Oracle: the same integrals; the dead force of this direction holds the same shape.
    for plane in Plane::BOTH {
        for end_turn in [0.5, 1.5] {
            let across = FRAC_PI_2 + end_turn;
            assert_second_order(&elastica_orders(plane, across, end_turn, true));
        }
    }
}

#[test]
fn an_end_moment_bends_the_column_to_a_regular_polygon() {
    // Oracle: every hinge turns M / k; the nodes follow from turning half elements. A moment about the hinges' axis does
    // not care whether it turns with the vertebra. 0.79 rad at eight joints is more than a full turn.
    const ROUNDING_RAD: f64 = 1e-13;
    for plane in Plane::BOTH {
        for (elements, turn) in [(1, 0.7), (8, 0.79), (13, -0.3), (40, 0.2)] {
            let model = column(elements);
            let stiffness = column_springs(&model, plane);
            let k = stiffness[0][(plane.hinge(), plane.hinge())];
            let moment = plane.axis() * (k * turn);
            for load in [
                BodyLoad::Moment { moment_nmm: moment },
                BodyLoad::FollowerMoment { moment_in_vertebra_nmm: moment },
            ] {
                let loading = Loading::single(elements, load);
                let found = equilibrium(&model, &stiffness, Support::Free, &loading).deformed;
                let h = LENGTH_MM / elements as f64;
                let mut node = Vec3::zeros();
                for (i, hinges) in found.hinges_rad.iter().enumerate() {
                    assert_near(hinges[plane.hinge()], turn, ROUNDING_RAD, "M / k");
                    assert_near(hinges[1 - plane.hinge()], 0.0, ROUNDING_RAD, "the other plane");
                    let (before, after) = (turn * i as f64, turn * (i + 1) as f64);
                    node += plane.point(before.sin() + after.sin(), before.cos() + after.cos())
                        * (0.5 * h);
                    let off = (found.midpoints_mm[i + 1] - node).norm();
                    assert_near(off, 0.0, ROUNDING_RAD * LENGTH_MM * 40.0, "node");
                }
            }
        }
    }
}

/// Dead load of this size downwards on the top.
fn weight(model: &SpineModel, size_n: f64) -> Loading {
    Loading::single(model.joints.len(), dead(Vec3::z() * -size_n))
}

/// The first branch point of a column under axial load.
fn buckling_load_n(model: &SpineModel, stiffness: &[Mat3], size_n: f64, support: Support) -> f64 {
    let options = PathOptions { largest_factor: 1.3, ..far() };
    let path = follow(model, stiffness, support, &weight(model, size_n), &options);
    assert_eq!(path.ending, PathEnding::BranchPoint);
    let points = events(&path, BranchEventKind::BranchPoint);
    assert_eq!((points.len(), path.events.len()), (1, 1));
    points[0] * size_n
}

/// The bisection for a branch point halves a step of at most 2.5 in the factor thirty times.
const BRANCH_POINT: f64 = 1e-8;

#[test]
fn one_and_two_rigid_bars_buckle_at_the_closed_form() {
    // Oracle: P = k / L for one bar; for two, P L / k is the smaller eigenvalue of [2 -1; -1 1], (3 - √5) / 2.
    let (length_mm, k) = (50.0, 1e5);
    for plane in Plane::BOTH {
        let support = if plane == Plane::Lateral { Support::Frontal } else { Support::Free };
        let mut stiffness = [4.0 * k; 3];
        stiffness[plane.hinge()] = k;
        let one = straight(&[0.0, length_mm], &[0.0]);
        let two = straight(&[0.0, length_mm, 2.0 * length_mm], &[0.0, length_mm]);
        for (model, number) in [(one, 1.0), (two, 0.5 * (3.0 - 5.0_f64.sqrt()))] {
            let expected = number * k / length_mm;
            let size = 1.1 * expected;
            let found = buckling_load_n(&model, &springs(&model, stiffness), size, support);
            assert_near(found, expected, BRANCH_POINT * expected, "buckling load");
        }
    }
}

#[test]
fn the_buckling_load_converges_to_eulers_with_second_order() {
    // Oracle: the chain's own closed form 4 EI/h² sin²(π / 4N) (turns of the bars sin(iπ / 2N) satisfy every balance,
    // the last bar being half as long); and Euler's π² EI / 4L² [timoshenko-gere-1961].
    let euler = PI * PI * EI / (4.0 * LENGTH_MM * LENGTH_MM);
    for plane in Plane::BOTH {
        let errors = [4, 8, 16, 32].map(|elements| {
            let model = column(elements);
            let h = LENGTH_MM / elements as f64;
            let discrete = 4.0 * EI / (h * h) * (PI / (4 * elements) as f64).sin().powi(2);
            // Hinges that are ten times as stiff buckle at ten times the load.
            let stiffness = column_springs(&model, plane);
            let found = buckling_load_n(&model, &stiffness, 1.2 * euler, Support::Free);
            assert_near(found, discrete, BRANCH_POINT * euler, "the chain's buckling load");
            (found - euler).abs()
        });
        assert_second_order(&orders(&errors));
    }
}

#[test]
fn a_follower_load_along_the_axis_has_no_branch_point() {
    // Oracle: Beck's column: no other static equilibrium at any load, though it flutters at 8.1 times Euler's
    // [bolotin-1963]. The tangent is unsymmetric, and its determinant keeps its sign.
    let model = column(10);
    let euler = PI * PI * EI / (4.0 * LENGTH_MM * LENGTH_MM);
    for (plane, share) in [0.5, 2.0, 4.0, 6.0, 9.0]
        .into_iter()
        .flat_map(|share| Plane::BOTH.map(|plane| (plane, share)))
    {
        let load = BodyLoad::FollowerForce {
            force_in_vertebra_n: Vec3::z() * (-share * euler),
            point_in_vertebra_mm: Vec3::zeros(),
        };
        let stiffness = column_springs(&model, plane);
        let loading = Loading::single(10, load);
        let path = follow(&model, &stiffness, Support::Free, &loading, &PathOptions::default());
        assert_eq!(path.ending, PathEnding::Converged);
        assert!(path.events.is_empty(), "{:?}", path.events);
        assert_eq!(path.equilibria[0].deformed.midpoints_mm, model.midpoints_mm);
    }
}

/// A column of which every node lies off the axis, in the chain's own buckling mode, by so much at the top.
fn bowed(elements: usize, top_mm: f64) -> SpineModel {
    let h = LENGTH_MM / elements as f64;
    let slope = |i: usize| (i as f64 * FRAC_PI_2 / elements as f64).sin();
    let rise: f64 = (1..=elements).map(|i| if i == elements { 0.5 } else { 1.0 } * slope(i)).sum();
    let size = top_mm / (h * rise);
    let (mut place, mut nodes, mut centres) = (Vec3::zeros(), vec![Vec3::zeros()], Vec::new());
    for i in 0..elements {
        let half = |i: usize| Vec3::new(0.0, size * slope(i), 1.0).normalize() * (0.5 * h);
        centres.push(half(i));
        place += half(i) + half(i + 1);
        nodes.push(place);
    }
    SpineModel::from_poses(nodes, vec![Mat3::identity(); elements + 1], &centres)
}

/// Buckling load of ten elements by Southwell's line through half and four fifths of it, over the true one.
///
/// A bow in the buckling mode grows by δ = a / (P_c/P - 1), so δ against δ/P has the slope P_c [southwell-1932].
fn southwell(bow_mm: f64) -> f64 {
    let elements = 10;
    let h = LENGTH_MM / elements as f64;
    let critical = 4.0 * EI / (h * h) * (PI / (4 * elements) as f64).sin().powi(2);
    let model = bowed(elements, bow_mm);
    let stiffness = column_springs(&model, Plane::Lateral);
    let at = |share: f64| {
        let loading = weight(&model, share * critical);
        let top = equilibrium(&model, &stiffness, Support::Free, &loading).deformed;
        top.midpoints_mm[elements].y - model.midpoints_mm[elements].y
    };
    let (low, high) = (at(0.5), at(0.8));
    (high - low) / (high / 0.8 - low / 0.5)
}

#[test]
fn southwells_line_gives_the_buckling_load_of_a_bowed_column() {
    // Oracle: the chain's closed form. Large turns add their square: the end moves by some (5 · 10 mm / 400 mm)².
    assert_near(southwell(10.0), 1.0, 1e-2, "Southwell's slope");
}

#[test]
fn southwells_line_gives_the_buckling_load_of_a_hardly_bowed_column() {
    // Oracle: as above; (5 · 0.5 mm / 400 mm)².
    assert_near(southwell(0.5), 1.0, 1e-3, "Southwell's slope");
}

/// Bends a column bowed by so much under twice Euler's load, and expects nothing to happen to its branch.
fn assert_bends_without_an_event(bow_mm: f64) {
    let model = bowed(10, bow_mm);
    let size_n = 2.0 * PI * PI * EI / (4.0 * LENGTH_MM * LENGTH_MM);
    let stiffness = column_springs(&model, Plane::Lateral);
    let options = PathOptions { largest_factor: 1.0, ..far() };
    let path = follow(&model, &stiffness, Support::Free, &weight(&model, size_n), &options);
    assert_eq!(path.ending, PathEnding::Converged, "{:?}", path.events);
    let bent = path.result().expect("converged").deformed.midpoints_mm[10];
    // The straight column's elastica, whose force grows from Euler's with the turn of its end.
    let turn = root(0.5, 3.0, |turn| elastica(PI, turn).force - 0.5 * PI * PI);
    let across = elastica(PI, turn).across * LENGTH_MM;
    // The bow adds less than itself, and ten elements leave less than h²/L².
    assert_near(bent.y, across, bow_mm + 1e-2 * LENGTH_MM, "the end's way across");
    assert!(path.events.is_empty(), "{:?}", path.events);
}

#[test]
fn a_bowed_column_bends_far_beyond_eulers_load_without_an_event() {
    // Oracle: no second branch crosses the branch of a bowed column; far beyond Euler's load it is the elastica of a straight one.
    assert_bends_without_an_event(20.0);
}

#[test]
fn a_hardly_bowed_column_bends_beyond_eulers_load_without_an_event() {
    // Oracle: as above; half a millimetre is enough for the branches to part.
    assert_bends_without_an_event(0.5);
}
