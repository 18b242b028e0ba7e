//! Points of the global frame on their film: there and back, and where the marks are.

use crate::common::{all_landmarks, landmarks, measured, phantom};
use proptest::prelude::*;
use spineline::analysis::{AnalysisOptions, MultiplierEnding, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::clinical::endplate_line;
use spineline::measure::{
    Corners, Film, FilmFrame, Outline, Spacing, SpacingPlane, endplate_centres,
};
use spineline::spatial::{Frontal, Pixel};
use spineline_phantom::{Readers, Scenario};

/// A few operations on places of some thousand pixels.
const ROUNDING_PX: f64 = 1e-9;

/// A film of a phantom with other pixels, and perhaps seen from the other side; the marks stay on the body.
fn film(subject: usize, readers: &Readers, spacing: Option<(f64, f64)>, flip: bool) -> Film {
    // Its bends are not looked at, so they are the quickest to make.
    let case = phantom(subject, Scenario::Bend, readers).case;
    let mut film = case.film(Posture::Erect).expect("erect").clone();
    let (image, crests, _) = landmarks(&mut film);
    let old = image.spacing.expect("phantoms have a spacing");
    let (column_mm, row_mm) = spacing.unwrap_or((0.15, 0.15));
    let scale = [old.column_mm / column_mm, old.row_mm / row_mm];
    image.columns = (f64::from(image.columns) * scale[0]).ceil() as u32 + 1;
    image.rows = (f64::from(image.rows) * scale[1]).ceil() as u32 + 1;
    image.spacing = spacing.map(|_| Spacing::stated(column_mm, row_mm, SpacingPlane::Patient));
    let last = f64::from(image.columns - 1);
    let moved = |place: Pixel| {
        let column = place.column_px * scale[0];
        Pixel::new(if flip { last - column } else { column }, place.row_px * scale[1])
    };
    if flip {
        image.patient_left = image.patient_left.opposite();
    }
    *crests = None;
    for landmark in all_landmarks(&mut film) {
        landmark.corners = landmark.corners.map(moved);
        landmark.axis_clockwise = None;
    }
    film
}

fn framed(film: &Film) -> (Outline, FilmFrame) {
    let outline = measured(film);
    let frame = FilmFrame::of(film, &outline).expect("a picture");
    (outline, frame)
}

/// Where the diagonals cross, in pixels: no scale and no side moves that.
fn crossing(corners: &Corners<Pixel>) -> Pixel {
    let as_point = |p: Pixel| Frontal::new(p.column_px, p.row_px);
    let body = corners.map(as_point).measure_location().expect("a body");
    Pixel::new(body.y_mm, body.z_mm)
}

fn apart(a: Pixel, b: Pixel) -> f64 {
    (a.column_px - b.column_px).hypot(a.row_px - b.row_px)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn conversion_to_the_film_and_back_gives_the_same_place(
        subject in 0..18_usize, column in 0.05..0.5, row in 0.05..0.5, scaled: bool, flip: bool,
        y in -200.0..200.0, z in -100.0..600.0, place in (0.0..4000.0, 0.0..5000.0),
    ) {
        let film = film(subject, &Readers::exact(), scaled.then_some((column, row)), flip);
        let (_, frame) = framed(&film);
        let point = Frontal::new(y, z);
        prop_assert!(frame.point(frame.pixel(point)).distance_mm(point) < ROUNDING_PX);
        let place = Pixel::new(place.0, place.1);
        prop_assert!(apart(frame.pixel(frame.point(place)), place) < ROUNDING_PX);
    }

    #[test]
    fn measured_midpoints_are_at_the_intersection_of_diagonals(
        subject in 0..18_usize, column in 0.05..0.5, row in 0.05..0.5, scaled: bool, flip: bool,
    ) {
        let film = film(subject, &Readers::default(), scaled.then_some((column, row)), flip);
        let (outline, frame) = framed(&film);
        let (_, _, readings) = landmarks_of(&film);
        for vertebra in &outline.vertebrae {
            // Several readings: the mean of their crossings.
            let count = readings.len() as f64;
            let sum = readings.iter().fold((0.0, 0.0), |sum, reading| {
                let at = crossing(&reading[&vertebra.level]);
                (sum.0 + at.column_px / count, sum.1 + at.row_px / count)
            });
            let seen = frame.pixel(vertebra.location);
            prop_assert!(apart(seen, Pixel::new(sum.0, sum.1)) < ROUNDING_PX);
        }
    }

    #[test]
    fn a_mirrored_film_shows_the_mirrored_place(subject in 0..18_usize, y in -100.0..100.0, z in 0.0..400.0) {
        let [plain, turned] = [false, true].map(|flip| {
            let film = film(subject, &Readers::exact(), Some((0.2, 0.3)), flip);
            let last = f64::from(landmarks(&mut film.clone()).0.columns - 1);
            (framed(&film).1.pixel(Frontal::new(y, z)), last)
        });
        let (plain, last) = plain;
        prop_assert!(apart(Pixel::new(last - plain.column_px, plain.row_px), turned.0) < 1e-6);
    }
}

type Bodies = std::collections::BTreeMap<Level, Corners<Pixel>>;

/// The picture's size and the corners of every reading.
fn landmarks_of(film: &Film) -> (u32, u32, Vec<Bodies>) {
    let mut film = film.clone();
    let (image, _, readings) = landmarks(&mut film);
    let bodies = readings.iter().map(|reading| {
        reading.vertebrae.iter().map(|(&level, landmark)| (level, landmark.corners)).collect()
    });
    (image.columns, image.rows, bodies.collect())
}

#[test]
fn lines_end_on_the_edge_of_their_film() {
    let film = film(0, &Readers::exact(), Some((0.15, 0.2)), false);
    let (outline, frame) = framed(&film);
    let top = outline.vertebrae[14].location;
    let [from, to] = frame.line(Frontal::default(), top).expect("it crosses the film");
    let image = frame.image();
    let last_row = f64::from(image.rows - 1);
    assert!(image.contains(from) && image.contains(to));
    // From below to above, from edge to edge.
    assert!((from.row_px - last_row).abs() < 1e-6 && to.row_px.abs() < 1e-6);
    assert_eq!(frame.line(Frontal::new(1e6, 0.0), Frontal::new(0.0, 1.0)), None);
}

#[test]
fn the_angle_between_endplate_lines_is_the_cobb_angle() {
    let case = phantom(0, Scenario::Rod, &Readers::exact()).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    let film = case.film(Posture::Erect).expect("erect");
    let outline = &analysis.movement.erect().outline;
    let frame = FilmFrame::of(film, outline).expect("a picture");
    for curve in &analysis.movement.clinical {
        let plates = |level| outline.vertebra(level).and_then(|v| v.endplates).expect("marked");
        let upper = (curve.ends.superior, plates(curve.ends.superior).superior);
        let lower = (curve.ends.inferior, plates(curve.ends.inferior).inferior);
        let [upper, lower] = [upper, lower].map(|(level, tilt)| {
            let [centre, _] = endplate_centres(film, &frame, level).expect("marked");
            let [right, left] = endplate_line(centre, tilt, 40.0);
            assert!(((left - right).norm_mm() - 80.0).abs() < 1e-9 && left.y_mm > right.y_mm);
            (left - right).lateral_tilt()
        });
        let cobb = curve.cobb_in(Posture::Erect).expect("the erect film");
        assert!(((upper - lower).wrapped() - cobb).rad().abs() < 1e-12);
    }
}

#[test]
fn a_multiplier_is_contradicted_when_most_of_its_joints_are_counter_rotating() {
    // Bends in which all joints turn one way contradict a force that crosses the spine twice.
    let case = phantom(0, Scenario::Bend, &Readers::exact()).case;
    let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    for model in &analysis.models {
        let verdicts = model.verdicts(&analysis);
        let fitted: Vec<_> =
            model.simulations.iter().filter(|s| s.fitted && s.is_usable()).collect();
        // Every joint that turns against the force is counted behind one multiplier.
        let against: usize = verdicts.iter().map(|verdict| verdict.against).sum();
        assert_eq!(against, fitted.iter().map(|s| s.contradicted.len()).sum::<usize>());
        let joints: usize = verdicts.iter().map(|verdict| verdict.joints).sum();
        assert_eq!(joints, 14 * fitted.len());
        for verdict in &verdicts {
            let most = 2 * verdict.against > verdict.joints;
            let fits = model.fit.status == spineline::personalize::FitStatus::Converged;
            if fits && !fitted.is_empty() {
                assert_eq!(most, verdict.ending == MultiplierEnding::Contradicted);
            } else {
                assert_eq!(verdict.ending, MultiplierEnding::NotConverged);
            }
            assert_ne!(verdict.ending, MultiplierEnding::Absolute, "no force is known");
        }
    }
    let contradicted = |scenario| {
        let case = phantom(0, scenario, &Readers::exact()).case;
        let analysis = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
        let line = analysis.models[0].verdicts(&analysis);
        line.iter().filter(|v| v.ending == MultiplierEnding::Contradicted).count()
    };
    assert!(contradicted(Scenario::Bend) > contradicted(Scenario::Rod));
}
