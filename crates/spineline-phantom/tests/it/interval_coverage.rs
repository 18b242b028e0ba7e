//! How often intervals under landmark noise contain the result of a reader without noise.

use std::collections::BTreeMap;

use rayon::prelude::*;
use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::uncertainty::{
    AnalysisQuantity, LandmarkNoise, MonteCarlo, QuantityKind, Uncertainty,
};
use spineline_phantom::{Readers, SUBJECTS, Scenario, generate};

/// For each kind of number: how often the interval contains it, out of how many.
type Counts = BTreeMap<&'static str, [usize; 2]>;

/// Kinds of numbers. A line's offset is measured from the case's own inflections, so another reading cannot be
/// compared.
fn kind(quantity: AnalysisQuantity) -> Option<&'static str> {
    use QuantityKind as K;
    Some(match quantity.kind {
        K::LocationY | K::LocationZ => "location",
        K::Tilt => "tilt",
        K::Ferguson => "Ferguson angle",
        K::Cobb => "Cobb angle",
        K::InflectionY | K::InflectionZ => "place of an inflection",
        K::LeastSegment => "least-rotating segment",
        K::LineTilt => match quantity.line? {
            LineKind::Inflection => "lean of the inflection line",
            LineKind::Iliac => "lean of the iliac line",
            LineKind::Estimated => "lean of the estimated line",
            LineKind::Given => return None,
        },
        K::LogMultiplier => "ln of a multiplier",
        K::Force => "force",
        _ => return None,
    })
}

/// Replicates of marks about an analysis, with its weights and options.
fn replicated(
    case: &Case,
    analysis: &Analysis,
    noise: LandmarkNoise,
    replicates: u64,
) -> Uncertainty {
    let monte_carlo = MonteCarlo::new(case, analysis, noise, 1).expect("readings");
    let mut tally = monte_carlo.tally();
    (0..replicates).for_each(|index| tally.add(&monte_carlo.replicate(index)));
    tally.finish(replicates)
}

/// One patient, read with noise; and the results of marks without noise with the same weights.
fn patient(index: usize, scenario: Scenario, seed: u64, replicates: u64) -> Counts {
    let read = |readers| generate(index, scenario, &readers, seed).expect("a subject").case;
    let (noisy, exact) = (read(Readers::default()), read(Readers::exact()));
    let analysis = analyze(&noisy, &AnalysisOptions::default()).expect("a sound case");
    let found = replicated(&noisy, &analysis, LandmarkNoise::Measured, replicates);
    let right = replicated(&exact, &analysis, LandmarkNoise::Pixels(0.0), 1);
    let mut counts = Counts::new();
    for spread in found.quantities.iter().filter(|spread| 20 * spread.count >= 19 * replicates) {
        let both = spread.interval_95().zip(right.spread(spread.quantity));
        let Some((kind, ([low, high], right))) = kind(spread.quantity).zip(both) else { continue };
        let [held, all] = counts.entry(kind).or_default();
        *held += usize::from((low..=high).contains(&right.mean));
        *all += 1;
    }
    counts
}

fn study(scenario: Scenario, patients: &[(usize, u64)], replicates: u64) -> Counts {
    let counts: Vec<Counts> = patients
        .par_iter()
        .map(|&(index, seed)| patient(index, scenario, seed, replicates))
        .collect();
    let mut sum = Counts::new();
    for (kind, [held, all]) in counts.into_iter().flatten() {
        let total = sum.entry(kind).or_default();
        *total = [total[0] + held, total[1] + all];
    }
    sum
}

fn share(counts: &Counts, kind: &str) -> f64 {
    let [held, all] = counts[kind];
    held as f64 / all as f64
}

#[test]
fn intervals_of_a_few_patients_hold_values_without_landmark_noise() {
    // Oracle: the same analysis of marks without noise. The numbers of a film share its noise; the ends of 80
    // replicates are imprecise.
    let patients: Vec<(usize, u64)> = (0..6).map(|index| (index, 1)).collect();
    let counts = study(Scenario::Rod, &patients, 80);
    for kind in ["location", "tilt", "Ferguson angle", "ln of a multiplier", "force"] {
        let share = share(&counts, kind);
        assert!(share > 0.8, "{kind}: {share}");
    }
}

/// The study behind the rows in `validation/README.md`.
#[test]
#[ignore = "minutes: cargo test --release -p spineline-phantom --test it interval_coverage -- --ignored --nocapture"]
fn over_hundreds_of_patients() {
    let patients: Vec<(usize, u64)> =
        (1..=10).flat_map(|seed| (0..SUBJECTS.len()).map(move |index| (index, seed))).collect();
    for scenario in [Scenario::Rod, Scenario::Pull] {
        let counts = study(scenario, &patients, 400);
        println!("synthetic, {} ({scenario})", scenario.key());
        for (kind, [held, all]) in &counts {
            println!("  {kind}: {held} of {all}, {:.1} %", 100.0 * *held as f64 / *all as f64);
        }
        for kind in ["location", "tilt", "Cobb angle", "Ferguson angle", "force"] {
            let share = share(&counts, kind);
            assert!((0.93..=0.975).contains(&share), "{kind}: {share}");
        }
    }
}
