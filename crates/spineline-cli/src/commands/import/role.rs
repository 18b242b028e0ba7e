//! The role of a film in a case.

use std::fmt;

use spineline::anatomy::Posture;

/// A frontal film of a posture, or the lateral one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Role {
    Frontal(Posture),
    Lateral,
}

impl Role {
    pub const fn posture(self) -> Option<Posture> {
        match self {
            Self::Frontal(posture) => Some(posture),
            Self::Lateral => None,
        }
    }

    /// The name of its file.
    pub const fn key(self) -> &'static str {
        match self {
            Self::Frontal(posture) => posture.key(),
            Self::Lateral => "lateral",
        }
    }

    /// The word for it on the command line.
    pub fn word(self) -> String {
        self.key().replace('_', "-")
    }
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Frontal(posture) => write!(f, "{posture} film"),
            Self::Lateral => f.write_str("lateral film"),
        }
    }
}
