//! `spineline export`: a personalised model for another multibody program.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use spineline_io::{ExportFormat, export};

use crate::analyze::{generator, write_or_print};
use crate::failure::{Ending, Failure};
use crate::model::read_model;

/// How to come by a model file, and how each program opens what comes out.
pub const EXAMPLES: &str = "\
Examples:
  spineline analyze CASE.json --model model.json
  spineline export model.json --to mjcf --out spine.xml
      python -m mujoco.viewer --mjcf=spine.xml
      mujoco.MjModel.from_xml_path('spine.xml')
  spineline export model.json --to osim --out spine.osim
      opensim.Model('spine.osim').initSystem(), or File > Open Model in OpenSim
  spineline export model.json --to urdf --out spine.urdf
      pinocchio.buildModelFromUrdf('spine.urdf')

All are in metres, newtons and radians. MJCF and URDF keep x anterior, y left, z cranial; OpenSim has x anterior, \
y cranial, z right. MJCF and OpenSim carry the springs; URDF has no word for them, so they stand in its `gazebo` \
elements. The comment at the top of each file holds the loads that the model needs for its films. Masses and damping \
are nominal.";

#[derive(Args)]
pub struct ExportArgs {
    /// Model file, from `spineline analyze CASE --model FILE`
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// Format: `mjcf` for MuJoCo, `osim` for OpenSim 4, `urdf` for Pinocchio, Gazebo, Drake and others
    #[arg(long, value_enum, value_name = "FORMAT")]
    to: FormatName,
    /// File to write (`-`: standard output)
    #[arg(long, value_name = "FILE", default_value = "-")]
    out: PathBuf,
}

#[derive(Clone, Copy, ValueEnum)]
enum FormatName {
    /// MuJoCo
    Mjcf,
    /// OpenSim 4
    Osim,
    /// Pinocchio, Gazebo, Drake and others
    Urdf,
}

impl FormatName {
    fn format(self) -> ExportFormat {
        match self {
            Self::Mjcf => ExportFormat::Mjcf,
            Self::Osim => ExportFormat::Osim,
            Self::Urdf => ExportFormat::Urdf,
        }
    }
}

pub fn run(args: &ExportArgs) -> Result<Ending, Failure> {
    let model = read_model(&args.model)?;
    let text = export(&model, args.to.format(), &generator())
        .map_err(|error| Failure::input(&args.model.display().to_string(), &error, error.help()))?;
    write_or_print(&args.out, &text)?;
    Ok(Ending::Done)
}
