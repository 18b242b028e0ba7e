//! Replicates of one case on all cores, and what they say in a report.

use std::fmt::Write;

use clap::Args;
use indicatif::ProgressBar;
use rayon::prelude::*;
use spineline::analysis::{Analysis, Case};
use spineline::anatomy::Level;
use spineline::uncertainty::{
    LandmarkNoise, MonteCarlo, Quantity, QuantitySpread, QuantityUnit, Replicate, Uncertainty,
};
use spineline_files::Replicates;

use crate::args::number;
use crate::failure::Failure;
use crate::table::{Table, wrap};
use crate::{progress, stop};

/// Replicates that are computed before they are told in order; more would only take memory.
const BLOCK: u64 = 256;

/// What noise of the landmarks does to the results.
#[derive(Args)]
#[command(next_help_heading = "Uncertainty")]
pub struct UncertaintyArgs {
    /// Tell which multipliers the bending films identify: profile likelihood, 95 % intervals, the weakest direction
    #[arg(long)]
    pub identifiability: bool,
    /// Move all landmarks at random and analyse anew, so many times: every number then has a standard deviation and a 95 %
    /// interval, in the report and under `uncertainty` in the JSON. 1000 are enough for intervals, 10000 for their ends
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=10_000_000))]
    pub replicates: Option<u64>,
    /// Standard deviation of a landmark in one reading: `measured` (between the case's own readings; where it was read once,
    /// what one careful reading is taken to have), or pixels of the film, such as 3
    #[arg(long, value_name = "measured|PX", default_value = "measured", value_parser = noise, requires = "replicates")]
    pub noise: LandmarkNoise,
    /// Seed of the replicates; each has a random stream of its own
    #[arg(long, default_value_t = 1, requires = "replicates")]
    pub seed: u64,
}

fn noise(text: &str) -> Result<LandmarkNoise, String> {
    if text == "measured" {
        return Ok(LandmarkNoise::Measured);
    }
    match number(text) {
        Ok(sd_px @ 0.0..=1000.0) => Ok(LandmarkNoise::Pixels(sd_px)),
        _ => Err("expected `measured`, or a standard deviation of 0 to 1000 pixels".to_owned()),
    }
}

impl UncertaintyArgs {
    /// The replicates that were asked for.
    pub fn replicates(&self) -> Option<Replicates> {
        let count = self.replicates?;
        Some(Replicates { count, noise: self.noise, seed: self.seed })
    }
}

/// Runs the replicates that were asked for. Ctrl-C ends them early, with what is done.
///
/// # Errors
/// If the noise cannot be laid on this case.
pub fn run(
    case: &Case,
    nominal: &Analysis,
    asked: &Replicates,
    threads: usize,
) -> Result<Uncertainty, Failure> {
    let monte_carlo = MonteCarlo::new(case, nominal, asked.noise, asked.seed)
        .map_err(|error| Failure::input(&case.id, &error, error.help()))?;
    stop::catch()?;
    let pool = progress::pool(threads)?;
    let asked = asked.count;
    let bar = progress::bar("replicates", usize::try_from(asked).unwrap_or(usize::MAX));
    let mut tally = monte_carlo.tally();
    let mut next = 0;
    while next < asked && !stop::is_wanted() {
        let end = asked.min(next + BLOCK);
        let block = pool.install(|| block(&monte_carlo, next..end, &bar));
        // In their order, so that the bytes are the same for any number of threads.
        block.iter().for_each(|replicate| tally.add(replicate));
        next = end;
    }
    bar.finish_and_clear();
    Ok(tally.finish(asked))
}

fn block(
    monte_carlo: &MonteCarlo<'_>,
    indices: std::ops::Range<u64>,
    bar: &ProgressBar,
) -> Vec<Replicate> {
    let one = |index| {
        let replicate = monte_carlo.replicate(index);
        bar.inc(1);
        replicate
    };
    indices.into_par_iter().map(one).collect()
}

/// The part of a report that tells how sure its numbers are.
pub fn text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut text = format!(
        "Landmark noise: {} replicates, seed {}; mean is that of the replicates, the interval holds 95 % of them\n",
        found.done, found.seed
    );
    if found.done < found.asked {
        let _ = writeln!(text, "  broken off: {} were asked for", found.asked);
    }
    for words in found.noise_words() {
        text.push_str(&wrap(&words, 106, "  "));
    }
    let _ = writeln!(text, "  failed: {} of {} analyses", found.failed, found.done);
    for words in found.failure_words() {
        text.push_str(&wrap(&words, 106, "    "));
    }
    text.push_str(&wrap(Uncertainty::CAVEAT, 106, "  "));
    let _ = write!(text, "\n{}\n{}", places_text(analysis, found), spreads_text(analysis, found));
    text
}

/// Deviations of the measured vertebrae, film by film.
fn places_text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut table = Table::new([
        "Standard deviation of vertebrae",
        "to the side",
        "largest",
        "height",
        "largest",
        "tilt (°)",
        "largest",
    ]);
    for posture in analysis.postures.iter().map(|p| p.outline.posture) {
        let mut row = vec![posture.to_string()];
        for quantity in [Quantity::LocationY, Quantity::LocationZ, Quantity::Tilt] {
            row.extend(mean_and_largest(found, |level| quantity(posture, level), analysis));
        }
        table.row(row);
    }
    table.text()
}

fn mean_and_largest(
    found: &Uncertainty,
    quantity: impl Fn(Level) -> Quantity,
    analysis: &Analysis,
) -> [String; 2] {
    let sds: Vec<(f64, Level)> = Level::MODEL[1..]
        .iter()
        .filter_map(|&level| Some((found.spread(quantity(level))?.sd, level)))
        .collect();
    let Some(&(largest, level)) = sds.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return ["-".to_owned(), "-".to_owned()];
    };
    let unit = match quantity(level).unit(analysis) {
        QuantityUnit::Degrees => String::new(),
        unit => format!(" {}", unit.key()),
    };
    let mean = sds.iter().map(|(sd, _)| sd).sum::<f64>() / sds.len() as f64;
    [format!("{mean:.2}{unit}"), format!("{largest:.2} ({level})")]
}

/// Every other number that the report shows.
fn spreads_text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut table = Table::new(["Number", "unit", "value", "mean", "sd", "95 % interval", "in"]);
    for spread in found.quantities.iter().filter(|spread| spread.quantity.is_reported()) {
        table.row(row(analysis, spread, found.done));
    }
    table.text()
}

fn row(analysis: &Analysis, spread: &QuantitySpread, done: u64) -> Vec<String> {
    let quantity = spread.quantity;
    let number = |value: f64| match quantity.unit(analysis) {
        QuantityUnit::Segments => format!("{value:.0}"),
        QuantityUnit::One | QuantityUnit::Millimetres => format!("{value:.2}"),
        _ => format!("{value:.1}"),
    };
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let found = spread.spread;
    vec![
        quantity.label(analysis),
        quantity.unit(analysis).key().to_owned(),
        or_dash(spread.nominal.ok().map(number)),
        or_dash(found.map(|s| number(s.mean))),
        or_dash(found.map(|s| format!("{:.2}", s.sd))),
        or_dash(found.map(|s| {
            let [low, high] = s.interval_95();
            format!("{} to {}", number(low), number(high))
        })),
        format!("{:.1} %", 100.0 * spread.count as f64 / done.max(1) as f64),
    ]
}
