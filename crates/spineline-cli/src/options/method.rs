//! Choices of the method.

use std::path::{Path, PathBuf};

use clap::Args;
use spineline::action::LineOfAction;
use spineline::analysis::{AnalysisOptions, Grouping};
use spineline::anatomy::Posture;
use spineline::clinical::EndChoice;
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::Support;
use spineline::personalize::{FitTarget, Gauge};
use spineline::spatial::Angle;
use spineline_files::StoredRotationPrior;
use spineline_files::method_text::{
    ChosenHypotheses, Prior, StiffnessSource, curve_turn, end_vertebrae, film_lengths, gauge,
    given_line, hypotheses, inflection_sites, option_named, order_rule, prior, read_rotation_prior,
    stiffness_source,
};

use super::choice::choice;
use crate::run::failure::Failure;

fn help_of(name: &str) -> &'static str {
    option_named(name).help
}

fn default_of(name: &str) -> &'static str {
    option_named(name).default
}

/// Choices of the method, with the texts of the list of all options.
#[derive(Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    #[arg(long, help = help_of("order_rule"), value_name = "RULE", default_value = default_of("order_rule"), value_parser = order_rule)]
    order_rule: OrderRule,
    #[arg(long, help = help_of("gauge"), value_name = "GAUGE", default_value = default_of("gauge"), value_parser = gauge)]
    gauge: Gauge,
    #[arg(long, help = help_of("support"), value_parser = choice::<Support>(), default_value = default_of("support"))]
    support: Support,
    #[arg(long, help = help_of("fit"), value_parser = choice::<FitTarget>(), default_value = default_of("fit"))]
    fit: FitTarget,
    #[arg(long, help = help_of("tilt"), value_parser = choice::<TiltRule>(), default_value = default_of("tilt"))]
    tilt: TiltRule,
    #[arg(long, help = help_of("film_lengths"), value_name = "RULE", default_value = default_of("film_lengths"), value_parser = film_lengths)]
    film_lengths: FilmLengthRule,
    #[arg(long, help = help_of("end_vertebrae"), value_name = "CHOICE", default_value = default_of("end_vertebrae"), value_parser = end_vertebrae)]
    end_vertebrae: EndChoice,
    #[arg(long, help = help_of("multipliers"), value_parser = choice::<Grouping>(), default_value = default_of("multipliers"))]
    multipliers: Grouping,
    #[arg(long, help = help_of("prior"), value_name = "none|in-vivo|SD", default_value = default_of("prior"), value_parser = prior)]
    prior: Prior,
    #[arg(long, help = help_of("rotation_prior"), value_name = "FILE")]
    rotation_prior: Option<PathBuf>,
    #[arg(long, help = help_of("stiffness"), value_name = "TABLE|FILE", default_value = default_of("stiffness"), value_parser = stiffness_source)]
    stiffness: StiffnessSource,
    #[arg(long, help = help_of("inflections"), value_name = "SITE,SITE", value_parser = inflection_sites)]
    inflections: Option<[Site; 2]>,
    #[arg(long, help = help_of("min_curve"), value_name = "DEG", default_value = default_of("min_curve"), value_parser = curve_turn)]
    min_curve: Angle,
    #[arg(long, help = help_of("given_line"), value_name = "LINE", value_parser = given_line)]
    given_line: Vec<(Posture, LineOfAction)>,
    #[arg(long, help = help_of("compare_models"), value_name = "all|NAME,NAME", value_parser = hypotheses)]
    compare_models: Option<ChosenHypotheses>,
}

impl MethodArgs {
    /// The library's options.
    ///
    /// # Errors
    /// If the stiffness table cannot be read.
    pub fn options(&self) -> Result<AnalysisOptions, Failure> {
        let mut options = AnalysisOptions {
            tilt: self.tilt,
            film_lengths: self.film_lengths,
            ends: self.end_vertebrae,
            order_rule: self.order_rule,
            gauge: self.gauge,
            support: self.support,
            target: self.fit,
            grouping: self.multipliers,
            prior: self.prior.0,
            inflections: self
                .inflections
                .map_or(InflectionChoice::Automatic, InflectionChoice::ByHand),
            min_curve: self.min_curve,
            given_lines: self.given_line.clone(),
            hypotheses: self.compare_models.clone().map(|chosen| chosen.0).unwrap_or_default(),
            ..AnalysisOptions::default()
        };
        options.library = self.stiffness.library().map_err(|error| {
            let path = self.stiffness_file().map_or(Path::new(""), PathBuf::as_path);
            Failure::file(path, &error)
        })?;
        options.rotation_prior = self.stored_rotation_prior()?.map(|stored| stored.prior);
        Ok(options)
    }

    /// The distribution of joint rotations that is read from a file.
    ///
    /// # Errors
    /// If the file cannot be read, or was learned with tilts of another rule.
    pub fn stored_rotation_prior(&self) -> Result<Option<StoredRotationPrior>, Failure> {
        let Some(path) = &self.rotation_prior else { return Ok(None) };
        let stored = read_rotation_prior(path).map_err(|error| Failure::file(path, &error))?;
        stored.check_tilt(self.tilt).map_err(|error| Failure::file(path, &error))?;
        Ok(Some(stored))
    }

    /// Files that the options name: they are inputs.
    pub fn files(&self) -> impl Iterator<Item = &PathBuf> {
        self.stiffness_file().into_iter().chain(&self.rotation_prior)
    }

    fn stiffness_file(&self) -> Option<&PathBuf> {
        match &self.stiffness {
            StiffnessSource::File(path) => Some(path),
            StiffnessSource::Table(_) => None,
        }
    }
}
