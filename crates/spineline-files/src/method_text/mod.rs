//! Options of the method as text: the command line and the Python package spell them alike.
//!
//! ```
//! use spineline::analysis::AnalysisOptions;
//! use spineline_files::method_text::set_option;
//!
//! let mut options = AnalysisOptions::default();
//! set_option(&mut options, "support", "frontal").expect("a known support");
//! let error = set_option(&mut options, "suport", "frontal").expect_err("a misspelt option");
//! assert_eq!(error.to_string(), "unknown option `suport`; did you mean `support`?");
//! ```

mod catalogue;
mod choice;
mod chosen;
mod ends;
mod parse;
mod values;

pub use catalogue::{MethodOption, NamedValue, OPTION_NAMES, OPTIONS, OptionValues, option_named};
pub use choice::{Choice, of_spelling};
pub use chosen::{ChosenOption, ChosenOptions, study_options};
pub use ends::end_vertebrae;
pub use parse::{
    ChosenHypotheses, Prior, StiffnessSource, curve_turn, film_lengths, gauge, given_line,
    hypotheses, inflection_sites, noise, order_rule, prior, read_rotation_prior, site_text,
    stiffness_source,
};
pub use values::{number, posture};

use std::path::Path;

use spineline::analysis::{AnalysisOptions, Case};
use spineline::anatomy::Posture;
use spineline::curve::InflectionChoice;
use spineline::personalize::Gauge;

use crate::FileError;
use crate::json::nearest;

/// An option that cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OptionError {
    /// A name that no option has.
    #[error("unknown option `{name}`{}", nearest.as_ref().map(|n| format!("; did you mean `{n}`?")).unwrap_or_default())]
    Unknown {
        /// The name.
        name: String,
        /// The known name that it resembles most.
        nearest: Option<String>,
    },
    /// A value that the option does not take.
    #[error("option `{name}`, value `{value}`: {reason}")]
    Value {
        /// The option.
        name: String,
        /// What was given.
        value: String,
        /// What is expected.
        reason: String,
    },
    /// A file that cannot be read.
    #[error("option `{name}`: {error}")]
    File {
        /// The option that names it.
        name: String,
        /// Why.
        error: FileError,
    },
}

impl OptionError {
    /// Remedy.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::Unknown { .. } | Self::Value { .. } => {
                "`spineline analyze --help` lists every option with its values"
            }
            Self::File { error, .. } => error.help(),
        }
    }
}

/// Sets one option by its name. A `given_line` is added to those that were given before.
///
/// # Errors
/// [`OptionError`]: no such option, or no such value.
pub fn set_option(
    options: &mut AnalysisOptions,
    name: &str,
    value: &str,
) -> Result<(), OptionError> {
    let name = name.replace('-', "_");
    let refused =
        |reason: String| OptionError::Value { name: name.clone(), value: value.to_owned(), reason };
    let in_file = |error| OptionError::File { name: name.clone(), error };
    match name.as_str() {
        "order_rule" => options.order_rule = order_rule(value).map_err(refused)?,
        "gauge" => options.gauge = gauge(value).map_err(refused)?,
        "support" => options.support = named(value).map_err(refused)?,
        "fit" => options.target = named(value).map_err(refused)?,
        "tilt" => options.tilt = named(value).map_err(refused)?,
        "film_lengths" => options.film_lengths = film_lengths(value).map_err(refused)?,
        "end_vertebrae" => options.ends = end_vertebrae(value).map_err(refused)?,
        "multipliers" => options.grouping = named(value).map_err(refused)?,
        "prior" => options.prior = prior(value).map_err(refused)?.0,
        "rotation_prior" => {
            let stored = read_rotation_prior(Path::new(value)).map_err(in_file)?;
            options.rotation_prior = Some(stored.prior);
        }
        "stiffness" => {
            let source = stiffness_source(value).map_err(refused)?;
            options.library = source.library().map_err(in_file)?;
        }
        "inflections" => {
            let sites = inflection_sites(value).map_err(refused)?;
            options.inflections = InflectionChoice::ByHand(sites);
        }
        "min_curve" => options.min_curve = curve_turn(value).map_err(refused)?,
        "given_line" => options.given_lines.push(given_line(value).map_err(refused)?),
        "compare_models" => options.hypotheses = hypotheses(value).map_err(refused)?.0,
        _ => {
            let nearest = nearest(&name, &OPTION_NAMES);
            return Err(OptionError::Unknown { name, nearest });
        }
    }
    Ok(())
}

/// The film whose force the options know, where the case does not have it: such options do not fit the case.
#[must_use]
pub fn missing_known_force(options: &AnalysisOptions, case: &Case) -> Option<Posture> {
    let Gauge::KnownForce { posture, .. } = options.gauge else { return None };
    let has = case.films.iter().any(|film| film.posture == posture);
    (!has).then_some(posture)
}

/// A named value, in either spelling.
fn named<T: Choice>(text: &str) -> Result<T, String> {
    of_spelling(&text.replace('_', "-")).or_else(|| of_spelling(text)).ok_or_else(|| {
        let known: Vec<&str> = T::ALL.iter().map(|value| value.spelling()).collect();
        let meant = nearest(text, &known).map(|word| format!("; did you mean `{word}`?"));
        format!("expected one of {}{}", known.join(", "), meant.unwrap_or_default())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use spineline::multibody::Support;

    #[test]
    fn every_option_is_set_by_its_name() {
        let values = [
            "paper",
            "frozen-force",
            "free",
            "ferguson",
            "axis",
            "as-marked",
            "each-film",
            "per-joint",
            "in-vivo",
            "in-vitro",
            "L1/T12,T6",
            "7",
            "left_bending=20,150,-5",
            "all",
        ];
        // The tests of the command line have a file of rotations.
        let names = OPTION_NAMES.into_iter().filter(|name| *name != "rotation_prior");
        for (name, value) in names.zip(values) {
            let mut options = AnalysisOptions::default();
            set_option(&mut options, name, value).expect(name);
            assert_ne!(options, AnalysisOptions::default(), "{name}");
        }
    }

    #[test]
    fn sites_are_written_as_they_are_read() {
        for text in ["L1/T12,T6", "L4,T3/T2"] {
            let sites = inflection_sites(text).expect("two sites");
            assert_eq!(sites.map(site_text).join(","), text);
        }
    }

    #[test]
    fn a_wrong_name_or_value_is_answered_with_the_nearest() {
        let mut options = AnalysisOptions::default();
        for (name, value, word) in [
            ("orderrule", "paper", "did you mean `order_rule`?"),
            ("support", "frontl", "did you mean `frontal`?"),
            ("min_curve", "wide", "not a number"),
        ] {
            let error = set_option(&mut options, name, value).expect_err(name).to_string();
            assert!(error.contains(word), "{error}");
        }
        set_option(&mut options, "multipliers", "per_joint").expect("either spelling");
        assert_eq!(options.support, Support::default());
    }
}
