//! Faults of the landmarks of a film, and their messages.

use spineline::anatomy::{FilmView, Level, Side};
use spineline::measure::{CornerFault, out_of_order_words};
use spineline::number::fixed;
use spineline::spatial::{Angle, Pixel};

/// A fault of the landmarks of a film.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MarkingFault {
    /// A corner lies outside of the picture.
    #[error("{level}: a corner at column {}, row {} lies outside of the picture", fixed(place.column_px, 1), fixed(place.row_px, 1))]
    OffPicture {
        /// Vertebra.
        level: Level,
        /// The corner.
        place: Pixel,
    },
    /// The corners do not make a body; three corners are checked as far as possible.
    #[error("{level}: {fault}; {}", fault.help())]
    Corners {
        /// Vertebra.
        level: Level,
        /// The fault of the corners.
        fault: CornerFault,
    },
    /// One corner lies within the triangle of the others.
    #[error("{level}: one corner lies between the others: move it out to the edge of the body")]
    NotConvex {
        /// Vertebra.
        level: Level,
    },
    /// Left and right corners are exchanged in every vertebra.
    #[error(
        "left and right corners are exchanged in all {count} vertebrae: check the lead marker; left is the patient's"
    )]
    Mirrored {
        /// Vertebrae marked.
        count: usize,
    },
    /// The spine runs down the picture, with the sides exchanged in every vertebra.
    #[error(
        "in all {count} vertebrae the superior corners lie below the inferior ones, and the sides are exchanged. The film is upside down, or its file counts rows from the bottom: correct this and add the film again"
    )]
    RowsFromBottom {
        /// Vertebrae marked.
        count: usize,
    },
    /// A vertebra lies at or below the next lower one.
    #[error("{}", out_of_order_words(*inferior, *superior, *share))]
    OutOfOrder {
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// Its distance above the lower one along both axes, as a part of the usual distance in this spine.
        share: f64,
    },
    /// The distance of two vertebrae suggests that one was skipped or doubled.
    #[error("{inferior} and {superior} are {} times the expected distance for this spine apart: check that no vertebra was skipped or marked twice", fixed(*ratio, 1))]
    Distance {
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// Their distance as a part of the usual one in this spine.
        ratio: f64,
    },
    /// A body is far wider or narrower than its neighbours.
    #[error("{level} is {} times as wide as its neighbours: check that its corners lie on the vertebral body", fixed(*ratio, 1))]
    Width {
        /// Vertebra.
        level: Level,
        /// Its width over theirs.
        ratio: f64,
    },
    /// A body is tilted far against its neighbours.
    #[error("{level} is tilted by {} against its neighbours: check that its corners belong to one vertebra", step.abs())]
    Tilt {
        /// Vertebra.
        level: Level,
        /// Its tilt less theirs, positive to the patient's right.
        step: Angle,
    },
    /// A landmark of a vertebra without four corners lies far from the spine.
    #[error("{level} lies {} times the expected distance from {near}: does this landmark belong to {level}?", fixed(*ratio, 1))]
    Far {
        /// Vertebra.
        level: Level,
        /// The next vertebra with four corners.
        near: Level,
        /// Its distance from there over the largest expected one.
        ratio: f64,
    },
    /// An iliac crest lies outside of the picture.
    #[error("the {side} iliac crest lies outside of the picture")]
    CrestOffPicture {
        /// The patient's side.
        side: Side,
    },
    /// The left crest lies on the right.
    #[error("the left iliac crest lies to the right of the right one: left is the patient's")]
    CrestsExchanged,
}

impl MarkingFault {
    /// A key for programs.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::OffPicture { .. } => "corner_off_picture",
            Self::Corners { fault: CornerFault::Crossed, .. } => "corners_crossed",
            Self::Corners { fault: CornerFault::SidesExchanged, .. } => "sides_exchanged",
            Self::Corners { fault: CornerFault::UpsideDown, .. } => "upside_down",
            Self::Corners { fault: CornerFault::Flat, .. } => "corners_flat",
            Self::NotConvex { .. } => "corners_not_convex",
            Self::Mirrored { .. } => "film_mirrored",
            Self::RowsFromBottom { .. } => "rows_from_bottom",
            Self::OutOfOrder { .. } => "out_of_order",
            Self::Distance { .. } => "spacing_unusual",
            Self::Width { .. } => "width_unusual",
            Self::Tilt { .. } => "tilt_unusual",
            Self::Far { .. } => "landmark_far",
            Self::CrestOffPicture { .. } => "crest_off_picture",
            Self::CrestsExchanged => "crests_exchanged",
        }
    }

    /// The affected vertebra, if it is one.
    #[must_use]
    pub const fn level(&self) -> Option<Level> {
        match *self {
            Self::OffPicture { level, .. }
            | Self::Corners { level, .. }
            | Self::NotConvex { level }
            | Self::Width { level, .. }
            | Self::Tilt { level, .. }
            | Self::Far { level, .. }
            | Self::OutOfOrder { superior: level, .. }
            | Self::Distance { superior: level, .. } => Some(level),
            Self::Mirrored { .. }
            | Self::RowsFromBottom { .. }
            | Self::CrestOffPicture { .. }
            | Self::CrestsExchanged => None,
        }
    }

    /// Whether measurement is impossible; else a check is advised.
    #[must_use]
    pub const fn is_error(&self) -> bool {
        !matches!(
            self,
            Self::Distance { .. }
                | Self::Width { .. }
                | Self::Tilt { .. }
                | Self::Far { .. }
                | Self::CrestsExchanged
        )
    }
}

impl MarkingFault {
    /// The message for a film of this view; on the lateral film, with the front in place of the left, corners are
    /// exchanged between front and back. On a frontal film it is the text of [`Display`](std::fmt::Display).
    #[must_use]
    pub fn words(&self, view: FilmView) -> String {
        match (view, self) {
            (FilmView::Lateral, Self::Corners { level, fault: CornerFault::SidesExchanged }) => {
                format!("{level}: its front and back corners are exchanged; exchange them")
            }
            (FilmView::Lateral, Self::Mirrored { count }) => format!(
                "front and back corners are exchanged in all {count} vertebrae: check which way the patient faces"
            ),
            (FilmView::Lateral, Self::Width { level, ratio }) => format!(
                "{level} is {} times as deep as its neighbours: check that its corners lie on the vertebral body",
                fixed(*ratio, 1)
            ),
            _ => self.to_string(),
        }
    }
}
