//! Spineline's own times, through the core's public functions.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;
use spineline::multibody::{ForceSign, Solution, Statics, Support, match_amplitude};
use spineline::personalize::{FitFilm, FitSettings, FitTarget, Gauge, personalize};

use crate::case::Case;

/// What an engine says of one case.
#[derive(Debug, Serialize)]
pub struct Times {
    engine: &'static str,
    version: &'static str,
    case: String,
    rows: Vec<Row>,
}

/// One task done in one way.
#[derive(Debug, Default, Serialize)]
struct Row {
    task: &'static str,
    method: &'static str,
    /// Median time of one solution: of one bend, but for the personalisation, which is of both.
    seconds: f64,
    /// Midpoints per bend and vertebra, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    midpoints_mm: Vec<Vec<[f64; 3]>>,
    /// Forces per bend, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    forces_n: Vec<f64>,
    /// Multipliers found, to be compared.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    multipliers: Vec<f64>,
}

/// Forces vary by so much from call to call, so that no branch is learnt by heart.
const WOBBLE: f64 = 1e-3;

/// Times of all tasks.
pub fn times(case: &Case) -> Times {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let logs = case.log_multipliers();
    let statics = Statics::new(&model, &library, &groups, &logs, Support::Free);
    // The general Newton solver, from the erect spine and from a nearby start, has its rows here once the core has it.
    let rows = vec![equilibrium(case, &statics), amplitude(case, &statics), personalisation(case)];
    Times { engine: "spineline", version: env!("CARGO_PKG_VERSION"), case: case.name.clone(), rows }
}

/// One march per bend; it needs no start.
fn equilibrium(case: &Case, statics: &Statics<'_>) -> Row {
    let loads = case.bends.each_ref().map(|bend| (bend.load(), bend.force_n));
    let mut solution = Solution::default();
    let midpoints_mm = loads.iter().map(|(load, force_n)| {
        statics.solve(load, &[*force_n], &[], &mut solution);
        solution.deformed.midpoints_mm.iter().map(|&midpoint| midpoint.into()).collect()
    });
    let midpoints_mm = midpoints_mm.collect();
    let seconds = median_seconds(2000, 50, |i| {
        let (load, force_n) = &loads[i % 2];
        let force_n = force_n * (1.0 - WOBBLE * (i % 64) as f64 / 64.0);
        statics.solve(black_box(load), black_box(&[force_n]), &[], &mut solution);
        black_box(&solution);
    });
    Row {
        task: "equilibrium",
        method: "explicit march",
        seconds,
        midpoints_mm,
        ..Default::default()
    }
}

fn amplitude(case: &Case, statics: &Statics<'_>) -> Row {
    let goals = case.bends.each_ref().map(|bend| (bend.load(), bend.lean()));
    let forces_n = goals
        .iter()
        .map(|(load, lean)| match_amplitude(statics, load, ForceSign::Positive, *lean).force_n);
    let forces_n = forces_n.collect();
    let seconds = median_seconds(1000, 10, |i| {
        let (load, lean) = &goals[i % 2];
        let lean = *lean * (1.0 - WOBBLE * (i % 64) as f64 / 64.0);
        black_box(match_amplitude(statics, black_box(load), ForceSign::Positive, lean));
    });
    Row {
        task: "amplitude",
        method: "continuation from zero",
        seconds,
        forces_n,
        ..Default::default()
    }
}

/// Everything from outlines to multipliers, with the search for a start.
fn personalisation(case: &Case) -> Row {
    let (model, library, groups) = (case.model(), case.library(), case.groups());
    let (erect, regions) = (case.erect(), case.regions());
    let outlines = [case.bend(0), case.bend(1)];
    let films: [FitFilm<'_>; 2] =
        std::array::from_fn(|i| FitFilm { outline: &outlines[i], load: case.bends[i].load() });
    let settings = FitSettings {
        regions: &regions,
        target: FitTarget::Shape,
        gauge: Gauge::GeometricMean,
        support: Support::Free,
        hints: &[],
    };
    let fit = || personalize(&model, &library, &groups, &erect, black_box(&films), &settings);
    let found = fit();
    let seconds = median_seconds(1000, 1, |_| {
        black_box(fit());
    });
    Row {
        task: "personalisation",
        method: "own start, Levenberg-Marquardt",
        seconds,
        forces_n: found.loads.iter().map(|load| load[0]).collect(),
        multipliers: found.log_multipliers.iter().map(|log| log.exp()).collect(),
        ..Default::default()
    }
}

/// Median over samples of the mean time of one call; a sample of several calls makes the clock's own time small.
fn median_seconds(samples: usize, calls: usize, mut work: impl FnMut(usize)) -> f64 {
    let mut call = 0;
    let mut means: Vec<f64> = (0..samples + samples / 10)
        .map(|_| {
            let start = Instant::now();
            for _ in 0..calls {
                work(call);
                call += 1;
            }
            start.elapsed().as_secs_f64() / calls as f64
        })
        // The first tenth warms up.
        .skip(samples / 10)
        .collect();
    means.sort_by(f64::total_cmp);
    means[means.len() / 2]
}
