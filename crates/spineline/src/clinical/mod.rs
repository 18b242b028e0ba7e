//! Cobb and Ferguson angles, Lenke type and flexibility: what clinicians read off the same films.
//!
//! Regions, end vertebrae and apices are chosen on the erect film and then held for every posture, because both angles
//! depend much on that choice [stokes-1993]. Tilts are those of whole vertebral bodies, not of single endplates, so a
//! Cobb angle here is slightly smaller than the one between endplates.

mod curves;
mod places;
mod regions;
mod shares;
mod tilt_range;

pub use curves::{ClinicalCurve, CobbEnds, LenkeType, lenke_type, measure_curves};
pub use places::{CurvePlaces, convex_side, endplate_line};
pub use regions::{RegionBounds, Regions, ferguson_angle};
pub use shares::JointShares;
pub use tilt_range::tilt_range;
