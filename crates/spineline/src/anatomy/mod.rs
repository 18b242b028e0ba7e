//! Names of the body: vertebral levels, sides, postures, regions, and the sizes of a typical spine.

mod level;
mod morphometry;
mod posture;
mod trunk;

pub use level::{Level, UnknownLevel};
pub use morphometry::{Morphometry, SagittalProfile};
pub use posture::{ImageSide, Posture, Region, Side};
pub use trunk::trunk_weight_share;
