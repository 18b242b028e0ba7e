//! The study store of Spineline, and the browser app over it.
//!
//! [`store`] keeps films, blinded readings and every click on them in one file that proves its own history. [`http`] serves
//! it to a browser on the same machine.

pub mod http;
pub mod store;
pub mod synthetic;

// The session of the crash tests is one file, which unit tests use too.
#[cfg(test)]
extern crate self as spineline_server;
