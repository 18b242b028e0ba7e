//! Films: made by hand, and the public samples with what an independent program read from them.

#![allow(clippy::unwrap_used)]

mod child;
mod deid;
mod display;
mod faults;
mod maker;
mod reading;
mod samples;
