//! Export of personalised models for other programs: MJCF, OpenSim and URDF for multibody programs, VTK and glTF for 3-D views.
//!
//! Formats for multibody programs have the content of [`PersonalisedModel`]: bodies in the erect posture, three hinges in series
//! at every joint, and a linear spring on each. Other values that they need (masses, damping, shapes to draw) are nominal, and do
//! not change an equilibrium. Formats for 3-D views have only the vertebral bodies, as boxes. Each file states its content, its
//! origin, its frame and its units.

mod assembly;
mod boxes;
mod gltf;
mod header;
mod mjcf;
mod osim;
mod rotation;
mod standing;
mod urdf;
mod vtp;
mod xml;

use spineline::analysis::PersonalisedModel;
use spineline::anatomy::Level;
use spineline::multibody::Support;

use crate::text_with_hash;
use assembly::{Assembly, Axis, vertebrae};

spineline::named! {
    /// A format of another program.
    pub enum ExportFormat {
        /// MuJoCo's own XML.
        Mjcf = "mjcf",
        /// An OpenSim 4 model.
        Osim = "osim",
        /// Unified robot description format, with the springs in SDFormat's extension.
        Urdf = "urdf",
        /// Vertebral bodies as VTK's XML PolyData.
        Vtp = "vtp",
        /// Vertebral bodies as glTF 2.0, with its data inside.
        Gltf = "gltf",
    }
}

impl ExportFormat {
    /// The ending of its files.
    #[must_use]
    pub const fn file_ending(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Osim => "osim",
            Self::Urdf => "urdf",
            Self::Vtp => "vtp",
            Self::Gltf => "gltf",
        }
    }

    /// The programs that read it.
    #[must_use]
    pub const fn programs(self) -> &'static str {
        match self {
            Self::Mjcf => "MuJoCo",
            Self::Osim => "OpenSim 4",
            Self::Urdf => "Pinocchio, Gazebo, Drake and others",
            Self::Vtp => "3D Slicer and ParaView; vertebral bodies with their angles, no joints",
            Self::Gltf => "Blender, ParaView and others; vertebral bodies, no joints",
        }
    }

    /// The media type of its files.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Mjcf | Self::Osim | Self::Urdf | Self::Vtp => "application/xml",
            Self::Gltf => "model/gltf+json",
        }
    }
}

/// A model that a format cannot represent.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// Two bodies would have one name.
    #[error("vertebra {level} is given twice")]
    LevelTwice {
        /// The vertebra.
        level: Level,
    },
    /// An invalid spring.
    #[error(
        "joint {inferior}/{superior}: {axis} stiffness is {value} N·mm/rad; it must be positive and finite"
    )]
    Spring {
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// Axis.
        axis: &'static str,
        /// Value in the model.
        value: f64,
    },
    /// Hinges whose springs are coupled.
    #[error(
        "joint {inferior}/{superior}: its springs couple the three hinges, and {format} has one spring per hinge",
        format = format.key()
    )]
    Coupled {
        /// The format, which has no coupled springs.
        format: ExportFormat,
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
    },
    /// A character that XML cannot hold, or not everywhere.
    #[error("`{what}` has the character U+{:04X}; XML does not allow it", u32::from(*character))]
    Text {
        /// Key of the model file.
        what: &'static str,
        /// The character.
        character: char,
    },
}

impl ExportError {
    /// Remedy.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::LevelTwice { .. } | Self::Spring { .. } => {
                "write the model again with `spineline analyze CASE --model FILE`"
            }
            Self::Coupled { .. } => {
                "`--to vtp` and `--to gltf` write the vertebral bodies of this model; for its springs, make a model without coupling: `spineline analyze CASE --stiffness motion-segments --model FILE` with your other options, or with `--support frontal`, which locks the axial hinges"
            }
            Self::Text { .. } => "remove control characters from that text in the model file",
        }
    }
}

/// The text of a model in another program's format. The same model gives the same bytes.
///
/// # Errors
/// [`ExportError`] for a model that the format cannot hold.
///
/// # Panics
/// If the model has not one level per vertebra, which [`parse_model`](crate::parse_model) sees to.
pub fn export(
    model: &PersonalisedModel,
    format: ExportFormat,
    generator: &str,
) -> Result<String, ExportError> {
    for (what, text) in [("case_id", &*model.case_id), ("generator", generator)] {
        check_text(what, text)?;
    }
    let vertebrae = vertebrae(model)?;
    let assembly = |vertebrae| Assembly::of(model, vertebrae, format);
    Ok(text_with_hash(match format {
        ExportFormat::Mjcf => mjcf::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Osim => osim::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Urdf => urdf::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Vtp => vtp::text(model, &vertebrae, generator),
        ExportFormat::Gltf => gltf::text(model, &vertebrae, generator),
    }))
}

/// XML forbids control characters and the two noncharacters, even escaped.
fn check_text(what: &'static str, text: &str) -> Result<(), ExportError> {
    let refused = |c: &char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    match text.chars().find(refused) {
        Some(character) => Err(ExportError::Text { what, character }),
        None => Ok(()),
    }
}

/// Whether a support lets a hinge turn.
const fn turns(support: Support, axis: Axis) -> bool {
    match support {
        Support::Free => true,
        Support::Frontal => matches!(axis, Axis::Lateral),
    }
}
