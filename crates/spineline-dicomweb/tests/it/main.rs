//! The integration tests of this crate, in one executable so that they are linked once.

mod answers;
mod orthanc;
mod orthanc_program;
mod server;
