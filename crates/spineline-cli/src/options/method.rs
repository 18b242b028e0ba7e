//! Choices of the method.

use std::path::Path;

use clap::builder::ValueParser;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command, FromArgMatches, ValueHint};
use spineline::analysis::AnalysisOptions;
use spineline::multibody::Support;
use spineline_files::StoredRotationPrior;
use spineline_files::method_text::{MethodOption, OPTIONS, OptionError, OptionValues, options_of};

use super::choice::spelling;
use crate::run::failure::Failure;
use crate::run::messages::say;

/// Choices of the method: one for each of [`OPTIONS`].
pub struct MethodArgs {
    /// Those that were given, with their values, in the order of [`OPTIONS`].
    given: Vec<(&'static MethodOption, String)>,
}

impl Args for MethodArgs {
    fn augment_args(command: Command) -> Command {
        command.next_help_heading("Method").args(OPTIONS.iter().map(arg))
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

/// The argument of an option.
fn arg(option: &'static MethodOption) -> Arg {
    let parser: ValueParser = match option.values {
        OptionValues::Named(values) if !option.takes_a_file() => spelling(values()).into(),
        _ => {
            let read = |text: &str| option.check(text).map(|()| text.to_owned());
            ValueParser::from(read)
        }
    };
    let arg = Arg::new(option.name)
        .long(option.name.replace('_', "-"))
        .help(option.help)
        .value_name(option.value_name)
        .value_parser(parser)
        .action(if option.may_repeat { ArgAction::Append } else { ArgAction::Set });
    let takes_only_files = option.takes_a_file() && option.named_values().is_empty();
    let arg = if takes_only_files { arg.value_hint(ValueHint::AnyPath) } else { arg };
    let default = option.default_text();
    if default.is_empty() { arg } else { arg.default_value(default) }
}

impl FromArgMatches for MethodArgs {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let is_given = |option: &&MethodOption| {
            matches.value_source(option.name) == Some(ValueSource::CommandLine)
        };
        let values = |option: &'static MethodOption| {
            let values = matches.get_many::<String>(option.name).into_iter().flatten();
            values.map(move |value| (option, value.clone()))
        };
        Ok(Self { given: OPTIONS.iter().filter(is_given).flat_map(values).collect() })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

impl MethodArgs {
    /// The library's options, and the distribution of joint rotations that is read from a file.
    ///
    /// # Errors
    /// If a file cannot be read, or joint rotations were learned with tilts of another rule.
    pub fn options(&self) -> Result<(AnalysisOptions, Option<StoredRotationPrior>), Failure> {
        let given = self.given.iter().map(|(option, value)| (option.name, value.as_str()));
        let (options, files) = options_of(given).map_err(|error| match error {
            OptionError::File { name, error } => {
                let value = self.given.iter().find(|(option, _)| option.name == name);
                let path = value.map_or("", |(_, value)| value.as_str());
                Failure::file(Path::new(path), &error)
            }
            other => Failure::usage(format!("{other}; {}", other.help())),
        })?;
        self.check_idle(&options)?;
        Ok((options, files.into_iter().find_map(|file| file.rotation_prior)))
    }

    /// Whether an option was given, by its name in [`OPTIONS`].
    pub fn is_given(&self, name: &str) -> bool {
        self.given.iter().any(|(option, _)| option.name == name)
    }

    /// Refuses an option that another one leaves without effect, and notes one that the support does.
    fn check_idle(&self, options: &AnalysisOptions) -> Result<(), Failure> {
        if self.is_given("inflections") && self.is_given("min_curve") {
            return Err(Failure::usage(
                "--min-curve is for inflections that are found, and --inflections sets them by hand; give one of both",
            ));
        }
        let mut rows = options.library.rows().iter();
        if self.is_given("stiffness")
            && options.support == Support::Frontal
            && rows.any(|row| row.axial_per_lateral != 0.0)
        {
            say(
                "note: the coupling of --stiffness counts with --support free only; --support frontal locks axial rotation",
            );
        }
        Ok(())
    }

    /// Files that the options name: they are inputs.
    pub fn files(&self) -> impl Iterator<Item = &Path> {
        let files = self.given.iter().rev().filter(|(option, value)| option.names_a_file(value));
        files.map(|(_, value)| Path::new(value))
    }
}
