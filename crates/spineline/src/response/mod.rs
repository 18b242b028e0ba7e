//! Loads on a personalised spine: the shape that it takes, all others that meet the same target, and their clinical
//! measures.
//!
//! [`respond`] follows the branch of equilibria from the erect spine ([`crate::multibody::GeneralStatics::follow_with`]).
//! For a given load that is one path. For a given amplitude it is two, since the loads may have to act against themselves, and
//! the least loaded shape that a spine reaches without snapping or buckling is the one it takes.

mod acting;
mod loaded;
mod measures;
mod pads;
mod search;

pub use acting::{ActingKind, ActingLoad, acting_loads};
pub use loaded::{LoadedMeasure, LoadedQuantity, LoadedState, loaded_measures};
pub use measures::{
    CurveAngles, CurveChange, SpineAngles, UNUSUAL_HINGE, erect_shape, largest_displacement_mm,
    largest_hinge, measure_angles,
};
pub use pads::{OtherLoads, OtherLoadsError, PadEffect, PadReached, PadTrial, try_pad};
pub use search::{
    GoalEquilibrium, OnSignedPoint, Response, SignedPath, Verdict, go_on, largest_factor, respond,
    usual_limit,
};
