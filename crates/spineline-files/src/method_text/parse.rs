//! Choices of the method, each from its text.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use spineline::action::LineOfAction;
use spineline::anatomy::{Level, Posture};
use spineline::curve::{OrderRule, Site};
use spineline::hypothesis::Hypothesis;
use spineline::measure::FilmLengthRule;
use spineline::multibody::{StiffnessLibrary, StiffnessTable};
use spineline::personalize::{Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};
use spineline::uncertainty::LandmarkNoise;

use super::named;
use super::values::{number, posture};
use crate::{FileError, StoredRotationPrior, parse_rotation_prior, parse_stiffness, read_text};

/// Where springs come from.
#[derive(Debug, Clone, PartialEq)]
pub enum StiffnessSource {
    /// A table of the library.
    Table(StiffnessTable),
    /// A file of [`crate::StiffnessFile`].
    File(PathBuf),
}

impl StiffnessSource {
    /// The springs.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn library(&self) -> Result<StiffnessLibrary, FileError> {
        match self {
            Self::Table(table) => Ok(table.library()),
            Self::File(path) => read_text(path).and_then(|text| parse_stiffness(&text)),
        }
    }
}

/// A table by its name, or else the path of a file.
///
/// # Errors
/// Never: what is no table is a path.
pub fn stiffness_source(text: &str) -> Result<StiffnessSource, String> {
    Ok(named(text)
        .map_or_else(|_| StiffnessSource::File(PathBuf::from(text)), StiffnessSource::Table))
}

/// Reads a file of [`crate::RotationPriorFile`].
///
/// # Errors
/// If the file cannot be read, or holds no prior.
pub fn read_rotation_prior(path: &Path) -> Result<StoredRotationPrior, FileError> {
    read_text(path).and_then(|text| parse_rotation_prior(&text))
}

/// A prior, or none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prior(pub Option<LogNormalPrior>);

/// `none`, `in-vivo` or a standard deviation of ln.
///
/// # Errors
/// If it is none of these, or out of range.
pub fn prior(text: &str) -> Result<Prior, String> {
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

/// Least standard deviation of the length of a film, in percent: what is less was meant as a fraction, or is below what landmarks show.
const MIN_LENGTH_SD_PERCENT: f64 = 0.1;

/// `per-film`, `as-marked` or a standard deviation in percent.
///
/// # Errors
/// If it is none of these, or out of range.
pub fn film_lengths(text: &str) -> Result<FilmLengthRule, String> {
    match text {
        "per-film" => Ok(FilmLengthRule::default()),
        "as-marked" => Ok(FilmLengthRule::AsMarked),
        percent => match number(percent) {
            Ok(percent @ MIN_LENGTH_SD_PERCENT..=50.0) => {
                Ok(FilmLengthRule::PerFilm { relative_sd: 0.01 * percent })
            }
            given => {
                let fraction =
                    given.ok().filter(|part| (0.002..MIN_LENGTH_SD_PERCENT).contains(part));
                let hint = fraction.map_or_else(String::new, |part| {
                    let percent = (1e9 * 100.0 * part).round() / 1e9;
                    format!("; a fraction of {part} is {percent} percent")
                });
                Err(format!(
                    "expected `per-film`, `as-marked`, or a standard deviation from {MIN_LENGTH_SD_PERCENT} to 50 percent{hint}"
                ))
            }
        },
    }
}

/// `leave-one-out`, `paper` or an order.
///
/// # Errors
/// If it is none of these, or out of range.
pub fn order_rule(text: &str) -> Result<OrderRule, String> {
    match text {
        "leave-one-out" => Ok(OrderRule::LeaveOneOut),
        "paper" => Ok(OrderRule::Paper),
        number => match usize::from_str(number) {
            Ok(order @ 4..=12) => Ok(OrderRule::Fixed(order)),
            _ => Err("expected `leave-one-out`, `paper`, or an order from 4 to 12".to_owned()),
        },
    }
}

/// `geometric-mean`, `frozen-force` or `known-force:POSTURE=NEWTON`.
///
/// # Errors
/// If it is none of these, or the force or film is impossible.
pub fn gauge(text: &str) -> Result<Gauge, String> {
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

/// A minimum angle of a curve in degrees.
///
/// # Errors
/// If it is not from 0 to 90.
pub fn curve_turn(text: &str) -> Result<Angle, String> {
    match number(text)? {
        degrees @ 0.0..=90.0 => Ok(Angle::from_deg(degrees)),
        _ => Err("expected 0 to 90 degrees".to_owned()),
    }
}

/// Two sites, caudal first, each a vertebra or a disc, such as `L1/T12,T6`.
///
/// # Errors
/// If a level is not in the model, or the order is wrong.
pub fn inflection_sites(text: &str) -> Result<[Site; 2], String> {
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

/// A site as [`inflection_sites`] reads it.
#[must_use]
pub fn site_text(site: Site) -> String {
    if site.inferior == site.superior {
        site.inferior.to_string()
    } else {
        format!("{}/{}", site.inferior, site.superior)
    }
}

/// A line of action of a film: `POSTURE=Y,Z,TILT`.
///
/// # Errors
/// If a part is missing or no number.
pub fn given_line(text: &str) -> Result<(Posture, LineOfAction), String> {
    let expected = || "expected POSTURE=Y,Z,TILT, such as left_bending=20,150,-5".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let numbers: Vec<f64> = rest.split(',').map(number).collect::<Result<_, _>>()?;
    let [y, z, tilt] = numbers[..] else { return Err(expected()) };
    Ok((posture(name)?, LineOfAction::leaning(Frontal::new(y, z), Angle::from_deg(tilt))))
}

/// Loads and base supports to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct ChosenHypotheses(pub Vec<Hypothesis>);

/// `all`, or names of loads with commas between.
///
/// # Errors
/// If a name is not known.
pub fn hypotheses(text: &str) -> Result<ChosenHypotheses, String> {
    if text == "all" {
        return Ok(ChosenHypotheses(Hypothesis::compared()));
    }
    let chosen = text.split(',').map(Hypothesis::from_str).collect::<Result<_, _>>();
    chosen.map(ChosenHypotheses).map_err(|error| error.to_string())
}

/// `measured`, or a standard deviation in pixels of the film.
///
/// # Errors
/// If it is out of range.
pub fn noise(text: &str) -> Result<LandmarkNoise, String> {
    if text == "measured" {
        return Ok(LandmarkNoise::Measured);
    }
    match number(text) {
        Ok(sd_px @ 0.0..=1000.0) => Ok(LandmarkNoise::Pixels(sd_px)),
        _ => Err("expected `measured`, or a noise standard deviation from 0 to 1000 px".to_owned()),
    }
}
