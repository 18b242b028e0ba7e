//! The command line of `simulate`.

use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use spineline::anatomy::{Level, Posture, Side};
use spineline::multibody::Support;
use spineline_files::{DIRECTIONS, direction};

use crate::options::choice::choice;
use crate::options::uncertainty::ReplicateArgs;
use crate::options::values::{number, posture, threads};
use crate::run::outputs::OverwriteArgs;

/// Shown below the options.
pub const EXAMPLES: &str = "\
Examples:
  spineline analyze CASE.json --model model.json
      make a model to simulate
  spineline simulate model.json --push left --force 50
      apply a force of 50 to the patient's left at T2: a relative force, not newtons, unless the model is absolute
  spineline simulate model.json --push caudal --force 300 --level T6 --follow
      apply a force that follows the rotation of its vertebra
  spineline simulate model.json --posture left_bending
      apply the force that the analysis found for this film
  spineline simulate model.json --push left --amplitude 20 --towards left
      find the force for a lateral tilt of 20 degrees (L4-T2 against L4's axis); all solutions are listed
  spineline simulate model.json --load load.json --json out.json --csv path.csv --svg shape.svg
      apply weight, pads, straps, rods and any forces together
  spineline simulate model.json --push left --force 20 --replicates 200 --case CASE.json
      95 % intervals: the same force on the models of 200 replicates with perturbed landmarks

A load file; `spineline schema load` explains every kind:
  { \"format\": \"spineline-load\", \"version\": 1, \"loads\": [
    { \"kind\": \"gravity\", \"body_weight\": 20 },
    { \"kind\": \"pad\", \"level\": \"T9\", \"direction\": [0, 1, 0], \"force_per_mm\": 2, \"advance_mm\": 20 } ] }
x is anterior, y to the patient's left, z cranial. Constant loads (`\"timing\": \"held\"`, the default of \
gravity) are applied first and stay; proportional loads (`\"growing\"`) are then multiplied by one factor from 0 to 1, or up to \
the wanted lateral tilt.

Exit codes: 0 a result; 2 wrong usage; 3 bad input; 4 no result: a limit or branch point came first, the target is out of \
reach, the path was lost, or Ctrl-C (the files then hold the path and the replicates so far; a second Ctrl-C ends the program at once).

Films identify only ratios of stiffness. Unless the model is absolute (made with `analyze --gauge known-force:POSTURE=NEWTON`), every force \
is relative to the nominal stiffness, not newtons: --force 20 bends the model as 20 N would bend one with the nominal springs, and the patient by \
an unknown force.";

/// The command line.
#[derive(Args)]
#[command(group = ArgGroup::new("what").required(true).args(["load", "push", "posture"]))]
pub struct SimulateArgs {
    /// Model file, from `spineline analyze CASE --model FILE`
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Load file
    #[arg(long, value_name = "FILE")]
    pub load: Option<PathBuf>,
    /// Direction of one force on one vertebra, in the patient's terms
    #[arg(long, value_parser = push(), value_name = "DIRECTION", help_heading = "One force")]
    pub push: Option<[f64; 3]>,
    /// Apply the force that the analysis found for this film: left_bending, right_bending, neutral or traction
    #[arg(long, value_name = "FILM", value_parser = posture, help_heading = "One force")]
    pub posture: Option<Posture>,
    /// Magnitude of the force: newtons where the model is absolute, because a force was measured; else a relative force, not newtons.
    /// With --posture, it replaces the magnitude that was found
    #[arg(long, value_name = "FORCE", value_parser = positive, allow_negative_numbers = true, conflicts_with = "load", help_heading = "One force")]
    pub force: Option<f64>,
    /// Vertebra that the force acts on, at its midpoint [default: T2]
    #[arg(long, value_name = "LEVEL", value_parser = level, conflicts_with_all = ["load", "posture"], help_heading = "One force")]
    pub level: Option<Level>,
    /// Let the force follow the rotation of its vertebra
    #[arg(long, conflicts_with_all = ["load", "posture"], help_heading = "One force")]
    pub follow: bool,
    /// Solve for the load factor, of either sign, that gives this lateral tilt of L4-T2 against L4's axis, in degrees from 0 to 90.
    /// `check` and `analyze` measure films against the iliac normal instead
    #[arg(long, value_name = "DEG", value_parser = degrees, allow_negative_numbers = true, requires = "towards", help_heading = "Target")]
    pub amplitude: Option<f64>,
    /// Side of the lateral tilt
    #[arg(long, value_parser = choice::<Side>(), value_name = "SIDE", requires = "amplitude", help_heading = "Target")]
    pub towards: Option<Side>,
    /// Largest factor of the proportional loads [default: 2; with --amplitude, a force of about 1500]
    #[arg(long, value_name = "FACTOR", value_parser = number, allow_negative_numbers = true, help_heading = "Target")]
    pub largest_factor: Option<f64>,
    /// Support of the patient [default: as in the model file]
    #[arg(long, value_parser = choice::<Support>())]
    pub support: Option<Support>,
    /// Write all results as JSON (`-`: standard output)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub json: Option<PathBuf>,
    /// Write the path of equilibria as CSV, one row per shape (`-`: standard output)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub csv: Option<PathBuf>,
    /// Write what is measured before and under the loads as CSV, one row per number, with its interval where there are
    /// replicates (`-`: standard output)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub measures: Option<PathBuf>,
    /// Draw the spine from behind and from the right, erect and loaded, as SVG (`-`: standard output)
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    pub svg: Option<PathBuf>,
    /// Case file that the model was made from, or an analysis of it: replicates need its landmarks
    #[arg(long, value_name = "CASE", requires = "replicates", help_heading = "Uncertainty")]
    pub case: Option<PathBuf>,
    /// Threads for replicates; 0: all cores. The number does not change the results
    #[arg(long, default_value = "0", value_parser = threads, requires = "replicates", help_heading = "Uncertainty")]
    pub threads: usize,
    #[command(flatten)]
    pub replicates: ReplicateArgs,
    #[command(flatten)]
    pub overwrite: OverwriteArgs,
}

/// Reads a direction in the patient's terms as a unit vector of `G`.
fn push() -> impl TypedValueParser<Value = [f64; 3]> {
    PossibleValuesParser::new(DIRECTIONS.map(|(name, _)| name))
        .try_map(|name| direction(&name).ok_or("expected one of the possible values"))
}

fn positive(text: &str) -> Result<f64, String> {
    match number(text)? {
        value if value > 0.0 => Ok(value),
        value => Err(format!("{value} is not above zero; give the side or direction by name")),
    }
}

fn degrees(text: &str) -> Result<f64, String> {
    match number(text)? {
        value @ 0.0..=90.0 => Ok(value),
        _ => Err("expected 0 to 90 degrees; the side is --towards".to_owned()),
    }
}

fn level(text: &str) -> Result<Level, String> {
    text.parse().map_err(|error: spineline::anatomy::UnknownLevel| error.to_string())
}
