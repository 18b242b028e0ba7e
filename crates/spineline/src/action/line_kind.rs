use std::fmt;

use crate::anatomy::named;

named!(LineKind);

/// A candidate for the line of action; [`LineOfAction`](super::LineOfAction) is the line itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum LineKind {
    /// Through the two inflections as they lie in the posture.
    Inflection,
    /// Parallel to the iliac line, through T2's midpoint and moving with it.
    Iliac,
    /// The line that fits measured rotations and positions best.
    Estimated,
    /// The user's.
    Given,
}

impl LineKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Inflection, Self::Iliac, Self::Estimated, Self::Given];

    /// The name used in files.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Inflection => "inflection_line",
            Self::Iliac => "iliac_line",
            Self::Estimated => "estimated_line",
            Self::Given => "given_line",
        }
    }
}

impl fmt::Display for LineKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Inflection => "inflection line",
            Self::Iliac => "iliac line",
            Self::Estimated => "estimated line",
            Self::Given => "given line",
        })
    }
}
