//! The names of a usual program: a case, its analysis, the personalised model and loads on it.
//!
//! ```
//! use spineline::prelude::*;
//! ```

pub use crate::action::{LineKind, LineOfAction};
pub use crate::analysis::{
    Analysis, AnalysisOptions, Case, FilmMovement, Grouping, LineModel, Movement,
    PersonalisedModel, Sex, SimulationError, Subject, analyze, analyze_movement,
};
pub use crate::anatomy::{ImageSide, Level, Posture, Region, Side};
pub use crate::cohort::{Cohort, CohortPatient};
pub use crate::curve::OrderRule;
pub use crate::error::Error;
pub use crate::hypothesis::Hypothesis;
pub use crate::measure::{
    Corners, Film, FilmLandmarks, FilmLengthRule, IliacCrests, ImageGeometry, LateralFilm,
    Placement, PlacementSource, Reading, ReadingId, Spacing, SpacingPlane, TiltRule,
    VertebraLandmarks,
};
pub use crate::multibody::{
    BodyLoad, Goal, LoadItem, Loading, Rod, StiffnessTable, Support, Timing,
};
pub use crate::personalize::FitTarget;
pub use crate::response::Response;
pub use crate::spatial::{Angle, Frontal, Pixel, Vec3};
pub use crate::uncertainty::{LandmarkNoise, MonteCarlo, Uncertainty};
pub use crate::warning::{Severity, Warning, Warnings};
