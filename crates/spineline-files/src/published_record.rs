use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spineline::anatomy::{PublishedNumbers, SourceCheck};

/// Published numbers of a typical spine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PublishedRecord {
    /// The numbers, and of which vertebrae.
    numbers: String,
    /// What the program does with them.
    used_for: String,
    /// Keys of the project's list of references.
    source: String,
    /// How far they were compared with it.
    check: SourceCheck,
}

impl PublishedRecord {
    /// All of them.
    pub fn all() -> Vec<Self> {
        PublishedNumbers::ALL.map(Self::new).to_vec()
    }

    fn new(one: PublishedNumbers) -> Self {
        Self {
            numbers: one.numbers.to_owned(),
            used_for: one.used_for.to_owned(),
            source: one.source.to_owned(),
            check: one.check,
        }
    }
}
