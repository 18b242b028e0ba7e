//! Model options of a study.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The options with which a study is analysed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptionsView {
    /// Number of changes, to be sent with a change.
    pub revision: u64,
    /// Whether the requester may change them.
    pub may_change: bool,
    /// Every option, in the order of the command line.
    pub options: Vec<OptionView>,
    /// Options that differ from the defaults; absent if all have their defaults.
    pub changed_text: Option<String>,
}

/// One option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptionView {
    /// Its name.
    pub name: String,
    /// A short name.
    pub title: String,
    /// What it does, and the values that it takes.
    pub help: String,
    /// Its value; for a file, name and digest.
    pub value: String,
    /// The default value; may be empty.
    pub default: String,
    /// The default in the words of a report.
    pub default_words: String,
    /// Whether the value differs from the default.
    pub is_changed: bool,
    /// Whether `values` lists all values except a file.
    pub is_closed: bool,
    /// Whether it takes a file.
    pub takes_file: bool,
    /// Values to choose from.
    pub values: Vec<OptionValueView>,
}

/// A value of an option.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct OptionValueView {
    /// How it is spelled.
    pub value: String,
    /// Its meaning; empty where the spelling is clear.
    pub help: String,
}

/// A change of options.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OptionsChange {
    /// Revision that the change is based on.
    pub expected_revision: u64,
    /// Whether all options that the change does not name are reset.
    pub reset: bool,
    /// Options with their new values. An empty value resets an option.
    pub options: Vec<OptionChange>,
}

/// The new value of an option.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct OptionChange {
    /// Its name.
    pub name: String,
    /// Its value, spelled as on the command line; or the text of a file, which is kept with the study.
    pub value: String,
    /// The name of that file.
    #[serde(default)]
    pub file: Option<String>,
}
