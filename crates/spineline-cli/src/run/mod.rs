//! What every command does the same way: inputs, outputs, threads, progress and failures.

pub mod failure;
pub mod film_decoder;
pub mod inputs;
pub mod interrupt;
pub mod messages;
pub mod outputs;
#[cfg_attr(not(feature = "pdf"), path = "without_pdf.rs")]
pub mod pdf;
pub mod progress;
pub mod provenance;
pub mod shard;
pub mod suggestions;
pub mod threads;
