//! An analysis, or the samples of a cohort → figures as SVG text.
//!
//! | function | figure of [jalalian-loa] |
//! |---|---|
//! | [`functional_unit`] | 2 |
//! | [`chain`] | 4 |
//! | [`rotations`] | 5 |
//! | [`inflection_distances`] | 6 |
//! | [`location_errors`] | 8 |
//! | [`line_identification`] | 7 |
//! | [`measured_and_simulated`] | 9 |
//! | [`least_rotating_estimates`] | 10 |
//! | [`force_path`] | 11 |
//! | [`bland_altman`] | none: readings of two observers, or repeats of one, against one another |
//! | [`films`] | none: films as they were taken, with landmarks, curve, inflections and lines |
//! | [`spine_in_space`] | none: the multibody model from three sides |
//! | [`lenke_types`], [`exclusions`] | none: counts over a cohort |
//! | [`case_overview`] | none: all postures of one patient side by side |
//! | [`predictions`] | none: left-out bends, measured and predicted, on the first page |
//! | [`profiles`] | none: profile likelihoods of the multipliers |
//! | [`noise_study`] | none: the paper's claims over landmark noise |
//! | [`lateral_bias`] | none: pitch of a tilted vertebra on a lateral film |
//! | [`sagittal_profile`], [`sagittal_profiles`] | none: pitch of the vertebrae from the lateral film, beside the profile of a population |
//! | [`loaded_spine`] | none: a model under loads, from behind and from the right |
//!
//! # Conventions
//! Frontal pictures are seen **from behind**: the patient's left is on the left of the picture, and says so. Lengths are
//! millimetres at one scale for both axes, angles degrees. Colours are after Okabe and Ito; markers, dashes or names
//! carry the same meaning, so that a grey print can be read. A simulated shape whose force was not found is drawn, and
//! its panel says that it is not a result.
//!
//! # Drawing
//! kuva draws axes, grids and curves; this module lays out panels, legends, boxes and markers. Element ids derive from
//! the title, so that several figures can stand in one HTML page.

mod agreement;
mod arrows;
mod boxes;
mod chain;
mod cohort;
mod counts;
mod films;
mod frontal;
mod identification;
mod lateral_bias;
mod loaded;
mod noise;
mod overview;
mod page;
mod panel;
mod prediction;
mod profile;
mod rotation;
mod sagittal;
mod spines;
mod style;
mod unit;
mod views;

pub use agreement::bland_altman;
pub use chain::chain;
pub use cohort::{
    EstimateGroup, EstimateSample, InflectionSample, LocationErrorSample, inflection_distances,
    least_rotating_estimates, location_errors,
};
pub use counts::{FlowStep, exclusions, lenke_types};
pub use films::{FilmPicture, films};
pub use identification::line_identification;
pub use lateral_bias::lateral_bias;
pub use loaded::loaded_spine;
pub use noise::{NoisePanel, NoiseRow, NoiseScenario, noise_study};
pub use overview::case_overview;
pub use prediction::predictions;
pub use profile::profiles;
pub use rotation::rotations;
pub use sagittal::{sagittal_profile, sagittal_profiles};
pub use spines::{force_path, measured_and_simulated};
pub use unit::functional_unit;
pub use views::spine_in_space;
