//! Values of options as text that [`parse`](super::parse) reads; empty if no word gives them.

use spineline::action::LineOfAction;
use spineline::analysis::Reference;
use spineline::anatomy::{Named, Posture, Region};
use spineline::clinical::{EndChoice, EndRule};
use spineline::curve::{InflectionChoice, OrderRule, Site};
use spineline::hypothesis::Hypothesis;
use spineline::measure::FilmLengthRule;
use spineline::multibody::{StiffnessLibrary, StiffnessTable};
use spineline::personalize::{Gauge, LogNormalPrior};
use spineline::spatial::Angle;

use crate::stiffness_file::{border, degrees};
use crate::text::written_deg;

/// The key of a value, with `-`.
pub(super) fn spelling<T: Named>(value: T) -> String {
    value.key().replace('_', "-")
}

pub(super) fn order_rule(rule: OrderRule) -> String {
    rule.key().replace('_', "-")
}

pub(super) fn gauge(gauge: Gauge) -> String {
    let key = gauge.key().replace('_', "-");
    match gauge {
        Gauge::KnownForce { posture, force_n } => format!("{key}:{}={force_n}", posture.key()),
        Gauge::GeometricMean | Gauge::FrozenForce => key,
    }
}

pub(super) fn reference(reference: Reference) -> String {
    let key = reference.key();
    match reference {
        Reference::Unloaded => key.to_owned(),
        Reference::Loaded { body_mass_kg } => format!("{key}:{body_mass_kg}"),
    }
}

pub(super) fn film_lengths(rule: FilmLengthRule) -> String {
    match rule {
        FilmLengthRule::AsMarked => "as-marked".to_owned(),
        rule if rule == FilmLengthRule::default() => "per-film".to_owned(),
        FilmLengthRule::PerFilm { relative_sd } => {
            border(relative_sd, 100.0 * relative_sd, |percent| 0.01 * percent).to_string()
        }
    }
}

pub(super) fn end_vertebrae(choice: &EndChoice) -> String {
    let ends = Region::ALL.into_iter().zip(choice.given).filter_map(|(region, ends)| {
        let ends = ends?;
        Some(format!("{}={}/{}", spelling(region), ends.inferior, ends.superior))
    });
    let ends: Vec<String> = ends.collect();
    match choice.rule {
        _ if !ends.is_empty() => ends.join(","),
        EndRule::Erect | EndRule::EachFilm => spelling(choice.rule),
    }
}

pub(super) fn prior(prior: Option<LogNormalPrior>) -> String {
    match prior {
        None => "none".to_owned(),
        Some(LogNormalPrior::IN_VIVO) => "in-vivo".to_owned(),
        Some(prior) => prior.log_sd.to_string(),
    }
}

pub(super) fn stiffness(library: &StiffnessLibrary) -> String {
    let table = StiffnessTable::ALL.into_iter().find(|table| table.library() == *library);
    table.map(spelling).unwrap_or_default()
}

pub(super) fn inflections(choice: InflectionChoice) -> String {
    match choice {
        InflectionChoice::Automatic => String::new(),
        InflectionChoice::ByHand(sites) => sites.map(site_text).join(","),
    }
}

/// A place of an inflection: a vertebra or a disc.
#[must_use]
pub fn site_text(site: Site) -> String {
    if site.inferior == site.superior {
        site.inferior.to_string()
    } else {
        format!("{}/{}", site.inferior, site.superior)
    }
}

pub(super) fn min_curve(angle: Angle) -> String {
    degrees(angle).to_string()
}

pub(super) fn given_lines(lines: &[(Posture, LineOfAction)]) -> String {
    let line = |(posture, line): &(Posture, LineOfAction)| {
        // The sine and cosine of an angle round it.
        let tilt_deg = written_deg(line.lateral_tilt());
        format!("{}={},{},{tilt_deg}", posture.key(), line.point.y_mm, line.point.z_mm)
    };
    lines.iter().map(line).collect::<Vec<_>>().join("; ")
}

pub(super) fn hypotheses(all: &[Hypothesis]) -> String {
    if all == Hypothesis::compared() {
        return "all".to_owned();
    }
    let names = all.iter().map(|one| one.key().replace('_', "-"));
    names.collect::<Vec<_>>().join(",")
}
