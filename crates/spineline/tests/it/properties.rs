//! What must not change, or change in a known way, when films are mirrored, moved, scaled, or read in another order.

use crate::common::{
    self, analyzed, assert_near, case_of, landmarks, measured, move_landmarks, move_places,
    on_a_table, other_side, phantom, placement_film, spacing,
};
use proptest::prelude::*;
use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, LineModel};
use spineline::anatomy::{Level, Posture};
use spineline::measure::Film;
use spineline::personalize::{FitStatus, FitTarget};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline_phantom::{Readers, Scenario, exchange_sides, mirror};

/// Values computed once from landmarks by a few operations, in mm and rad.
const ROUNDING: f64 = 1e-9;
/// Values after a least-squares fit and a minimiser.
const FITTED: f64 = 1e-6;

/// Subject, scenario, and whether the readers are exact.
fn any_case() -> impl Strategy<Value = (usize, usize, bool)> {
    (0..18_usize, 0..3_usize, any::<bool>())
}

fn case((subject, scenario, exact): (usize, usize, bool)) -> Case {
    let readers = if exact { Readers::exact() } else { Readers::default() };
    phantom(subject, Scenario::PAPER[scenario], &readers).case
}

fn options(ferguson: bool) -> AnalysisOptions {
    let target = if ferguson { FitTarget::Ferguson } else { FitTarget::Shape };
    AnalysisOptions { target, ..on_a_table() }
}

/// The film of the patient's mirror image: the picture is flipped, the patient's sides change their names.
pub fn mirror_image(film: &Film) -> Film {
    let mut film = film.clone();
    film.posture = other_side(film.posture);
    mirror(&mut film);
    exchange_sides(&mut film);
    film
}

fn model(analysis: &Analysis, kind: LineKind) -> &LineModel {
    analysis.model(kind).expect("every line")
}

/// Whether a fit meets its films within three standard deviations: of a location or tilt, or of a Ferguson angle (0.5°).
fn explains(a: &Analysis, model: &LineModel) -> bool {
    let ferguson = a.options.target == FitTarget::Ferguson && model.kind != LineKind::Estimated;
    model.fit.residual_rms < if ferguson { 1.5 } else { 3.0 }
}

/// Tolerance of a fit's multipliers, relative; `None` where the minimiser did not end in a minimum.
///
/// A fit that misses its films by many standard deviations has a wrong line. Its minimum lies in a long valley in which
/// Gauss-Newton steps converge linearly. The minimiser stops where a step gains 1e-7 of the sum of squares, so the
/// unknowns are known to about its root times the steps still to go, and where along the valley depends on rounding.
fn multiplier_tolerance(a: &Analysis, model: &LineModel) -> Option<f64> {
    const IN_A_VALLEY: f64 = 1e-2;
    let tolerance = if explains(a, model) { FITTED } else { IN_A_VALLEY };
    (model.fit.status == FitStatus::Converged).then_some(tolerance)
}

/// Compares what two analyses found about stiffness and errors; lengths of the second are `scale` times larger.
fn assert_same_models(
    a: &Analysis,
    b: &Analysis,
    postures: &[(Posture, Posture)],
    scale: f64,
    kinds: &[LineKind],
) {
    for &kind in kinds {
        let limits = [a, b].map(|analysis| multiplier_tolerance(analysis, model(analysis, kind)));
        let good = explains(a, model(a, kind));
        let (a, b) = (model(a, kind), model(b, kind));
        let [Some(tolerance), Some(_)] = limits else {
            // Near the limit of iterations, rounding decides whether a poor fit got to its end.
            assert!(!good, "{kind}: a good fit that ended with {:?}", [a.fit.status, b.fit.status]);
            continue;
        };
        // What is minimised is known better than where.
        let rms = a.fit.residual_rms;
        let limit = if good { FITTED } else { 1e-3 } * rms;
        assert_near(b.fit.residual_rms, rms, limit, &format!("{kind}: residual"));
        for (i, (x, y)) in a.multipliers().zip(b.multipliers()).enumerate() {
            assert_near(y, x, tolerance * x, &format!("{kind}: multiplier {i}"));
        }
        for &(p, q) in postures.iter().skip(1) {
            let (Some(x), Some(y)) = (a.simulation(p), b.simulation(q)) else {
                assert_eq!(a.simulation(p).is_some(), b.simulation(q).is_some(), "{kind}, {p}");
                continue;
            };
            assert_eq!(x.status, y.status, "{kind}, {p}");
            assert_eq!(x.contradicted.len(), y.contradicted.len(), "{kind}, {p}");
            // The nearest shape to an amplitude out of reach is not a result; it depends on the largest force tried.
            if !x.is_usable() {
                continue;
            }
            for (i, (x, y)) in
                x.shape.location_errors_mm.iter().zip(&y.shape.location_errors_mm).enumerate()
            {
                // A multiplier moves shapes of some hundred millimetres.
                let limit_mm = 100.0 * tolerance;
                assert_near(*y, scale * x, limit_mm, &format!("{kind}, {p}: error {i}"));
            }
        }
    }
}

/// How much larger a patient may be and still have a spine of a plausible length.
const LARGER: f64 = 1.25;

const ALL_LINES: [LineKind; 3] = [LineKind::Inflection, LineKind::Iliac, LineKind::Estimated];

proptest! {
    #![proptest_config(common::deterministic(2016))]

    /// Oracle: left and right are names only.
    #[test]
    fn a_mirrored_patient_has_the_mirrored_analysis(made in any_case(), ferguson in any::<bool>()) {
        let case = case(made);
        let films = case.films.iter().map(mirror_image).collect();
        let options = options(ferguson);
        let (a, b) = (analyzed(&case, &options), analyzed(&case_of(films), &options));
        let postures = Posture::ALL.map(|posture| (posture, other_side(posture)));
        for (p, q) in postures {
            let (a, b) = (a.movement.film(p).expect("five films"), b.movement.film(q).expect("five films"));
            for (v, w) in a.outline.vertebrae.iter().zip(&b.outline.vertebrae) {
                assert_near(w.location.y_mm, -v.location.y_mm, ROUNDING, "y");
                assert_near(w.location.z_mm, v.location.z_mm, ROUNDING, "z");
                assert_near(w.tilt.rad(), -v.tilt.rad(), ROUNDING, "tilt");
            }
            prop_assert_eq!(a.fit.order, b.fit.order);
            prop_assert_eq!(a.pose.segments(), b.pose.segments());
            for (m, n) in a.motion.iter().zip(&b.motion) {
                for (x, y) in m.rotations.iter().zip(&n.rotations) {
                    assert_near(y.rad(), x.rad(), FITTED, "rotation");
                }
            }
        }
        prop_assert_eq!(a.movement.inflection_segments, b.movement.inflection_segments);
        prop_assert_eq!((a.movement.chain.segments, a.movement.chain.difference), (b.movement.chain.segments, b.movement.chain.difference));
        assert_near(b.movement.chain.segment_mm, a.movement.chain.segment_mm, ROUNDING, "segment");
        prop_assert_eq!(a.movement.regions, b.movement.regions);
        assert_same_models(&a, &b, &postures, 1.0, &ALL_LINES);
    }

    /// Oracle: how a film was held is not a property of the patient.
    #[test]
    fn a_rigid_motion_of_a_film_does_not_change_results(
        made in any_case(),
        moves in prop::collection::vec((-20.0..20.0_f64, -90.0..90.0_f64, -90.0..90.0_f64), 5),
    ) {
        let case = case(made);
        let mut moved = case.clone();
        for (film, (deg, y, z)) in moved.films.iter_mut().zip(&moves) {
            move_landmarks(film, Angle::from_deg(*deg), Frontal::new(*y, *z));
        }
        assert_same_analysis(&analyzed(&case, &on_a_table()), &analyzed(&moved, &on_a_table()));
    }

    /// Oracle: placements may be given in any frame of their film.
    #[test]
    fn placements_in_another_frame_do_not_change_results(
        subject in 0..18_usize,
        scenario in 0..3_usize,
        moves in prop::collection::vec((-80.0..80.0_f64, -900.0..900.0_f64, -900.0..900.0_f64), 5),
    ) {
        let phantom = phantom(subject, Scenario::PAPER[scenario], &Readers::exact());
        let films = |moves: &[(f64, f64, f64)]| -> Vec<Film> {
            let postures = phantom.postures.iter().zip(moves);
            postures.map(|(posture, &(deg, y, z))| {
                let turn = Angle::from_deg(deg);
                let places = posture.locations.iter().zip(&posture.tilts);
                let places = Level::MODEL.into_iter().zip(places).map(|(level, (place, tilt))| {
                    (level, place.rotated(turn) + Frontal::new(y, z), *tilt + turn)
                });
                placement_film(posture.posture, places)
            }).collect()
        };
        let (still, moved) = (case_of(films(&[(0.0, 0.0, 0.0); 5])), case_of(films(&moves)));
        assert_same_analysis(&analyzed(&still, &on_a_table()), &analyzed(&moved, &on_a_table()));
    }

    /// Oracle: a picture with a larger spacing shows a patient larger by the same factor.
    ///
    /// With the film scale its midpoints, the depths of joints and profile, which are typical ones in proportion to the
    /// spacing of the vertebrae, and the noise, which readings in pixels show. Then moments scale with lengths, so forces
    /// are divided by the factor, and angles, multipliers and segment numbers stay. What does not scale: the assumed noise of a single
    /// reading (so there are six here), T2's tolerance of a millimetre in held-out postures, and the least gap of a line.
    #[test]
    fn a_larger_patient_has_the_same_angles(subject in 0..18_usize, scenario in 0..3_usize) {
        let case = phantom(subject, Scenario::PAPER[scenario], &Readers::default()).case;
        let mut large = case.clone();
        for film in &mut large.films {
            let (image, _, _) = landmarks(film);
            spacing(image).column_mm *= LARGER;
            spacing(image).row_mm *= LARGER;
        }
        let (a, b) = (analyzed(&case, &options(true)), analyzed(&large, &options(true)));
        for (a, b) in a.movement.films.iter().zip(&b.movement.films) {
            for (v, w) in a.outline.vertebrae.iter().zip(&b.outline.vertebrae) {
                assert_near((w.location - v.location * LARGER).norm_mm(), 0.0, ROUNDING, "location");
                assert_near(w.tilt.rad(), v.tilt.rad(), ROUNDING, "tilt");
            }
            prop_assert_eq!(a.fit.order, b.fit.order);
            prop_assert_eq!(a.pose.segments(), b.pose.segments());
            for (m, n) in a.motion.iter().zip(&b.motion) {
                assert_near(n.mean_rotation().rad(), m.mean_rotation().rad(), ROUNDING, "rotation");
            }
        }
        prop_assert_eq!(a.movement.inflection_segments, b.movement.inflection_segments);
        prop_assert_eq!(a.movement.chain.segments, b.movement.chain.segments);
        assert_near(b.movement.chain.segment_mm, LARGER * a.movement.chain.segment_mm, ROUNDING, "segment");
        for (c, d) in a.movement.clinical.iter().zip(&b.movement.clinical) {
            for (x, y) in c.ferguson.iter().zip(&d.ferguson) {
                assert_near(y.1.rad(), x.1.rad(), ROUNDING, "Ferguson angle");
            }
            for ((_, x), (_, y)) in c.angles.iter().zip(&d.angles) {
                assert_near(y.tilt_range.rad(), x.tilt_range.rad(), ROUNDING, "tilt range");
                assert_near(y.size().rad(), x.size().rad(), ROUNDING, "Cobb angle");
            }
        }
        for (p, q) in a.movement.spine.midpoints_mm.iter().zip(&b.movement.spine.midpoints_mm) {
            assert_near((q - p * LARGER).norm(), 0.0, ROUNDING, "midpoint");
        }
        for (p, q) in a.movement.spine.joints.iter().zip(&b.movement.spine.joints) {
            let off = q.centre_in_inferior_mm - p.centre_in_inferior_mm * LARGER;
            assert_near(off.norm(), 0.0, ROUNDING, "joint centre");
        }
        let bends = &Posture::ALL.map(|posture| (posture, posture))[..3];
        assert_same_models(&a, &b, bends, LARGER, &[LineKind::Inflection, LineKind::Iliac]);
        for kind in [LineKind::Inflection, LineKind::Iliac] {
            let Some(tolerance) = multiplier_tolerance(&a, model(&a, kind)) else { continue };
            let (a, b) = (model(&a, kind), model(&b, kind));
            for (x, y) in a.fit.loads.iter().zip(&b.fit.loads) {
                assert_near(y[0], x[0] / LARGER, tolerance * x[0].abs(), &format!("{kind}: force"));
            }
        }
    }

    /// Oracle: a mean has no order. Debug prints every f64 so that it reads back to the same bits.
    #[test]
    fn the_order_of_readings_and_films_does_not_change_any_bit(
        subject in 0..18_usize,
        seed in any::<u64>(),
    ) {
        let case = phantom(subject, Scenario::Bend, &Readers::default()).case;
        let mut shuffled = case.clone();
        let mut draw = common::Draw::new(seed);
        for film in &mut shuffled.films {
            let (_, _, readings) = landmarks(film);
            for i in (1..readings.len()).rev() {
                readings.swap(i, draw.below(i + 1));
            }
        }
        shuffled.films.rotate_left(draw.below(5));
        let (a, b) = (analyzed(&case, &on_a_table()), analyzed(&shuffled, &on_a_table()));
        prop_assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }

    /// Oracle: millimetres do not know the pixels in which they were drawn.
    #[test]
    fn pixels_that_are_not_square_show_the_same_spine(
        subject in 0..18_usize,
        factor in 0.4..2.5_f64,
    ) {
        let case = phantom(subject, Scenario::Bend, &Readers::exact()).case;
        let mut stretched = case.clone();
        for film in &mut stretched.films {
            let (image, ..) = landmarks(film);
            spacing(image).row_mm *= factor;
            image.rows = (f64::from(image.rows) / factor).ceil() as u32 + 1;
            move_places(film, |p| Pixel::new(p.column_px, p.row_px / factor));
        }
        for (film, other) in case.films.iter().zip(&stretched.films) {
            let (a, b) = (measured(film), measured(other));
            for (v, w) in a.vertebrae.iter().zip(&b.vertebrae) {
                assert_near(w.location.distance_mm(v.location), 0.0, ROUNDING, "location");
                assert_near(w.tilt.rad(), v.tilt.rad(), ROUNDING, "tilt");
            }
            assert_near(b.amplitude().rad(), a.amplitude().rad(), ROUNDING, "amplitude");
        }
    }
}

/// Everything that a frame of the film could reach.
fn assert_same_analysis(a: &Analysis, b: &Analysis) {
    for (a, b) in a.movement.films.iter().zip(&b.movement.films) {
        for (v, w) in a.outline.vertebrae.iter().zip(&b.outline.vertebrae) {
            assert_near(w.location.distance_mm(v.location), 0.0, ROUNDING, "location");
            assert_near(w.tilt.rad(), v.tilt.rad(), ROUNDING, "tilt");
        }
        assert_near(b.outline.amplitude().rad(), a.outline.amplitude().rad(), ROUNDING, "lean");
        assert_eq!((a.fit.order, a.pose.segments()), (b.fit.order, b.pose.segments()));
        for (x, y) in a.inflection_points.iter().flatten().zip(b.inflection_points.iter().flatten())
        {
            assert_near(y.distance_mm(*x), 0.0, FITTED, "inflection");
        }
    }
    assert_eq!(a.movement.inflection_segments, b.movement.inflection_segments);
    assert_eq!(a.movement.chain.segments, b.movement.chain.segments);
    let postures = Posture::ALL.map(|posture| (posture, posture));
    assert_same_models(a, b, &postures, 1.0, &ALL_LINES);
}

#[test]
fn predicted_stiffness_of_mirrored_films_is_the_same() {
    let predicted = |case: &Case| {
        let found = analyzed(case, &on_a_table());
        let of = |kind| found.group_stiffness(model(&found, kind)).ok();
        [LineKind::Inflection, LineKind::Iliac].map(of)
    };
    let mut compared = 0;
    for (subject, scenario) in (0..6).flat_map(|subject| Scenario::PAPER.map(|one| (subject, one)))
    {
        let case = phantom(subject, scenario, &Readers::default()).case;
        let mut other = case.clone();
        other.films.iter_mut().for_each(|film| *film = mirror_image(film));
        for (one, other) in predicted(&case).into_iter().zip(predicted(&other)) {
            let (Some(one), Some(other)) = (one, other) else { continue };
            compared += 1;
            for (a, b) in one.iter().zip(&other) {
                let off = (a.log_mean - b.log_mean).abs().max((a.log_reach - b.log_reach).abs());
                assert!(off < 1e-3 * (1.0 + a.log_reach), "{subject} {scenario:?}: {a:?} {b:?}");
            }
        }
    }
    assert!(compared > 24, "{compared}");
}
