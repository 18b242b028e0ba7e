use super::observer::OBSERVER_HELP;
use super::order::out_of_order_words;
use super::{
    CornerFault, CornerOrder, FilmSize, FilmTooLarge, LateralFault, OBSERVER_RULE, PedicleFault,
    ReadingId,
};
use crate::anatomy::{Level, Levels, Posture};

/// The corners in their order, as errors name them.
const CORNER_NAMES: [&str; 4] =
    ["superior left", "superior right", "inferior left", "inferior right"];

/// Marks from which no measurement can be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeasureError {
    /// A film without any reading.
    #[error("{posture} film: no reading")]
    NoReading {
        /// Film.
        posture: Posture,
    },
    /// Two readings of a film carry the same observer and repeat.
    #[error("{posture} film: the reading of observer {id} is given twice")]
    DuplicateReading {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
    },
    /// A reading whose observer is no code.
    #[error("{posture} film: the observer of a reading is `{}` (repeat {}), and must be {OBSERVER_RULE}", id.observer, id.repeat)]
    Observer {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
    },
    /// The columns and rows of all landmarks are exchanged.
    #[error(
        "{posture} film, observer {id}: the landmarks of {count} vertebrae fit the film only with columns and rows exchanged"
    )]
    AxesExchanged {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebrae marked.
        count: usize,
    },
    /// The distance between pixels is none that a film has.
    #[error(
        "{posture} film: {direction} spacing is {value} mm, and must be above 0.0001 mm and at most 5 mm"
    )]
    Spacing {
        /// Film.
        posture: Posture,
        /// Which of the two spacings.
        direction: &'static str,
        /// What it is.
        value: f64,
    },
    /// With its scale the film would be larger than any film of a spine.
    #[error("{posture} film: {fault}")]
    FilmTooLarge {
        /// Film.
        posture: Posture,
        /// Its size and the limit.
        fault: FilmTooLarge,
    },
    /// With the scale of its film a body has a size that no vertebra has.
    #[error(
        "{posture} film, observer {id}: {level} is {size_mm:.1} mm {side}, and no vertebral body is outside of {least_mm} to {most_mm} mm"
    )]
    BodySize {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// `wide` or `high`.
        side: &'static str,
        /// Mean of the two endplates, or of the two walls.
        size_mm: f64,
        /// The least.
        least_mm: f64,
        /// The most.
        most_mm: f64,
    },
    /// With its scale, or as its locations are given, the spine or its bodies have a size that no patient has.
    #[error("{posture} film: {size}")]
    Length {
        /// Film.
        posture: Posture,
        /// What was measured, and the limits.
        size: FilmSize,
    },
    /// Tilts that follow the curve of their locations, but are 57 times too small.
    #[error(
        "{posture} film, observer {id}: the tilts follow the curve of the locations but are 57 times too small, so they are in radians"
    )]
    TiltsInRadians {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
    },
    /// Tilts to the other side than the curve of their locations.
    #[error(
        "{posture} film, observer {id}: the tilts go to the other side than the curve of the locations, so one of both has the wrong sign"
    )]
    TiltsReversed {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
    },
    /// A standard deviation of a scale that no scale has.
    #[error(
        "{posture} film: the standard deviation of the scale is {value} of the scale, and must be 0 to {most}{}", percent_words(*value, *most)
    )]
    ScaleSd {
        /// Film.
        posture: Posture,
        /// What it is.
        value: f64,
        /// The most.
        most: f64,
    },
    /// The film does not show enough of the thoracic spine.
    #[error(
        "{posture} film: {}, and a model needs all up to {} or higher", match highest {
            Some(highest) => format!("no vertebra above {highest} is marked in any reading"),
            None => "no vertebra from L4 to T2 is marked in any reading".to_owned(),
        },
        Levels::LOWEST_TOP
    )]
    TopMissing {
        /// Film.
        posture: Posture,
        /// The highest vertebra of the model that is marked.
        highest: Option<Level>,
    },
    /// The film does not show enough of the lumbar spine.
    #[error(
        "{posture} film: no vertebra below {lowest} is marked in any reading, and a model needs L4, L3 or {} as its fixed base",
        Levels::HIGHEST_BASE
    )]
    BaseMissing {
        /// Film.
        posture: Posture,
        /// The lowest vertebra of the model that is marked.
        lowest: Level,
    },
    /// No vertebra at which a model may end is marked on every film.
    #[error(
        "{posture} film: {} is marked on every film, and this one lacks most of them",
        if *at_base { format!("none of L4 to {}", Levels::HIGHEST_BASE) } else { format!("none of {} to T2", Levels::LOWEST_TOP) }
    )]
    NoCommonEnd {
        /// The film that lacks most of the vertebrae in question.
        posture: Posture,
        /// Whether it is about the base; else about the top.
        at_base: bool,
    },
    /// So many neighbouring vertebrae are missing that those around them do not determine where they are.
    #[error(
        "{posture} film: {missing} vertebrae in a row are not marked, between {inferior} and {superior}, and at most {limit} can be interpolated"
    )]
    Gap {
        /// Film.
        posture: Posture,
        /// The marked vertebra below.
        inferior: Level,
        /// The marked vertebra above.
        superior: Level,
        /// Vertebrae between them.
        missing: usize,
        /// The most that can be.
        limit: usize,
    },
    /// A coordinate or an angle is no finite number.
    #[error("{posture} film, observer {id}, {level}: a coordinate is not a number")]
    NotFinite {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
    },
    /// A confidence that is no number from 0 to 1.
    #[error(
        "{posture} film, observer {id}, {level}: a confidence is {value}, and must be from 0 to 1{}", percent_words(*value, 1.0)
    )]
    Confidence {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// What it is.
        value: f64,
    },
    /// A deviation of corners that a program found, which no body has.
    #[error(
        "{posture} film, observer {id}, {level}: the standard deviation of the corners is {value} of the height of the body, and must be above 0 and at most {most}{}", percent_words(*value, *most)
    )]
    CornerSd {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// What it is.
        value: f64,
        /// The most.
        most: f64,
    },
    /// A landmark outside of the picture.
    #[error(
        "{posture} film, observer {id}, {level}: a corner at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture"
    )]
    OffImage {
        /// Film.
        posture: Posture,
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
    /// Four corners that make no vertebral body.
    #[error("{posture} film, observer {id}, {level}: {fault}")]
    Corners {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// What is wrong with them.
        fault: CornerFault,
    },
    /// Four corners on the lateral film that make no vertebral body.
    #[error("lateral film, observer {id}, {level}: {}", match fault {
        CornerFault::SidesExchanged => "its anterior and posterior corners are exchanged".to_owned(),
        other => other.to_string(),
    })]
    Lateral {
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// What is wrong with them.
        fault: CornerFault,
    },
    /// Two pedicles that give no rotation.
    #[error("{posture} film, observer {id}, {level}: {fault}")]
    Pedicles {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebra.
        level: Level,
        /// What is wrong with them.
        fault: PedicleFault,
    },
    /// Anything else that is wrong with the lateral film.
    #[error(transparent)]
    LateralFilm(#[from] LateralFault),
    /// An iliac crest outside of the picture.
    #[error(
        "{posture} film: the iliac crest at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture"
    )]
    CrestOffImage {
        /// Film.
        posture: Posture,
        /// Column of the crest.
        column_px: f64,
        /// Row of the crest.
        row_px: f64,
        /// Columns of the picture.
        columns: u32,
        /// Rows of the picture.
        rows: u32,
    },
    /// Iliac crests that give no line.
    #[error(
        "{posture} film: the iliac crests are {apart_mm:.1} mm apart, and the minimum is {limit_mm:.0} mm"
    )]
    Crests {
        /// Film.
        posture: Posture,
        /// Distance between them.
        apart_mm: f64,
        /// The least distance.
        limit_mm: f64,
    },
    /// Left and right corners are exchanged in every vertebra of a film.
    #[error(
        "{posture} film, observer {id}: left and right corners are exchanged in all {count} vertebrae, so the film is mirrored or its `patient_left` is wrong"
    )]
    FilmMirrored {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebrae marked.
        count: usize,
    },
    /// The four corners are given in another order in every vertebra of a film.
    #[error("{posture} film, observer {id}: in all {count} vertebrae {}", order.words(CORNER_NAMES))]
    CornerOrder {
        /// Film.
        posture: Posture,
        /// Reading.
        id: ReadingId,
        /// Vertebrae marked.
        count: usize,
        /// The order.
        order: CornerOrder,
    },
    /// A vertebra is marked at or below the next lower one.
    #[error("{posture} film: {}", out_of_order_words(*inferior, *superior, *share))]
    OutOfOrder {
        /// Film.
        posture: Posture,
        /// Lower vertebra.
        inferior: Level,
        /// Upper vertebra.
        superior: Level,
        /// How far above along the axes of both, as a part of the usual distance in this spine.
        share: f64,
        /// The least.
        limit: f64,
    },
    /// An angle of a vertebra beyond what a spine can show.
    #[error(
        "{posture} film: {level} is tilted {tilt_deg:.0}° relative to {base}, and the limit is {limit_deg:.0}°"
    )]
    TiltTooLarge {
        /// Film.
        posture: Posture,
        /// The lowest vertebra of the film, to which tilts are relative.
        base: Level,
        /// Vertebra.
        level: Level,
        /// Its tilt.
        tilt_deg: f64,
        /// The largest that can be handled.
        limit_deg: f64,
    },
}

impl MeasureError {
    /// A stable name, for counts.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::NoReading { .. } => "no_reading",
            Self::DuplicateReading { .. } => "duplicate_reading",
            Self::Observer { .. } => "observer",
            Self::AxesExchanged { .. } => "axes_exchanged",
            Self::Spacing { .. } => "spacing",
            Self::FilmTooLarge { .. } => "film_too_large",
            Self::BodySize { .. } => "body_size",
            Self::Length { .. } => "length",
            Self::TiltsInRadians { .. } => "tilts_in_radians",
            Self::TiltsReversed { .. } => "tilts_reversed",
            Self::ScaleSd { .. } => "scale_sd",
            Self::TopMissing { .. }
            | Self::BaseMissing { .. }
            | Self::NoCommonEnd { .. }
            | Self::Gap { .. } => "level_missing",
            Self::NotFinite { .. } => "not_finite",
            Self::Confidence { .. } => "confidence",
            Self::CornerSd { .. } => "corner_sd",
            Self::OffImage { .. } => "off_image",
            Self::Crests { .. } | Self::CrestOffImage { .. } => "crests",
            Self::Corners { .. } | Self::Lateral { .. } => "corners",
            Self::Pedicles { .. } => "pedicles",
            Self::LateralFilm(fault) => fault.code(),
            Self::FilmMirrored { .. } => "film_mirrored",
            Self::CornerOrder { .. } => "corner_order",
            Self::OutOfOrder { .. } => "out_of_order",
            Self::TiltTooLarge { .. } => "tilt_too_large",
        }
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        match self {
            Self::NoReading { posture } => of_film(
                *posture,
                "mark the vertebrae of the erect film; no analysis can do without it",
                "mark the vertebrae of this film, or leave the film out of the case",
            ),
            Self::DuplicateReading { .. } => {
                "give each reading of a film its own observer and repeat"
            }
            Self::Observer { .. } => OBSERVER_HELP,
            Self::AxesExchanged { .. } => {
                "landmarks are [column, row]: exchange the two numbers of every landmark of this reading"
            }
            Self::Spacing { .. } => "state the distance between pixel centres in mm",
            Self::FilmTooLarge { .. } => {
                "correct the scale of the film: a decimal comma or a distance in other units makes it ten times wrong"
            }
            Self::BodySize { .. } => {
                "correct the scale of the film, or the corners of this vertebra"
            }
            Self::Length { size, .. } => size.help(),
            Self::TiltsInRadians { .. } => "give tilts in degrees (`tilt_deg`)",
            Self::TiltsReversed { .. } => {
                "locations are [to the patient's left, cranial], and tilts are positive to the patient's right"
            }
            Self::ScaleSd { .. } => {
                "give it as a part of the scale: 0.033 for 3.3 %; leave it out where it is not known"
            }
            Self::TopMissing { posture, .. } => of_film(
                *posture,
                "mark the vertebrae of the erect film upwards to T6 at least; no analysis can do without this film",
                "mark its vertebrae upwards to T6 at least, or leave this film out of the case",
            ),
            Self::BaseMissing { posture, .. } => of_film(
                *posture,
                "mark L2 and, where they are seen, L3 and L4 on the erect film; no analysis can do without this film",
                "mark L2 and, where they are seen, L3 and L4, or leave this film out of the case",
            ),
            Self::NoCommonEnd { posture, .. } => of_film(
                *posture,
                "mark one of these vertebrae on all films, or leave out films that do not show those of the erect film",
                "mark one of these vertebrae on all films, or leave this film out of the case",
            ),
            Self::Gap { posture, .. } => of_film(
                *posture,
                "mark one of them at least on the erect film; no analysis can do without this film",
                "mark one of them at least, or leave this film out of the case",
            ),
            Self::NotFinite { .. } => "mark this vertebra again",
            Self::Confidence { .. } => {
                "give the probability that the program assigns to the landmark, or no confidence at all"
            }
            Self::CornerSd { .. } => "give it as a part of the height of the body",
            Self::OffImage { .. } => {
                "corner points are [column, row] in pixels of the full-size picture"
            }
            Self::Crests { .. } | Self::CrestOffImage { .. } => {
                "mark the superior tips of both crests again, or leave `iliac_crests_px` out"
            }
            Self::Corners { fault, .. } => fault.help(),
            Self::Pedicles { fault, .. } => fault.help(),
            Self::Lateral { .. } => {
                "mark this vertebra's superior and inferior corners again, anterior ones on the side of `patient_anterior`"
            }
            Self::LateralFilm(fault) => fault.help(),
            Self::FilmMirrored { .. } => {
                "check the lead marker, then correct `patient_left` of this film's image"
            }
            Self::CornerOrder { .. } => {
                "give the corners of every vertebra as superior left, superior right, inferior left, inferior right, and not around the body; left is the patient's, so check `patient_left` too"
            }
            Self::OutOfOrder { .. } => {
                "check the names of these two vertebrae: one is marked twice, skipped or exchanged"
            }
            Self::TiltTooLarge { .. } => {
                "check the corners of this vertebra and of the lowest one of the film"
            }
        }
    }
}

/// A fraction that was probably given in percent.
fn percent_words(value: f64, most: f64) -> String {
    let part = value / 100.0;
    if value > most && part <= most {
        format!("; {value} % are {}", (part * 1e9).round() / 1e9)
    } else {
        String::new()
    }
}

/// One text for the erect film, without which there is no analysis, and one for the others, which can be left out.
fn of_film(posture: Posture, erect: &'static str, other: &'static str) -> &'static str {
    if posture == Posture::Erect { erect } else { other }
}
