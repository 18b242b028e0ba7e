//! Tests of the crate that helps a person to read films.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

mod bends;
mod drawn_lines;
mod film_evidence;
mod reading;
