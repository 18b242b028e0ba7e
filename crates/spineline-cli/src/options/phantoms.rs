//! Options of synthetic patients.

use spineline::analysis::AnalysisOptions;
use spineline::curve::OrderRule;
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::Support;
use spineline::personalize::FitTarget;
use spineline_phantom::Readers;

use crate::run::failure::Failure;

/// How studies of synthetic patients analyse them: by the paper's method, except for the choices that are named here
/// (docs/decisions/0003, 0030, 0032), and those that the study varies.
pub fn options_of(support: Support, target: FitTarget) -> AnalysisOptions {
    AnalysisOptions {
        order_rule: OrderRule::LeaveOneOut,
        tilt: TiltRule::Endplates,
        film_lengths: FilmLengthRule::default(),
        support,
        target,
        ..AnalysisOptions::paper()
    }
}

/// The default virtual readers with their noise multiplied; zero is one reader without error.
///
/// # Errors
/// If the factor is out of range.
pub fn readers(noise: f64) -> Result<Readers, Failure> {
    if !(0.0..=10.0).contains(&noise) {
        return Err(Failure::usage(format!("--noise {noise}: the factor must be from 0 to 10")));
    }
    Ok(if noise == 0.0 { Readers::exact() } else { Readers::scaled(noise) })
}
