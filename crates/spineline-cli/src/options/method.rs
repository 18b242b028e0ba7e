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
    Choice, ChosenHypotheses, Prior, StiffnessSource, curve_turn, end_vertebrae, film_lengths,
    gauge, given_line, hypotheses, inflection_sites, order_rule, prior, read_rotation_prior,
    stiffness_source,
};

use super::choice::choice;
use crate::run::failure::Failure;

/// Choices of the method.
#[derive(Args)]
#[command(next_help_heading = "Method")]
pub struct MethodArgs {
    /// Polynomial order of the curves: `leave-one-out`, `paper`, or a number from 4 to 12
    #[arg(long, value_name = "RULE", default_value = "leave-one-out", value_parser = order_rule)]
    order_rule: OrderRule,
    /// Scale constraint (gauge) of stiffness and force: `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON`
    /// such as known-force:traction=120
    #[arg(long, value_name = "GAUGE", default_value = "geometric-mean", value_parser = gauge)]
    gauge: Gauge,
    /// Support of the patient; the paper's is `free`
    #[arg(long, value_parser = choice::<Support>(), default_value = Support::default().spelling())]
    support: Support,
    /// Quantity that the stiffness is fitted to
    #[arg(long, value_parser = choice::<FitTarget>(), default_value = FitTarget::Shape.spelling())]
    fit: FitTarget,
    /// Landmarks from which the tilt of a vertebra is measured
    #[arg(long, value_parser = choice::<TiltRule>(), default_value = TiltRule::Endplates.spelling())]
    tilt: TiltRule,
    /// Lengths of the films: `per-film` (each has a scale of its own against the erect film; standard deviation 3.3 % where
    /// films do not state the error of theirs), that standard deviation in percent, or `as-marked` (one scale, as in the
    /// paper)
    #[arg(long, value_name = "RULE", default_value = "per-film", value_parser = film_lengths)]
    film_lengths: FilmLengthRule,
    /// End vertebrae of Cobb angles: `erect` (the most tilted ones of the erect film, kept on every film), `each-film`, or
    /// REGION=LEVEL/LEVEL such as main-thoracic=T12/T5
    #[arg(long, value_name = "CHOICE", default_value = "erect", value_parser = end_vertebrae)]
    end_vertebrae: EndChoice,
    /// Joints that share a stiffness multiplier
    #[arg(long, value_parser = choice::<Grouping>(), default_value = Grouping::Regional.spelling())]
    multipliers: Grouping,
    /// Log-normal prior of the multipliers about their mean: `none`, a standard deviation of ln such as 0.3, or `in-vivo`
    /// (0.5, the standard deviation between segments of living scoliotic spines)
    #[arg(long, value_name = "none|in-vivo|SD", default_value = "none", value_parser = prior)]
    prior: Prior,
    /// Distribution of joint rotations that `spineline learn-prior` learned from other patients, for the predictions without
    /// mechanics that models are compared with [default: published mobilities]
    #[arg(long, value_name = "FILE")]
    rotation_prior: Option<PathBuf>,
    /// Stiffness table to start from: `paper`, `in-vitro`, `intact-chest` or `scoliotic-in-vivo` (`spineline stiffness` prints
    /// them), or a file
    #[arg(long, value_name = "TABLE|FILE", default_value = "paper", value_parser = stiffness_source)]
    stiffness: StiffnessSource,
    /// Inflections set by hand, caudal first, each a vertebra or a disc, such as L1/T12,T6 [default: found on the erect film]
    #[arg(long, value_name = "SITE,SITE", value_parser = inflection_sites)]
    inflections: Option<[Site; 2]>,
    /// Minimum angle of a curve between inflections, in degrees
    #[arg(long, alias = "min-lobe", value_name = "DEG", default_value = "5", value_parser = curve_turn)]
    min_curve: Angle,
    /// Additional line of action: POSTURE=Y,Z,TILT with a point in mm and the lateral tilt from cranial in degrees, positive
    /// to the right; may be repeated
    #[arg(long, value_name = "LINE", value_parser = given_line)]
    given_line: Vec<(Posture, LineOfAction)>,
    /// Compare other loads and base supports with the paper's line, on fitted and left-out films: `all`, or names such as
    /// couple,weight,inflection-line+free-base (see docs/models.md)
    #[arg(long, value_name = "all|NAME,NAME", value_parser = hypotheses)]
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
        if stored.tilt != self.tilt {
            let [learned, asked] = [stored.tilt, self.tilt].map(|rule| rule.spelling());
            let text =
                format!("it was learned with --tilt {learned}, and this run has --tilt {asked}");
            let help = format!(
                "give --tilt {learned}, or learn it anew with `learn-prior --tilt {asked}`"
            );
            return Err(Failure::input(&path.display().to_string(), &text, &help));
        }
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
