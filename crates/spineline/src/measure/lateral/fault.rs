use crate::anatomy::Level;
use crate::measure::observer::OBSERVER_HELP;
use crate::measure::{CornerOrder, FilmSize, OBSERVER_RULE, ReadingId};

/// The corners in their order, as errors name them.
const NAMES: [&str; 4] =
    ["superior anterior", "superior posterior", "inferior anterior", "inferior posterior"];

/// What is wrong with a lateral film, other than the four corners of one vertebra.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LateralFault {
    /// A reading whose observer is no code.
    #[error("lateral film: the observer of a reading is `{}` (repeat {}), and must be {OBSERVER_RULE}", id.observer, id.repeat)]
    Observer {
        /// Reading.
        id: ReadingId,
    },
    /// Two readings carry the same observer and repeat.
    #[error("lateral film: the reading of observer {id} is given twice")]
    DuplicateReading {
        /// Reading.
        id: ReadingId,
    },
    /// The distance between pixels is none that a film has.
    #[error(
        "lateral film: {direction} spacing is {value} mm, and must be above 0.0001 mm and at most 5 mm"
    )]
    Spacing {
        /// Which of the two spacings.
        direction: &'static str,
        /// What it is.
        value: f64,
    },
    /// With its scale, the spine or its bodies have a size that no patient has.
    #[error("lateral film: {size}")]
    Length {
        /// What was measured, and the limits.
        size: FilmSize,
    },
    /// A coordinate is no finite number.
    #[error("lateral film, observer {id}, {level}: a coordinate is not a number")]
    NotFinite {
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
    },
    /// A landmark outside of the picture.
    #[error(
        "lateral film, observer {id}, {level}: a corner at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture"
    )]
    OffImage {
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// Column of the corner.
        column_px: f64,
        /// Row of the corner.
        row_px: f64,
        /// Columns of the picture.
        columns: u32,
        /// Rows of the picture.
        rows: u32,
    },
    /// The four corners are given in another order in every vertebra.
    #[error("lateral film, observer {id}: in all {count} vertebrae {}", order.words(NAMES))]
    CornerOrder {
        /// Reading.
        id: ReadingId,
        /// Vertebrae marked.
        count: usize,
        /// The order.
        order: CornerOrder,
    },
    /// A vertebra is marked at or below the next lower one.
    #[error(
        "lateral film, observer {id}: {superior} lies {:.0} % of the expected distance above {inferior}, and the minimum is {:.0} %", 100.0 * share, 100.0 * limit
    )]
    OutOfOrder {
        /// Reading.
        id: ReadingId,
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// How far above along the axes of both, as a part of the usual distance in this spine.
        share: f64,
        /// The least.
        limit: f64,
    },
}

impl LateralFault {
    /// The name that the same fault of a frontal film has.
    pub(in crate::measure) const fn code(&self) -> &'static str {
        match self {
            Self::Observer { .. } => "observer",
            Self::DuplicateReading { .. } => "duplicate_reading",
            Self::Spacing { .. } => "spacing",
            Self::Length { .. } => "length",
            Self::NotFinite { .. } => "not_finite",
            Self::OffImage { .. } => "off_image",
            Self::CornerOrder { .. } => "corner_order",
            Self::OutOfOrder { .. } => "out_of_order",
        }
    }

    /// What the user can do about it.
    pub(in crate::measure) const fn help(&self) -> &'static str {
        match self {
            Self::Observer { .. } => OBSERVER_HELP,
            Self::DuplicateReading { .. } => {
                "give each reading of a film its own observer and repeat"
            }
            Self::Spacing { .. } => "state the distance between pixel centres in mm",
            Self::Length { size } => size.help(),
            Self::NotFinite { .. } => "mark this vertebra again",
            Self::OffImage { .. } => {
                "corner points are [column, row] in pixels of the full-size picture"
            }
            Self::CornerOrder { .. } => {
                "give the corners of every vertebra as superior anterior, superior posterior, inferior anterior, inferior posterior, and not around the body"
            }
            Self::OutOfOrder { .. } => {
                "check the names of these two vertebrae: one is marked twice, skipped or exchanged"
            }
        }
    }
}
