//! The formats of other programs, and what they cannot hold.

use spineline::anatomy::{FilmView, Level, Posture};

use crate::error::MODEL_HELP;

spineline::named! {
    /// A format of another program.
    pub enum ExportFormat {
        /// MuJoCo's own XML.
        Mjcf = "mjcf",
        /// An OpenSim 4 model.
        Osim = "osim",
        /// Poses of the films as a motion of OpenSim.
        Sto = "sto",
        /// Forces of the films as external loads of OpenSim.
        Loads = "loads",
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
            Self::Sto => "sto",
            Self::Loads => "loads.xml",
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
            Self::Sto => "OpenSim 4; pose and force of every film, as a motion of the `osim` model",
            Self::Loads => {
                "OpenSim 4; ExternalLoads with the forces of the `sto` motion, under the name films.sto"
            }
            Self::Urdf => "Pinocchio, Gazebo, Drake and others",
            Self::Vtp => "3D Slicer and ParaView; vertebral bodies with their angles, no joints",
            Self::Gltf => "Blender, ParaView and others; vertebral bodies, no joints",
        }
    }

    /// The media type of its files.
    #[must_use]
    pub const fn media_type(self) -> &'static str {
        match self {
            Self::Mjcf | Self::Osim | Self::Loads | Self::Urdf | Self::Vtp => "application/xml",
            Self::Sto => "text/plain",
            Self::Gltf => "model/gltf+json",
        }
    }
}

spineline::faults! {
    /// A model that a format cannot represent.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum ExportError {
        /// Two bodies would have one name.
        #[error("vertebra {level} is given twice")]
        #[help(MODEL_HELP)]
        #[at(level = *level)]
        LevelTwice {
            level: Level,
        },
        /// Two films of one posture would have one name.
        #[error("the {posture} film has two loads")]
        #[help(MODEL_HELP)]
        #[at(film = FilmView::from(*posture))]
        FilmTwice {
            posture: Posture,
        },
        /// An invalid spring.
        #[error(
            "joint {inferior}/{superior}: {axis} stiffness is {value} N·mm/rad; it must be positive and finite"
        )]
        #[help(MODEL_HELP)]
        #[at(level = *superior, value = *value, limit = 0.0)]
        Spring {
            inferior: Level,
            superior: Level,
            axis: &'static str,
            /// Value in the model.
            value: f64,
        },
        /// Hinges whose springs are coupled.
        #[error(
            "joint {inferior}/{superior}: its springs couple the three hinges, and {format} has one spring per hinge",
            format = format.key()
        )]
        #[help("`--to vtp` and `--to gltf` write the vertebral bodies of this model; for its springs, make a model without coupling: `spineline analyze CASE --stiffness motion-segments --model FILE` with your other options, or with `--support frontal`, which locks the axial hinges")]
        Coupled {
            /// The format, which has no coupled springs.
            format: ExportFormat,
            inferior: Level,
            superior: Level,
        },
        /// A character that XML cannot hold, or not everywhere.
        #[error("`{what}` has the character U+{:04X}; XML does not allow it", u32::from(*character))]
        #[help("remove control characters from that text in the model file")]
        Text {
            /// Key of the model file.
            what: &'static str,
            character: char,
        },
    }
}
