//! Films: synthetic ones, public samples compared with an independent program, and films among other files.

#![allow(clippy::unwrap_used)]

mod child;
mod deid;
mod display;
mod faults;
mod intake;
mod maker;
mod pixel_shape;
mod reading;
mod samples;
mod write;
