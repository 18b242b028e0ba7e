//! Option groups that several commands share.

pub mod choice;
pub mod method;
pub mod phantoms;
pub mod uncertainty;
pub mod values;
