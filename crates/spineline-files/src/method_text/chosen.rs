//! Options that were chosen for a study, as texts.

use serde::{Deserialize, Serialize};
use spineline::analysis::AnalysisOptions;

use super::{
    MethodOption, OPTIONS, OptionError, option_of, replace_fit_of_joints, set_option_of_text,
};
use crate::{StoredRotationPrior, sha256_hex};

/// An option with its value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChosenOption {
    /// Its name.
    pub name: String,
    /// Its value, or the text of a file.
    pub value: String,
    /// The name of that file, without its folder; `None` where the value is a word.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
}

impl ChosenOption {
    /// A value that is a word.
    #[must_use]
    pub fn word(name: &str, value: &str) -> Self {
        Self { name: name.to_owned(), value: value.to_owned(), file: None }
    }

    /// The value in a few words: of a file its name, and which one it is.
    #[must_use]
    pub fn words(&self) -> String {
        match &self.file {
            Some(file) => {
                let digest = sha256_hex(self.value.as_bytes());
                format!("{file} (SHA-256 {}…)", &digest[..12])
            }
            None => self.value.clone(),
        }
    }

    /// What the option is; empty where the program does not know it.
    fn title(&self) -> &'static str {
        option_of(&self.name).map_or("", |(_, option)| option.title)
    }

    /// Sets the option without reading a file.
    fn set(
        &self,
        options: &mut AnalysisOptions,
    ) -> Result<Option<StoredRotationPrior>, OptionError> {
        if option_of(&self.name).is_ok_and(|(_, option)| !option.of_a_study) {
            return Err(self.refused("a study does not keep this option"));
        }
        match &self.file {
            None => set_option_of_text(options, &self.name, &self.value, None),
            Some(file) => set_option_of_text(options, &self.name, file, Some(&self.value)),
        }
    }

    /// The option as the command line takes it; of a file its name.
    fn argument(&self) -> String {
        let value = self.file.as_ref().unwrap_or(&self.value);
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.,:=/+".contains(c);
        let quote = if value.chars().all(is_plain) { "" } else { "\"" };
        format!("--{} {quote}{value}{quote}", self.name.replace('_', "-"))
    }

    fn refused(&self, reason: impl Into<String>) -> OptionError {
        let value = self.file.clone().unwrap_or_else(|| self.value.clone());
        OptionError::Value { name: self.name.clone(), value, reason: reason.into() }
    }
}

/// The options of a study that differ from the defaults and from the chosen method, each once, in the order of [`OPTIONS`].
///
/// They read no files, so a value from elsewhere cannot open one: the content of a file is kept as text.
///
/// ```
/// use spineline_files::method_text::{ChosenOption, ChosenOptions};
///
/// let chosen = ChosenOptions::new(&[
///     ChosenOption::word("support", "free"),
///     ChosenOption::word("tilt", "endplates"),
/// ])?;
/// assert_eq!(chosen.all(), [ChosenOption::word("support", "free")]); // the other one is the default
/// # Ok::<(), spineline_files::method_text::OptionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ChosenOptions(Vec<ChosenOption>);

impl ChosenOptions {
    /// Checks options, and keeps those that differ from the defaults, or from the choices of the method among them.
    ///
    /// # Errors
    /// [`OptionError`]: an unknown option of a study, an unknown value, or an option twice.
    pub fn new(wanted: &[ChosenOption]) -> Result<Self, OptionError> {
        let mut known: Vec<(usize, ChosenOption)> = Vec::new();
        for ChosenOption { name, value, file } in wanted {
            let (place, option) = option_of(name)?;
            let (name, value) = (option.name.to_owned(), value.trim().to_owned());
            let one = ChosenOption { name, value, file: file.clone() };
            if known.iter().any(|(other, _)| *other == place) {
                return Err(one.refused("the option is given twice"));
            }
            known.push((place, one));
        }
        known.sort_by_key(|(place, _)| *place);
        let mut options = AnalysisOptions::default();
        let mut kept = Vec::new();
        for (_, one) in known {
            let before = options.clone();
            one.set(&mut options)?;
            if options != before {
                kept.push(one);
            }
        }
        Ok(Self(kept))
    }

    /// The options.
    #[must_use]
    pub fn all(&self) -> &[ChosenOption] {
        &self.0
    }

    /// An option, where it was chosen.
    #[must_use]
    pub fn of(&self, name: &str) -> Option<&ChosenOption> {
        self.0.iter().find(|one| one.name == name)
    }

    /// The library's options, and the distribution of joint rotations that was chosen.
    ///
    /// # Errors
    /// [`OptionError`], where another version of the program chose them.
    pub fn options(&self) -> Result<(AnalysisOptions, Option<StoredRotationPrior>), OptionError> {
        let mut options = AnalysisOptions::default();
        let mut learned = None;
        for one in &self.0 {
            learned = one.set(&mut options)?.or(learned);
        }
        replace_fit_of_joints(&mut options, self.of("fit").is_some());
        Ok((options, learned))
    }

    /// The options with the value that an option has if it is not chosen: the value of the chosen method, which is set first.
    ///
    /// # Errors
    /// [`OptionError`], where another version of the program chose them.
    pub fn before(&self, option: &MethodOption) -> Result<AnalysisOptions, OptionError> {
        let (place, _) = option_of(option.name)?;
        // Multipliers per joint replace a fit that is not chosen.
        let replaces = |one: &ChosenOption| option.name == "fit" && one.name == "multipliers";
        let is_before = |one: &ChosenOption| OPTIONS[..place].iter().any(|o| o.name == one.name);
        let mut options = AnalysisOptions::default();
        for one in self.0.iter().filter(|one| is_before(one) || replaces(one)) {
            one.set(&mut options)?;
        }
        replace_fit_of_joints(&mut options, false);
        Ok(options)
    }

    /// The choices in a few words, such as `Support: free; Fitted to: ferguson`; empty for the defaults.
    #[must_use]
    pub fn words(&self) -> String {
        let words = self.0.iter().map(|one| format!("{}: {}", one.title(), one.words()));
        words.collect::<Vec<_>>().join("; ")
    }

    /// The choices as the command line takes them, such as `--support free --fit ferguson`, with the names of files; empty for the
    /// defaults.
    #[must_use]
    pub fn arguments(&self) -> String {
        self.0.iter().map(ChosenOption::argument).collect::<Vec<_>>().join(" ")
    }

    /// The files among them in words, each with its option.
    pub fn files(&self) -> impl Iterator<Item = (&'static str, String)> {
        let files = self.0.iter().filter(|one| one.file.is_some());
        files.map(|one| (one.title(), one.words()))
    }
}

/// The options that a study keeps, in their order.
pub fn study_options() -> impl Iterator<Item = &'static MethodOption> {
    OPTIONS.iter().filter(|option| option.of_a_study)
}

#[cfg(test)]
mod tests {
    use spineline::multibody::{StiffnessLibrary, StiffnessTable, Support};

    use super::super::OptionValues;
    use super::ChosenOption as Chosen;
    use super::*;

    fn option(name: &str, value: &str) -> ChosenOption {
        Chosen::word(name, value)
    }

    fn file(name: &str, text: &str) -> ChosenOption {
        Chosen { file: Some("own.json".to_owned()), ..Chosen::word(name, text) }
    }

    #[test]
    fn every_suggested_value_is_read() {
        for of_study in study_options() {
            let suggested: &[&str] = match of_study.values {
                OptionValues::Named(_) => &[],
                OptionValues::Text(some) => some,
            };
            let named = of_study.named_values().into_iter().map(|one| one.spelling);
            for value in named.chain(suggested.iter().copied().map(str::to_owned)) {
                ChosenOptions::new(&[option(of_study.name, &value)]).expect(&value);
            }
        }
    }

    #[test]
    fn chosen_options_are_kept_once_in_their_order_without_defaults() {
        let chosen = ChosenOptions::new(&[
            option("inflections", "L1/T12,T6"),
            option("fit", "shape"),
            option("order-rule", " paper "),
            option("prior", ""),
            option("min_curve", "5.0"),
        ]);
        // An empty text is not a prior.
        assert!(chosen.is_err_and(|error| error.to_string().contains("`prior`")));
        let chosen = ChosenOptions::new(&[
            option("inflections", "L1/T12,T6"),
            option("min_curve", "5.0"),
            option("support", "free"),
            option("order-rule", " paper "),
        ])
        .expect("valid");
        let names: Vec<&str> = chosen.all().iter().map(|one| one.name.as_str()).collect();
        assert_eq!(names, ["order_rule", "support", "inflections"]);
        assert_eq!(chosen.options().expect("valid").0.support, Support::Free);
        assert_eq!(
            chosen.words(),
            "Order of the curves: paper; Support: free; Inflections: L1/T12,T6"
        );
        assert_eq!(chosen.arguments(), "--order-rule paper --support free --inflections L1/T12,T6");
        let json = serde_json::to_string(&chosen).expect("texts");
        assert_eq!(serde_json::from_str::<ChosenOptions>(&json).expect("the same"), chosen);
    }

    #[test]
    fn a_study_opens_no_file_and_refuses_what_it_does_not_keep() {
        for (name, value, word) in [
            ("stiffness", "/etc/passwd", "expected one of motion"),
            ("rotation_prior", "/etc/passwd", "expected a file of"),
            ("compare_models", "all", "does not keep"),
            ("given_line", "left_bending=1,2,3; left-bending=4,5,6", "two lines"),
            ("suport", "free", "did you mean `support`?"),
        ] {
            let error = ChosenOptions::new(&[option(name, value)]).expect_err(name).to_string();
            assert!(error.contains(word), "{error}");
        }
        let twice = [option("support", "free"), option("support", "free")];
        assert!(ChosenOptions::new(&twice).is_err());
    }

    #[test]
    fn the_content_of_a_file_is_kept_as_text_and_named_by_its_digest() {
        let mut table = StiffnessTable::InVitro.library();
        let text = crate::to_text(&crate::StiffnessFile::from(&table));
        let chosen = ChosenOptions::new(&[file("stiffness", &text)]).expect("a table");
        assert_eq!(chosen.options().expect("valid").0.library, table);
        let digest = sha256_hex(text.trim().as_bytes());
        let words = format!("Stiffness table: own.json (SHA-256 {}…)", &digest[..12]);
        assert_eq!(chosen.words(), words);
        assert_eq!(chosen.arguments(), "--stiffness own.json");
        assert_eq!(chosen.files().count(), 1);
        let json = serde_json::to_string(&chosen).expect("texts");
        assert_eq!(serde_json::from_str::<ChosenOptions>(&json).expect("the same"), chosen);
        // The default as a file is the default.
        table = StiffnessLibrary::default();
        let text = crate::to_text(&crate::StiffnessFile::from(&table));
        assert_eq!(ChosenOptions::new(&[file("stiffness", &text)]).expect("a table").all(), []);
        for (name, text) in [("stiffness", "{}"), ("rotation_prior", "{}"), ("support", "free")] {
            assert!(ChosenOptions::new(&[file(name, text)]).is_err(), "{name}");
        }
    }

    #[test]
    fn options_beside_a_method_are_those_that_differ_from_it() {
        let chosen = ChosenOptions::new(&[
            option("support", "frontal"),
            option("fit", "ferguson"),
            option("method", "paper"),
        ])
        .expect("valid");
        assert_eq!(chosen.words(), "Method: paper; Support: frontal");
        let frontal = AnalysisOptions { support: Support::Frontal, ..AnalysisOptions::paper() };
        assert!(chosen.options().expect("valid").0 == frontal);
        for (option, default) in OPTIONS.iter().zip(["default", "paper", "geometric-mean", "free"])
        {
            assert_eq!(option.shown(&chosen.before(option).expect("valid")), default);
        }
        assert!(
            ChosenOptions::new(&[option("method", "default")]).expect("valid").all().is_empty()
        );
    }

    #[test]
    fn lines_of_several_films_are_one_option() {
        let text = "left_bending=20,150,-5; right_bending=-20,150,5";
        let chosen = ChosenOptions::new(&[option("given_line", text)]).expect("two lines");
        assert_eq!(chosen.options().expect("valid").0.given_lines.len(), 2);
        assert_eq!(chosen.arguments(), format!("--given-line \"{text}\""));
    }
}
