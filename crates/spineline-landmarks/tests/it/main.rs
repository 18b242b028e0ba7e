//! Landmark files of other programs: read back as written, refused with the place of a fault, and the public AASCE set.

#![allow(clippy::float_cmp, reason = "tests compare with exact values")]

mod aasce;
mod exchange;
mod faults;
mod midlines;
mod origins;
mod wild;
