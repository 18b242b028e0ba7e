//! How often films are doubted: films of sound patients, and films that were exchanged, mirrored or read twice.

use std::collections::BTreeMap;

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};
use rayon::prelude::*;
use spineline::analysis::{AnalysisOptions, Case, analyze_movement};
use spineline::anatomy::Posture;
use spineline::measure::{Corners, Film, FilmLandmarks};
use spineline::spatial::Pixel;
use spineline_phantom::{
    Build, Construction, Readers, SUBJECTS, Scenario, exchange_sides, generate_built,
};

/// Codes of a case: of its doubts, or of the error that refuses it.
fn codes(case: &Case) -> Vec<&'static str> {
    match analyze_movement(case, &AnalysisOptions::default()) {
        Ok(analysis) => {
            let mut codes: Vec<&str> = analysis.film_doubts().map(|one| one.code.key()).collect();
            codes.sort_unstable();
            codes.dedup();
            codes
        }
        Err(error) => vec![error.code()],
    }
}

fn film_mut(case: &mut Case, posture: Posture) -> &mut Film {
    case.film_mut(posture).expect("all films")
}

/// Gives a posture the film of another one, marked by other readers of the same kind.
fn read_again(case: &mut Case, (from, to): (Posture, Posture), readers: &Readers, seed: u64) {
    let mut landmarks = film_mut(case, from).landmarks.clone();
    let FilmLandmarks::Corners { image, readings, .. } = &mut landmarks else {
        panic!("phantoms have corners")
    };
    let [column_mm, row_mm] = image.spacing.map_or([1.0; 2], |one| [one.column_mm, one.row_mm]);
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    // The copied readings already have an error.
    let sd_mm = (2.0_f64).sqrt() * readers.corner_sd_mm.hypot(readers.corner_bias_sd_mm);
    let corner = Normal::new(0.0, sd_mm).expect("a deviation");
    let axis_sd = readers.axis_sd.rad().hypot(readers.axis_bias_sd.rad());
    let axis = Normal::new(0.0, (2.0_f64).sqrt() * axis_sd).expect("a deviation");
    for landmark in readings.iter_mut().flat_map(|one| one.vertebrae.values_mut()) {
        let moved = landmark.corners.points().map(|place| {
            Pixel::new(
                place.column_px + corner.sample(&mut rng) / column_mm,
                place.row_px + corner.sample(&mut rng) / row_mm,
            )
        });
        landmark.corners = Corners::from(moved);
        let by = spineline::spatial::Angle::from_rad(axis.sample(&mut rng));
        landmark.axis_clockwise = landmark.axis_clockwise.map(|axis| axis + by);
    }
    film_mut(case, to).landmarks = landmarks;
}

/// Faults of a sound case, each with codes of which one has to be found.
const FAULTS: [(&str, &[&str]); 8] = [
    ("bends exchanged", &["bends_exchanged", "bend_leans_away", "film_looks_mirrored"]),
    ("left bend mirrored", &["bends_exchanged", "bend_leans_away", "film_looks_mirrored"]),
    ("right bend mirrored", &["bends_exchanged", "bend_leans_away", "film_looks_mirrored"]),
    ("neutral film mirrored", &["film_looks_mirrored"]),
    ("erect film as left bend", &["bend_keeps_shape"]),
    ("erect film as neutral one", &["films_show_one_shape"]),
    ("neutral film as traction", &["films_show_one_shape"]),
    ("left bend as right bend", &["films_show_one_shape", "bends_exchanged", "bend_leans_away"]),
];

fn with_fault(sound: &Case, fault: usize, readers: &Readers, seed: u64) -> Case {
    use Posture::{Erect, LeftBending, Neutral, RightBending, Traction};
    let mut case = sound.clone();
    match fault {
        0 => {
            for film in &mut case.films {
                film.posture = match film.posture {
                    LeftBending => RightBending,
                    RightBending => LeftBending,
                    same => same,
                };
            }
        }
        1 => exchange_sides(film_mut(&mut case, LeftBending)),
        2 => exchange_sides(film_mut(&mut case, RightBending)),
        3 => exchange_sides(film_mut(&mut case, Neutral)),
        4 => read_again(&mut case, (Erect, LeftBending), readers, seed),
        5 => read_again(&mut case, (Erect, Neutral), readers, seed),
        6 => read_again(&mut case, (Neutral, Traction), readers, seed),
        _ => read_again(&mut case, (LeftBending, RightBending), readers, seed),
    }
    case
}

/// Sound patients by doubt or error, patients with a found fault, and all.
#[derive(Default)]
struct Counts {
    patients: usize,
    doubted: usize,
    false_alarms: BTreeMap<&'static str, usize>,
    found: [usize; FAULTS.len()],
}

impl Counts {
    fn of(case: &Case, readers: &Readers, seed: u64) -> Self {
        let sound = codes(case);
        let found = std::array::from_fn(|fault| {
            let codes = codes(&with_fault(case, fault, readers, seed));
            usize::from(codes.iter().any(|code| FAULTS[fault].1.contains(code)))
        });
        Self {
            patients: 1,
            doubted: usize::from(!sound.is_empty()),
            false_alarms: sound.into_iter().map(|code| (code, 1)).collect(),
            found,
        }
    }

    fn and(mut self, other: Self) -> Self {
        self.patients += other.patients;
        self.doubted += other.doubted;
        for (code, count) in other.false_alarms {
            *self.false_alarms.entry(code).or_default() += count;
        }
        self.found = std::array::from_fn(|fault| self.found[fault] + other.found[fault]);
        self
    }
}

/// One observer who reads once, or the default two observers who read three times, with every deviation multiplied.
fn readers(observers: u32, noise: f64) -> Readers {
    let repeats = if observers == 1 { 1 } else { 3 };
    Readers { observers, repeats, ..Readers::scaled(noise) }
}

fn study(
    (scenario, construction): (Scenario, Construction),
    readers: &Readers,
    patients: &[(usize, u64)],
) -> Counts {
    let build = Build { construction, joint_log_sd: 0.2 };
    let of = |&(index, seed): &(usize, u64)| {
        let phantom = generate_built(index, scenario, readers, seed, build);
        phantom.map_or_else(|_| Counts::default(), |one| Counts::of(&one.case, readers, seed))
    };
    patients.par_iter().map(of).reduce(Counts::default, Counts::and)
}

const SPINES: [(Scenario, Construction); 9] = [
    (Scenario::Rod, Construction::Rod),
    (Scenario::Rod, Construction::Discs),
    (Scenario::Rod, Construction::Hinges),
    (Scenario::Pull, Construction::Rod),
    (Scenario::Pull, Construction::Discs),
    (Scenario::Pull, Construction::Hinges),
    (Scenario::Spread, Construction::Discs),
    (Scenario::Bend, Construction::Rod),
    (Scenario::Flatten, Construction::Rod),
];

/// Observers, and the factor on their errors. Noise hides some faults of one observer with three times the usual
/// errors, because the size of the errors is unknown.
const READERS: [(u32, f64); 4] = [(1, 1.0), (1, 3.0), (2, 1.0), (2, 3.0)];

/// Prints a row per spine and kind of readers, and returns the sums by kind of readers.
fn all_spines(patients: &[(usize, u64)]) -> [Counts; READERS.len()] {
    READERS.map(|(observers, noise)| {
        let mut sum = Counts::default();
        for spine in SPINES {
            let counts = study(spine, &readers(observers, noise), patients);
            println!(
                "synthetic, {}, {}, {observers} observers, noise {noise}: {} of {} sound patients doubted {:?}; found {:?}",
                spine.0.key(),
                spine.1.key(),
                counts.doubted,
                counts.patients,
                counts.false_alarms,
                counts.found
            );
            sum = sum.and(counts);
        }
        println!("{} of {} doubted: {:?}", sum.doubted, sum.patients, sum.false_alarms);
        for (found, (fault, _)) in sum.found.iter().zip(FAULTS) {
            println!("{fault}: {found} of {} found", sum.patients);
        }
        sum
    })
}

/// Oracle: the phantoms' films are what their names state, until a fault is made. Movements that flatten the curve are
/// not bends, so their exchange cannot be seen: a ninth of the patients.
fn check(by_readers: &[Counts], max_false: f64, min_found: f64) {
    for (counts, readers) in by_readers.iter().zip(READERS) {
        let part = |count: usize| count as f64 / counts.patients as f64;
        assert!(part(counts.doubted) <= max_false, "{readers:?}: {} doubted", counts.doubted);
        for (found, (fault, _)) in counts.found.iter().zip(FAULTS) {
            let is_hidden = readers == (1, 3.0);
            assert!(is_hidden || part(*found) >= min_found, "{readers:?}, {fault}: {found}");
        }
    }
}

#[test]
fn sound_films_are_not_doubted_and_wrong_ones_are() {
    let patients: Vec<(usize, u64)> = (0..SUBJECTS.len()).step_by(6).map(|i| (i, 11)).collect();
    check(&all_spines(&patients), 0.04, 0.8);
}

/// The study behind the table in `validation/warnings.md`.
#[test]
#[ignore = "minutes: cargo test --release -p spineline-phantom --test it film_doubts -- --ignored --nocapture"]
fn films_of_a_thousand_patients() {
    let patients: Vec<(usize, u64)> =
        (21..=22).flat_map(|seed| (0..SUBJECTS.len()).map(move |index| (index, seed))).collect();
    check(&all_spines(&patients), 0.02, 0.85);
}
