//! Step 1: landmarks on a radiograph → location and tilt of every vertebra in the global frame.
//!
//! The location of a vertebra is the intersection of the two diagonals of its body; its tilt is the tilt of its endplates
//! ([`TiltRule`]), or an axis turned by hand. Readings are averaged on the film, and the film is
//! then brought into `G`: L4's midpoint is the origin and L4's own axis is +Z, so L4's tilt is zero in every posture,
//! however the film was held.
//!
//! # Departures from the paper
//! Landmarks may be sub-pixel, pixels need not be square, and the patient's side is part of the film. The paper takes tilts
//! from the line through the endplates' centres, which has twice the noise; that is an option.
//!
//! # References
//! [jalalian-loa], section 2.1 and figure 3.

mod axial;
mod bodies;
pub mod completion;
mod confidence;
mod copies;
mod corner_order;
mod corners;
mod error;
mod film;
mod film_checks;
mod film_length;
mod film_place;
mod film_size;
mod frame;
mod interpolation;
mod lateral;
mod lengths;
mod means;
mod measure_film;
mod neighbours;
mod noise;
mod observer;
mod order;
mod origin;
mod outline;
mod outline_checks;
mod outline_length;
mod outline_noise;
mod pedicles;
mod placing;
mod plausibility;
mod program_corners;
mod readings;
mod readings_apart;
mod rounding;
mod seen_levels;
mod shared_errors;
mod space;
mod spacing;
mod tilt;
mod tilts;

pub use axial::{AxialRotation, NashMoe, PedicleFault};
pub use bodies::median;
pub use corner_order::CornerOrder;
pub use corners::{CornerFault, CornerName, Corners, EndplateTilts};
pub use error::{MeasureError, MeasureFault};
pub use film::{
    Film, FilmLandmarks, FilmTooLarge, IliacCrests, ImageGeometry, Placement, PlacementSource,
    Reading, ReadingId, VertebraLandmarks,
};
pub use film_length::{FilmLength, FilmLengthRule, FilmScale};
pub use film_place::FilmPlace;
pub use film_size::{FilmSize, SuspectedUnit};
pub(crate) use frame::body_shapes;
pub use frame::{FilmFrame, body_widths, endplate_centres};
pub(crate) use interpolation::InterpolationError;
pub use lateral::{LateralFilm, LateralOutline, LateralVertebra};
pub(crate) use measure_film::outline_of;
pub use measure_film::{check_landmarks, measure_film};
pub(crate) use noise::ReadingSquares;
pub use noise::{Noise, ProgramNoise};
pub use observer::{OBSERVER_RULE, alike_names, alike_remark, alike_words, is_observer_code};
pub use order::{LevelStep, out_of_order_words};
pub use origin::{Origin, VertebraOrigin};
pub use outline::{AmplitudeEnds, Interpolation, MeasuredVertebra, Outline, SharedErrors};
pub(crate) use outline_noise::OutlineNoise;
pub(crate) use pedicles::axial_rotations;
pub use placing::{cranial_of, runs_down};
pub use plausibility::{judge_landmarks, judge_reading};
pub(crate) use plausibility::{same_landmarks, warn_of_implausible_landmarks};
pub(crate) use program_corners::ProgramCorners;
pub(crate) use readings::warn_of_alike_observers;
pub use readings::{FilmReadings, measure_readings};
pub use seen_levels::shows_enough;
pub(crate) use seen_levels::{common_levels, seen_levels, shown_levels, warn_of_shortened_chain};
pub(crate) use shared_errors::{ErrorRate, Measured, Whitening};
pub use space::{FilmAlignment, HeightLine, SharedHeights, SpatialOutline, SpatialVertebra};
pub use spacing::{LengthScale, Spacing, SpacingPlane, SpacingSource};
pub use tilt::TiltRule;
