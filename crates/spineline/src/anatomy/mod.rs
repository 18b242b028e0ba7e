//! Names that all steps share: vertebral levels, sides, postures, regions and kinds of line; and the sizes of a typical
//! spine.

mod level;
mod line_kind;
mod morphometry;
mod posture;
mod trunk;

pub use level::{Level, UnknownLevel};
pub use line_kind::LineKind;
pub use morphometry::{Morphometry, SagittalProfile};
pub use posture::{ImageSide, Posture, Region, Side};
pub use trunk::trunk_weight_share;
