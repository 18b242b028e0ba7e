//! The tests of this crate that see it from outside, in one executable so that they are linked once.

mod answers;
mod orthanc;
mod orthanc_program;
mod server;
