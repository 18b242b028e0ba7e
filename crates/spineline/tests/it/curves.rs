//! Curves, chains and clinical angles against shapes whose answers are known.

use crate::common::{self, assert_near, graph_film, measured, outline, usual_regions};
use proptest::prelude::*;
use spineline::anatomy::{Level, Posture, Region, Side};
use spineline::chain::{Chain, SEGMENT_WINDOW};
use spineline::clinical::{CobbEnds, EndChoice, EndRule, measure_curves, measure_largest_curve};
use spineline::curve::{CurveFit, InflectionIntervals, OrderRule, find_inflections, fit_curve};
use spineline::measure::Outline;
use spineline::spatial::{Angle, Frontal};
use spineline::warning::{WarningCode, Warnings};

/// A least-squares fit in a well-conditioned basis leaves rounding of coordinates of 400 mm.
const RESIDUAL_MM: f64 = 1e-9;
/// A zero of the curvature, whose slope there is some 1e-5 per mm², shows rounding a thousand times larger.
const INFLECTION_MM: f64 = 1e-6;
/// Rounding of sums over a thousand links.
const CHAIN_MM: f64 = 1e-6;
const CHORD_MM: f64 = 1e-10;
const ROUNDING: f64 = 1e-12;
/// A curve counts from 5° on; those made here are far larger.
const MIN_TURN: Angle = Angle::from_deg(5.0);

/// A polynomial by its coefficients from `z²` upwards, with `u = z / height`.
#[derive(Debug, Clone)]
struct Polynomial {
    height_mm: f64,
    coefficients: Vec<f64>,
}

impl Polynomial {
    /// The degree-6 curve with `y'' = -A (z + a)(z - p)(z - q)(b - z)`: inflections at `p` and `q` alone.
    fn with_inflections(height_mm: f64, amplitude: f64, p: f64, q: f64) -> Self {
        let (a, b) = (0.05, 1.06);
        // Coefficients of the quartic by repeated multiplication with its linear factors.
        let mut quartic = vec![-amplitude];
        for [constant, slope] in [[a, 1.0], [-p, 1.0], [-q, 1.0], [b, -1.0]] {
            let mut next = vec![0.0; quartic.len() + 1];
            for (i, c) in quartic.iter().enumerate() {
                next[i] += constant * c;
                next[i + 1] += slope * c;
            }
            quartic = next;
        }
        // Integrated twice, from zero with slope zero.
        let coefficients =
            quartic.iter().enumerate().map(|(i, c)| c / ((i + 1) * (i + 2)) as f64).collect();
        Self { height_mm, coefficients }
    }

    /// `y` and `dy/dz`.
    fn at(&self, z_mm: f64) -> (f64, f64) {
        let u = z_mm / self.height_mm;
        let terms = self.coefficients.iter().enumerate();
        terms.fold((0.0, 0.0), |(y, slope), (i, c)| {
            let power = i as i32 + 2;
            (
                y + self.height_mm * c * u.powi(power),
                slope + c * f64::from(power) * u.powi(power - 1),
            )
        })
    }

    fn outline(&self) -> Outline {
        measured(&graph_film(Posture::Erect, self.height_mm, |z| self.at(z)))
    }
}

/// Curves of two inflections whose three curves all turn far enough to count.
fn any_polynomial() -> impl Strategy<Value = (Polynomial, f64, f64)> {
    (300.0..480.0_f64, 60.0..110.0_f64, 0.3..0.4_f64, 0.66..0.75_f64)
        .prop_map(|(height_mm, amplitude, p, q)| {
            let curve = Polynomial::with_inflections(height_mm, amplitude, p, q);
            (curve, p * height_mm, q * height_mm)
        })
        .prop_filter("every lobe turns by 6° or more", |(curve, p, q)| {
            let tilts = [0.0, *p, *q, curve.height_mm].map(|z| -curve.at(z).1.atan());
            tilts.windows(2).all(|ends| (ends[1] - ends[0]).abs() >= Angle::from_deg(6.0).rad())
        })
}

fn fit(outline: &Outline, rule: OrderRule) -> CurveFit {
    let mut warnings = Warnings::default();
    let fit = fit_curve(outline, rule, &mut warnings).expect("a plain spine");
    assert_eq!(warnings.all(), []);
    fit
}

proptest! {
    #![proptest_config(common::deterministic(1866))]

    /// Oracle: the polynomial that placed the vertebrae, and the roots of its second derivative.
    #[test]
    fn a_polynomial_of_degree_six_is_recovered((curve, p, q) in any_polynomial()) {
        let outline = curve.outline();
        for rule in [OrderRule::Fixed(6), OrderRule::Fixed(9), OrderRule::LeaveOneOut, OrderRule::TwoInflections, OrderRule::Paper] {
            let fit = fit(&outline, rule);
            prop_assert!(fit.order >= 6, "order {}", fit.order);
            assert_near(fit.rmse_mm, 0.0, RESIDUAL_MM, "residual");
            assert_near(fit.rmse_tilt.rad(), 0.0, RESIDUAL_MM, "residual of tilts");
            for k in 0..=50 {
                let z = curve.height_mm * f64::from(k) / 50.0;
                assert_near(fit.curve.point(z).y_mm, curve.at(z).0, 1e3 * RESIDUAL_MM, "curve");
            }
            let inflections = find_inflections(&fit, MIN_TURN);
            prop_assert_eq!(inflections.all.len(), 2);
            for (found, z) in inflections.all.iter().zip([p, q]) {
                assert_near(found.erect.z_mm, z, INFLECTION_MM, "inflection");
                assert_near(found.erect.y_mm, curve.at(z).0, INFLECTION_MM, "inflection");
            }
            let tilt = fit.curve.tilt(curve.height_mm);
            let turns = inflections.curves.iter().fold(Angle::ZERO, |sum, part| sum + part.turn);
            assert_near(turns.rad(), tilt.rad(), RESIDUAL_MM, "the lobes together turn as far as T2");
        }
        prop_assert_eq!(fit(&outline, OrderRule::LeaveOneOut).order, 6);
    }

    /// Oracle: every link is one chord long; a polygon is shorter than its arc by l³κ²/24 per link.
    #[test]
    fn links_and_remainder_have_the_length_of_the_curve((curve, _, _) in any_polynomial()) {
        let fit = fit(&curve.outline(), OrderRule::Fixed(6));
        let curve = &fit.curve;
        let length = curve.length_mm(curve.end_mm());
        let chain = Chain::fit(length, &[], SEGMENT_WINDOW).expect("a curve");
        let pose = chain.lay(curve);
        let link = chain.segment_mm;
        prop_assert_eq!(pose.segments(), chain.segments);
        prop_assert_eq!(pose.joints.len(), pose.segments() + 1);
        for pair in pose.joints.windows(2) {
            assert_near(pair[0].distance_mm(pair[1]), link, CHORD_MM, "link");
        }
        for (joint, &t) in pose.joints.iter().zip(&pose.t_mm) {
            assert_near(joint.distance_mm(curve.point(t)), 0.0, CHORD_MM, "a joint on the curve");
        }
        prop_assert!(pose.leftover_mm < link);
        // The part of the arc that the polygon leaves out, link by link, with the curvature at the link's middle.
        let lost: f64 = pose.t_mm.windows(2).map(|t| {
            let middle = 0.5 * (t[0] + t[1]);
            let curvature = curve.turning(middle) / curve.tangent(middle).norm_mm();
            link.powi(3) * curvature.powi(2) / 24.0
        }).sum();
        let polygon = pose.segments() as f64 * link + pose.leftover_mm;
        assert_near(polygon + lost, length, CHAIN_MM, "length");
        // The joint angles add up to the lateral tilt of the last link.
        let sum = pose.joint_angles.iter().fold(Angle::ZERO, |sum, &angle| sum + angle);
        let last = pose.joints[pose.segments()] - pose.joints[pose.segments() - 1];
        assert_near(sum.rad(), last.lateral_tilt().rad(), 1e3 * ROUNDING, "sum of the joint angles");
        let table = pose.to_denavit_hartenberg(&chain);
        prop_assert_eq!(table.len(), pose.segments());
        prop_assert!(table.iter().all(|row| row.a_mm == link && row.alpha == Angle::ZERO && row.d_mm == 0.0));
    }

    /// Oracle: the chords of either half of an arc lateral tilt by a quarter of its angle from the middle chord.
    #[test]
    fn an_arc_has_half_its_angle_by_ferguson_and_all_as_tilt_range(
        a in 10.0..60.0_f64,
        b in 10.0..90.0_f64,
        c in 10.0..60.0_f64,
    ) {
        let outline = three_arcs([-a, b, -c]);
        let regions = usual_regions();
        let curves = measure_curves(&regions, &[&outline], &EndChoice::default());
        for ((curve, bounds), angle) in curves.iter().zip(&regions.bounds).zip([-a, b, -c]) {
            let ferguson = bounds.ferguson_angle(|i| outline.vertebrae[i].location);
            assert_near(ferguson.deg(), 0.5 * angle, 1e3 * ROUNDING, "Ferguson");
            assert_near(curve.ferguson[0].1.deg(), 0.5 * angle, 1e3 * ROUNDING, "Ferguson");
            assert_near(curve.angles[0].1.tilt_range.deg(), angle, 1e3 * ROUNDING, "Cobb");
            // A spine that turns to the right as it rises bulges to the left.
            prop_assert_eq!(curve.convex, Some(if angle > 0.0 { Side::Left } else { Side::Right }));
        }
    }
}

#[test]
fn a_curve_over_the_usual_limits_is_measured_as_a_whole() {
    // By hand: one arc of 50° from L4 to T6, over the limit at T12, whose middle is T11; above it the spine turns back by 15°.
    let outline = three_arcs([20.0, 30.0, -15.0]);
    let curve = measure_largest_curve(&[&outline], EndRule::Erect).expect("a curve");
    assert_eq!(curve.ends, CobbEnds { inferior: Level::L4, superior: Level::T6 });
    assert_eq!((curve.apex, curve.region), (Level::T11, Region::MainThoracic));
    assert_eq!(curve.convex, Some(Side::Left));
    assert_near(curve.erect_size().deg(), 50.0, 1e3 * ROUNDING, "tilt range");
}

/// Three arcs between L4, T12, T6 and T2 with the vertebrae at equal angles, so that the apices of `usual_regions` are
/// their middles.
fn three_arcs(angles_deg: [f64; 3]) -> Outline {
    const RADIUS_STEP_MM: f64 = 25.0;
    let parts: [&[f64]; 3] = [&[0.25; 4], &[1.0 / 6.0; 6], &[0.25; 4]];
    let (mut place, mut tilt) = (Frontal::default(), Angle::ZERO);
    let mut vertebrae = vec![(place, tilt)];
    for (part, angle) in parts.iter().zip(angles_deg) {
        for share in *part {
            let turn = Angle::from_deg(angle * share);
            // The chord of a piece of arc leans by half its turn more than its start.
            let chord = RADIUS_STEP_MM * (0.5 * turn.rad()).sin() / (0.5 * turn.rad());
            place = place + Frontal::leaning(tilt + turn * 0.5) * chord;
            tilt = tilt + turn;
            vertebrae.push((place, tilt));
        }
    }
    outline(Posture::Erect, &vertebrae)
}

/// A curve whose curvature changes its sign at given parts of the height, with a bump between them and ripples all along.
fn rippled(height_mm: f64, [p, q]: [f64; 2]) -> Outline {
    let bending = |u: f64| {
        let bump = 1.0 + 12.0 * (-((u - 0.52) / 0.16).powi(2)).exp();
        -bump * (10.0 + 2.5 * (9.0 * u).sin()) * (u - p) * (u - q)
    };
    // Integrated twice by the midpoint rule.
    const FINE: usize = 20_000;
    let step = 1.0 / FINE as f64;
    let mut grid = vec![(0.0, 0.0)];
    for i in 0..FINE {
        let (y, slope) = grid[i];
        let next = slope + step * bending((i as f64 + 0.5) * step);
        grid.push((y + 0.5 * step * (slope + next), next));
    }
    measured(&graph_film(Posture::Erect, height_mm, |z| {
        let (y, slope) = grid[(z / height_mm / step).round() as usize];
        (height_mm * y, slope)
    }))
}

#[test]
fn intervals_hold_the_inflections_of_a_curve_that_is_not_a_polynomial() {
    // Oracle: the places where the curvature was made to change its sign; landmarks are exact but are given an error.
    let height_mm = 390.0;
    let ends = [0.34, 0.7];
    let outline = rippled(height_mm, ends);
    let fit = fit(&outline, OrderRule::LeaveOneOut);
    let pair = find_inflections(&fit, MIN_TURN).pair.expect("three curves");
    let found = fit.inflection_intervals(&outline, pair).expect("a graph");
    for (end, interval) in ends.iter().zip(found.each) {
        let interval = interval.expect("far from both ends of the spine");
        let [low, high] = interval.t_mm;
        assert!((low..=high).contains(&(end * height_mm)), "{end}: {low} to {high}");
        assert!(high - low < 60.0, "{end}: {low} to {high}");
        // The lengths along the curve belong to its heights, and the vertebrae lie around them.
        assert_near(
            interval.along_mm[0],
            fit.curve.length_mm(low),
            CHAIN_MM,
            "length to the interval",
        );
        let levels = outline.levels();
        let place = |level| fit.vertebra_t_mm[levels.index_of(level).expect("of the model")];
        assert!(place(interval.between.0) <= low && high <= place(interval.between.1));
    }
    // Landmarks that are said to be rougher leave more open.
    let mut rough = outline.clone();
    rough.noise.location_mm *= 4.0;
    rough.noise.tilt = rough.noise.tilt * 4.0;
    let wider = fit.inflection_intervals(&rough, pair).expect("a graph");
    let trace = |found: &InflectionIntervals| found.about_polynomial_mm2.trace();
    assert!(trace(&wider) > trace(&found));
}

#[test]
fn one_rule_takes_an_order_with_two_inflections_and_the_papers_the_least_residual() {
    // Oracle: the curve was made with two, and noise that a high order would follow.
    let curve = Polynomial::with_inflections(390.0, 80.0, 0.33, 0.72);
    let mut draw = common::Draw::new(3);
    let mut outline = curve.outline();
    for vertebra in &mut outline.vertebrae[1..] {
        let shift = Frontal::new(draw.between(-1.0, 1.0), draw.between(-1.0, 1.0));
        vertebra.location = vertebra.location + shift;
        vertebra.tilt = vertebra.tilt + Angle::from_deg(draw.between(-2.0, 2.0));
    }
    let two = fit(&outline, OrderRule::TwoInflections);
    assert_eq!(find_inflections(&two, MIN_TURN).all.len(), 2);
    // The default leaves the noise alone: its order is not above the others, which have the least residual.
    assert!(fit(&outline, OrderRule::LeaveOneOut).order <= two.order);
    let paper = fit(&outline, OrderRule::Paper);
    for order in 4..=12 {
        let other = fit(&outline, OrderRule::Fixed(order));
        let sum = |fit: &CurveFit| {
            fit.rmse_mm / outline.noise.location_mm + fit.rmse_tilt.rad() / outline.noise.tilt.rad()
        };
        assert!(sum(&paper) <= sum(&other), "{order}");
    }
    assert!(two.order <= paper.order);
}

#[test]
fn a_spine_tilted_by_more_than_seventy_degrees_is_fitted_in_parametric_form() {
    // Oracle: an arc of 80° with the vertebrae at equal angles.
    let radius_mm = 300.0;
    let vertebrae: Vec<(Frontal, Angle)> = (0..15)
        .map(|i| {
            let turn = Angle::from_deg(80.0 * f64::from(i) / 14.0);
            let (s, c) = turn.rad().sin_cos();
            (Frontal::new(-radius_mm * (1.0 - c), radius_mm * s), turn)
        })
        .collect();
    let mut warnings = Warnings::default();
    let outline = outline(Posture::LeftBending, &vertebrae);
    let fit = fit_curve(&outline, OrderRule::LeaveOneOut, &mut warnings).expect("an arc");
    assert!(warnings.has(WarningCode::ParametricCurve));
    assert_eq!(fit.curve.form(), spineline::curve::CurveForm::Parametric);
    // An order that stops where the noise of a reading begins: well below 0.25 mm.
    assert!(fit.rmse_mm < 0.05, "{}", fit.rmse_mm);
    let length = fit.curve.length_mm(fit.curve.end_mm());
    assert_near(length, radius_mm * Angle::from_deg(80.0).rad(), 0.1, "length of the arc");
}
