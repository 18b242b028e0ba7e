//! Erect films on which the springs carry the weight of the trunk, and predictions with the tilt of T2 of films by the general solver.

use std::collections::BTreeMap;

use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{
    Analysis, AnalysisOptions, Case, FilmPredictor, FilmRole, Reference, analyze, analyze_movement,
};
use spineline::anatomy::{ImageSide, Level, Levels, Posture, trunk_weight_shares};
use spineline::evaluate::{FilmShape, RotationPrior};
use spineline::hypothesis::{Hypothesis, LoadShape, Role};
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
use crate::common::{case_of, graph_film, other_side, spine};
use crate::properties::mirror_image;

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

    fn load(&self) -> Vec<LoadItem> {
        let line = self.line();
        let in_space = |v: Frontal| Vec3::new(0.0, v.y_mm, v.z_mm);
        let (force_n, point_mm) = (in_space(line.direction) * self.3, in_space(line.point));
        vec![proportional(14, BodyLoad::ForceOnLine { force_n, point_mm })]
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

/// Tilt of L4 on all films.
const BASE_TILT: Angle = Angle::from_deg(3.0);

/// A spine that stands under its weight on the erect film, and lies under a force on T2 on every other film.
fn case(subject: usize) -> Case {
    let weight = at_midpoints(&weights_n(Levels::COMPLETE, BASE_TILT));
    case_under(subject, weight, PULLS.map(|pull| (pull.0, pull.load())))
}

/// A spine under some loads on the erect film, and under others on other films.
fn case_under<const N: usize>(
    subject: usize,
    erect: Vec<LoadItem>,
    others: [(Posture, Vec<LoadItem>); N],
) -> Case {
    let model = spine(subject).1;
    let films = [(Posture::Erect, erect)].into_iter().chain(others);
    let films = films.map(|(posture, items)| film(posture, &shape(&model, items), BASE_TILT));
    Case { synthetic: true, ..Case::of_films("stands", films.collect()) }
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
    let weights = weights_n(movement.levels(), BASE_TILT);
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
        for multipliers in [&table, &doubled] {
            let level: f64 = multipliers.iter().map(|value| value.ln()).sum();
            assert!(
                level.abs() < 1e-5,
                "{reference:?}: the geometric mean of {multipliers:?} is 1"
            );
        }
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

/// Shapes with the tilt of T2: by a given line on all films that it predicts, by other loads on the bends.
fn with_tilt(case: &Case, options: &AnalysisOptions) -> Vec<FilmShape> {
    let analysis = analyze(case, options).expect("a sound case");
    let compared = analysis.comparison();
    let by = FilmPredictor::LineWithTilt(LineKind::Given);
    let by_line = compared.films.iter().filter_map(|film| compared.shape(film, by));
    let by_load = analysis.hypotheses.iter().flat_map(|fit| &fit.predictions);
    let by_load = by_load.filter(|found| found.role == Role::LeftOutWithTilt);
    by_line.chain(by_load.map(|found| &found.shape)).cloned().collect()
}

/// Forces to the patient's left on all vertebrae, each for its part of the length of the spine.
fn spread(subject: usize, force_n: f64) -> Vec<LoadItem> {
    let erect = spine(subject).0;
    let links = erect.vertebrae.windows(2);
    let links: Vec<f64> = links.map(|two| two[0].location.distance_mm(two[1].location)).collect();
    let part = |i: usize| {
        let below = if i == 0 { links[0] } else { 0.5 * links[i] };
        let above = links.get(i + 1).map_or(0.0, |link| 0.5 * link);
        (below + above) / links.iter().sum::<f64>()
    };
    at_midpoints(&(0..14).map(|i| Vec3::y() * (force_n * part(i))).collect::<Vec<_>>())
}

#[test]
fn predictions_with_the_tilt_of_the_top_meet_the_films_and_mirror_with_the_patient() {
    // Oracle: the general solver, and that left and right are names only.
    const NEAR_MM: f64 = 1.0;
    const MIRRORED_MM: f64 = 1e-3;
    let published = RotationPrior::published(Levels::COMPLETE);
    let covariance = published.covariance_rad2().clone();
    let mean = vec![Angle::from_deg(1.0); 14];
    let to_the_right =
        RotationPrior::new(Levels::COMPLETE, mean, covariance, published.source()).expect("sound");
    let rotation_prior = Some(to_the_right.with_erect_coefficient(-0.4));
    let unloaded = || options(Reference::Unloaded);
    let pulled = || case_under(4, Vec::new(), PULLS.map(|pull| (pull.0, pull.load())));
    let bends = [(Posture::LeftBending, 30.0), (Posture::RightBending, -30.0)];
    let spread = case_under(4, Vec::new(), bends.map(|(bend, force_n)| (bend, spread(4, force_n))));
    let hypotheses = vec![Hypothesis::of(LoadShape::Lateral)];
    let of_load = AnalysisOptions { hypotheses, given_lines: Vec::new(), ..unloaded() };
    for (name, case, options, films) in [
        ("given line", pulled(), unloaded(), 4),
        ("given distribution", pulled(), AnalysisOptions { rotation_prior, ..unloaded() }, 4),
        ("loaded reference", case(4), options(LOADED), 4),
        ("distributed load", spread, of_load, 2),
    ] {
        let mirrored_line = |&(posture, line): &(Posture, LineOfAction)| {
            let point = Frontal::new(-line.point.y_mm, line.point.z_mm);
            (other_side(posture), LineOfAction::leaning(point, -line.lateral_tilt()))
        };
        let given_lines = options.given_lines.iter().map(mirrored_line).collect();
        let image = case_of(case.films.iter().map(mirror_image).collect());
        let mirrored = with_tilt(&image, &AnalysisOptions { given_lines, ..options.clone() });
        let found = with_tilt(&case, &options);
        assert_eq!([found.len(), mirrored.len()], [films; 2], "{name}");
        for shape in &found {
            let (mm, posture) = (shape.mean_location_error_mm(), shape.posture);
            assert!(mm < NEAR_MM, "{name}, {posture}: {mm} mm");
            let image = mirrored.iter().find(|image| image.posture == other_side(posture));
            let image = image.expect("the same films");
            for (a, b) in shape.locations.iter().zip(&image.locations) {
                let off = a.distance_mm(Frontal::new(-b.y_mm, b.z_mm));
                assert!(off < MIRRORED_MM, "{name}, {posture}: {off} mm");
            }
            for (a, b) in shape.location_errors_mm.iter().zip(&image.location_errors_mm) {
                assert!((a - b).abs() < MIRRORED_MM, "{name}, {posture}: {a} and {b} mm");
            }
        }
    }
}
