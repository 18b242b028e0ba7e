//! Options of the method as text, each defined once in [`OPTIONS`]: command line, Python package, form of a study, reports and files
//! follow.
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

mod chosen;
mod parse;
mod show;
mod table;
mod words;

pub use chosen::{ChosenOption, ChosenOptions, study_options};
pub use parse::{named, noise, number, posture};
pub use show::site_text;
pub use table::{
    MethodOption, NamedValue, OPTIONS, OptionValues, departures, named_values, nearest_method,
};

#[cfg(test)]
pub(crate) use tests::all_others;

use std::path::PathBuf;

use serde::Serialize;
use spineline::analysis::{AnalysisOptions, Case, Grouping};
use spineline::anatomy::Posture;
use spineline::personalize::{FitTarget, Gauge};

use crate::nearest::nearest;
use crate::{FileError, InputFile, StoredRotationPrior, read_text};

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
    /// A file of an analysis without this option.
    #[error("option `{name}` is missing")]
    Missing {
        /// The option.
        name: String,
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
            Self::Unknown { .. } | Self::Value { .. } | Self::Missing { .. } => {
                "`spineline analyze --help` lists every option with its values"
            }
            Self::File { error, .. } => error.help(),
        }
    }
}

/// The option of a name, in either spelling, with its place in [`OPTIONS`].
fn option_of(name: &str) -> Result<(usize, &'static MethodOption), OptionError> {
    let name = name.replace('-', "_");
    OPTIONS.iter().enumerate().find(|(_, option)| option.name == name).ok_or_else(|| {
        let nearest = nearest(&name, &OPTIONS.map(|option| option.name));
        OptionError::Unknown { name, nearest }
    })
}

/// The file that the value of an option names; `None` where the value is a word.
#[must_use]
pub fn option_file(name: &str, value: &str) -> Option<PathBuf> {
    option_of(name).ok()?.1.names_a_file(value).then(|| PathBuf::from(value))
}

/// A file that an option names.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OptionFile {
    /// The option.
    pub option: String,
    /// The file.
    #[serde(flatten)]
    pub file: InputFile,
    /// The distribution of joint rotations that it holds.
    #[serde(skip)]
    pub rotation_prior: Option<StoredRotationPrior>,
}

/// The options of these names and values, and the files that the values name. They are set in the order of [`OPTIONS`], in whichever
/// order they are given; an option that may be repeated has all of its values.
///
/// # Errors
/// [`OptionError`]: an unknown option, an unknown value, a file that cannot be read, or joint rotations that were learned with other tilts.
pub fn options_of<'a>(
    given: impl IntoIterator<Item = (&'a str, &'a str)>,
) -> Result<(AnalysisOptions, Vec<OptionFile>), OptionError> {
    let mut files = Vec::new();
    let options = set_in_order(given, |options, name, value| {
        files.extend(set_option(options, name, value)?);
        Ok(())
    })?;
    Ok((options, files))
}

/// Sets options one after the other in the order of [`OPTIONS`].
pub(crate) fn set_in_order<'a>(
    given: impl IntoIterator<Item = (&'a str, &'a str)>,
    mut set: impl FnMut(&mut AnalysisOptions, &'static str, &'a str) -> Result<(), OptionError>,
) -> Result<AnalysisOptions, OptionError> {
    let known = given.into_iter().map(|(name, value)| Ok((option_of(name)?, value)));
    let mut known: Vec<_> = known.collect::<Result<_, OptionError>>()?;
    known.sort_by_key(|((place, _), _)| *place);
    let is_fit_given = known.iter().any(|((_, option), _)| option.name == "fit");
    let mut options = AnalysisOptions::default();
    for ((_, option), value) in known {
        set(&mut options, option.name, value)?;
    }
    replace_fit_of_joints(&mut options, is_fit_given);
    Ok(options)
}

/// Multipliers per joint replace a fit to Ferguson angles that is a choice of the method. The analysis refuses one that is given.
fn replace_fit_of_joints(options: &mut AnalysisOptions, is_fit_given: bool) {
    if options.grouping == Grouping::PerJoint && !is_fit_given {
        options.target = FitTarget::Shape;
    }
}

/// Sets one option by its name, and returns the file that its value names, if it names one. A `given_line` is added to those that
/// were given before; joint rotations are checked against the tilts that are set.
///
/// # Errors
/// [`OptionError`]: an unknown option, an unknown value, or a file that cannot be read or used.
pub fn set_option(
    options: &mut AnalysisOptions,
    name: &str,
    value: &str,
) -> Result<Option<OptionFile>, OptionError> {
    let Some(path) = option_file(name, value) else {
        set_option_of_text(options, name, value, None)?;
        return Ok(None);
    };
    let option = name.replace('-', "_");
    let text =
        read_text(&path).map_err(|error| OptionError::File { name: option.clone(), error })?;
    let rotation_prior = set_option_of_text(options, name, value, Some(&text))?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    let file = InputFile::of(name, text.as_bytes());
    Ok(Some(OptionFile { option, file, rotation_prior }))
}

/// Sets one option without reading a file: where its value names one, the text of the file is given. Returns the distribution of joint
/// rotations that the file holds.
pub(crate) fn set_option_of_text(
    options: &mut AnalysisOptions,
    name: &str,
    value: &str,
    file: Option<&str>,
) -> Result<Option<StoredRotationPrior>, OptionError> {
    let (_, option) = option_of(name)?;
    let name = option.name.to_owned();
    let refused =
        |reason| OptionError::Value { name: name.clone(), value: value.to_owned(), reason };
    let in_file = |error| OptionError::File { name: name.clone(), error };
    match (file, option.read_file) {
        (None, _) => (option.read)(options, value).map(|()| None).map_err(refused),
        (Some(_), None) => Err(refused("this option takes no file".to_owned())),
        (Some(text), Some(read)) => {
            let learned = read(options, text).map_err(in_file)?;
            if let Some(prior) = &learned {
                prior.check_tilt(options.tilt).map_err(in_file)?;
            }
            Ok(learned)
        }
    }
}

/// The film of the known force, if the case lacks it: such options do not fit the case.
#[must_use]
pub fn missing_known_force(options: &AnalysisOptions, case: &Case) -> Option<Posture> {
    let Gauge::KnownForce { posture, .. } = options.gauge else { return None };
    case.film(posture).is_none().then_some(posture)
}

#[cfg(test)]
mod tests {
    use super::parse::inflection_sites;
    use super::*;
    use nalgebra::DMatrix;
    use spineline::analysis::Method;
    use spineline::anatomy::Levels;
    use spineline::evaluate::{PriorSource, RotationPrior};
    use spineline::multibody::{StiffnessTable, Support};
    use spineline::spatial::Angle;

    /// Another value of every option than the default; empty where only a file has one.
    const OTHERS: [&str; OPTIONS.len()] = [
        "paper",
        "paper",
        "known-force:traction=117.3",
        "free",
        "loaded:47.5",
        "ferguson",
        "axis",
        "t1-l5",
        "2.7",
        "main-thoracic=T12/T5,proximal-thoracic=T5/T2",
        "per-joint",
        "in-vivo",
        "",
        "in-vitro",
        "L1/T12,T6",
        "4.1",
        "left_bending=20,150,-5; right_bending=-20.25,150,7.3",
        "couple,inflection-line+free-base",
    ];

    /// Options of which every one has another value than the default.
    pub fn all_others() -> AnalysisOptions {
        let given = OPTIONS.iter().map(|option| option.name).zip(OTHERS);
        let (options, _) =
            options_of(given.filter(|(_, value)| !value.is_empty())).expect("sound values");
        let source = PriorSource::Learned { patients: 7, bends: 13, shrinkage: 0.25 };
        let covariance_rad2 = DMatrix::identity(14, 14) * Angle::from_deg(1.0).rad().powi(2);
        let mean = vec![Angle::ZERO; 14];
        let learned = RotationPrior::new(Levels::COMPLETE, mean, covariance_rad2, source);
        AnalysisOptions { rotation_prior: Some(learned.expect("a covariance")), ..options }
    }

    #[test]
    fn every_field_of_the_options_is_set_by_an_option() {
        // A new field does not compile here until it is compared too.
        let AnalysisOptions {
            tilt,
            amplitude,
            film_lengths,
            order_rule,
            inflections,
            min_curve,
            ends,
            library,
            support,
            reference,
            gauge,
            target,
            grouping,
            prior,
            rotation_prior,
            given_lines,
            hypotheses,
        } = all_others();
        let usual = AnalysisOptions::default();
        let differ = [
            tilt != usual.tilt,
            amplitude != usual.amplitude,
            film_lengths != usual.film_lengths,
            order_rule != usual.order_rule,
            inflections != usual.inflections,
            min_curve != usual.min_curve,
            ends != usual.ends,
            library != usual.library,
            support != usual.support,
            reference != usual.reference,
            gauge != usual.gauge,
            target != usual.target,
            grouping != usual.grouping,
            prior != usual.prior,
            rotation_prior != usual.rotation_prior,
            given_lines != usual.given_lines,
            hypotheses != usual.hypotheses,
        ];
        // The first option is the method itself.
        assert_eq!(differ, [true; OPTIONS.len() - 1]);
    }

    #[test]
    fn every_option_shows_the_value_that_it_was_set_to() {
        for (option, value) in OPTIONS.iter().zip(OTHERS).filter(|(_, value)| !value.is_empty()) {
            let usual = AnalysisOptions::default();
            let mut options = usual.clone();
            set_option(&mut options, option.name, value).expect(option.name);
            assert_ne!(options, usual, "{}", option.name);
            assert_eq!((option.show)(&options), value, "{}", option.name);
            assert_ne!(option.words(&options), option.words(&usual), "{}", option.name);
        }
    }

    #[test]
    fn every_default_that_is_shown_is_the_default_of_the_library() {
        for option in OPTIONS.iter().filter(|option| !option.default_text().is_empty()) {
            let mut options = all_others();
            options.given_lines.clear();
            set_option(&mut options, option.name, &option.default_text()).expect(option.name);
            assert_eq!((option.show)(&options), option.default_text());
            let mut options = AnalysisOptions::default();
            set_option(&mut options, option.name, &option.default_text()).expect(option.name);
            assert_eq!(options, AnalysisOptions::default(), "{}", option.name);
        }
    }

    #[test]
    fn options_are_set_in_the_order_of_the_table() {
        let given = [("given_line", "left_bending=1,2,3"), ("given-line", "right-bending=4,5,6")];
        let (options, _) = options_of(given).expect("two lines");
        assert_eq!(options.given_lines.len(), 2);
        let twice = options_of([given[0], given[0]]).expect_err("one film").to_string();
        assert!(twice.contains("two lines"), "{twice}");
    }

    #[test]
    fn other_options_replace_choices_of_the_method_in_either_order() {
        let frontal = AnalysisOptions { support: Support::Frontal, ..AnalysisOptions::paper() };
        let given = [("method", "paper"), ("support", "frontal")];
        for given in [given, [given[1], given[0]]] {
            assert!(options_of(given).expect("sound values").0 == frontal);
        }
        assert_eq!(nearest_method(&frontal), Method::Paper);
        let names: Vec<&str> =
            departures(&frontal, &AnalysisOptions::paper()).map(|option| option.name).collect();
        assert_eq!(names, ["support"]);
        assert_eq!(nearest_method(&AnalysisOptions::default()), Method::Default);
        let (paper, usual) = (AnalysisOptions::paper(), AnalysisOptions::default());
        let names: Vec<&str> = departures(&paper, &usual).map(|option| option.name).collect();
        let choices = ["order_rule", "support", "fit", "tilt", "amplitude", "film_lengths"];
        assert_eq!(names, choices);
    }

    #[test]
    fn the_scales_of_films_have_the_stated_error_of_the_films_first() {
        let option = OPTIONS.iter().find(|option| option.name == "film_lengths").expect("one");
        assert_eq!(
            option.words(&AnalysisOptions::default()),
            "every film has its own scale, standard deviation 3.3 % where it or the erect film states no error"
        );
    }

    #[test]
    fn multipliers_per_joint_replace_the_fit_of_the_method_and_not_a_given_one() {
        let paper = AnalysisOptions::paper();
        let given = [("multipliers", "per-joint"), ("method", "paper"), ("fit", "ferguson")];
        let (options, _) = options_of(given[..2].iter().copied()).expect("sound values");
        assert_eq!(options.target, FitTarget::Shape);
        let names: Vec<&str> = departures(&options, &paper).map(|option| option.name).collect();
        assert_eq!(names, ["fit", "multipliers"]);
        let (refused, _) = options_of(given).expect("sound values, each by itself");
        assert_eq!((refused.target, refused.grouping), (FitTarget::Ferguson, Grouping::PerJoint));
        let words = given[..2].iter().map(|(name, value)| ChosenOption::word(name, value));
        let chosen = ChosenOptions::new(&words.collect::<Vec<_>>()).expect("a choice of a study");
        assert!(chosen.options().expect("sound values").0 == options);
        let fit = OPTIONS.iter().find(|option| option.name == "fit").expect("an option");
        assert_eq!(fit.shown(&chosen.before(fit).expect("sound values")), "shape");
    }

    #[test]
    fn the_named_values_of_an_option_are_all_that_it_reads() {
        for option in OPTIONS.iter().filter(|option| !option.named_values().is_empty()) {
            let mut options = AnalysisOptions::default();
            let error = (option.read)(&mut options, "?").expect_err(option.name);
            let all: Vec<String> =
                option.named_values().into_iter().map(|one| one.spelling).collect();
            assert_eq!(error, format!("expected one of {}", all.join(", ")), "{}", option.name);
        }
    }

    #[test]
    fn the_file_of_every_option_that_takes_one_is_named_by_its_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("own.json");
        for option in OPTIONS.iter().filter(|option| option.takes_a_file()) {
            let value = path.to_str().expect("a path");
            assert_eq!(option_file(option.name, value), Some(path.clone()));
            let mut options = AnalysisOptions::default();
            let error = set_option(&mut options, option.name, value).expect_err("no file");
            assert!(matches!(error, OptionError::File { .. }), "{error}");
        }
        let text = crate::to_text(&crate::StiffnessFile::from(&StiffnessTable::InVitro.library()));
        std::fs::write(&path, &text).expect("a file");
        let mut options = AnalysisOptions::default();
        let read = set_option(&mut options, "stiffness", path.to_str().expect("a path"));
        let read = read.expect("a table").map(|one| one.file);
        assert_eq!(read, Some(InputFile::of("own.json", text.as_bytes())));
        assert_eq!(options.library, StiffnessTable::InVitro.library());
        // A word is not a file, in either spelling.
        for word in ["in-vitro", "in_vitro"] {
            assert_eq!(option_file("stiffness", word), None);
            assert_eq!(set_option(&mut options, "stiffness", word).expect("a table"), None);
        }
    }

    #[test]
    fn sites_are_written_as_they_are_read() {
        for text in ["L1/T12,T6", "L4,T3/T2"] {
            let sites = inflection_sites(text).expect("two sites");
            assert_eq!(sites.map(site_text).join(","), text);
        }
        for (text, words) in [
            ("L1/T3,T2", "L1 and T3 have no disc between them: give two neighbours"),
            ("T6,L1", "the caudal site comes first"),
            ("T6,T6", "the two sites differ"),
            ("L1/T12,L1", "the caudal site comes first"),
        ] {
            let error = inflection_sites(text).expect_err(text);
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn a_wrong_name_is_answered_with_the_nearest_and_a_wrong_value_with_all() {
        let mut options = AnalysisOptions::default();
        for (name, value, word) in [
            ("orderrule", "paper", "did you mean `order_rule`?"),
            ("support", "frontl", "expected one of"),
            ("min_curve", "wide", "not a number"),
        ] {
            let error = set_option(&mut options, name, value).expect_err(name).to_string();
            assert!(error.contains(word), "{error}");
            assert_eq!(error.contains("did you mean"), name == "orderrule", "{error}");
        }
        set_option(&mut options, "multipliers", "per_joint").expect("either spelling");
        assert_eq!(options.support, Support::default());
    }
}
