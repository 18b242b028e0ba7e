//! Names of the body: vertebral levels, sides, postures, regions, and the sizes of a typical spine.

mod level;
mod morphometry;
mod posture;

pub use level::{Level, UnknownLevel};
pub use morphometry::{Morphometry, SagittalProfile};
pub use posture::{ImageSide, Posture, Region, Side};
