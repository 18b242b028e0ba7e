//! Option groups that several commands share.

pub mod choice;
pub mod method;
pub mod phantoms;
pub mod shard;
pub mod uncertainty;
pub mod values;

use spineline_files::Request;

use crate::run::failure::Failure;
use method::MethodArgs;
use uncertainty::UncertaintyArgs;

/// What these options ask of every case.
///
/// # Errors
/// As [`MethodArgs::options`].
pub fn request(method: &MethodArgs, uncertainty: &UncertaintyArgs) -> Result<Request, Failure> {
    Ok(Request {
        options: method.options()?,
        replicates: uncertainty.replicates.asked(),
        identifiability: uncertainty.identifiability,
    })
}
