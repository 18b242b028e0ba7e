//! The command line of `phantom`.

use std::path::PathBuf;

use clap::{Args, ValueEnum, value_parser};
use spineline_phantom::{Construction, Scenario};

use crate::options::choice::choice;
use crate::options::values::threads;
use crate::run::outputs::OverwriteArgs;

#[derive(Args)]
pub struct PhantomArgs {
    /// Loading scenario that moved the spine
    #[arg(long, value_parser = choice::<Scenario>(), default_value = Scenario::Rod.key())]
    pub scenario: Scenario,
    /// How the spine is built; other than `rod` for scenarios with forces
    #[arg(long, value_parser = choice::<Construction>(), default_value = Construction::Rod.key())]
    pub construction: Construction,
    /// Standard deviation of the random effect of every joint on its stiffness, in percent, from 0 to 50
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0)]
    pub joint_sd: f64,
    /// Subject of the paper's Table 1, from 1 to 18 [default: all]
    #[arg(long, value_name = "N")]
    pub subject: Option<usize>,
    /// Folder for the case files
    #[arg(long, value_name = "DIR", default_value = "out/phantoms")]
    pub out: PathBuf,
    /// Seed of the random numbers
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Factor on the noise of the virtual readers (two observers, three repeats), from 0 to 10; 0: one reader without error
    #[arg(long, value_name = "FACTOR", default_value_t = 1.0)]
    pub noise: f64,
    /// Standard deviation of the length that each film but the erect one shows, in percent, from 0 to 20; 0: all films have one
    /// scale, and state so
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0)]
    pub film_length_sd: f64,
    /// Factor on the size of the films' pixels, a whole number from 1 to 8; films of `2` take a quarter of time and disk
    #[arg(long, value_name = "FACTOR", default_value_t = 1, value_parser = value_parser!(u32).range(1..=8))]
    pub pixel_size: u32,
    /// Draw radiographs too: one DICOM file per posture beside each case, about 10 MB each
    #[arg(long)]
    pub films: bool,
    /// Lossless pixel encoding of the films
    #[arg(long, value_enum, default_value_t = EncodingName::Mixed, requires = "films")]
    pub film_encoding: EncodingName,
    /// Threads for `--films`; 0: all cores. The number does not change the files
    #[arg(long, default_value = "0", value_parser = threads, requires = "films")]
    pub threads: usize,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
}

#[derive(Clone, Copy, ValueEnum)]
pub enum EncodingName {
    /// JPEG-LS, and RLE for every fifth film, as in archives
    Mixed,
    /// JPEG-LS Lossless, the smallest
    JpegLs,
    /// RLE Lossless
    Rle,
    /// Uncompressed, about 30 MB per film
    Plain,
}
