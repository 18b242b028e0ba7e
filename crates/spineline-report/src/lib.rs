//! Pictures of what Spineline found.
//!
//! [`figures`] turns an analysis, or samples of a cohort, into SVG text: pure functions without files, the same bytes
//! for the same input, and the word `synthetic` on every picture of made-up films.

pub mod figures;
