//! Options for identifiability and landmark noise.

use clap::Args;
use spineline::uncertainty::LandmarkNoise;
use spineline_files::Replicates;
use spineline_files::method_text::noise;

/// Questions about the confidence of the results.
#[derive(Args)]
#[command(next_help_heading = "Uncertainty")]
pub struct UncertaintyArgs {
    /// Compute which multipliers the films identify: 95 % intervals of the mean stiffness of their joints, from the joint rotations
    /// of all films; profile likelihood and weakest direction from the bends
    #[arg(long)]
    pub identifiability: bool,
    #[command(flatten)]
    pub replicates: ReplicateArgs,
}

/// Monte Carlo replicates.
#[derive(Args)]
#[command(next_help_heading = "Uncertainty")]
pub struct ReplicateArgs {
    /// Run N Monte Carlo replicates with perturbed landmarks: numbers get a standard deviation and, from 40 replicates on, 95 % intervals
    /// (errors and distances get none), in the report and under `uncertainty` in the JSON. Use 1000 for intervals, 10000 for stable ends
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=10_000_000))]
    pub replicates: Option<u64>,
    /// Standard deviation of the landmark noise of one reading: `measured` (between the case's readings; an assumed value
    /// where there is one reading), or a number of film pixels, such as 3
    #[arg(long, value_name = "measured|PX", default_value = "measured", value_parser = noise, requires = "replicates")]
    pub noise: LandmarkNoise,
    /// Seed of the replicates
    #[arg(long, default_value_t = 1, requires = "replicates")]
    pub seed: u64,
}

impl ReplicateArgs {
    /// The replicates that were asked for.
    pub fn asked(&self) -> Option<Replicates> {
        let count = self.replicates?;
        Some(Replicates { count, noise: self.noise, seed: self.seed })
    }
}
