//! The command line of `reproduce`.

use std::path::PathBuf;

use clap::Args;
use spineline::analysis::{AnalysisOptions, Method};
use spineline::multibody::Support;
use spineline::personalize::FitTarget;

use crate::options::choice::choice;
use crate::options::values::threads;
use crate::run::outputs::OverwriteArgs;

pub const EXAMPLES: &str = "\
Examples:
  spineline reproduce                    54 phantoms: three loading scenarios, 18 subjects each
  spineline reproduce cases              your own cases by the paper's method
  spineline reproduce cases --method default --full
      your own cases by this program's method, with every number";

#[derive(Args)]
pub struct ReproduceArgs {
    /// Case files or folders of them, to reproduce the paper on; without any, on phantoms
    #[arg(value_name = "CASE")]
    pub cases: Vec<PathBuf>,
    /// Folder for tables, figures and reports
    #[arg(long, value_name = "DIR", default_value = "out/reproduce")]
    pub out: PathBuf,
    /// How the films are analysed
    #[arg(long, value_parser = choice::<Method>(), default_value = Method::Paper.key())]
    pub method: Method,
    /// Seed of the phantoms and of the bootstrap
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Threads; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads)]
    pub threads: usize,
    /// Factor on the noise of the virtual readers, from 0 to 10; 0: one reader without error
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0, conflicts_with = "cases")]
    pub noise: f64,
    /// Quantity that the stiffness is fitted to; by default the method's
    #[arg(long, value_parser = choice::<FitTarget>())]
    pub fit: Option<FitTarget>,
    /// Print every number after the answer
    #[arg(long)]
    pub full: bool,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
}

impl ReproduceArgs {
    /// The options of every analysis, with a support.
    pub fn options(&self, support: Support) -> AnalysisOptions {
        let options = self.method.options();
        AnalysisOptions { support, target: self.fit.unwrap_or(options.target), ..options }
    }
}
