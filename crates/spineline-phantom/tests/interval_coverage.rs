//! How often intervals under the noise of landmarks hold what a reader without noise would have found.

use std::collections::BTreeMap;

use rayon::prelude::*;
use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::uncertainty::{LandmarkNoise, MonteCarlo, Quantity, Uncertainty};
use spineline_phantom::{Readers, SUBJECTS, Truth, generate};

/// Of each kind of number: how often it is held, and of how many.
type Counts = BTreeMap<&'static str, [usize; 2]>;

/// Kinds of numbers. A line's offset is measured from the case's own inflections, which another reading does not share.
fn kind(quantity: Quantity) -> Option<&'static str> {
    use Quantity as Q;
    Some(match quantity {
        Q::LocationY(..) | Q::LocationZ(..) => "location",
        Q::Tilt(..) => "tilt",
        Q::Ferguson(..) => "Ferguson angle",
        Q::Cobb(..) => "Cobb angle",
        Q::InflectionY(_) | Q::InflectionZ(_) => "place of an inflection",
        Q::LeastSegment(..) => "least-rotating segment",
        Q::LineLean(LineKind::Inflection, _) => "lean of the inflection line",
        Q::LineLean(LineKind::Iliac, _) => "lean of the iliac line",
        Q::LineLean(LineKind::Estimated, _) => "lean of the estimated line",
        Q::LogMultiplier(..) => "ln of a multiplier",
        Q::Force(..) => "force",
        Q::LocationError(..) | Q::MeanLocationError(..) => "location error",
        _ => return None,
    })
}

fn analyzed(case: &Case) -> Analysis {
    analyze(case, &AnalysisOptions::default()).expect("a sound case")
}

fn told(case: &Case, analysis: &Analysis, replicates: u64) -> Uncertainty {
    let noise = LandmarkNoise::Measured;
    let monte_carlo = MonteCarlo::new(case, analysis, noise, 1).expect("readings");
    let mut tally = monte_carlo.tally();
    (0..replicates).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    tally.finish(replicates)
}

/// One patient, read with noise and nearly without it: a hundredth of it weighs places against tilts as the whole does.
fn patient(index: usize, truth: Truth, seed: u64, replicates: u64) -> Counts {
    let read = |readers| generate(index, truth, &readers, seed).expect("a subject").case;
    let noisy = read(Readers::default());
    let exact = read(Readers { rounded: false, ..Readers::scaled(0.01) });
    let found = told(&noisy, &analyzed(&noisy), replicates);
    let right = told(&exact, &analyzed(&exact), 0);
    let mut counts = Counts::new();
    for spread in &found.quantities {
        let named = kind(spread.quantity).zip(spread.spread.as_ref());
        let Some((kind, spread_95)) = named.filter(|_| 20 * spread.count >= 19 * replicates) else {
            continue;
        };
        let Some(Ok(right)) = right.of(spread.quantity).map(|exact| exact.nominal) else { continue };
        let [low, high] = spread_95.interval_95();
        let [held, all] = counts.entry(kind).or_default();
        *held += usize::from((low..=high).contains(&right));
        *all += 1;
    }
    counts
}

fn study(truth: Truth, seeds: u64, replicates: u64) -> Counts {
    let patients: Vec<(usize, u64)> =
        (1..=seeds).flat_map(|seed| (0..SUBJECTS.len()).map(move |index| (index, seed))).collect();
    let counts: Vec<Counts> = patients
        .par_iter()
        .map(|&(index, seed)| patient(index, truth, seed, replicates))
        .collect();
    let mut sum = Counts::new();
    for (kind, [held, all]) in counts.into_iter().flatten() {
        let total = sum.entry(kind).or_default();
        *total = [total[0] + held, total[1] + all];
    }
    sum
}

#[test]
#[ignore = "minutes: cargo test --release -p spineline-phantom --test interval_coverage -- --ignored --nocapture"]
fn over_hundreds_of_patients() {
    for truth in [Truth::Rod, Truth::Pull] {
        println!("synthetic, {} ({})", truth.key(), truth.meaning());
        for (kind, [held, all]) in study(truth, 10, 400) {
            println!("  {kind}: {held} of {all}, {:.1} %", 100.0 * held as f64 / all as f64);
        }
    }
}
