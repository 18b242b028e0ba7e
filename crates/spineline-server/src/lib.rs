//! The study store.
