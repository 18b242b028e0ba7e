//! Choices of the method.

use std::path::PathBuf;
use std::str::FromStr;

use clap::Args;
use spineline::action::LineOfAction;
use spineline::analysis::{AnalysisOptions, Grouping};
use spineline::anatomy::{Level, Posture};
use spineline::clinical::EndChoice;
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::hypothesis::Hypothesis;
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::{StiffnessTable, Support};
use spineline::personalize::{FitTarget, Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};

use super::choice::{Choice, choice, of_spelling};
use super::ends::end_vertebrae;
use super::values::{number, posture};
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
    /// (0.5, the spread between segments of living scoliotic spines)
    #[arg(long, value_name = "none|in-vivo|SD", default_value = "none", value_parser = prior)]
    prior: Prior,
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
        options.library = match &self.stiffness {
            StiffnessSource::Table(table) => table.library(),
            StiffnessSource::File(path) => spineline_files::read_text(path)
                .and_then(|text| spineline_files::parse_stiffness(&text))
                .map_err(|error| Failure::file(path, &error))?,
        };
        Ok(options)
    }

    /// The file of the stiffness table, where it is one of the inputs.
    pub fn stiffness_file(&self) -> Option<&PathBuf> {
        match &self.stiffness {
            StiffnessSource::File(path) => Some(path),
            StiffnessSource::Table(_) => None,
        }
    }
}

/// Where springs come from.
#[derive(Clone)]
enum StiffnessSource {
    Table(StiffnessTable),
    File(PathBuf),
}

fn stiffness_source(text: &str) -> Result<StiffnessSource, String> {
    Ok(of_spelling(text)
        .map_or_else(|| StiffnessSource::File(PathBuf::from(text)), StiffnessSource::Table))
}

/// A prior, or none.
#[derive(Clone, Copy)]
struct Prior(Option<LogNormalPrior>);

fn prior(text: &str) -> Result<Prior, String> {
    match text {
        "none" => Ok(Prior(None)),
        "in-vivo" => Ok(Prior(Some(LogNormalPrior::IN_VIVO))),
        other => match number(other) {
            Ok(log_sd @ 0.01..=5.0) => Ok(Prior(Some(LogNormalPrior { log_sd }))),
            _ => Err("expected `none`, `in-vivo`, or a standard deviation of ln from 0.01 to 5"
                .to_owned()),
        },
    }
}

fn film_lengths(text: &str) -> Result<FilmLengthRule, String> {
    match text {
        "per-film" => Ok(FilmLengthRule::default()),
        "as-marked" => Ok(FilmLengthRule::AsMarked),
        percent => match number(percent) {
            Ok(percent @ 0.01..=50.0) => {
                Ok(FilmLengthRule::PerFilm { relative_sd: 0.01 * percent })
            }
            _ => Err(
                "expected `per-film`, `as-marked`, or a standard deviation from 0.01 to 50 percent"
                    .to_owned(),
            ),
        },
    }
}

fn order_rule(text: &str) -> Result<OrderRule, String> {
    match text {
        "leave-one-out" => Ok(OrderRule::LeaveOneOut),
        "paper" => Ok(OrderRule::Paper),
        number => match usize::from_str(number) {
            Ok(order @ 4..=12) => Ok(OrderRule::Fixed(order)),
            _ => Err("expected `leave-one-out`, `paper`, or an order from 4 to 12".to_owned()),
        },
    }
}

fn gauge(text: &str) -> Result<Gauge, String> {
    match text {
        "geometric-mean" => return Ok(Gauge::GeometricMean),
        "frozen-force" => return Ok(Gauge::FrozenForce),
        _ => {}
    }
    let expected = "expected `geometric-mean`, `frozen-force`, or `known-force:POSTURE=NEWTON`";
    let (name, force) = text
        .strip_prefix("known-force:")
        .and_then(|rest| rest.split_once('='))
        .ok_or_else(|| expected.to_owned())?;
    let force_n = number(force)?;
    if force_n <= 0.0 {
        return Err(
            "a known force must be greater than 0 N: it is a magnitude, and its direction is found"
                .to_owned(),
        );
    }
    let posture = posture(name)?;
    if posture == Posture::Erect {
        return Err("the erect film has no force: all others are measured from it; name the film on which the force was measured".to_owned());
    }
    Ok(Gauge::KnownForce { posture, force_n })
}

fn curve_turn(text: &str) -> Result<Angle, String> {
    match number(text)? {
        degrees @ 0.0..=90.0 => Ok(Angle::from_deg(degrees)),
        _ => Err("expected 0 to 90 degrees".to_owned()),
    }
}

fn inflection_sites(text: &str) -> Result<[Site; 2], String> {
    let site = |text: &str| -> Result<Site, String> {
        let level = |name: &str| {
            let level = Level::from_str(name.trim()).map_err(|error| error.to_string())?;
            level
                .model_index()
                .map(|_| level)
                .ok_or_else(|| format!("{level} is not between L4 and T2"))
        };
        let (a, b) = text.split_once('/').unwrap_or((text, text));
        let (a, b) = (level(a)?, level(b)?);
        Ok(Site { inferior: a.min(b), superior: a.max(b) })
    };
    let (caudal, cranial) =
        text.split_once(',').ok_or_else(|| "expected two sites, such as L1/T12,T6".to_owned())?;
    let sites = [site(caudal)?, site(cranial)?];
    if sites[0].inferior > sites[1].inferior {
        Err("the caudal site comes first".to_owned())
    } else {
        Ok(sites)
    }
}

fn given_line(text: &str) -> Result<(Posture, LineOfAction), String> {
    let expected = || "expected POSTURE=Y,Z,TILT, such as left_bending=20,150,-5".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let numbers: Vec<f64> = rest.split(',').map(number).collect::<Result<_, _>>()?;
    let [y, z, tilt] = numbers[..] else { return Err(expected()) };
    Ok((posture(name)?, LineOfAction::leaning(Frontal::new(y, z), Angle::from_deg(tilt))))
}

/// Loads and base supports to compare.
#[derive(Clone)]
struct ChosenHypotheses(Vec<Hypothesis>);

/// `all`, or names with commas between.
fn hypotheses(text: &str) -> Result<ChosenHypotheses, String> {
    if text == "all" {
        return Ok(ChosenHypotheses(Hypothesis::compared()));
    }
    let chosen = text.split(',').map(Hypothesis::from_str).collect::<Result<_, _>>();
    chosen.map(ChosenHypotheses).map_err(|error| error.to_string())
}
