use std::fmt;
use std::str::FromStr;

use serde::de::{Deserialize, Deserializer, Error as _};
use serde::ser::{Serialize, Serializer};

/// A vertebra by its anatomical name, ordered from caudal to cranial. In files it is its name: `L4`, `T12` (`Th12` and `D12` are read too).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Level {
    /// Fifth lumbar vertebra; may be marked, not part of the model.
    L5,
    /// Fourth lumbar vertebra: the fixed base.
    L4,
    /// Third lumbar vertebra.
    L3,
    /// Second lumbar vertebra.
    L2,
    /// First lumbar vertebra.
    L1,
    /// Twelfth thoracic vertebra.
    T12,
    /// Eleventh thoracic vertebra.
    T11,
    /// Tenth thoracic vertebra.
    T10,
    /// Ninth thoracic vertebra.
    T9,
    /// Eighth thoracic vertebra.
    T8,
    /// Seventh thoracic vertebra.
    T7,
    /// Sixth thoracic vertebra.
    T6,
    /// Fifth thoracic vertebra.
    T5,
    /// Fourth thoracic vertebra.
    T4,
    /// Third thoracic vertebra.
    T3,
    /// Second thoracic vertebra: carries the force.
    T2,
    /// First thoracic vertebra; may be marked, not part of the model.
    T1,
}

/// Text that names no vertebra from L5 to T1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a vertebra from L5 to T1 (as in L4, T12 or Th12)")]
pub struct UnknownLevel(pub String);

impl Level {
    /// Every level known here, from caudal to cranial.
    pub const ALL: [Self; 17] = [
        Self::L5,
        Self::L4,
        Self::L3,
        Self::L2,
        Self::L1,
        Self::T12,
        Self::T11,
        Self::T10,
        Self::T9,
        Self::T8,
        Self::T7,
        Self::T6,
        Self::T5,
        Self::T4,
        Self::T3,
        Self::T2,
        Self::T1,
    ];

    /// The vertebrae of the complete model, from the fixed L4 to T2; films that show fewer give a part of them
    /// ([`Levels`](super::Levels)).
    pub const MODEL: [Self; 15] = {
        let [_, model @ .., _] = Self::ALL;
        model
    };

    /// The place of this level in [`Level::MODEL`]; `None` for L5 and T1.
    #[must_use]
    pub fn model_index(self) -> Option<usize> {
        Self::MODEL.iter().position(|&level| level == self)
    }

    /// The next vertebra above; `None` above T1.
    #[must_use]
    pub fn next_above(self) -> Option<Self> {
        Self::ALL.get(self as usize + 1).copied()
    }

    /// The next vertebra below; `None` below L5.
    #[must_use]
    pub fn next_below(self) -> Option<Self> {
        (self as usize).checked_sub(1).map(|below| Self::ALL[below])
    }

    /// The short name, such as `T12`.
    #[must_use]
    pub fn name(self) -> &'static str {
        const NAMES: [&str; 17] = [
            "L5", "L4", "L3", "L2", "L1", "T12", "T11", "T10", "T9", "T8", "T7", "T6", "T5", "T4",
            "T3", "T2", "T1",
        ];
        NAMES[self as usize]
    }
}

impl fmt::Display for Level {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Level {
    type Err = UnknownLevel;

    /// Reads `T12`, and `Th12` or `D12` as some films have it.
    fn from_str(text: &str) -> Result<Self, UnknownLevel> {
        let canonical = text
            .strip_prefix("Th")
            .or_else(|| text.strip_prefix('D'))
            .map_or_else(|| text.to_owned(), |number| format!("T{number}"));
        Self::ALL
            .into_iter()
            .find(|level| level.name() == canonical)
            .ok_or_else(|| UnknownLevel(text.to_owned()))
    }
}

impl Serialize for Level {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Level {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        text.parse().map_err(D::Error::custom)
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Level {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Level".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let names = Self::ALL.map(Self::name);
        schemars::json_schema!({ "type": "string", "enum": names, "description": "A vertebra" })
    }
}
