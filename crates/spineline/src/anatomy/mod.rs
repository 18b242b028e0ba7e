//! Names that all steps share: vertebral levels, sides, postures and regions; how such names are read
//! ([`Named`]); and the sizes of a typical spine, with their sources.

mod level;
mod levels;
mod morphometry;
mod named;
mod pedicles;
mod posture;
mod published;
mod trunk;

pub(crate) use crate::named;
pub use level::{Level, UnknownLevel};
pub use levels::Levels;
pub use morphometry::{Morphometry, SagittalProfile};
#[cfg(feature = "schema")]
#[doc(hidden)]
pub use named::schema_of_keys;
pub use named::{Named, UnknownKey};
#[doc(hidden)]
pub use named::{deserialize_key, of_key};
pub use pedicles::PediclePlace;
pub use posture::{FilmView, ImageSide, Posture, Region, Side};
pub use published::{PublishedNumbers, SourceCheck};
pub use trunk::{trunk_weight_share, trunk_weight_shares};
