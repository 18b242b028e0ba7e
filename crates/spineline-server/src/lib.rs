//! The study store of Spineline: films, blinded readings and every click on them, in one file that proves its own history.

pub mod store;

// The session of the crash tests is one file, which unit tests use too.
#[cfg(test)]
extern crate self as spineline_server;
