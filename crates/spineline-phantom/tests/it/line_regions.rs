//! How often regions and tests of the line of action are right: synthetic patients whose line is known, read with noise.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use nalgebra::Matrix4;
use rayon::prelude::*;
use spineline::action::LineOfAction;
use spineline::analysis::{Analysis, AnalysisOptions, PostureAnalysis, analyze};
use spineline::anatomy::Posture;
use spineline::personalize::{Crossing, ProposedLine};
use spineline::spatial::Frontal;
use spineline_phantom::{Readers, SUBJECTS, TruePosture, Truth, generate_varied};

const REGION: &str = "the true line is in the 95 % region";
const SETTLED: &str = "the fit of the films' own loads settles";
const CROSSING: &str = "the true line crosses within the 95 % interval";

/// How often each of several things was so.
type Counts = BTreeMap<(Posture, &'static str), [usize; 2]>;

/// A true line in the frame of the film as it was read: that is L4's, which turns and shifts as L4 is read. All vertebrae
/// together show where it lies.
fn as_read(line: &LineOfAction, truth: &TruePosture, posture: &PostureAnalysis) -> LineOfAction {
    let read: Vec<Frontal> = posture.outline.vertebrae.iter().map(|v| v.location).collect();
    let mean = |places: &[Frontal]| {
        places.iter().fold(Frontal::default(), |sum, place| sum + *place)
            * (1.0 / places.len() as f64)
    };
    let (middle, true_middle) = (mean(&read), mean(&truth.locations));
    // The turn that brings true places nearest to those read.
    let pairs = truth.locations.iter().zip(&read).map(|(a, b)| (*a - true_middle, *b - middle));
    let (cross, dot) = pairs.fold((0.0, 0.0), |(c, d), (a, b)| (c + a.cross(b), d + a.dot(b)));
    let (sin, cos) = (cross / cross.hypot(dot), dot / cross.hypot(dot));
    let turned =
        |v: Frontal| Frontal::new(cos * v.y_mm - sin * v.z_mm, sin * v.y_mm + cos * v.z_mm);
    let mut line = *line;
    line.point = middle + turned(line.point - true_middle);
    line.direction = turned(line.direction);
    line
}

fn count(phantom: &spineline_phantom::Phantom, analysis: &Analysis, counts: &mut Counts) {
    let loads = analysis.preferred_loads();
    // One fit for all films: it is kept under the one that has no load.
    let [settled, all] = counts.entry((Posture::Erect, SETTLED)).or_default();
    *settled += usize::from(loads.is_some());
    *all += 1;
    let Some(loads) = loads else { return };
    let moved = analysis.postures.iter().filter(|posture| posture.evidence.is_some());
    for (film, posture) in moved.enumerate() {
        let name = posture.outline.posture;
        let mut add = |what, right: bool| {
            let [yes, all] = counts.entry((name, what)).or_default();
            *yes += usize::from(right);
            *all += 1;
        };
        let truth = phantom.posture(name).expect("a film");
        let line = as_read(&truth.line.expect("a known line"), truth, posture);
        let points = [line.point, line.point + line.direction * 100.0];
        let proposal = ProposedLine::Through { points, covariance: Matrix4::zeros() };
        let test = loads.test(film, &proposal).expect("a load");
        add(REGION, !test.rejects());
        let own = posture.preferred_line.as_ref().expect("a line");
        let inflection = own.inflection.expect("two inflections").test;
        add("'through the inflections' is not rejected", !inflection.rejects());
        let iliac = own.iliac.expect("marked crests");
        add("'parallel to the iliac line' is not rejected", !iliac.rejects());
        for at in own.crossings.iter().filter(|_| line.direction.z_mm.abs() > 0.2) {
            let y_mm = line.y_mm_at(at.z_mm);
            let right = match at.within {
                Crossing::Between([low, high]) => (low..=high).contains(&y_mm),
                Crossing::Open => true,
            };
            add(CROSSING, right);
        }
    }
}

/// Counts over sets of the 18 subjects, one per seed, whose joints may differ from one another.
fn study(truth: Truth, seeds: RangeInclusive<u64>, joint_log_sd: f64) -> Counts {
    let patients: Vec<(u64, usize)> =
        seeds.flat_map(|seed| (0..SUBJECTS.len()).map(move |index| (seed, index))).collect();
    let counts: Vec<Counts> = patients
        .par_iter()
        .map(|&(seed, index)| {
            let mut counts = Counts::new();
            let phantom = generate_varied(index, truth, &Readers::default(), seed, joint_log_sd)
                .expect("a phantom");
            let analysis =
                analyze(&phantom.case, &AnalysisOptions::default()).expect("a sound case");
            if analysis.inflections.pair.is_some() {
                count(&phantom, &analysis, &mut counts);
            }
            counts
        })
        .collect();
    let mut sum = Counts::new();
    for (key, [yes, all]) in counts.into_iter().flatten() {
        let total = sum.entry(key).or_default();
        *total = [total[0] + yes, total[1] + all];
    }
    sum
}

fn share(counts: &Counts, posture: Posture, what: &'static str) -> f64 {
    let [yes, all] = counts[&(posture, what)];
    yes as f64 / all as f64
}

fn print(truth: Truth, joint_log_sd: f64, counts: &Counts) {
    println!("synthetic, {} ({}), joints differ by {joint_log_sd}", truth.key(), truth.meaning());
    for ((posture, what), [yes, all]) in counts {
        println!("  {posture}: {what}: {yes} of {all}, {:.1} %", 100.0 * *yes as f64 / *all as f64);
    }
}

/// The hypothesis that each truth obeys, and one that it breaks.
fn check(truth: Truth, counts: &Counts, right: RangeInclusive<f64>) {
    let (inflection, iliac) = (
        "'through the inflections' is not rejected",
        "'parallel to the iliac line' is not rejected",
    );
    assert!(share(counts, Posture::Erect, SETTLED) > 0.99, "{truth:?}");
    for posture in Posture::MOVED {
        let region = share(counts, posture, REGION);
        assert!(right.contains(&region), "{truth:?}, {posture}: {region}");
        // The other lines of pulled spines are nearly horizontal, and cross anywhere.
        if truth == Truth::Rod || posture == Posture::Traction {
            let crossing = share(counts, posture, CROSSING);
            assert!(right.contains(&crossing), "{truth:?}, {posture}: {crossing}");
        }
        let (obeyed, broken) = match (truth, posture) {
            // Its traction is a cranial force at T2.
            (Truth::Pull, Posture::Traction) => continue,
            (Truth::Pull, _) => (iliac, inflection),
            _ => (inflection, iliac),
        };
        let kept = share(counts, posture, obeyed);
        assert!(right.contains(&kept), "{truth:?}, {posture}: {obeyed} in {kept}");
        let missed = share(counts, posture, broken);
        assert!(missed < 0.2, "{truth:?}, {posture}: {broken} in {missed}");
    }
}

#[test]
fn regions_contain_the_true_line_and_tests_keep_their_size() {
    // Oracle: the line that made the films. Of 36 patients 95 % are 34; fewer than 29 come by chance once in 200 times.
    for truth in [Truth::Rod, Truth::Pull] {
        check(truth, &study(truth, 1..=2, 0.0), 0.8..=1.0);
    }
}

/// The study behind the rows in `validation/README.md`: some minutes in a release build. The priors of deviations were chosen
/// with sets 1 to 168 and 1001 to 1168 in view; these are others.
#[test]
#[ignore = "over 2,000 patients per truth: cargo test --release -p spineline-phantom --test it line_regions -- --ignored --nocapture"]
fn over_two_thousand_patients() {
    for (truth, joint_log_sd) in
        [Truth::Rod, Truth::Pull].into_iter().flat_map(|truth| [(truth, 0.0), (truth, 0.1)])
    {
        let counts = study(truth, 2001..=2112, joint_log_sd);
        print(truth, joint_log_sd, &counts);
        check(truth, &counts, 0.93..=0.97);
    }
}
