//! Erect films on which the springs carry the weight of the trunk.

use std::collections::BTreeMap;

use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{
    Analysis, AnalysisOptions, Case, FilmPredictor, FilmRole, Reference, analyze, analyze_movement,
};
use spineline::anatomy::{ImageSide, Level, Levels, Posture, trunk_weight_shares};
use spineline::measure::{
    Corners, Film, FilmLandmarks, FilmLengthRule, ImageGeometry, Reading, ReadingId, Spacing,
    SpacingPlane, VertebraLandmarks,
};
use spineline::multibody::{
    BodyLoad, Deformed, GeneralStatics, Goal, JointStiffness, LoadItem, Loading, PathOptions,
    SpineModel, StiffnessLibrary, Support,
};
use spineline::personalize::Gauge;
use spineline::spatial::{Angle, Frontal, Mat3, Pixel, Vec3};
use spineline::warning::WarningCode;

use crate::common::chain::{dead, proportional};
use crate::common::{case_of, graph_film, spine};

/// Springs alone hold no heavier trunk: a patient's muscles do.
const BODY_MASS_KG: f64 = 12.0;
/// A force on T2 along a line: y and z of a point, its lateral tilt, and the force towards cranial.
struct Pull(Posture, Frontal, Angle, f64);

const PULLS: [Pull; 4] = [
    Pull(Posture::LeftBending, Frontal::new(20.0, 390.0), Angle::from_deg(-60.0), 20.0),
    Pull(Posture::RightBending, Frontal::new(10.0, 370.0), Angle::from_deg(65.0), 20.0),
    Pull(Posture::Neutral, Frontal::new(12.0, 150.0), Angle::from_deg(-20.0), 5.0),
    Pull(Posture::Traction, Frontal::new(6.0, 150.0), Angle::from_deg(1.0), 90.0),
];

impl Pull {
    fn line(&self) -> LineOfAction {
        LineOfAction::leaning(self.1, self.2)
    }
}

/// The weights of all vertebrae above the base, along the vertical of a film on which L4 has this tilt.
fn weights_n(levels: Levels, base_tilt: Angle) -> Vec<Vec3> {
    let down = Frontal::new(0.0, -1.0).rotated(-base_tilt) * (9.806_65 * BODY_MASS_KG);
    let shares = trunk_weight_shares(levels).into_iter();
    shares.map(|share| Vec3::new(0.0, down.y_mm, down.z_mm) * share).collect()
}

fn at_midpoints(forces_n: &[Vec3]) -> Vec<LoadItem> {
    (1..).zip(forces_n).map(|(vertebra, &force_n)| proportional(vertebra, dead(force_n))).collect()
}

/// Equilibrium of a spine with the springs of the library, by the general solver.
fn shape(model: &SpineModel, items: Vec<LoadItem>) -> Deformed {
    let springs = StiffnessLibrary::default();
    let springs =
        springs.rows().iter().map(|row| Mat3::from_diagonal(&Vec3::from(row.nmm_per_rad)));
    let statics = GeneralStatics::new(model, springs, Support::Frontal).expect("sound springs");
    let loading = Loading { items, rods: Vec::new() };
    let path = statics.follow(&loading, Goal::FullLoad, &PathOptions::default()).expect("sound");
    path.result().expect("an equilibrium").deformed.clone()
}

/// A picture of bodies 40 mm wide and 26 mm high, with 0.5 mm per pixel; L4 is tilted as on the film.
fn film(posture: Posture, shape: &Deformed, base_tilt: Angle) -> Film {
    let vertebra = |(i, &level): (usize, &Level)| {
        let corner = |left_mm: f64, up_mm: f64| {
            let on_body = Frontal::new(left_mm, up_mm).rotated(shape.tilt(i));
            let place = (shape.location(i) + on_body).rotated(base_tilt);
            Pixel::new(600.0 + 2.0 * place.y_mm, 1200.0 - 2.0 * place.z_mm)
        };
        let corners = Corners {
            superior_left: corner(20.0, 13.0),
            superior_right: corner(-20.0, 13.0),
            inferior_left: corner(20.0, -13.0),
            inferior_right: corner(-20.0, -13.0),
        };
        (level, VertebraLandmarks::clicked(corners))
    };
    let landmarks = FilmLandmarks::Corners {
        image: ImageGeometry {
            columns: 1200,
            rows: 1300,
            spacing: Some(Spacing::stated(0.5, 0.5, SpacingPlane::Patient)),
            patient_left: ImageSide::Right,
        },
        iliac_crests: None,
        readings: vec![Reading {
            id: ReadingId { observer: "A".into(), repeat: 1 },
            vertebrae: Level::MODEL.iter().enumerate().map(vertebra).collect(),
        }],
    };
    Film::new(posture, landmarks)
}

/// A spine that stands under its weight on the erect film, and lies under a force on T2 on every other film.
fn case(subject: usize) -> Case {
    let model = spine(subject).1;
    let base_tilt = Angle::from_deg(3.0);
    let standing = shape(&model, at_midpoints(&weights_n(Levels::COMPLETE, base_tilt)));
    let pulled = |pull: &Pull| {
        let line = pull.line();
        let in_space = |v: Frontal| Vec3::new(0.0, v.y_mm, v.z_mm);
        let (force_n, point_mm) = (in_space(line.direction) * pull.3, in_space(line.point));
        let load = BodyLoad::ForceOnLine { force_n, point_mm };
        film(pull.0, &shape(&model, vec![proportional(14, load)]), base_tilt)
    };
    let films = [film(Posture::Erect, &standing, base_tilt)];
    let films = films.into_iter().chain(PULLS.iter().map(pulled)).collect();
    Case { synthetic: true, ..Case::of_films("stands", films) }
}

fn options(reference: Reference) -> AnalysisOptions {
    AnalysisOptions {
        reference,
        support: Support::Frontal,
        film_lengths: FilmLengthRule::AsMarked,
        given_lines: PULLS.iter().map(|pull| (pull.0, pull.line())).collect(),
        ..AnalysisOptions::default()
    }
}

const LOADED: Reference = Reference::Loaded { body_mass_kg: BODY_MASS_KG };

fn analysed(subject: usize, reference: Reference) -> Analysis {
    analyze(&case(subject), &options(reference)).expect("a sound case")
}

#[test]
fn a_spine_that_carries_a_load_stands_still_under_it() {
    let movement = analyze_movement(&case(4), &options(LOADED)).expect("a sound case").movement;
    let model = movement.spine_of_films();
    let weights = weights_n(movement.levels(), Angle::from_deg(3.0));
    let turned = shape(model, at_midpoints(&weights)).largest_hinge_rad();
    assert!(turned < 1e-9, "{turned:e} rad");
    let free = shape(model, Vec::new()).largest_hinge_rad();
    assert!(free > Angle::from_deg(0.5).rad(), "{free} rad");
}

#[test]
fn films_of_a_spine_that_lies_are_explained_by_a_loaded_reference() {
    // Oracle: the general solver on the unstressed spine. The analysis knows the lines, and neither the unstressed shape nor forces.
    let errors_mm = |analysis: &Analysis| -> Vec<((FilmRole, Posture), f64)> {
        let found = analysis.comparison();
        let of_film = |film| {
            let shape = found.shape(film, FilmPredictor::Line(LineKind::Given));
            let mm = shape.expect("a result").mean_location_error_mm();
            ((film.role, film.posture), mm)
        };
        found.films.iter().map(of_film).collect()
    };
    let mut means_mm: BTreeMap<(FilmRole, Posture), [f64; 2]> = BTreeMap::new();
    // Subjects 10 and 11 fall over.
    for subject in (0..18).filter(|subject| !(10..12).contains(subject)) {
        let loaded = analysed(subject, LOADED);
        let unloaded = analysed(subject, Reference::Unloaded);
        for ((film, with), (same, without)) in
            errors_mm(&loaded).into_iter().zip(errors_mm(&unloaded))
        {
            assert_eq!(film, same);
            assert!(with < without, "subject {subject}, {film:?}: {with} and {without} mm");
            assert!(with < 0.8, "subject {subject}, {film:?}: {with} mm");
            let means = means_mm.entry(film).or_insert([0.0; 2]);
            means[0] += with / 16.0;
            means[1] += without / 16.0;
        }
        for multiplier in loaded.model(LineKind::Given).expect("a model").multipliers() {
            assert!((multiplier - 1.0).abs() < 0.05, "subject {subject}: {multiplier}");
        }
    }
    for ((role, posture), [with, without]) in means_mm {
        println!("{role}, {posture}: loaded {with:.2} mm, unloaded {without:.1} mm");
        assert!(with < 0.25 && without > 1.0, "{role}, {posture}: {with} and {without} mm");
    }
}

#[test]
fn ratios_depend_on_the_level_of_the_table_only_under_a_weight() {
    let multipliers = |reference, factor: f64| -> (Vec<f64>, &'static str) {
        let published = StiffnessLibrary::default();
        let rows = published.rows().iter().cloned().map(|row| JointStiffness {
            nmm_per_rad: row.nmm_per_rad.map(|value| factor * value),
            ..row
        });
        let library = StiffnessLibrary::from_rows(rows.collect()).expect("sound springs");
        let options = AnalysisOptions { library, ..options(reference) };
        let analysis = analyze(&case(4), &options).expect("a sound case");
        let model = analysis.model(LineKind::Given).expect("a model");
        (model.multipliers().collect(), analysis.gauge_words())
    };
    for (reference, is_ratio) in [(Reference::Unloaded, true), (LOADED, false)] {
        let ((table, words), (doubled, _)) =
            (multipliers(reference, 1.0), multipliers(reference, 2.0));
        let changes = table.iter().zip(&doubled).map(|(a, b)| (a / b).ln().abs());
        let change = changes.fold(0.0, f64::max);
        assert!(if is_ratio { change < 1e-4 } else { change > 1e-3 }, "{reference:?}: {change:e}");
        assert_eq!(words.contains("only ratios are identified"), is_ratio, "{words}");
        assert_eq!(words.contains("(assumed)"), !is_ratio, "{words}");
    }
}

#[test]
fn a_model_of_a_loaded_reference_is_of_the_standing_patient() {
    let analysis = analysed(4, LOADED);
    let model = analysis.personalised_model(analysis.model(LineKind::Given).expect("a model"));
    assert_eq!(model.loads, []);
    assert!(model.spine.joints.iter().all(|joint| joint.erect_moment_nmm == Vec3::zeros()));
}

#[test]
fn weight_takes_a_vertical_with_a_warning_and_no_known_force() {
    let posture = Posture::LeftBending;
    let gauge = Gauge::KnownForce { posture, force_n: 50.0 };
    let error = analyze(&case(4), &AnalysisOptions { gauge, ..options(LOADED) }).expect_err("both");
    assert_eq!(error.code(), "weight_and_known_force");
    assert!(error.to_string().contains("do not balance the weight"), "{error}");
    let placed = case_of(vec![graph_film(Posture::Erect, 400.0, |_| (0.0, 0.0))]);
    let analysis = analyze(&placed, &options(LOADED)).expect("a sound case");
    let has = |code| analysis.warnings.all().iter().any(|warning| warning.code == code);
    assert!(has(WarningCode::VerticalAssumed));
}
