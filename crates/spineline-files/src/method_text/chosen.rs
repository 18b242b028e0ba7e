//! Options that were chosen for a study, as texts.

use serde::{Deserialize, Serialize};
use spineline::analysis::AnalysisOptions;
use spineline::multibody::StiffnessTable;

use super::catalogue::{MethodOption, OPTIONS};
use super::{OptionError, named, set_option};

/// Options that a study does not keep, because they name files, or have results of their own.
const NOT_OF_A_STUDY: [&str; 3] = ["rotation_prior", "given_line", "compare_models"];

/// An option with its value.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ChosenOption {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
}

/// The options of a study that differ from the defaults, each once, in the order of [`OPTIONS`].
///
/// They read no files, so that a value from elsewhere opens none.
///
/// ```
/// use spineline_files::method_text::{ChosenOption, ChosenOptions};
///
/// let option = |name: &str, value: &str| ChosenOption { name: name.into(), value: value.into() };
/// let chosen = ChosenOptions::new(&[option("support", "free"), option("tilt", "endplates")])?;
/// assert_eq!(chosen.all(), [option("support", "free")]); // the other one is the default
/// # Ok::<(), spineline_files::method_text::OptionError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct ChosenOptions(Vec<ChosenOption>);

impl ChosenOptions {
    /// Checks options, and keeps those that differ from the defaults.
    ///
    /// # Errors
    /// [`OptionError`]: no such option of a study, no such value, or an option twice.
    pub fn new(wanted: &[ChosenOption]) -> Result<Self, OptionError> {
        let mut kept: Vec<ChosenOption> = Vec::new();
        for ChosenOption { name, value } in wanted {
            let (name, value) = (name.replace('-', "_"), value.trim().to_owned());
            if kept.iter().any(|one| one.name == name) {
                let reason = "the option is given twice".to_owned();
                return Err(OptionError::Value { name, value, reason });
            }
            if let Some(option) = OPTIONS.iter().find(|option| option.name == name)
                && value == option.default
            {
                continue;
            }
            kept.push(ChosenOption { name, value });
        }
        for one in &kept {
            let mut alone = AnalysisOptions::default();
            set(&mut alone, one)?;
        }
        kept.retain(differs);
        kept.sort_by_key(|one| OPTIONS.iter().position(|option| option.name == one.name));
        Ok(Self(kept))
    }

    /// The options.
    #[must_use]
    pub fn all(&self) -> &[ChosenOption] {
        &self.0
    }

    /// The value of an option, where it was chosen.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<&str> {
        self.0.iter().find(|one| one.name == name).map(|one| one.value.as_str())
    }

    /// The library's options.
    ///
    /// # Errors
    /// [`OptionError`], where another version of the program chose them.
    pub fn options(&self) -> Result<AnalysisOptions, OptionError> {
        let mut options = AnalysisOptions::default();
        for one in &self.0 {
            set(&mut options, one)?;
        }
        Ok(options)
    }

    /// What was chosen in a few words, such as `Support: free; Fitted to: ferguson`; empty for the defaults.
    #[must_use]
    pub fn words(&self) -> String {
        let title = |name: &str| {
            OPTIONS.iter().find(|option| option.name == name).map_or("", |option| option.title)
        };
        let words = self.0.iter().map(|one| format!("{}: {}", title(&one.name), one.value));
        words.collect::<Vec<_>>().join("; ")
    }
}

/// The options that a study keeps, in their order.
pub fn study_options() -> impl Iterator<Item = &'static MethodOption> {
    OPTIONS.iter().filter(|option| !NOT_OF_A_STUDY.contains(&option.name))
}

fn differs(one: &ChosenOption) -> bool {
    let mut alone = AnalysisOptions::default();
    set(&mut alone, one).is_ok() && alone != AnalysisOptions::default()
}

/// Sets one option without reading a file.
fn set(options: &mut AnalysisOptions, one: &ChosenOption) -> Result<(), OptionError> {
    let ChosenOption { name, value } = one;
    let refused =
        |reason: String| OptionError::Value { name: name.clone(), value: value.clone(), reason };
    if NOT_OF_A_STUDY.contains(&name.as_str()) {
        return Err(refused("a study does not keep this option".to_owned()));
    }
    if name == "stiffness" {
        let table: StiffnessTable = named(value).map_err(refused)?;
        options.library = table.library();
        return Ok(());
    }
    set_option(options, name, value)
}

#[cfg(test)]
mod tests {
    use spineline::multibody::Support;

    use super::*;

    fn option(name: &str, value: &str) -> ChosenOption {
        ChosenOption { name: name.to_owned(), value: value.to_owned() }
    }

    #[test]
    fn every_default_of_the_list_is_the_default_of_the_library() {
        for of_study in study_options().filter(|option| !option.default.is_empty()) {
            let mut options = AnalysisOptions::default();
            set(&mut options, &option(of_study.name, of_study.default)).expect(of_study.name);
            assert_eq!(options, AnalysisOptions::default(), "{}", of_study.name);
        }
    }

    #[test]
    fn every_suggested_value_is_read() {
        for of_study in study_options() {
            let values: Vec<&str> = match of_study.values {
                super::super::OptionValues::Named(all) => {
                    all().iter().map(|one| one.spelling).collect()
                }
                super::super::OptionValues::Text(some) => some.to_vec(),
                super::super::OptionValues::File => panic!("a study reads no files"),
            };
            for value in values {
                ChosenOptions::new(&[option(of_study.name, value)]).expect(value);
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
        // An empty text is no prior.
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
        assert_eq!(chosen.options().expect("valid").support, Support::Free);
        assert_eq!(
            chosen.words(),
            "Order of the curves: paper; Support: free; Inflections: L1/T12,T6"
        );
        let json = serde_json::to_string(&chosen).expect("texts");
        assert_eq!(serde_json::from_str::<ChosenOptions>(&json).expect("the same"), chosen);
    }

    #[test]
    fn a_study_opens_no_file_and_refuses_what_it_does_not_keep() {
        for (name, value, word) in [
            ("stiffness", "/etc/passwd", "expected one of paper"),
            ("rotation_prior", "/etc/passwd", "does not keep"),
            ("given_line", "left_bending=20,150,-5", "does not keep"),
            ("suport", "free", "did you mean `support`?"),
        ] {
            let error = ChosenOptions::new(&[option(name, value)]).expect_err(name).to_string();
            assert!(error.contains(word), "{error}");
        }
        let twice = [option("support", "free"), option("support", "free")];
        assert!(ChosenOptions::new(&twice).is_err());
    }
}
