use super::observer::OBSERVER_HELP;
use super::order::out_of_order_words;
use super::{
    CornerFault, CornerOrder, FilmPlace, FilmSize, FilmTooLarge, OBSERVER_RULE, PedicleFault,
    ReadingId, Spacing,
};
use crate::anatomy::{FilmView, Level, Levels, Posture};
use crate::fault::{ErrorPlace, Remedy, faults};
use crate::number::fixed;

const CRESTS_HELP: &str =
    "mark the superior tips of both crests again, or leave `iliac_crests_px` out";
const ORDER_HELP: &str =
    "check the names of these two vertebrae: one is marked twice, skipped or exchanged";

/// Marks from which no measurement can be made: where they are, and what is wrong.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{at}: {fault}")]
pub struct MeasureError {
    /// The film, and the reading and the vertebra where the fault is about one.
    pub at: FilmPlace,
    /// What is wrong.
    pub fault: MeasureFault,
}

impl MeasureError {
    /// A stable name, for counts.
    #[must_use]
    pub fn code(&self) -> &'static str {
        self.fault.code()
    }

    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        self.fault.help(self.at.film)
    }

    /// Its place, for programs.
    #[must_use]
    pub fn place(&self) -> ErrorPlace {
        let fault = self.fault.place();
        ErrorPlace { film: Some(self.at.film), level: self.at.level.or(fault.level), ..fault }
    }
}

impl Remedy for MeasureError {
    fn help(&self) -> &'static str {
        MeasureError::help(self)
    }

    fn place(&self) -> ErrorPlace {
        MeasureError::place(self)
    }
}

impl MeasureFault {
    pub(crate) fn at(self, place: impl Into<FilmPlace>) -> MeasureError {
        MeasureError { at: place.into(), fault: self }
    }
}

faults! {
    /// What is wrong with marks from which no measurement can be made.
    pub enum MeasureFault on film {
        /// A film without any reading.
        #[error("no reading")]
        #[code("no_reading")]
        #[help(of_film(
            film,
            "mark the vertebrae of the erect film; no analysis can do without it",
            "mark the vertebrae of this film, or leave the film out of the case",
        ))]
        NoReading,
        /// Two readings of a film carry the same observer and repeat.
        #[error("the reading of observer {id} is given twice")]
        #[code("duplicate_reading")]
        #[help("give each reading of a film its own observer and repeat")]
        DuplicateReading {
            id: ReadingId,
        },
        /// A reading with the repeat 0.
        #[error("the repeat of a reading of observer {} is {}, and must be 1 or more", id.observer, id.repeat)]
        #[code("repeat")]
        #[help("number the repeats of every observer from 1")]
        #[at(value = f64::from(id.repeat), limit = 1.0)]
        Repeat {
            id: ReadingId,
        },
        /// A reading whose observer is not a code.
        #[error("the observer of a reading is `{}` (repeat {}), and must be {OBSERVER_RULE}", id.observer, id.repeat)]
        #[code("observer")]
        #[help(OBSERVER_HELP)]
        Observer {
            id: ReadingId,
        },
        /// The columns and rows of all landmarks are exchanged.
        #[error("the landmarks of {count} vertebrae fit the film only with columns and rows exchanged")]
        #[code("axes_exchanged")]
        #[help("landmarks are [column, row]: exchange the two numbers of every landmark of this reading")]
        AxesExchanged {
            /// Vertebrae marked.
            count: usize,
        },
        /// The distance between pixels is none that a film has.
        #[error("{direction} spacing is {value} mm, and must be from {} to {} mm", Spacing::MIN_MM, Spacing::MAX_MM)]
        #[code("spacing")]
        #[help("state the distance between pixel centres in mm")]
        #[at(value = *value, limit = ErrorPlace::limit(*value, Spacing::MIN_MM, Spacing::MAX_MM))]
        Spacing {
            /// Which of the two spacings.
            direction: &'static str,
            value: f64,
        },
        /// With its scale the film would be larger than any film of a spine.
        #[error("{fault}")]
        #[code("film_too_large")]
        #[help("correct the scale of the film: a decimal comma or a distance in other units makes it ten times wrong")]
        #[at(value = fault.size_mm, limit = fault.limit_mm)]
        FilmTooLarge {
            /// Its size and the limit.
            fault: FilmTooLarge,
        },
        /// With the scale of its film a body has a size that no vertebra has.
        #[error(
            "{level} is {} mm {side}, and no vertebral body is outside of {least_mm} to {most_mm} mm",
            fixed(*size_mm, 1)
        )]
        #[code("body_size")]
        #[help("correct the scale of the film, or the corners of this vertebra")]
        #[at(level = *level, value = *size_mm, limit = ErrorPlace::limit(*size_mm, *least_mm, *most_mm))]
        BodySize {
            level: Level,
            /// `wide` or `high`.
            side: &'static str,
            /// Mean of the two endplates, or of the two walls.
            size_mm: f64,
            least_mm: f64,
            most_mm: f64,
        },
        /// With its scale, or as its locations are given, the spine or its bodies have a size that no patient has.
        #[error("{size}")]
        #[code("length")]
        #[help(size.help())]
        #[at(value = size.value(), limit = size.limit())]
        Length {
            /// What was measured, and the limits.
            size: FilmSize,
        },
        /// Tilts that follow the curve of their locations, but are 57 times too small.
        #[error("the tilts follow the curve of the locations but are 57 times too small, so they are in radians")]
        #[code("tilts_in_radians")]
        #[help("give tilts in degrees (`tilt_deg`)")]
        TiltsInRadians,
        /// Equal tilts beside locations that turn.
        #[error("the tilts of all vertebrae are equal while the curve of the locations turns, so they were filled in and not measured")]
        #[code("tilts_equal")]
        #[help("give the measured tilt of every vertebra in degrees (`tilt_deg`)")]
        TiltsEqual,
        /// Locations that run along their first coordinate, beside tilts of an upright spine.
        #[error("the locations run along their first coordinate, but the tilts belong to an upright spine, so the two coordinates are exchanged")]
        #[code("axes_exchanged")]
        #[help("`location_mm` is [to the patient's left, cranial]: exchange the two numbers of every location")]
        LocationsExchanged,
        /// Locations that run downwards, beside tilts of an upright spine.
        #[error("the second coordinate falls from the lowest vertebra to the highest, but the tilts belong to an upright spine, so it counts downwards as rows do")]
        #[code("rows_from_top")]
        #[help("`location_mm` is [to the patient's left, cranial]: change the sign of the second number of every location")]
        LocationsDownwards,
        /// Tilts to the other side than the curve of their locations.
        #[error("the tilts go to the other side than the curve of the locations, so one of both has the wrong sign")]
        #[code("tilts_reversed")]
        #[help("locations are [to the patient's left, cranial], and tilts are positive to the patient's right")]
        TiltsReversed,
        /// A standard deviation of a scale that no scale has.
        #[error("the standard deviation of the scale is {value} of the scale, and must be 0 to {most}{}", percent_words(*value, *most))]
        #[code("scale_sd")]
        #[help("give it as a part of the scale: 0.033 for 3.3 %; leave it out where it is not known")]
        #[at(value = *value, limit = ErrorPlace::limit(*value, 0.0, *most))]
        ScaleSd {
            value: f64,
            most: f64,
        },
        /// The film does not show enough of the thoracic spine.
        #[error("{}, and a model needs all up to {} or higher", match highest {
            Some(highest) => format!("no vertebra above {highest} is marked in any reading"),
            None => "no vertebra from L4 to T2 is marked in any reading".to_owned(),
        }, Levels::LOWEST_TOP)]
        #[code("level_missing")]
        #[help(of_film(
            film,
            "mark the vertebrae of the erect film upwards to T6 at least; no analysis can do without this film",
            "mark its vertebrae upwards to T6 at least, or leave this film out of the case",
        ))]
        #[at(level = *highest)]
        TopMissing {
            /// The highest vertebra of the model that is marked.
            highest: Option<Level>,
        },
        /// The film does not show enough of the lumbar spine.
        #[error("no vertebra below {lowest} is marked in any reading, and a model needs L4, L3 or {} as its fixed base", Levels::HIGHEST_BASE)]
        #[code("level_missing")]
        #[help(of_film(
            film,
            "mark L2 and, where they are seen, L3 and L4 on the erect film; no analysis can do without this film",
            "mark L2 and, where they are seen, L3 and L4, or leave this film out of the case",
        ))]
        #[at(level = *lowest)]
        BaseMissing {
            /// The lowest vertebra of the model that is marked.
            lowest: Level,
        },
        /// No vertebra at which a model may end is marked on every film; the place is the film that lacks most of them.
        #[error("no vertebra from {} is marked on every film, and this film lacks most of them",
            if *at_base { format!("L4 to {}", Levels::HIGHEST_BASE) } else { format!("{} to T2", Levels::LOWEST_TOP) })]
        #[code("level_missing")]
        #[help(of_film(
            film,
            "mark one of these vertebrae on all films, or leave out films without the vertebrae of the erect film",
            "mark one of these vertebrae on all films, or leave this film out of the case",
        ))]
        NoCommonEnd {
            /// Whether it is about the base; else about the top.
            at_base: bool,
        },
        /// Too many neighbouring vertebrae are missing: the vertebrae around them do not determine their locations.
        #[error("{missing} vertebrae in a row are not marked, between {inferior} and {superior}, and at most {limit} can be interpolated")]
        #[code("level_missing")]
        #[help(of_film(
            film,
            "mark one of them at least on the erect film; no analysis can do without this film",
            "mark one of them at least, or leave this film out of the case",
        ))]
        #[at(level = *superior, value = *missing as f64, limit = *limit as f64)]
        Gap {
            /// The marked vertebra below.
            inferior: Level,
            /// The marked vertebra above.
            superior: Level,
            /// Vertebrae between them.
            missing: usize,
            /// The most that can be.
            limit: usize,
        },
        /// A coordinate or an angle is not a finite number.
        #[error("a coordinate is not a number")]
        #[code("not_finite")]
        #[help("mark this vertebra again")]
        NotFinite,
        /// A confidence that is not a number from 0 to 1.
        #[error("a confidence is {value}, and must be from 0 to 1{}", percent_words(*value, 1.0))]
        #[code("confidence")]
        #[help("give the probability that the program assigns to the landmark, or no confidence at all")]
        #[at(value = *value, limit = ErrorPlace::limit(*value, 0.0, 1.0))]
        Confidence {
            value: f64,
        },
        /// A deviation of corners that a program found, which no body has.
        #[error("the standard deviation of the corners is {value} of the height of the body, and must be above 0 and at most {most}{}", percent_words(*value, *most))]
        #[code("corner_sd")]
        #[help("give it as a part of the height of the body")]
        #[at(value = *value, limit = ErrorPlace::limit(*value, 0.0, *most))]
        CornerSd {
            value: f64,
            most: f64,
        },
        /// A landmark outside of the picture.
        #[error("a corner at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture")]
        #[code("off_image")]
        #[help("corner points are [column, row] in pixels of the full-size picture")]
        OffImage {
            column_px: f64,
            row_px: f64,
            columns: u32,
            rows: u32,
        },
        /// Four corners that make no vertebral body.
        #[error("{fault}")]
        #[code("corners")]
        #[help(fault.help())]
        Corners {
            fault: CornerFault,
        },
        /// Four corners on the lateral film that make no vertebral body.
        #[error("{}", match fault {
            CornerFault::SidesExchanged => "its anterior and posterior corners are exchanged".to_owned(),
            other => other.to_string(),
        })]
        #[code("corners")]
        #[help("mark this vertebra's superior and inferior corners again, anterior ones on the side of `patient_anterior`")]
        LateralCorners {
            fault: CornerFault,
        },
        /// Two pedicles that give no rotation.
        #[error("{fault}")]
        #[code("pedicles")]
        #[help(fault.help())]
        Pedicles {
            fault: PedicleFault,
        },
        /// An iliac crest outside of the picture.
        #[error("the iliac crest at column {column_px}, row {row_px} lies outside of the {columns} × {rows} picture")]
        #[code("crests")]
        #[help(CRESTS_HELP)]
        CrestOffImage {
            column_px: f64,
            row_px: f64,
            columns: u32,
            rows: u32,
        },
        /// Iliac crests that give no line.
        #[error("the iliac crests are {} mm apart, and the minimum is {} mm", fixed(*apart_mm, 1), fixed(*limit_mm, 0))]
        #[code("crests")]
        #[help(CRESTS_HELP)]
        #[at(value = *apart_mm, limit = *limit_mm)]
        Crests {
            apart_mm: f64,
            /// The least distance.
            limit_mm: f64,
        },
        /// Left and right corners are exchanged in every vertebra of a film.
        #[error("left and right corners are exchanged in all {count} vertebrae, so the film is mirrored or its `patient_left` is wrong")]
        #[code("film_mirrored")]
        #[help("check the lead marker, then correct `patient_left` of this film's image")]
        FilmMirrored {
            /// Vertebrae marked.
            count: usize,
        },
        /// Anterior and posterior corners are exchanged in every vertebra of the lateral film.
        #[error("anterior and posterior corners are exchanged in all {count} vertebrae, so the film is mirrored or its `patient_anterior` is wrong")]
        #[code("film_mirrored")]
        #[help("look on which side of the picture the patient's front is, then correct `patient_anterior` of this film's image")]
        LateralMirrored {
            /// Vertebrae marked.
            count: usize,
        },
        /// The spine runs down the picture of a film, with left and right, or front and back, exchanged in every vertebra.
        #[error("in all {count} vertebrae the superior corners lie below the inferior ones and the sides are exchanged, so rows count from the bottom, or the film is upside down")]
        #[code("rows_from_bottom")]
        #[help("write height − 1 − row for every row, and keep the side of the patient; or turn a film that is upside down and mark it again")]
        RowsFromBottom {
            /// Vertebrae marked.
            count: usize,
        },
        /// The levels run down the picture of a film, while every body stands upright in it.
        #[error("in all {count} vertebrae the superior corners lie above the inferior ones, but the levels run down the picture, so the names of the vertebrae are in reverse order")]
        #[code("levels_reversed")]
        #[help("name the vertebrae from below: L5 or L4 is the lowest one; keep the corners and the side of the patient")]
        LevelsReversed {
            /// Vertebrae marked.
            count: usize,
        },
        /// The four corners are given in another order in every vertebra of a film.
        #[error("in all {count} vertebrae {}", order.words(view.corners()))]
        #[code("corner_order")]
        #[help(match view {
            FilmView::Frontal(_) => "give the corners of every vertebra as superior left, superior right, inferior left, inferior right, and not around the body; left is the patient's, so check `patient_left` too",
            FilmView::Lateral => "give the corners of every vertebra as superior anterior, superior posterior, inferior anterior, inferior posterior, and not around the body",
        })]
        CornerOrder {
            view: FilmView,
            /// Vertebrae marked.
            count: usize,
            order: CornerOrder,
        },
        /// A vertebra is marked at or below the next lower one.
        #[error("{}", out_of_order_words(*inferior, *superior, *share))]
        #[code("out_of_order")]
        #[help(ORDER_HELP)]
        #[at(level = *superior, value = *share, limit = *limit)]
        OutOfOrder {
            inferior: Level,
            superior: Level,
            /// How far above along the axes of both, as a part of the usual distance in this spine.
            share: f64,
            /// The least.
            limit: f64,
        },
        /// The same in a reading of the lateral film.
        #[error(
            "{superior} lies {} % of the expected distance above {inferior}, and the minimum is {} %",
            fixed(100.0 * share, 0),
            fixed(100.0 * limit, 0)
        )]
        #[code("out_of_order")]
        #[help(ORDER_HELP)]
        #[at(level = *superior, value = *share, limit = *limit)]
        LateralOutOfOrder {
            inferior: Level,
            superior: Level,
            /// How far above along the axes of both, as a part of the usual distance in this spine.
            share: f64,
            /// The least.
            limit: f64,
        },
        /// An angle of a vertebra beyond what a spine can show.
        #[error("{level} is tilted {}° relative to {base}, and the limit is {}°", fixed(*tilt_deg, 0), fixed(*limit_deg, 0))]
        #[code("tilt_too_large")]
        #[help("check the corners of this vertebra and of the lowest one of the film")]
        #[at(level = *level, value = *tilt_deg, limit = *limit_deg)]
        TiltTooLarge {
            /// The lowest vertebra of the film, to which tilts are relative.
            base: Level,
            level: Level,
            tilt_deg: f64,
            /// The largest that can be handled.
            limit_deg: f64,
        },
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

/// One text for the erect film, which every analysis needs, and one for the other films, which can be left out.
fn of_film(film: FilmView, erect: &'static str, other: &'static str) -> &'static str {
    if film == Posture::Erect.into() { erect } else { other }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_tells_programs_the_film_the_vertebra_the_value_and_the_limit() {
        let fault = MeasureFault::TiltTooLarge {
            base: Level::L4,
            level: Level::T5,
            tilt_deg: 91.0,
            limit_deg: 85.0,
        };
        let expected = ErrorPlace {
            film: Some(Posture::Traction.into()),
            level: Some(Level::T5),
            value: Some(91.0),
            limit: Some(85.0),
        };
        assert_eq!(fault.at(Posture::Traction).place(), expected);
        let place = MeasureFault::Spacing { direction: "column", value: -1.0 }
            .at(FilmView::Lateral)
            .place();
        assert_eq!((place.film, place.value), (Some(FilmView::Lateral), Some(-1.0)));
        let limits = [-1.0, 6.0, f64::NAN]
            .map(|value| MeasureFault::Spacing { direction: "row", value }.place().limit);
        assert_eq!(limits, [Some(0.01), Some(5.0), None]);
    }

    #[test]
    fn a_message_names_film_reading_and_vertebra_in_this_order() {
        let id = ReadingId { observer: "A".to_owned(), repeat: 2 };
        let error =
            MeasureFault::NotFinite.at(FilmPlace::vertebra(Posture::LeftBending, &id, Level::T5));
        assert_eq!(
            error.to_string(),
            "left bending film, observer A (repeat 2), T5: a coordinate is not a number"
        );
        let error = MeasureFault::NoReading.at(FilmView::Lateral);
        assert_eq!(error.to_string(), "lateral film: no reading");
    }
}
