//! The command line of `phantom`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use spineline_phantom::Truth;

use crate::options::phantoms::ScenarioName;
use crate::options::values::threads;

#[derive(Args)]
pub struct PhantomArgs {
    /// What moved the spine
    #[arg(long, value_enum, default_value_t = ScenarioName(Truth::Rod))]
    pub truth: ScenarioName,
    /// Subject of the paper's Table 1, 1 to 18; all of them if not given
    #[arg(long, value_name = "N")]
    pub subject: Option<usize>,
    /// Folder for the case files
    #[arg(long, value_name = "DIR", default_value = "out/phantoms")]
    pub out: PathBuf,
    /// Seed
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Factor on the deviations of the virtual readers (two observers, three repeats); 0 lets one reader see the truth
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub noise: f64,
    /// Draw the radiographs too: one DICOM file per posture beside each case, which then names them; about 10 MB each
    #[arg(long)]
    pub films: bool,
    /// How `--films` stores pixels; no way loses anything
    #[arg(long, value_enum, default_value_t = EncodingName::Mixed, requires = "films")]
    pub film_encoding: EncodingName,
    /// Threads for `--films`; 0 uses all cores. The files do not depend on it
    #[arg(long, default_value = "0", value_parser = threads, requires = "films")]
    pub threads: usize,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum EncodingName {
    /// JPEG-LS, and RLE for every fifth film, as archives mix them
    Mixed,
    /// JPEG-LS Lossless, the smallest
    JpegLs,
    /// RLE Lossless
    Rle,
    /// Not compressed, about 30 MB each
    Plain,
}
