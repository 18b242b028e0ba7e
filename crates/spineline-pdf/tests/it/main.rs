//! The integration tests of this crate, in one executable so that they are linked once.

mod pdf;
