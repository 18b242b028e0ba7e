//! Values of options in the words of a report.

use spineline::action::LineOfAction;
use spineline::analysis::Reference;
use spineline::anatomy::{Named, Posture};
use spineline::clinical::EndChoice;
use spineline::curve::{InflectionChoice, OrderRule};
use spineline::evaluate::RotationPrior;
use spineline::hypothesis::Hypothesis;
use spineline::measure::FilmLengthRule;
use spineline::multibody::StiffnessLibrary;
use spineline::personalize::{Gauge, LogNormalPrior};

use super::show;

/// A value with its help: `free: every joint rotates about three axes (the paper)`.
pub(super) fn named<T: Named>(value: T) -> String {
    let help = value.help();
    let mut letters = help.trim_end_matches('.').chars();
    let first = letters.next().map(|first| first.to_ascii_lowercase());
    let help: String = first.into_iter().chain(letters).collect();
    format!("{}: {help}", show::spelling(value))
}

pub(super) fn order_rule(rule: OrderRule) -> String {
    match rule {
        OrderRule::LeaveOneOut => {
            "smallest order with an error on left-out vertebrae within 5 % of the best".to_owned()
        }
        OrderRule::Paper => "the paper's: smallest residual, nearly always order 12".to_owned(),
        OrderRule::TwoInflections => {
            "smallest residual among orders with two inflections".to_owned()
        }
        OrderRule::Fixed(order) => format!("{order}, given"),
    }
}

pub(super) fn gauge(gauge: Gauge) -> String {
    match gauge {
        Gauge::GeometricMean => "geometric mean of the multipliers is held at 1".to_owned(),
        Gauge::FrozenForce => "forces fixed at their values with the nominal stiffness".to_owned(),
        Gauge::KnownForce { posture, force_n } => {
            format!("the force of the {posture} film is {force_n} N")
        }
    }
}

pub(super) fn reference(reference: Reference) -> String {
    match reference {
        Reference::Unloaded => "springs are unstressed on the erect film (the paper)".to_owned(),
        Reference::Loaded { body_mass_kg } => format!(
            "springs carry the trunk of a body of {body_mass_kg} kg on the erect film; all other films are without this weight"
        ),
    }
}

pub(super) fn film_lengths(rule: FilmLengthRule) -> String {
    match rule {
        FilmLengthRule::PerFilm { relative_sd } => {
            let percent = (1e11 * relative_sd).round() / 1e9;
            format!(
                "every film has its own scale, standard deviation {percent} % where it or the erect film states no error"
            )
        }
        FilmLengthRule::AsMarked => "one scale for all films (the paper)".to_owned(),
    }
}

pub(super) fn end_vertebrae(choice: &EndChoice) -> String {
    if choice.given.iter().all(Option::is_none) {
        return named(choice.rule);
    }
    format!("{}, given", show::end_vertebrae(choice))
}

pub(super) fn prior(prior: Option<LogNormalPrior>) -> String {
    let words =
        |prior: LogNormalPrior| format!("log-normal, standard deviation of ln {}", prior.log_sd);
    prior.map_or_else(|| "none".to_owned(), words)
}

pub(super) fn rotation_prior(prior: Option<&RotationPrior>) -> String {
    if prior.is_some() { "learned from other patients" } else { "published mobilities" }.to_owned()
}

/// The sources of a table, each once, in their order.
pub(super) fn stiffness(library: &StiffnessLibrary) -> String {
    let mut sources: Vec<&str> = Vec::new();
    for row in library.rows() {
        if !sources.contains(&row.source.as_str()) {
            sources.push(&row.source);
        }
    }
    let from = match show::stiffness(library) {
        name if name.is_empty() => "the user's".to_owned(),
        name => name,
    };
    format!("{from}: {}", sources.join("; "))
}

pub(super) fn inflections(choice: InflectionChoice) -> String {
    match choice {
        InflectionChoice::Automatic => "from the erect curve".to_owned(),
        InflectionChoice::ByHand(_) => format!("{}, picked by hand", show::inflections(choice)),
    }
}

pub(super) fn given_lines(lines: &[(Posture, LineOfAction)]) -> String {
    if lines.is_empty() { "none".to_owned() } else { show::given_lines(lines) }
}

pub(super) fn hypotheses(all: &[Hypothesis]) -> String {
    if all.is_empty() { "none".to_owned() } else { show::hypotheses(all) }
}
