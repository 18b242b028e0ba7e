//! The tests of this crate that see it from outside, in one executable so that they are linked once.

mod cohort;
mod common;
mod figures;
mod layout;
mod loaded;
mod marks;
mod reports;
mod reproduction;
mod scale;
mod short;
mod terminal;
