//! Types of the HTTP interface. The browser's types are generated from these.
//!
//! Names end in their unit; sides are the patient's unless a name says `image`; pixels are `[column, row]`, sub-pixel, with
//! the centre of the first pixel at zero. Points `[y, z]` and `[x, y, z]` are in the global frame in millimetres: x
//! anterior, y to the patient's left, z cranial. Texts are shown to people without change.

mod archives;
mod cohort;
mod computations;
mod drawn;
mod exports;
mod live;
mod load_file;
mod loads;
mod model;
mod named;
mod options;
mod readings;
mod session;
mod studies;
mod words;

pub use archives::*;
pub use cohort::*;
pub use computations::*;
pub use drawn::*;
pub use exports::*;
pub use live::*;
pub use load_file::*;
pub use loads::*;
pub use model::*;
pub use named::*;
pub use options::*;
pub use readings::*;
pub use session::*;
pub use studies::*;
pub use words::*;
