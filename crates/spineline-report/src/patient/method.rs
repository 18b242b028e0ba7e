//! How a report was made.

use spineline::analysis::{Analysis, AnalysisOptions, Grouping};
use spineline::anatomy::PublishedNumbers;
use spineline::curve::{InflectionChoice, OrderRule};
use spineline::measure::{FilmLengthRule, TiltRule};
use spineline::multibody::{StiffnessLibrary, Support};
use spineline::personalize::{FitTarget, Gauge};

use super::Patient;
use crate::document::{Column, Section, Table};

/// Version, choices and sources of one patient's analysis.
pub fn how(patient: &Patient<'_>) -> Section {
    let mut section = Section::new("method", "How this report was made");
    let mut table = options(patient.generator, &patient.analysis.options);
    let mut add = |what: &str, words: String| table.row(vec![what.to_owned(), words]);
    let analysis: &Analysis = patient.analysis;
    add("Films", if analysis.synthetic { "synthetic" } else { "real" }.to_owned());
    add("Lengths", analysis.movement.scale().to_string());
    add("Sagittal shape", analysis.profile_words().to_owned());
    section.table(table);
    section.table(published());
    section.paragraph(MEANING);
    section
}

/// The published numbers of a typical spine, and how far they were compared with their sources.
pub(crate) fn published() -> Table {
    let columns = vec![
        Column::words("Numbers"),
        Column::words("Used for"),
        Column::words("Source"),
        Column::words("Compared"),
    ];
    let mut table = Table::new("Published numbers of a typical spine", columns);
    for one in PublishedNumbers::ALL {
        let words = [one.numbers, one.used_for, one.source].map(str::to_owned);
        table.row(words.into_iter().chain([one.check.to_string()]).collect());
    }
    table.note = "Springs have their sources in the table of springs.".to_owned();
    table
}

const MEANING: &str = "Method: Jalalian et al. 2016, Finding line of action of the force exerted on erect spine based on lateral bending test in personalization of scoliotic spine models. Bending films carry no force, so only ratios of stiffness are identified. Sources are named by their keys in the project's list of references.";

/// Version and choices, which all patients of a run share.
pub(crate) fn options(generator: &str, options: &AnalysisOptions) -> Table {
    let mut table =
        Table::new("Version and options", vec![Column::words("What"), Column::words("Choice")]);
    let mut add = |what: &str, words: String| table.row(vec![what.to_owned(), words]);
    add("Program", generator.to_owned());
    add("Order of the curves", order_words(options.order_rule));
    add("Inflections", inflection_words(options));
    add("Scale constraint (gauge)", gauge_words(options.gauge));
    add(
        "Support",
        match options.support {
            Support::Free => "free: every joint rotates about three axes (the paper)",
            Support::Frontal => "frontal: flexion and axial hinges are locked",
        }
        .to_owned(),
    );
    add(
        "Fitted to",
        match options.target {
            FitTarget::Shape => "locations and tilts of all vertebrae",
            FitTarget::Ferguson => "three Ferguson angles per bend (the paper)",
        }
        .to_owned(),
    );
    add(
        "Multipliers",
        match options.grouping {
            Grouping::Regional => "one per region (the paper)",
            Grouping::PerJoint => "one per joint",
        }
        .to_owned(),
    );
    let prior = options.prior.map_or_else(
        || "none".to_owned(),
        |prior| format!("log-normal, standard deviation of ln {}", prior.log_sd),
    );
    add("Prior of the multipliers", prior);
    add("Stiffness table", library_words(&options.library));
    table
}

/// The options that differ from the defaults, with what was chosen; empty for the defaults.
///
/// The distribution of joint rotations and the compared loads change no model and have sections of their own.
pub(crate) fn changed(options: &AnalysisOptions) -> String {
    let usual = AnalysisOptions::default();
    let [chosen, defaults] = [options, &usual].map(|one| self::options("", one).rows);
    let rows = chosen.into_iter().zip(defaults).filter(|(chosen, usual)| chosen != usual);
    let mut words: Vec<String> = rows.map(|(chosen, _)| chosen.join(": ")).collect();
    let mut add = |differs: bool, text: &str| words.extend(differs.then(|| text.to_owned()));
    add(options.tilt != usual.tilt, tilt_words(options.tilt));
    let lengths = format!("Lengths of the films: {}", length_words(options.film_lengths));
    add(options.film_lengths != usual.film_lengths, &lengths);
    add(options.ends != usual.ends, "End vertebrae of Cobb angles: chosen otherwise");
    add(options.segment_window != usual.segment_window, "Number of segments: given");
    add(options.profile != usual.profile, "Sagittal shape: given");
    add(!options.given_lines.is_empty(), "Given line of action: added");
    words.join("; ")
}

const fn tilt_words(rule: TiltRule) -> &'static str {
    match rule {
        TiltRule::Endplates => "Tilts: by both endplates",
        TiltRule::Axis => "Tilts: by the line through the centres of the endplates (the paper)",
    }
}

fn length_words(rule: FilmLengthRule) -> String {
    match rule {
        FilmLengthRule::PerFilm { relative_sd } => {
            format!(
                "every film has a scale of its own, standard deviation {:.1} %",
                100.0 * relative_sd
            )
        }
        FilmLengthRule::AsMarked => "one scale for all films (the paper)".to_owned(),
    }
}

fn order_words(rule: OrderRule) -> String {
    match rule {
        OrderRule::LeaveOneOut => {
            "smallest order whose error on left-out vertebrae is within 5 % of the best".to_owned()
        }
        OrderRule::Paper => {
            "the paper's: smallest residual among orders with two inflections".to_owned()
        }
        OrderRule::Fixed(order) => format!("{order}, given"),
    }
}

fn inflection_words(options: &AnalysisOptions) -> String {
    let from = match options.inflections {
        InflectionChoice::Automatic => "from the erect curve",
        InflectionChoice::ByHand(_) => "picked by hand",
    };
    format!("{from}; a curve between inflections counts from {} on", options.min_curve)
}

fn gauge_words(gauge: Gauge) -> String {
    match gauge {
        Gauge::GeometricMean => "geometric mean of the multipliers is held at 1, to 0.1 % with frontal and 1 % with free support".to_owned(),
        Gauge::FrozenForce => "forces fixed at those of the nominal stiffness".to_owned(),
        Gauge::KnownForce { posture, force_n } => {
            format!("the force of the {posture} film is {force_n} N")
        }
    }
}

/// The sources of a table, each once, in their order.
fn library_words(library: &StiffnessLibrary) -> String {
    let mut sources: Vec<&str> = Vec::new();
    for row in library.rows() {
        if !sources.contains(&row.source.as_str()) {
            sources.push(&row.source);
        }
    }
    let built_in = if *library == StiffnessLibrary::default() { "built in" } else { "the user's" };
    format!("{built_in}: {}", sources.join("; "))
}
