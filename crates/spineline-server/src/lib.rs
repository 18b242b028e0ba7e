//! The browser app of Spineline over a study store.
//!
//! [`http`] serves a [`spineline_store::Store`] to a browser on the same machine; [`synthetic`] draws the films of its
//! demonstration.

pub mod http;
pub mod synthetic;
