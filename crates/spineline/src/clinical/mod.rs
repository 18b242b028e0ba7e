//! Cobb and Ferguson angles, balance, Lenke type and flexibility: what clinicians read off the same films.
//!
//! Regions, end vertebrae and apices are chosen on the erect film and then held for every posture, because both angles
//! depend much on that choice [stokes-1993]. A Cobb angle is the angle between
//! the superior endplate of the upper and the inferior endplate of the lower end vertebra. Where only locations and tilts are
//! known, a tilt range replaces the Cobb angle: the difference of the tilts of the end vertebrae.

mod balance;
mod curves;
mod largest;
mod places;
mod regions;
mod shares;
mod space;

pub use balance::{
    Balance, SacralReference, measure_balance, sacral_line_offset_mm, sacral_reference,
};
pub(crate) use curves::lenke_doubt;
pub use curves::{
    ClinicalCurve, EndChoice, EndRule, LenkeType, UnmarkedNeighbour, film_tilts, lenke_type,
    measure_curves, measure_largest_curve,
};
pub use largest::largest_tilt_difference;
pub use places::{CobbEnds, CurvePlaces, EndAngles, convex_side, endplate_line};
pub use regions::{RegionBounds, Regions};
pub use shares::JointShares;
pub use space::{
    Dimension, MaximumCurvature, SagittalAngle, SagittalPart, SpatialMeasures, SpatialNumber,
    SpinalLength, WithSd,
};
