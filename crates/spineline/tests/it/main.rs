//! The tests of this crate that see it from outside, in one executable so that they are linked once.

mod common;
mod curves;
mod faults;
mod faults_contradictions;
mod faults_films;
mod faults_lines;
mod faults_models;
mod faults_pictures;
mod film_evidence;
mod film_frame;
mod general_extremes;
mod general_march;
mod hypothesis;
mod nearest_t2;
mod oracle;
mod oracle_hand;
mod properties;
mod response;
mod uncertainty;
mod verification_beam;
mod verification_branches;
mod verification_hand;
mod verification_loads;
mod verification_symmetry;
mod verification_tilt;
mod wrong_films;
