//! The integration tests of this crate, in one executable so that they are linked once.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

mod baselines;
mod counter_examples;
mod exact_model;
mod film_doubts;
mod hypotheses;
mod identifiability;
mod inflection_force;
mod interval_coverage;
mod joint_truth;
mod line_regions;
mod lines_compared;
mod phantoms;
mod radiographs;
mod recovery;
mod shared_errors;
mod space_bends;
