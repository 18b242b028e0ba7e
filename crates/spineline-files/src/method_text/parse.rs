//! Values of options, each from its text.

use std::str::FromStr;

use spineline::action::LineOfAction;
use spineline::analysis::Reference;
use spineline::anatomy::{Level, Named, Posture, Region};
use spineline::clinical::{CobbEnds, EndChoice, EndRule};
use spineline::curve::{OrderRule, Site};
use spineline::hypothesis::Hypothesis;
use spineline::measure::FilmLengthRule;
use spineline::personalize::{Gauge, LogNormalPrior};
use spineline::spatial::{Angle, Frontal};
use spineline::uncertainty::LandmarkNoise;

use super::show::spelling;

/// A posture by its key, with `-` or `_`.
///
/// # Errors
/// If no posture has this name.
pub fn posture(text: &str) -> Result<Posture, String> {
    let wanted = text.replace('-', "_");
    wanted.parse().map_err(|_| {
        format!(
            "unknown posture `{text}`; expected one of {}",
            Posture::ALL.map(Posture::key).join(", ")
        )
    })
}

/// A value by its key, with `-` or `_`.
///
/// # Errors
/// If no value has this name; the message lists all names.
pub fn named<T: Named>(text: &str) -> Result<T, String> {
    let wanted = text.replace('_', "-");
    T::ALL.iter().copied().find(|value| spelling(*value) == wanted).ok_or_else(|| {
        let known: Vec<String> = T::ALL.iter().map(|value| spelling(*value)).collect();
        format!("expected one of {}", known.join(", "))
    })
}

/// A finite number.
///
/// # Errors
/// If the text is not a finite number.
pub fn number(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("`{text}` is not a number")),
    }
}

/// `none`, `in-vivo` or a standard deviation of ln.
pub(super) fn prior(text: &str) -> Result<Option<LogNormalPrior>, String> {
    match text {
        "none" => Ok(None),
        "in-vivo" => Ok(Some(LogNormalPrior::IN_VIVO)),
        other => match number(other) {
            Ok(log_sd @ 0.01..=5.0) => Ok(Some(LogNormalPrior { log_sd })),
            _ => Err("expected `none`, `in-vivo`, or a standard deviation of ln from 0.01 to 5"
                .to_owned()),
        },
    }
}

/// Least standard deviation of the length of a film, in percent: less is a fraction by mistake, or below the noise of landmarks.
const MIN_LENGTH_SD_PERCENT: f64 = 0.1;

/// `per-film`, `as-marked` or a standard deviation in percent.
pub(super) fn film_lengths(text: &str) -> Result<FilmLengthRule, String> {
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

/// `leave-one-out`, `paper`, `two-inflections` or an order.
pub(super) fn order_rule(text: &str) -> Result<OrderRule, String> {
    match text {
        "leave-one-out" => Ok(OrderRule::LeaveOneOut),
        "paper" => Ok(OrderRule::Paper),
        "two-inflections" => Ok(OrderRule::TwoInflections),
        number => match usize::from_str(number) {
            Ok(order @ 4..=12) => Ok(OrderRule::Fixed(order)),
            _ => Err(
                "expected `leave-one-out`, `two-inflections`, `paper`, or an order from 4 to 12"
                    .to_owned(),
            ),
        },
    }
}

/// `geometric-mean`, `frozen-force` or `known-force:POSTURE=NEWTON`.
pub(super) fn gauge(text: &str) -> Result<Gauge, String> {
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
    let [least, most] = Gauge::FORCES_N;
    if !(least..=most).contains(&force_n) {
        return Err(format!(
            "the known force is {force_n} N, and must be from {least} to {most} N: it is a magnitude, and its direction is found"
        ));
    }
    let posture = posture(name)?;
    if posture == Posture::Erect {
        return Err("the erect film has no force: all others are measured from it; name the film on which the force was measured".to_owned());
    }
    Ok(Gauge::KnownForce { posture, force_n })
}

/// Masses of patients, in kg.
const BODY_MASSES_KG: std::ops::RangeInclusive<f64> = 10.0..=250.0;

/// `unloaded` or `loaded:KG`.
pub(super) fn reference(text: &str) -> Result<Reference, String> {
    if text == "unloaded" {
        return Ok(Reference::Unloaded);
    }
    let mass =
        text.strip_prefix("loaded:").and_then(|mass| number(mass.trim_end_matches("kg")).ok());
    match mass.filter(|mass| BODY_MASSES_KG.contains(mass)) {
        Some(body_mass_kg) => Ok(Reference::Loaded { body_mass_kg }),
        None => Err("expected `unloaded`, or `loaded:KG` with the mass of the body from 10 to 250 kg, such as loaded:50".to_owned()),
    }
}

/// A minimum angle of a curve in degrees.
pub(super) fn curve_turn(text: &str) -> Result<Angle, String> {
    match number(text)? {
        degrees @ 0.0..=90.0 => Ok(Angle::from_deg(degrees)),
        _ => Err("expected 0 to 90 degrees".to_owned()),
    }
}

/// Reads `erect`, `each-film`, or end vertebrae of regions such as `main-thoracic=T12/T5`.
pub(super) fn end_vertebrae(text: &str) -> Result<EndChoice, String> {
    match text {
        "erect" => return Ok(EndChoice::default()),
        "each-film" => return Ok(EndChoice { rule: EndRule::EachFilm, ..EndChoice::default() }),
        _ => {}
    }
    let mut choice = EndChoice::default();
    for part in text.split(',') {
        let (region, ends) = part.split_once('=').ok_or_else(|| {
            "expected `erect`, `each-film`, or REGION=LEVEL/LEVEL, such as main-thoracic=T12/T5"
                .to_owned()
        })?;
        let region = region_of(region.trim())?;
        let given = &mut choice.given[region.index()];
        if given.is_some() {
            return Err(format!("the {region} curve has its end vertebrae twice"));
        }
        *given = Some(ends_of(ends)?);
    }
    Ok(choice)
}

fn region_of(text: &str) -> Result<Region, String> {
    named(text).map_err(|expected| format!("no region is called `{text}`: {expected}"))
}

fn ends_of(text: &str) -> Result<CobbEnds, String> {
    let (a, b) = text
        .split_once('/')
        .ok_or_else(|| "expected two end vertebrae, such as T12/T5".to_owned())?;
    let (a, b) = (model_level(a)?, model_level(b)?);
    if a == b {
        return Err(format!("a curve needs two end vertebrae, and {a} is given twice"));
    }
    Ok(CobbEnds { inferior: a.min(b), superior: a.max(b) })
}

/// A level of the model.
fn model_level(name: &str) -> Result<Level, String> {
    let level = Level::from_str(name.trim()).map_err(|error| error.to_string())?;
    let of_model = level.model_index().map(|_| level);
    of_model.ok_or_else(|| format!("{level} is not between L4 and T2"))
}

/// Two sites, caudal first, each a disc or the midpoint of a vertebra, such as `L1/T12,T6`.
pub(super) fn inflection_sites(text: &str) -> Result<[Site; 2], String> {
    let site = |text: &str| -> Result<Site, String> {
        let (a, b) = text.split_once('/').unwrap_or((text, text));
        let (a, b) = (model_level(a)?, model_level(b)?);
        let (inferior, superior) = (a.min(b), a.max(b));
        if a != b && inferior.next_above() != Some(superior) {
            return Err(format!(
                "{a} and {b} have no disc between them: give two neighbours, such as L1/T12, or one vertebra"
            ));
        }
        Ok(Site { inferior, superior })
    };
    let (caudal, cranial) =
        text.split_once(',').ok_or_else(|| "expected two sites, such as L1/T12,T6".to_owned())?;
    let sites = [site(caudal)?, site(cranial)?];
    let [below, above] = sites.map(|site| (site.inferior, site.superior));
    if below < above {
        Ok(sites)
    } else {
        Err("the caudal site comes first, and the two sites differ".to_owned())
    }
}

/// Adds lines of action, each of a film that has none yet: `POSTURE=Y,Z,TILT`, with `;` between.
pub(super) fn given_lines(
    lines: &mut Vec<(Posture, LineOfAction)>,
    text: &str,
) -> Result<(), String> {
    for one in text.split(';').map(str::trim).filter(|one| !one.is_empty()) {
        let (posture, line) = given_line(one)?;
        if lines.iter().any(|(other, _)| *other == posture) {
            return Err(format!("the {posture} film has two lines"));
        }
        lines.push((posture, line));
    }
    Ok(())
}

fn given_line(text: &str) -> Result<(Posture, LineOfAction), String> {
    let expected = || "expected POSTURE=Y,Z,TILT, such as left_bending=20,150,-5".to_owned();
    let (name, rest) = text.split_once('=').ok_or_else(expected)?;
    let numbers: Vec<f64> = rest.split(',').map(number).collect::<Result<_, _>>()?;
    let [y, z, tilt] = numbers[..] else { return Err(expected()) };
    let posture = posture(name)?;
    if posture == Posture::Erect {
        return Err("the erect film has no line of action: all others are measured from it; name another film".to_owned());
    }
    if !(-180.0..=180.0).contains(&tilt) {
        return Err(format!("the tilt is {tilt}°, and must be from -180 to 180"));
    }
    Ok((posture, LineOfAction::leaning(Frontal::new(y, z), Angle::from_deg(tilt))))
}

/// `all`, or names of loads with commas between.
pub(super) fn hypotheses(text: &str) -> Result<Vec<Hypothesis>, String> {
    if text == "all" {
        return Ok(Hypothesis::compared());
    }
    let chosen = text.split(',').map(Hypothesis::from_str).collect::<Result<_, _>>();
    chosen.map_err(|error| error.to_string())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn end_vertebrae_are_read_in_either_order_and_wrong_ones_are_explained() {
        let choice = end_vertebrae("main-thoracic=T5/T12, proximal_thoracic=T5/T2").expect("valid");
        let main = CobbEnds { inferior: Level::T12, superior: Level::T5 };
        assert_eq!(choice.given[Region::MainThoracic.index()], Some(main));
        assert!(choice.given[Region::ProximalThoracic.index()].is_some());
        assert_eq!(choice.given[Region::ThoracolumbarLumbar.index()], None);
        assert_eq!(end_vertebrae("each-film").map(|choice| choice.rule), Ok(EndRule::EachFilm));
        for (text, word) in [
            ("thoracic=T5/T12", "main-thoracic"),
            ("main-thoracic=T5", "two end vertebrae"),
            ("main-thoracic=T5/T5", "twice"),
            ("main-thoracic=T5/S1", "S1"),
            ("main-thoracic=T5/L5", "between L4 and T2"),
            ("every", "each-film"),
        ] {
            assert!(end_vertebrae(text).is_err_and(|error| error.contains(word)), "{text}");
        }
    }
}
