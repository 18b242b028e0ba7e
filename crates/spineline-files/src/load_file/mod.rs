//! The file of loads.

use spineline::anatomy::Level;
mod place;
mod words;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::multibody::Timing;

use crate::FileError;
use crate::json::parse;

pub use place::{LoadFault, PlacedLoads};

const FORMAT: &str = "spineline-load";
const VERSION: u32 = 1;

/// Loads on a spine. `G`: x anterior, y to the patient's left, z cranial along L4's own axis, origin at L4's midpoint;
/// names that say `in_vertebra` are in a vertebra's own axes, from its midpoint. Forces have the unit of the model:
/// newtons where it is `absolute`, because a force was measured; else relative to the nominal stiffness. Moments are force × mm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "Spineline load, version 1")]
pub struct LoadFile {
    /// `spineline-load`.
    format: String,
    /// 1.
    version: u32,
    /// At least one.
    pub loads: Vec<AppliedLoad>,
}

/// One load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum AppliedLoad {
    /// A force along a line that is fixed in space.
    ForceOnLine {
        /// Vertebra that carries it.
        level: Level,
        /// Force in `G`.
        #[serde(rename = "force")]
        force_n: [f64; 3],
        /// Any point of the line, in `G`.
        point_mm: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A force of fixed direction that moves with a point of the vertebra.
    ForceAtPoint {
        /// Vertebra.
        level: Level,
        /// Force in `G`.
        #[serde(rename = "force")]
        force_n: [f64; 3],
        /// Point; the midpoint if not given.
        #[serde(default)]
        point_in_vertebra_mm: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A force that moves and rotates with the vertebra.
    FollowerForce {
        /// Vertebra.
        level: Level,
        /// Force in the vertebra's axes.
        #[serde(rename = "force_in_vertebra")]
        force_in_vertebra_n: [f64; 3],
        /// Point; the midpoint if not given.
        #[serde(default)]
        point_in_vertebra_mm: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A moment of fixed direction.
    Moment {
        /// Vertebra.
        level: Level,
        /// Right-handed moment about the axes of `G`.
        #[serde(rename = "moment")]
        moment_nmm: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A moment that rotates with the vertebra.
    FollowerMoment {
        /// Vertebra.
        level: Level,
        /// Right-handed moment about the vertebra's axes.
        #[serde(rename = "moment_in_vertebra")]
        moment_in_vertebra_nmm: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// The weight of trunk, head and arms, slice by slice, at the midpoints of L3 to T2.
    Gravity {
        /// The whole patient's weight, in the unit of forces.
        #[serde(rename = "body_weight")]
        body_weight_n: f64,
        /// Unit vector in `G`; `[0, 0, -1]`, along L4's own axis, if not given.
        #[serde(default = "caudal")]
        down: [f64; 3],
        /// `held` (constant) or `growing` (proportional); `held` if not given.
        #[serde(default = "held")]
        timing: Timing,
    },
    /// A frictionless pad that touches the erect spine and is then pushed in: a linear spring along one direction.
    Pad {
        /// Vertebra.
        level: Level,
        /// Where it touches; the midpoint if not given.
        #[serde(default)]
        point_in_vertebra_mm: [f64; 3],
        /// Direction of the push: unit vector in `G`.
        direction: [f64; 3],
        /// Stiffness: force per mm.
        #[serde(rename = "force_per_mm")]
        n_per_mm: f64,
        /// Displacement of the pad.
        advance_mm: f64,
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A strap to a point of the ground, unstretched on the erect spine and then shortened: a linear spring along itself.
    Strap {
        /// Vertebra.
        level: Level,
        /// Point of attachment; the midpoint if not given.
        #[serde(default)]
        point_in_vertebra_mm: [f64; 3],
        /// Point on the ground, in `G`.
        anchor_mm: [f64; 3],
        /// Stiffness: force per mm.
        #[serde(rename = "force_per_mm")]
        n_per_mm: f64,
        /// Shortening of the strap.
        shortening_mm: f64,
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
    /// A stiff rod between two vertebrae, which prescribes their relative pose; as in the erect posture if nothing else is
    /// given. With frontal support it prescribes the tilt and the lateral place of the upper vertebra alone: the first number of
    /// `turn_deg` and the second one of `shift_mm`; the others must be zero.
    Rod {
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra; where the rod moves it, at least three joints above, with frontal support two.
        superior: Level,
        /// Displacement of the upper vertebra from its erect pose, in the lower one's axes.
        #[serde(default)]
        shift_mm: [f64; 3],
        /// Rotation from its erect pose: rotation vector in the lower one's axes.
        #[serde(default)]
        turn_deg: [f64; 3],
        /// `held` (constant) or `growing` (proportional).
        #[serde(default)]
        timing: Timing,
    },
}

const fn held() -> Timing {
    Timing::Constant
}

fn caudal() -> [f64; 3] {
    [0.0, 0.0, -1.0]
}

impl AppliedLoad {
    /// The name of its kind in files.
    #[must_use]
    pub const fn kind(&self) -> &'static str {
        match self {
            Self::ForceOnLine { .. } => "force_on_line",
            Self::ForceAtPoint { .. } => "force_at_point",
            Self::FollowerForce { .. } => "follower_force",
            Self::Moment { .. } => "moment",
            Self::FollowerMoment { .. } => "follower_moment",
            Self::Gravity { .. } => "gravity",
            Self::Pad { .. } => "pad",
            Self::Strap { .. } => "strap",
            Self::Rod { .. } => "rod",
        }
    }

    /// `held` (constant) or `growing` (proportional).
    #[must_use]
    pub const fn timing(&self) -> Timing {
        match self {
            Self::ForceOnLine { timing, .. }
            | Self::ForceAtPoint { timing, .. }
            | Self::FollowerForce { timing, .. }
            | Self::Moment { timing, .. }
            | Self::FollowerMoment { timing, .. }
            | Self::Gravity { timing, .. }
            | Self::Pad { timing, .. }
            | Self::Strap { timing, .. }
            | Self::Rod { timing, .. } => *timing,
        }
    }

    /// Where it acts, such as `T8`, `T12 to T6` or `all vertebrae`.
    #[must_use]
    pub fn place(&self) -> String {
        match self {
            Self::ForceOnLine { level, .. }
            | Self::ForceAtPoint { level, .. }
            | Self::FollowerForce { level, .. }
            | Self::Moment { level, .. }
            | Self::FollowerMoment { level, .. }
            | Self::Pad { level, .. }
            | Self::Strap { level, .. } => level.to_string(),
            Self::Gravity { .. } => "all vertebrae".to_owned(),
            Self::Rod { inferior, superior, .. } => format!("{} to {}", inferior, superior),
        }
    }
}

/// Unit vectors of `G` in the patient's terms.
pub const DIRECTIONS: [(&str, [f64; 3]); 6] = [
    ("left", [0.0, 1.0, 0.0]),
    ("right", [0.0, -1.0, 0.0]),
    ("cranial", [0.0, 0.0, 1.0]),
    ("caudal", [0.0, 0.0, -1.0]),
    ("anterior", [1.0, 0.0, 0.0]),
    ("posterior", [-1.0, 0.0, 0.0]),
];

/// The unit vector of a direction in the patient's terms.
#[must_use]
pub fn direction(name: &str) -> Option<[f64; 3]> {
    DIRECTIONS.into_iter().find(|(known, _)| *known == name).map(|(_, vector)| vector)
}

/// Reads loads from the text of their file.
pub fn parse_load(text: &str) -> Result<LoadFile, FileError> {
    let file: LoadFile = parse(text, FORMAT, VERSION)?;
    if file.loads.is_empty() { Err(FileError::NoLoads) } else { Ok(file) }
}

impl LoadFile {
    /// A file of given loads.
    #[must_use]
    pub fn new(loads: Vec<AppliedLoad>) -> Self {
        Self { format: FORMAT.to_owned(), version: VERSION, loads }
    }
}
