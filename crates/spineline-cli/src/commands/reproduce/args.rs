//! The command line of `reproduce`.

use std::path::PathBuf;

use clap::Args;
use spineline::analysis::AnalysisOptions;
use spineline::personalize::FitTarget;

use crate::options::choice::choice;
use crate::options::values::threads;
use crate::run::outputs::OverwriteArgs;

#[derive(Args)]
pub struct ReproduceArgs {
    /// Folder for tables, figures and reports
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub out: PathBuf,
    /// Seed of the phantoms and of the bootstrap
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// Factor on the noise of the virtual readers, from 0 to 10; 0: one reader without error
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub noise: f64,
    /// Quantity that the stiffness is fitted to; the paper fitted Ferguson angles
    #[arg(long, value_parser = choice::<FitTarget>(), default_value = AnalysisOptions::paper().target.key())]
    pub fit: FitTarget,
    /// Print every number after the answer
    #[arg(long)]
    pub full: bool,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
}
