//! How often regions, intervals and tests of the line of action are right, on synthetic patients with a known line or with
//! loads that no line describes, read with noise.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::Matrix4;
use rayon::prelude::*;
use spineline::action::{LineKind, LineOfAction};
use spineline::analysis::{Analysis, AnalysisOptions, FilmMovement, analyze};
use spineline::anatomy::Posture;
use spineline::personalize::{BestFitLoads, Crossing, ProposedLine, TestOutcome};
use spineline::spatial::Frontal;
use spineline_phantom::{
    Build, Construction, Phantom, Readers, SUBJECTS, Scenario, TruePosture, generate_built,
};

const FOUND: &str = "the load is found, and two inflections";
const CONVERGED: &str = "the fit of the films' own loads converges";
const INFLECTION: &str = "an inflection is in its 95 % interval";
const STIFFNESS: &str = "the mean stiffness of a region is in its 95 % interval";
const REGION: &str = "the true line of a bend is in the 95 % region";
const REGION_AT_REST: &str = "the true line of a neutral or traction film is in the 95 % region";
const CROSSING: &str = "the true line crosses within the 95 % interval";
const BY_INFLECTIONS: &str = "'through the inflections' is rejected";
const BY_ILIAC: &str = "'parallel to the iliac line' is rejected";
const BY_PETIT: &str = "'through T2, parallel to the iliac line' is rejected";
const PATIENT_BY_INFLECTIONS: &str = "the bends of a patient reject the inflection line";
const PATIENT_BY_ILIAC: &str = "the bends of a patient reject the iliac line";

/// Standard deviation of a coordinate of a crest, as these observers mark it.
const CREST_SD_MM: f64 = 1.5;

/// How often each result is true, out of how many, by patient.
type Counts = BTreeMap<&'static str, Vec<[usize; 2]>>;

/// One kind of synthetic patients.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Kind {
    construction: Construction,
    scenario: Scenario,
    /// Observers, each of whom reads every film once.
    observers: u32,
}

/// Observers with biases for every corner, who mark crests roughly and set no axis by hand: tilts come from corners.
fn readers(observers: u32) -> Readers {
    Readers {
        observers,
        repeats: 1,
        corner_sd_mm: 0.5,
        corner_bias_sd_mm: 0.35,
        crest_sd_mm: CREST_SD_MM,
        rounded: false,
        ..Readers::default()
    }
}

/// A patient; every second one has films whose scales differ by 3 %. `None` if the spine buckles before it is bent far
/// enough.
fn patient(kind: Kind, index: usize, seed: u64) -> Option<Phantom> {
    let build = Build { construction: kind.construction, joint_log_sd: joint_log_sd(kind) };
    let phantom =
        generate_built(index, kind.scenario, &readers(kind.observers), seed, build).ok()?;
    let scaled = (index as u64 + seed).is_multiple_of(2);
    Some(if scaled { phantom.with_film_lengths(0.03, index, seed) } else { phantom })
}

/// The joints of some constructions differ already.
fn joint_log_sd(kind: Kind) -> f64 {
    match kind.construction {
        Construction::Rod | Construction::Discs | Construction::Hinges => 0.12,
        Construction::Elastica | Construction::Wedges | Construction::Stiffening => 0.0,
    }
}

/// From the true frame to the frame of the film as read: L4's frame, which moves with the reading of L4. It is found
/// from all vertebrae together.
fn as_read(truth: &TruePosture, posture: &FilmMovement) -> impl Fn(Frontal) -> Frontal {
    let read: Vec<Frontal> = posture.outline.vertebrae.iter().map(|v| v.location).collect();
    let mean = |places: &[Frontal]| {
        places.iter().fold(Frontal::default(), |sum, place| sum + *place)
            * (1.0 / places.len() as f64)
    };
    let (middle, true_middle) = (mean(&read), mean(&truth.locations));
    // The rotation that brings true places nearest to the read ones.
    let pairs = truth.locations.iter().zip(&read).map(|(a, b)| (*a - true_middle, *b - middle));
    let (cross, dot) = pairs.fold((0.0, 0.0), |(c, d), (a, b)| (c + a.cross(b), d + a.dot(b)));
    let (sin, cos) = (cross / cross.hypot(dot), dot / cross.hypot(dot));
    move |place| {
        let v = place - true_middle;
        middle + Frontal::new(cos * v.y_mm - sin * v.z_mm, sin * v.y_mm + cos * v.z_mm)
    }
}

/// The results of one patient.
fn count(kind: Kind, index: usize, seed: u64) -> BTreeMap<&'static str, [usize; 2]> {
    let mut counts = BTreeMap::from([(FOUND, [0, 1])]);
    let Some(phantom) = &patient(kind, index, seed) else { return counts };
    let analysis = &analyze(&phantom.case, &AnalysisOptions::default()).expect("a sound case");
    if analysis.movement.inflections.pair.is_none() {
        return counts;
    }
    counts.insert(FOUND, [1, 1]);
    let mut add = |what, right: bool| {
        let [yes, all] = counts.entry(what).or_insert([0; 2]);
        *yes += usize::from(right);
        *all += 1;
    };
    let erect = phantom.posture(Posture::Erect).expect("a film");
    let intervals = analysis.movement.inflection_intervals.expect("a pair of inflections");
    for (truth, interval) in erect.inflections.iter().zip(intervals.each) {
        // An unlimited interval contains everything.
        let z_mm = as_read(erect, analysis.movement.erect())(*truth).z_mm;
        add(
            INFLECTION,
            interval.is_none_or(|found| (found.t_mm[0]..=found.t_mm[1]).contains(&z_mm)),
        );
    }
    stiffness_held(phantom, analysis).into_iter().for_each(|held| add(STIFFNESS, held));
    let loads = analysis.best_fit_loads();
    add(CONVERGED, loads.is_ok());
    let Ok(loads) = loads else { return counts };
    let moved = analysis.movement.films.iter().filter(|posture| posture.evidence.is_some());
    for (film, posture) in moved.enumerate() {
        let truth = phantom.posture(posture.outline.posture).expect("a film");
        true_line(&loads, film, posture, truth, &mut add);
        if posture.outline.posture.bend().is_some() {
            rejections(&loads, film, posture, &mut add);
        }
    }
    for (kind, what) in
        [(LineKind::Inflection, PATIENT_BY_INFLECTIONS), (LineKind::Iliac, PATIENT_BY_ILIAC)]
    {
        match analysis.model(kind).map(|model| analysis.compatibility(model).outcome()) {
            Some(TestOutcome::Rejected) => add(what, true),
            Some(TestOutcome::Kept) => add(what, false),
            Some(TestOutcome::NotTested) | None => {}
        }
    }
    counts
}

/// The true line in its region and crossings, where there is one.
fn true_line(
    loads: &BestFitLoads,
    film: usize,
    posture: &FilmMovement,
    truth: &TruePosture,
    add: &mut impl FnMut(&'static str, bool),
) {
    let Some(true_line) = truth.line else { return };
    let placed = as_read(truth, posture);
    let points = [0.0, 100.0].map(|mm| placed(true_line.point + true_line.direction * mm));
    let line = LineOfAction::through(points[0], points[1]).expect("two points");
    let proposal = ProposedLine::Through { points, covariance: Matrix4::zeros() };
    let what = if truth.posture.bend().is_some() { REGION } else { REGION_AT_REST };
    add(what, !loads.test(film, &proposal).expect("a load").rejects());
    let Some(own) = &posture.best_fit_line else { return };
    // A nearly horizontal line crosses anywhere.
    for at in own.crossings.iter().filter(|_| line.direction.z_mm.abs() > 0.2) {
        let y_mm = line.y_mm_at(at.z_mm);
        let right = match at.within {
            Crossing::Between([low, high]) => (low..=high).contains(&y_mm),
            Crossing::Open => true,
        };
        add(CROSSING, right);
    }
}

/// Which lines are rejected on a bend.
fn rejections(
    loads: &BestFitLoads,
    film: usize,
    posture: &FilmMovement,
    add: &mut impl FnMut(&'static str, bool),
) {
    // On films with little movement, the load is rarely (once in thousands) a couple, which has no line.
    let Some(own) = &posture.best_fit_line else { return };
    add(BY_INFLECTIONS, own.inflection.expect("two inflections").test.rejects());
    add(BY_ILIAC, own.iliac.expect("marked crests").test.rejects());
    let t2 = posture.outline.top();
    let petit = LineOfAction::along_iliac(t2, posture.outline.iliac_normal);
    // Errors of two crests, 220 mm apart, move a point at 100 mm across the line.
    let across_mm = 100.0 * f64::sqrt(2.0) * CREST_SD_MM / 220.0;
    let place_mm2 = posture.outline.noise.location_mm.powi(2);
    let mut covariance = Matrix4::from_fn(|i, j| if i % 2 == j % 2 { place_mm2 } else { 0.0 });
    covariance[(3, 3)] += across_mm * across_mm;
    let points = [t2, t2 + petit.direction * 100.0];
    let test = loads.test(film, &ProposedLine::Through { points, covariance });
    add(BY_PETIT, test.expect("a load").rejects());
}

/// Whether the intervals that `--identifiability` shows for the model with the true line hold the means of `ln` stiffness
/// over the joints of the regions, under the scale constraint.
fn stiffness_held(phantom: &Phantom, analysis: &Analysis) -> Vec<bool> {
    let kind = match phantom.scenario {
        Scenario::Rod => LineKind::Inflection,
        Scenario::Pull => LineKind::Iliac,
        _ => return Vec::new(),
    };
    let Some(model) = analysis.model(kind) else { return Vec::new() };
    let Some(found) = analysis.identifiability(model) else { return Vec::new() };
    let mean = |group: usize| {
        let joints = model.groups.of_joint().iter().zip(&phantom.joint_logs);
        let own: Vec<f64> = joints.filter(|(g, _)| **g == group).map(|(_, log)| *log).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    let logs: Vec<f64> = (0..model.groups.len()).map(mean).collect();
    let level = logs.iter().sum::<f64>() / logs.len() as f64;
    let intervals = found.multipliers.iter().zip(&logs).filter_map(|(one, log)| {
        let [low, high] = one.stiffness?.log_interval_95();
        Some((low..=high).contains(&(log - level)))
    });
    intervals.collect()
}

/// Counts over sets of the 18 subjects, one per seed.
fn study(kind: Kind, seeds: &RangeInclusive<u64>) -> Counts {
    let patients: Vec<(u64, usize)> = seeds
        .clone()
        .flat_map(|seed| (0..SUBJECTS.len()).map(move |index| (seed, index)))
        .collect();
    let by_patient: Vec<_> =
        patients.par_iter().map(|&(seed, index)| count(kind, index, seed)).collect();
    let mut sum = Counts::new();
    for (what, numbers) in by_patient.into_iter().flatten() {
        sum.entry(what).or_default().push(numbers);
    }
    sum
}

/// A share, and its standard error over patients.
#[derive(Debug, Clone, Copy)]
struct Share {
    part: f64,
    error: f64,
    patients: usize,
}

impl Share {
    fn of(counts: &Counts, what: &str) -> Option<Self> {
        let all = counts.get(what)?;
        let sum = |i: usize| all.iter().map(|one| one[i] as f64).sum::<f64>();
        let (yes, tries) = (sum(0), sum(1));
        let part = yes / tries;
        let off = all.iter().map(|one| (one[0] as f64 - part * one[1] as f64).powi(2));
        Some(Self { part, error: off.sum::<f64>().sqrt() / tries, patients: all.len() })
    }

    /// The share that is not exceeded once in thousands, were `part` the true one: tries of one patient count once.
    fn limit(self, part: f64, sense: f64) -> f64 {
        part + sense * 3.3 * (part * (1.0 - part) / self.patients as f64).sqrt()
    }
}

/// What was counted on which loading scenario, in the words of `validation/claims.md`.
const ROWS: [(&str, Scenario, &str); 17] = [
    ("true inflection in its interval", Scenario::Rod, INFLECTION),
    ("true inflection line in its region", Scenario::Rod, REGION),
    ("true line of Petit in its region", Scenario::Pull, REGION),
    ("the same, neutral and traction", Scenario::Pull, REGION_AT_REST),
    ("mean stiffness in its interval, inflection line", Scenario::Rod, STIFFNESS),
    ("mean stiffness in its interval, Petit's line", Scenario::Pull, STIFFNESS),
    ("true inflection line rejected", Scenario::Rod, BY_INFLECTIONS),
    ("the same, all bends of a patient", Scenario::Rod, PATIENT_BY_INFLECTIONS),
    ("true iliac line rejected", Scenario::Pull, BY_ILIAC),
    ("the same, all bends of a patient", Scenario::Pull, PATIENT_BY_ILIAC),
    ("true line of Petit rejected, direction and T2", Scenario::Pull, BY_PETIT),
    ("weight and couple: inflection line rejected", Scenario::WeightAndCouple, BY_INFLECTIONS),
    ("weight and couple: iliac line rejected", Scenario::WeightAndCouple, BY_ILIAC),
    ("weight and couple: Petit's line rejected", Scenario::WeightAndCouple, BY_PETIT),
    ("two pads: inflection line rejected", Scenario::Pads, BY_INFLECTIONS),
    ("two pads: iliac line rejected", Scenario::Pads, BY_ILIAC),
    ("two pads: Petit's line rejected", Scenario::Pads, BY_PETIT),
];

/// Prints a table of shares in %, with standard errors over patients.
fn print(observers: u32, all: &[(Kind, Counts)]) {
    let titles = Construction::ALL.map(|construction| format!(" `{}` |", construction.key()));
    println!("| {observers} readings of each film |{}", titles.concat());
    println!("|---|{}", "---|".repeat(titles.len()));
    for (title, scenario, what) in ROWS {
        let cell = |construction| {
            let kind = Kind { construction, scenario, observers };
            let (_, counts) = all.iter().find(|(own, _)| *own == kind).expect("studied");
            let Share { part, error, .. } = Share::of(counts, what).expect("counted");
            format!(" {:.0} ± {:.0} |", 100.0 * part, 100.0 * error)
        };
        println!("| {title} |{}", Construction::ALL.map(cell).concat());
    }
}

/// Shares of a kind that a study may not leave, beside what chance explains.
struct Bounds {
    /// Least share of true lines of bends in their region.
    region: f64,
    /// Least share of regions whose mean stiffness is in its interval.
    stiffness: f64,
    /// Greatest share of bends, and of patients, on which the true line is rejected.
    rejected: f64,
}

/// After the tables in `validation/claims.md`.
fn bounds(kind: Kind) -> Bounds {
    use Construction as C;
    let [region, stiffness, rejected] = match (kind.construction, kind.scenario) {
        (C::Rod | C::Discs | C::Hinges | C::Elastica, Scenario::Pull) => [0.91, 0.9, 0.12],
        (C::Wedges, Scenario::Pull) => [0.85, 0.9, 0.12],
        (C::Stiffening, Scenario::Pull) => [0.78, 0.68, 0.12],
        (C::Stiffening, _) => [0.95, 0.81, 0.05],
        _ => [0.95, 0.92, 0.05],
    };
    Bounds { region, stiffness, rejected }
}

/// The true line and inflections of a kind against its bounds, and a false line, which is rejected.
fn check(kind: Kind, counts: &Counts) {
    let bounds = bounds(kind);
    let share = |what| Share::of(counts, what).expect("counted");
    let least = |what, part: f64| {
        let share = share(what);
        assert!(share.part >= share.limit(part, -1.0), "{kind:?}: {what}: {share:?}");
    };
    let most = |what, part: f64| {
        let share = share(what);
        assert!(share.part <= share.limit(part, 1.0), "{kind:?}: {what}: {share:?}");
    };
    least(FOUND, 0.97);
    least(CONVERGED, 0.98);
    least(INFLECTION, 0.95);
    let (obeyed, by_patient, broken) = match kind.scenario {
        Scenario::Rod => (BY_INFLECTIONS, PATIENT_BY_INFLECTIONS, BY_ILIAC),
        Scenario::Pull => (BY_ILIAC, PATIENT_BY_ILIAC, BY_INFLECTIONS),
        _ => return,
    };
    least(REGION, bounds.region);
    least(STIFFNESS, bounds.stiffness);
    most(obeyed, bounds.rejected);
    most(by_patient, bounds.rejected);
    least(broken, 0.95);
}

#[test]
fn regions_contain_the_true_line_and_tests_keep_their_size() {
    // Oracle: the true line.
    for construction in [Construction::Rod, Construction::Elastica, Construction::Stiffening] {
        for scenario in [Scenario::Rod, Scenario::Pull] {
            let kind = Kind { construction, scenario, observers: 2 };
            check(kind, &study(kind, &(1..=1)));
        }
    }
}

/// Every construction with a true line, and with loads that no line describes; with two readings of each film and
/// with one, whose noise is assumed.
fn over_all_spines(seeds: &RangeInclusive<u64>) {
    let scenarios = [Scenario::Rod, Scenario::Pull, Scenario::WeightAndCouple, Scenario::Pads];
    for observers in [2, 1] {
        let mut all = Vec::new();
        for construction in Construction::ALL {
            for scenario in scenarios {
                let kind = Kind { construction, scenario, observers };
                let counts = study(kind, seeds);
                let Share { part, patients, .. } = Share::of(&counts, FOUND).expect("counted");
                println!("synthetic, {kind:?}: {:.1} % of {patients} patients", 100.0 * part);
                all.push((kind, counts));
            }
        }
        print(observers, &all);
        all.iter().for_each(|(kind, counts)| check(*kind, counts));
    }
}

/// A part of the study below.
#[test]
#[ignore = "minutes: cargo test --release -p spineline-phantom --test it line_regions::over_hundreds -- --ignored --nocapture"]
fn over_hundreds_of_patients() {
    over_all_spines(&(9001..=9001));
}

/// The study behind the tables in `validation/claims.md`.
#[test]
#[ignore = "ten minutes: cargo test --release -p spineline-phantom --test it line_regions::over_thousands -- --ignored --nocapture"]
fn over_thousands_of_patients() {
    over_all_spines(&(9001..=9004));
}
