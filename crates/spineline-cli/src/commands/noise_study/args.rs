//! The command line of `noise-study`.

use std::path::PathBuf;

use clap::Args;
use spineline::analysis::AnalysisOptions;
use spineline::personalize::FitTarget;
use spineline_phantom::Scenario;

use crate::options::choice::choice;
use crate::options::values::threads;
use crate::run::outputs::OverwriteArgs;

/// The command line.
#[derive(Args)]
pub struct NoiseStudyArgs {
    /// Folder for the table and the figure
    #[arg(long, value_name = "DIR", default_value = "out/noise-study")]
    pub out: PathBuf,
    /// Seed of the phantoms, of their noise and of the bootstrap
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Phantoms per loading scenario; they take the rows of the paper's Table 1 in turn
    #[arg(long, value_name = "N", default_value_t = 36, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub phantoms: u32,
    /// Threads; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// Loading scenarios, separated by commas [default: all]
    #[arg(long, value_name = "SCENARIOS", value_parser = choice::<Scenario>(), value_delimiter = ',')]
    pub scenarios: Vec<Scenario>,
    /// Quantity that the stiffness is fitted to; the paper fitted Ferguson angles
    #[arg(long, value_parser = choice::<FitTarget>(), default_value = AnalysisOptions::paper().target.key())]
    pub fit: FitTarget,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
}

impl NoiseStudyArgs {
    /// What is studied, in the order of the figure.
    pub fn scenarios(&self) -> Vec<Scenario> {
        let wanted = &self.scenarios;
        let every = Scenario::LINES.iter().copied();
        every.filter(|scenario| wanted.is_empty() || wanted.contains(scenario)).collect()
    }
}
