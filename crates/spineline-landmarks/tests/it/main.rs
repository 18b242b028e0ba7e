//! Landmark files of other programs: read back as written, refused with the place of a fault, and the public AASCE set.

mod aasce;
mod exchange;
mod faults;
mod midlines;
