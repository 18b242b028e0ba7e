//! Options of synthetic patients.

use std::sync::LazyLock;

use clap::ValueEnum;
use clap::builder::PossibleValue;
use spineline::analysis::AnalysisOptions;
use spineline::curve::OrderRule;
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::Support;
use spineline::personalize::FitTarget;
use spineline_phantom::{Construction, Readers, Scenario};

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

/// A loading scenario: what moved the synthetic spine.
#[derive(Clone, Copy)]
pub struct ScenarioName(pub Scenario);

impl ValueEnum for ScenarioName {
    fn value_variants<'a>() -> &'a [Self] {
        static NAMES: LazyLock<Vec<ScenarioName>> =
            LazyLock::new(|| Scenario::ALL.into_iter().map(ScenarioName).collect());
        &NAMES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.key()).help(self.0.meaning()))
    }
}

/// How the synthetic spine is built.
#[derive(Clone, Copy)]
pub struct ConstructionName(pub Construction);

impl ValueEnum for ConstructionName {
    fn value_variants<'a>() -> &'a [Self] {
        static NAMES: LazyLock<Vec<ConstructionName>> =
            LazyLock::new(|| Construction::ALL.into_iter().map(ConstructionName).collect());
        &NAMES
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(PossibleValue::new(self.0.key()).help(self.0.meaning()))
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
