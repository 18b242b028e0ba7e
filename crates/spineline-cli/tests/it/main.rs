//! The program as its users call it: what it prints, what it writes, and how it ends.

mod advice;
mod answers;
mod cohort_list;
mod commands;
mod comparison;
mod detect;
mod endings;
mod endless;
mod exchange;
mod film;
mod guide;
mod hidden;
mod import;
mod import_marks;
mod import_midlines;
mod import_spacing;
mod learn_prior;
mod licences;
#[path = "../../../spineline-films/tests/it/maker.rs"]
mod maker;
mod merge;
mod noise_study;
mod outputs;
mod privacy;
mod program;
mod reliability;
mod repeated_films;
mod report;
mod reproduce;
mod rerun;
mod results;
mod serve;
mod signals;
mod simulate;
mod simulate_replicates;
mod space;
mod streams;
mod study;
mod tables;
mod terminals;
mod unpacked;
#[cfg(not(feature = "weights"))]
mod without_weights;
