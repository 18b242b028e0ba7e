//! The options of an analysis in files, sufficient to repeat it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use spineline::analysis::AnalysisOptions;

use crate::FileError;
use crate::method_text::{OPTIONS, OptionError, set_in_order, set_option_of_text};
use crate::rotation_prior_record::RotationPriorRecord;
use crate::stiffness_file::StiffnessFile;

/// The options of an analysis, each by its name: a value as the command line takes it, or the content of a file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(test, derive(schemars::JsonSchema))]
pub(crate) struct OptionsRecord {
    /// `null` where no value is given.
    #[serde(flatten)]
    #[cfg_attr(test, schemars(with = "Texts"))]
    words: Words,
    /// Distribution of joint rotations learned from other patients; absent for the published one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    rotation_prior: Option<RotationPriorRecord>,
    /// Springs before personalisation, each with its source.
    stiffness: StiffnessFile,
}

type Texts = BTreeMap<String, Option<String>>;

/// Every option whose value is a word; the options of files have their defaults.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Texts", into = "Texts")]
struct Words(AnalysisOptions);

impl TryFrom<Texts> for Words {
    type Error = OptionError;

    fn try_from(texts: Texts) -> Result<Self, OptionError> {
        let missing = |(name, _): &(String, Option<String>)| !texts.contains_key(name);
        if let Some((name, _)) = words_of(&AnalysisOptions::default()).find(missing) {
            return Err(OptionError::Missing { name });
        }
        let given = texts.iter().filter_map(|(name, text)| Some((name.as_str(), text.as_deref()?)));
        // The text of a file opens no other file.
        let set = |options: &mut _, name: &str, text: &str| {
            set_option_of_text(options, name, text, None).map(drop)
        };
        set_in_order(given, set).map(Self)
    }
}

impl From<Words> for Texts {
    fn from(words: Words) -> Self {
        words_of(&words.0).collect()
    }
}

fn words_of(options: &AnalysisOptions) -> impl Iterator<Item = (String, Option<String>)> {
    let words = OPTIONS.iter().filter(|option| !option.takes_a_file());
    words.map(|option| {
        (option.name.to_owned(), Some(option.shown(options)).filter(|text| !text.is_empty()))
    })
}

impl From<&AnalysisOptions> for OptionsRecord {
    fn from(options: &AnalysisOptions) -> Self {
        let library = AnalysisOptions::default().library;
        Self {
            words: Words(AnalysisOptions { library, rotation_prior: None, ..options.clone() }),
            rotation_prior: options.rotation_prior.as_ref().and_then(RotationPriorRecord::new),
            stiffness: StiffnessFile::from(&options.library),
        }
    }
}

impl OptionsRecord {
    /// The library's options.
    pub fn options(&self) -> Result<AnalysisOptions, FileError> {
        let rotation_prior = self.rotation_prior.as_ref().map(RotationPriorRecord::prior);
        Ok(AnalysisOptions {
            library: self.stiffness.clone().library()?,
            rotation_prior: rotation_prior.transpose()?,
            ..self.words.0.clone()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::method_text::all_others;

    #[test]
    fn every_option_of_the_method_is_in_the_file_and_read_from_it() {
        let options = all_others();
        let text = crate::to_text(&OptionsRecord::from(&options));
        let read: OptionsRecord = serde_json::from_str(&text).expect("our own text");
        // The file has the springs of a table, and an option its name.
        assert!(read.options().expect("sound options") == options, "an option is lost in the file");
    }
}
