//! Options for identifiability and landmark noise.

use clap::Args;
use spineline::uncertainty::LandmarkNoise;
use spineline_io::Replicates;

use super::values::number;

/// Questions about the confidence of the results.
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
