//! Cases read and analysed, with the confidence of their numbers.

pub mod case;
pub mod cohort;
pub mod confidence;
pub mod figures;
pub mod films;
pub mod record;
pub mod replicates;
pub mod study;
