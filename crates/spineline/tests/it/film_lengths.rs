//! A scale per film: found where a film has another one, left alone where it is stated, and never taken from what is predicted.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, FilmRole};
use spineline::anatomy::Posture;
use spineline::evaluate::{Baseline, predict_baseline};
use spineline::measure::{FilmLength, FilmLengthRule, FilmScale};
use spineline::spatial::{Angle, Frontal};
use spineline::warning::WarningCode;
use spineline_phantom::{Readers, Scenario};

use crate::common::{
    analyzed, assert_near, exact_case, film_mut, landmarks, measured, on_a_table, phantom, turned,
};

/// The case with films whose scales are not stated, each film's lengths multiplied.
fn scaled(case: &Case, factors: &[(Posture, f64)]) -> Case {
    let mut case = case.clone();
    for film in &mut case.films {
        let posture = film.posture;
        let factor = factors.iter().find(|(own, _)| *own == posture).map_or(1.0, |(_, f)| *f);
        let (image, ..) = landmarks(film);
        let spacing = image.spacing.as_mut().expect("phantoms have a spacing");
        spacing.column_mm *= factor;
        spacing.row_mm *= factor;
        spacing.relative_sd = None;
    }
    case
}

const FACTORS: [(Posture, f64); 4] = [
    (Posture::LeftBending, 1.05),
    (Posture::RightBending, 0.96),
    (Posture::Neutral, 1.03),
    (Posture::Traction, 0.98),
];

fn errors_mm(analysis: &Analysis, kind: LineKind, role: FilmRole) -> f64 {
    let found = analysis.comparison();
    let place = found.lines.iter().position(|line| line.kind == kind).expect("every line");
    found.errors(place, role).expect("such films").location_mm
}

#[test]
fn the_scale_of_a_film_is_found_and_taken_out() {
    let case = phantom(2, Scenario::Pull, &Readers::exact()).case;
    let other = scaled(&case, &FACTORS);
    let as_marked = AnalysisOptions { film_lengths: FilmLengthRule::AsMarked, ..on_a_table() };
    let (truth, found) = (analyzed(&case, &on_a_table()), analyzed(&other, &on_a_table()));
    let raw = analyzed(&other, &as_marked);
    for posture in &found.movement.films[1..] {
        let FilmLength { measured, scale, prior_log_sd } = posture.outline.length;
        let factor = FACTORS.iter().find(|(own, _)| *own == posture.outline.posture);
        let factor = factor.expect("every film but the erect one").1;
        assert_near(measured.factor, factor, 0.002, "measured scale");
        let [low, high] = scale.interval_95();
        assert!(low < factor && factor < high, "{factor} is not within {low} to {high}");
        assert_eq!(prior_log_sd, FilmLengthRule::RELATIVE_SD);
    }
    // The true line predicts as well as on films of one scale; without a scale per film it does not.
    for role in [FilmRole::LeftOutBend, FilmRole::HeldOut] {
        let [exact, with, without] =
            [&truth, &found, &raw].map(|analysis| errors_mm(analysis, LineKind::Iliac, role));
        assert!(with < exact + 0.3, "{role}: {with} and {exact} mm");
        assert!(without > with + 2.0, "{role}: {without} and {with} mm");
    }
    let multipliers = |analysis: &Analysis| -> Vec<f64> {
        let model = analysis.model(LineKind::Iliac).expect("an iliac line");
        model.fit.log_multipliers.clone()
    };
    for (own, exact) in multipliers(&found).iter().zip(multipliers(&truth)) {
        assert_near(*own, exact, 0.05, "ln multiplier");
    }
}

#[test]
fn stated_scales_are_not_fitted() {
    let case = phantom(4, Scenario::Rod, &Readers::exact()).case;
    let analysis = analyzed(&case, &AnalysisOptions::default());
    // All films of a phantom state one exact scale.
    assert!(analysis.movement.films.iter().all(|p| !p.outline.length.is_free()));
    assert!(analysis.movement.films.iter().all(|p| p.outline.length.scale == FilmScale::ONE));
    let mut stated = scaled(&case, &[(Posture::LeftBending, 1.02)]);
    for (posture, sd) in [(Posture::Erect, 0.003), (Posture::LeftBending, 0.004)] {
        let (image, ..) = landmarks(film_mut(&mut stated, posture));
        image.spacing.as_mut().expect("a spacing").relative_sd = Some(sd);
    }
    let analysis = analyzed(&stated, &AnalysisOptions::default());
    let length = |posture| analysis.movement.film(posture).expect("a film").outline.length;
    assert_near(length(Posture::LeftBending).prior_log_sd, 0.005, 1e-12, "both stated");
    assert_eq!(length(Posture::RightBending).prior_log_sd, FilmLengthRule::RELATIVE_SD);
    // 2 % is four deviations of what the two films state.
    let warned =
        analysis.warnings.all().iter().filter(|one| one.code == WarningCode::LengthsDiffer);
    assert_eq!(warned.map(|one| one.posture).collect::<Vec<_>>(), [Some(Posture::LeftBending)]);
}

#[test]
fn a_film_without_spacing_is_taken_to_be_as_long_as_the_erect_one() {
    // A smaller spine than the typical one.
    let factors = Posture::ALL.map(|posture| (posture, 0.75));
    let case = scaled(&phantom(1, Scenario::Rod, &Readers::exact()).case, &factors);
    let options = |film_lengths| AnalysisOptions { film_lengths, ..on_a_table() };
    // The oracle: lengths in millimetres, and scales that are nearly unknown.
    let oracle = analyzed(&case, &options(FilmLengthRule::PerFilm { relative_sd: 0.5 }));
    for without in [Posture::LeftBending, Posture::Erect] {
        let mut case = case.clone();
        landmarks(film_mut(&mut case, without)).0.spacing = None;
        for rule in [FilmLengthRule::AsMarked, FilmLengthRule::default()] {
            let found = analyzed(&case, &options(rule));
            assert!(!found.warnings.has(WarningCode::LengthsDiffer));
            for (own, other) in found.movement.films.iter().zip(&oracle.movement.films) {
                let Some(rotation) = other.mean_rotation().map(Angle::deg) else { continue };
                let rotation_by = own.mean_rotation().expect("a film that moved").deg() / rotation;
                assert_near(rotation_by, 1.0, 0.02, "mean rotation");
                let marked_mm = other.outline.polygon_mm() * other.outline.length.scale.factor;
                let own_mm = own.outline.polygon_mm() * own.outline.length.scale.factor;
                let scale = &own.outline.scale;
                // Pixels of 0.075 mm.
                let in_px = || 0.075 * scale.px(own_mm).expect("pixels");
                let own_mm = scale.mm(own_mm).unwrap_or_else(in_px);
                assert_near(own_mm / marked_mm, 1.0, 1e-6, "length as marked");
            }
        }
    }
}

#[test]
fn predicted_vertebrae_give_no_scale() {
    let case = scaled(&phantom(3, Scenario::Pull, &Readers::exact()).case, &FACTORS);
    let mut moved = case.clone();
    let film = film_mut(&mut moved, Posture::Neutral);
    let (_, _, readings) = landmarks(film);
    for reading in readings {
        let count = reading.vertebrae.len();
        for landmark in reading.vertebrae.values_mut().skip(2).take(count - 4) {
            // Five millimetres up: within the order of the vertebrae, and far beyond any reader's error.
            landmark.corners = landmark.corners.map(|mut corner| {
                corner.row_px -= 50.0;
                corner
            });
        }
    }
    let of = |case: &Case| {
        let analysis = analyzed(case, &on_a_table());
        let model = analysis.model(LineKind::Iliac);
        let neutral = model.expect("an iliac line").simulation(Posture::Neutral).cloned();
        neutral.expect("a neutral film")
    };
    let (first, second) = (of(&case), of(&moved));
    assert!(first.is_usable() && second.is_usable());
    // The force is relative to T2's place and the scale alone.
    assert_near(second.shape.scale.factor, first.shape.scale.factor, 1e-6, "scale");
    assert_near(second.force_n, first.force_n, 1e-3 * first.force_n.abs(), "force");
    assert!(second.shape.mean_location_error_mm() > first.shape.mean_location_error_mm() + 1.0);
}

#[test]
fn the_scale_from_t2_minimises_its_two_squares() {
    let length = FilmLength { prior_log_sd: 0.033, ..FilmLength::ERECT };
    let (simulated, marked, sd_mm) = (Frontal::new(-60.0, 350.0), Frontal::new(-70.0, 355.0), 0.4);
    let cost = |log: f64| {
        let off = simulated * log.exp() - marked;
        off.dot(off) / (sd_mm * sd_mm) + (log / 0.033_f64).powi(2)
    };
    let found = length.from_top(simulated, marked, sd_mm);
    let log = found.factor.ln();
    for step in [-1e-4, 1e-4] {
        assert!(cost(log + step) > cost(log), "{log} is not a minimum");
    }
    // The deviation is where the sum of squares is one higher.
    let rise = cost(log + found.log_sd) - cost(log);
    assert_near(rise, 1.0, 0.02, "rise of the sum of squares");
    assert_eq!(FilmLength::ERECT.from_top(simulated, marked, sd_mm), FilmScale::ONE);
}

#[test]
fn a_pattern_of_rotations_is_recognised_at_any_size_and_scale() {
    let erect = measured(&exact_case(1).films[0]);
    let pattern: Vec<f64> = (0..14).map(|joint| 1.0 + 0.1 * f64::from(joint % 5)).collect();
    let rotation = |joint: f64| Angle::from_deg(2.3 * joint);
    let mut tilts = vec![0.0];
    for joint in &pattern {
        tilts.push(tilts[tilts.len() - 1] + rotation(*joint).rad());
    }
    let mut film = erect.clone();
    film.posture = Posture::RightBending;
    film.length = FilmLength { prior_log_sd: 0.05, ..FilmLength::ERECT };
    for ((vertebra, location), tilt) in
        film.vertebrae.iter_mut().zip(turned(&erect, &tilts)).zip(&tilts)
    {
        vertebra.location = location * 1.03;
        vertebra.tilt = vertebra.tilt + Angle::from_rad(*tilt);
    }
    let angles: Vec<Angle> = pattern.iter().map(|&joint| Angle::from_deg(joint)).collect();
    let found = predict_baseline(Baseline::OtherPatients, &angles, &erect, &film);
    assert!(found.is_usable());
    let amount = found.amount.expect("a pattern");
    assert_near(amount, 2.3, 1e-3, "amount");
    assert_near(found.shape.scale.factor, 1.03, 1e-4, "scale");
    assert!(
        found.shape.mean_location_error_mm() < 0.05,
        "{}",
        found.shape.mean_location_error_mm()
    );
    // The whole outline gives the same scale.
    let length = FilmLength::of(&erect, &film, FilmLengthRule::default());
    assert_near(length.measured.factor, 1.03, 1e-9, "measured scale");
    // The opposite pattern is the same one.
    let opposite: Vec<Angle> = angles.iter().map(|&angle| -angle).collect();
    let mirrored = predict_baseline(Baseline::MirroredBend, &opposite, &erect, &film);
    assert_near(mirrored.amount.expect("a pattern"), -amount, 1e-6, "opposite amount");
}
