//! Helps a person to read films, before the method measures them.
//!
//! - [`PartialReading`]: an unfinished reading, its faults, and the next landmark with its expected place
//! - [`ErectFilm`]: the erect film of the patient, which gives the lengths and the levels of the other films
//! - [`Calibration`] and [`DrawnLine`]: objects of known size and lines that a person draws on a film
//! - [`judge_spacing`] and [`judge_view`]: the spacing of the pixels and the view, as far as a file states them
//! - [`Midline`]: a midline of the back surface, cut into vertebrae
//!
//! Like the core, it uses no files and no clock, and does not print.

mod body_neighbours;
mod calibration;
mod drawn;
mod erect;
mod fault;
mod midline;
mod proposal;
mod reading;
mod series;
mod spacing_evidence;
mod view;

pub use calibration::{Calibration, CalibrationError, Calibrator};
pub use drawn::{DrawnAngle, DrawnFault, DrawnLength, DrawnLine};
pub use erect::ErectFilm;
pub use fault::MarkingFault;
pub use midline::{Midline, MidlineEnd, MidlineError, MidlinePoint};
pub use proposal::{NextLandmark, ProposedVertebra};
pub use reading::{MarkedBody, PartialLandmarks, PartialReading, turn_axis_towards};
pub use series::{LevelMatch, NamelessBody, SecondMatch};
pub use spacing_evidence::{
    CalibrationType, SpacingEvidence, SpacingJudgement, SpacingRemark, judge_spacing, pixels_agree,
};
pub use view::{
    PatientDirection, Stance, View, ViewEvidence, ViewJudgement, ViewPosition, ViewQuestion,
    judge_view,
};
