//! The tests of this crate that see it from outside, in one executable so that they are linked once.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

mod amplitude;
mod axial;
mod balance;
mod cobb;
mod common;
mod confidence;
mod coupling;
mod curves;
mod faults;
mod faults_contradictions;
mod faults_films;
mod faults_lines;
mod faults_models;
mod faults_pictures;
mod faults_units;
mod film_frame;
mod film_lengths;
mod fixed_regions;
mod general_extremes;
mod general_march;
mod hidden_levels;
mod hypothesis;
mod loaded_reference;
mod loaded_replicates;
mod nearest_t2;
mod oracle;
mod oracle_hand;
mod properties;
mod published;
mod response;
mod rods;
mod rotation_prior;
mod shared_heights;
mod space;
mod stiffness_tables;
mod uncertainty;
mod verification_beam;
mod verification_branches;
mod verification_hand;
mod verification_loads;
mod verification_symmetry;
mod verification_tilt;
mod wrong_films;
