//! Spineline turns frontal radiographs of a scoliotic spine into a personalised multibody model.
//!
//! Data flows one way:
//!
//! 1. [`measure`]: landmarks on a film → location and tilt of every vertebra
//! 2. [`curve`]: → a smooth curve and its inflections ([`clinical`] reads Cobb and Ferguson angles beside it)
//! 3. [`chain`]: → a chain of equal micro-scale segments on every film
//! 4. [`motion`]: → how far every segment rotates, and which rotate least
//! 5. [`action`]: → candidates for the line along which the force acts
//! 6. [`multibody`]: → vertebrae, joints and springs in static equilibrium
//! 7. [`personalize`]: → stiffness multipliers that reproduce the bends
//! 8. [`evaluate`]: → errors on films that were fitted and, apart from them, on films that were not
//!
//! [`reliability`] asks how well the readings of step 1 repeat. [`uncertainty`] asks what their noise does to every result. [`response`] asks a personalised model what it would do under any loads.
//!
//! [`analysis::analyze`] does all eight steps. The library has no files, no clock, no printing and no hidden randomness.
//!
//! # What it is not
//! Research software, not a medical device. Bending films carry no force, so only ratios of stiffness are identified.

#![cfg_attr(test, allow(clippy::float_cmp, reason = "tests compare with exact values"))]

#[cfg(feature = "schema")]
#[doc(hidden)]
pub use schemars;
#[doc(hidden)]
pub use serde;

pub mod action;
pub mod analysis;
pub mod anatomy;
pub mod chain;
pub mod clinical;
pub mod cohort;
pub mod curve;
pub mod error;
pub mod evaluate;
pub mod fault;
pub mod hypothesis;
pub(crate) mod least_squares;
pub mod measure;
pub mod motion;
pub mod multibody;
pub mod personalize;
pub mod reliability;
pub mod response;
pub mod spatial;
pub mod uncertainty;
pub mod warning;
