//! Step 8: a personalised model → simulated postures, their errors, and statistics.
//!
//! # Definition
//! The location error of a vertebra is `E_LOC = |simulated - measured midpoint|`, at the scale of the film ([`crate::measure::FilmScale`]); a figure for a
//! film is its mean over the vertebrae above the base that the film shows, and the Ferguson errors of three regions stand beside it.
//!
//! A film that was not fitted is predicted ([`predict`]) from the place of its T2, and so are predictions without mechanics
//! ([`Baseline`]): patterns of rotation, distributions of rotations ([`RotationPrior`]) and a cubic. A [`Band`] holds a vertebra of such a
//! film in 95 % of films.
//!
//! Postures that were fitted and postures that were held out are never mixed: every [`Simulation`] says which it is.
//!
//! # References
//! [jalalian-loa], sections 3.2 and 4.

mod band;
mod baseline;
mod bend_rotations;
mod cubic;
mod film_covariance;
mod film_shape;
mod mobility;
mod most_probable;
pub mod paired;
mod prediction;
mod rotation_prior;
mod simulate;
pub mod statistics;

pub use band::Band;
pub(crate) use band::PredictedFilm;
pub use baseline::{Baseline, BaselinePrediction, predict_baseline, predict_from_prior};
pub(crate) use baseline::{FilmFromTop, Links};
pub use bend_rotations::{BendRotations, joint_rotations};
pub(crate) use cubic::predict_cubic;
pub(crate) use film_covariance::FilmCovariance;
pub use film_shape::FilmShape;
pub use mobility::published_lateral_bending;
pub(crate) use most_probable::{BeforeTheFilm, MostProbable, UnknownLoad};
pub use prediction::predict;
pub(crate) use prediction::{ScaledPrediction, at_scale_of_top};
pub use rotation_prior::{PriorSource, RotationPrior, RotationPriorError};
pub use simulate::{
    Alternative, FilmUnderLine, ForceChoice, NearbyMatch, Simulation, Target, simulate,
};
