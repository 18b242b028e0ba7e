//! How a landmark came about.

use super::Corners;
use crate::anatomy::named;

named! {
    /// How the place of a corner came about.
    #[default(Clicked)]
    pub enum Origin {
        /// A person clicked it, or another program gave it without saying how.
        Clicked = "clicked",
        /// It was completed from other landmarks of the film, and no person reviewed it.
        Completed = "completed",
        /// A program found it in the picture, and no person reviewed it.
        Detected = "detected",
        /// A person looked at a place that a program proposed, and accepted it.
        Accepted = "accepted",
        /// A person moved a place that a program had proposed.
        Adjusted = "adjusted",
    }
}

impl Origin {
    /// Whether a person chose the place, with the error of a click.
    ///
    /// A person who accepts a proposed place sees only its large errors: it keeps the error of the program.
    #[must_use]
    pub const fn is_placed(self) -> bool {
        matches!(self, Self::Clicked | Self::Adjusted)
    }

    /// Whether a person has looked at it.
    #[must_use]
    pub const fn is_reviewed(self) -> bool {
        !matches!(self, Self::Completed | Self::Detected)
    }
}

/// How the corners of a vertebra came about, over all of them and all readings.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VertebraOrigin {
    /// All alike.
    Alike(Origin),
    /// Of several origins.
    Mixed,
}

impl VertebraOrigin {
    /// Of the corners of one reading.
    #[must_use]
    pub fn of(corners: &Corners<Origin>) -> Self {
        let [first, rest @ ..] = corners.points();
        if rest.iter().all(|one| *one == first) { Self::Alike(first) } else { Self::Mixed }
    }

    /// With another reading.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        if self == other { self } else { Self::Mixed }
    }

    /// The name used in files: the origin's, or `mixed`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Alike(origin) => origin.key(),
            Self::Mixed => "mixed",
        }
    }
}

impl Corners<Origin> {
    /// The same origin of all four corners.
    #[must_use]
    pub const fn all(origin: Origin) -> Self {
        Self {
            superior_left: origin,
            superior_right: origin,
            inferior_left: origin,
            inferior_right: origin,
        }
    }
}
