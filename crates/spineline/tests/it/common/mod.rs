//! Helpers that the tests of this crate share.
#![allow(dead_code, reason = "`allocations.rs` uses a part of them")]

pub mod chain;
pub mod elastica;
pub mod everything;
pub mod independent;

use proptest::test_runner::{Config as ProptestConfig, RngSeed};
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::anatomy::{Level, PediclePlace, Posture, Region, SagittalProfile};
use spineline::clinical::{RegionBounds, Regions};
use spineline::error::Error;
use spineline::measure::{
    Film, FilmLandmarks, FilmLength, IliacCrests, ImageGeometry, LengthScale, MeasuredVertebra,
    Noise, Outline, Placement, Reading, ReadingId, Spacing, SpacingPlane, TiltRule,
    VertebraLandmarks, measure_film,
};
use spineline::multibody::{SpineModel, Support};
use spineline::spatial::{Angle, Frontal, Pixel};
use spineline::uncertainty::{MonteCarlo, Uncertainty};
use spineline::warning::{Warning, WarningCode, Warnings};
use spineline_phantom::{Phantom, Readers, Scenario, TrueBody, generate, mirror};

/// A small generator of numbers, so that "random" inputs are the same on every machine (xorshift64*).
pub struct Draw(u64);

impl Draw {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Uniform in a range.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        low + (high - low) * bits as f64 / (1_u64 << 53) as f64
    }

    /// A whole number below a limit.
    pub fn below(&mut self, limit: usize) -> usize {
        (self.between(0.0, limit as f64) as usize).min(limit - 1)
    }
}

/// Twenty-four cases from a fixed seed; `PROPTEST_CASES` and `PROPTEST_RNG_SEED` ask for others.
pub fn deterministic(seed: u64) -> ProptestConfig {
    let asked = |name: &str| std::env::var(name).ok().and_then(|number| number.parse().ok());
    ProptestConfig {
        cases: asked("PROPTEST_CASES").map_or(24, |cases: u64| cases as u32),
        rng_seed: RngSeed::Fixed(asked("PROPTEST_RNG_SEED").unwrap_or(seed)),
        failure_persistence: None,
        max_shrink_iters: 20,
        ..ProptestConfig::default()
    }
}

/// Panics unless two numbers agree within a tolerance relative to a scale.
#[track_caller]
pub fn assert_near(actual: f64, expected: f64, tolerance: f64, what: &str) {
    assert!(
        (actual - expected).abs() <= tolerance,
        "{what}: {actual:e} instead of {expected:e}, off by {:e} and not by at most {tolerance:e}",
        actual - expected
    );
}

/// The axial rotation that the pedicles of a body give after Stokes: its tangent is the true one times a ratio, the place of the
/// pedicles of the body over their place in the reader's table.
pub fn read_axial(body: &TrueBody) -> Angle {
    let [beside_mm, behind_mm] = body.pedicle_mm();
    let reader = PediclePlace::of(body.level);
    let share = (behind_mm / beside_mm) / (reader.behind_mm / reader.beside_mm);
    Angle::from_rad((share * body.axial.rad().tan()).atan())
}

/// Phantom of a subject (from 0), seed 1.
pub fn phantom(subject: usize, scenario: Scenario, readers: &Readers) -> Phantom {
    generate(subject, scenario, readers, 1)
        .expect("all 18 subjects have phantoms of every scenario")
}

/// A patient whose landmarks are exact, moved by prescribed rotations: the quickest phantom to make.
pub fn exact_case(subject: usize) -> Case {
    phantom(subject, Scenario::Bend, &Readers::exact()).case
}

/// A patient on a table.
pub fn on_a_table() -> AnalysisOptions {
    AnalysisOptions { support: Support::Frontal, ..Default::default() }
}

#[track_caller]
pub fn analyzed(case: &Case, options: &AnalysisOptions) -> Analysis {
    analyze(case, options).expect("a sound case")
}

/// The error that a case must end with.
#[track_caller]
pub fn refused(case: &Case) -> Error {
    let error = analyze(case, &on_a_table()).expect_err("a faulty case");
    assert!(!error.help().is_empty(), "no help for {error}");
    error
}

/// A film of a case.
pub fn film_mut(case: &mut Case, posture: Posture) -> &mut Film {
    case.film_mut(posture).expect("the case has this film")
}

/// The warning of a code, about a film where one is given.
#[track_caller]
pub fn warned(analysis: &Analysis, code: WarningCode, posture: Option<Posture>) -> &Warning {
    let mut all = analysis.warnings.all().iter();
    let found = all.find(|w| w.code == code && (posture.is_none() || w.posture == posture));
    let warning = found.unwrap_or_else(|| panic!("no {code:?} in {:?}", analysis.warnings.all()));
    assert!(!warning.message.is_empty());
    warning
}

/// Replicates from the first to a number of them, one after the other.
pub fn replicated(monte_carlo: &MonteCarlo<'_>, count: u64) -> Uncertainty {
    let mut tally = monte_carlo.tally();
    (0..count).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    tally.finish(count)
}

/// The parts of a film with landmarks.
pub fn landmarks(
    film: &mut Film,
) -> (&mut ImageGeometry, &mut Option<IliacCrests>, &mut Vec<Reading<VertebraLandmarks>>) {
    match &mut film.landmarks {
        FilmLandmarks::Corners { image, iliac_crests, readings } => (image, iliac_crests, readings),
        FilmLandmarks::Placements { .. } => panic!("phantoms have landmarks"),
    }
}

/// The spacing of a picture that has one.
pub fn spacing(image: &mut ImageGeometry) -> &mut Spacing {
    image.spacing.as_mut().expect("phantoms have a spacing")
}

/// One mark of the first reading.
pub fn landmarks_mut(case: &mut Case, posture: Posture, level: Level) -> &mut VertebraLandmarks {
    let (_, _, readings) = landmarks(film_mut(case, posture));
    readings[0].vertebrae.get_mut(&level).expect("phantoms mark every vertebra")
}

/// All landmarks of all readings of a film.
pub fn all_landmarks(film: &mut Film) -> impl Iterator<Item = &mut VertebraLandmarks> {
    let (_, _, readings) = landmarks(film);
    readings.iter_mut().flat_map(|reading| reading.vertebrae.values_mut())
}

/// Takes the corners and crests of a film to other places of its picture.
pub fn move_places(film: &mut Film, to: impl Fn(Pixel) -> Pixel) {
    all_landmarks(film).for_each(|landmark| landmark.corners = landmark.corners.map(&to));
    let (_, crests, _) = landmarks(film);
    *crests = crests.map(|crests| IliacCrests { left: to(crests.left), right: to(crests.right) });
}

/// Turns the axes of a film that were set by hand.
pub fn turn_axes(film: &mut Film, to: impl Fn(Angle) -> Angle) {
    all_landmarks(film)
        .for_each(|landmark| landmark.axis_clockwise = landmark.axis_clockwise.map(&to));
}

/// All pictures seen from the other side.
pub fn mirrored(case: &Case) -> Case {
    let mut case = case.clone();
    case.films.iter_mut().for_each(mirror);
    case
}

/// The same posture of the patient's mirror image.
pub fn other_side(posture: Posture) -> Posture {
    match posture {
        Posture::LeftBending => Posture::RightBending,
        Posture::RightBending => Posture::LeftBending,
        same => same,
    }
}

/// Moves every landmark of a film in the plane of the film; axes turned by hand turn with them.
///
/// The picture is made large enough, and the landmarks are shifted into its middle.
pub fn move_landmarks(film: &mut Film, turn: Angle, shift: Frontal) {
    let (image, ..) = landmarks(film);
    let old = *image;
    // A quarter of the largest film on each side.
    const MARGIN_MM: f64 = 900.0;
    let [columns, rows] = old.spacing.map_or([9_000.0; 2], |spacing| {
        [(MARGIN_MM / spacing.column_mm).floor(), (MARGIN_MM / spacing.row_mm).floor()]
    });
    image.columns += 2 * columns as u32;
    image.rows += 2 * rows as u32;
    let middle = Frontal::new(
        old.frontal(Pixel::new(columns, 0.0)).y_mm,
        old.frontal(Pixel::new(0.0, rows)).z_mm,
    );
    move_places(film, |place| old.pixel(old.frontal(place).rotated(turn) + shift + middle));
    turn_axes(film, |axis| old.tilt_from_clockwise(old.tilt_from_clockwise(axis) + turn));
}

/// A film from another program: locations and tilts.
pub fn placement_film(
    posture: Posture,
    vertebrae: impl IntoIterator<Item = (Level, Frontal, Angle)>,
) -> Film {
    let vertebrae = vertebrae
        .into_iter()
        .map(|(level, location, tilt)| (level, Placement::new(location, tilt)))
        .collect();
    let reading = Reading { id: ReadingId::new("A", 1), vertebrae };
    Film::new(posture, FilmLandmarks::placed(SpacingPlane::Patient, vec![reading]))
}

/// A film of vertebrae that stand on the graph `y(z)` at equal heights; `shape` gives `y` and `dy/dz`.
pub fn graph_film(posture: Posture, height_mm: f64, shape: impl Fn(f64) -> (f64, f64)) -> Film {
    let vertebrae = Level::MODEL.into_iter().enumerate().map(|(i, level)| {
        let z = height_mm * i as f64 / 14.0;
        let (y, slope) = shape(z);
        (level, Frontal::new(y, z), Angle::from_sin_cos(-slope, 1.0))
    });
    placement_film(posture, vertebrae)
}

pub fn case_of(films: Vec<Film>) -> Case {
    Case { synthetic: true, ..Case::of_films("test", films) }
}

pub fn measured(film: &Film) -> Outline {
    measure_film(film, TiltRule::default(), &mut Warnings::default()).expect("a sound film")
}

/// The erect outline of a subject and the unloaded spine that it gives.
pub fn spine(subject: usize) -> (Outline, SpineModel) {
    let case = exact_case(subject);
    let erect = measured(&case.films[0]);
    assert_eq!(erect.posture, Posture::Erect);
    let model = SpineModel::from_outline(&erect, &SagittalProfile::default());
    (erect, model)
}

/// Regions that end at the usual vertebrae T12 and T6.
pub fn usual_regions() -> Regions {
    let bounds =
        |region, inferior, apex, superior| RegionBounds { region, inferior, apex, superior };
    Regions {
        bounds: [
            bounds(Region::ThoracolumbarLumbar, 0, 2, 4),
            bounds(Region::MainThoracic, 4, 7, 10),
            bounds(Region::ProximalThoracic, 10, 12, 14),
        ],
        are_curves: false,
    }
}

/// An outline made of given locations and tilts, already in the global frame.
pub fn outline(posture: Posture, vertebrae: &[(Frontal, Angle)]) -> Outline {
    let vertebrae = Level::MODEL
        .into_iter()
        .zip(vertebrae)
        .map(|(level, &(location, tilt))| {
            MeasuredVertebra::of_mean(level, Placement::new(location, tilt), 1)
        })
        .collect();
    Outline {
        posture,
        vertebrae,
        others: Vec::new(),
        iliac_normal: None,
        iliac_middle: None,
        vertical: None,
        l4_on_film: Angle::ZERO,
        l4_midpoint_on_film: Frontal::default(),
        amplitude_ends: Default::default(),
        noise: Noise::ONE_READING,
        shared_errors: None,
        scale: LengthScale::stated(SpacingPlane::Patient, None),
        length: FilmLength::ERECT,
        readings: 1,
    }
}

/// The erect spine after every link turned with its two vertebrae: angles of links by complex numbers.
pub fn turned(erect: &Outline, tilts: &[f64]) -> Vec<Frontal> {
    let mut at = Frontal::default();
    let mut all = vec![at];
    for (pair, turn) in erect.vertebrae.windows(2).zip(tilts.windows(2)) {
        let link = pair[1].location - pair[0].location;
        let half = |turn: f64| {
            let (sin, cos) = turn.sin_cos();
            Frontal::new(
                0.5 * (cos * link.y_mm - sin * link.z_mm),
                0.5 * (sin * link.y_mm + cos * link.z_mm),
            )
        };
        at = at + half(turn[0]) + half(turn[1]);
        all.push(at);
    }
    all
}
