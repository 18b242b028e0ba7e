//! Whether two films were exposed together, as biplanar scanners do, by their files.

use std::fmt;
use std::hash::{DefaultHasher, Hash, Hasher};

use dicom_dictionary_std::tags;
use dicom_object::InMemDicomObject;
use serde::{Deserialize, Serialize};
use spineline::number::fixed;

use super::element::Attributes;

/// Acquisitions within this time are one: patients cannot turn by a right angle so fast (assumption).
const TOGETHER_S: f64 = 2.0;
/// Acquisitions farther apart are two: a scan of a whole spine takes less (assumption).
const APART_S: f64 = 30.0;

/// Time and frame of an acquisition, only for comparison of two files. Never written to a file.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ExposureMarks {
    /// Hash of the Frame of Reference UID (0020,0052).
    frame: Option<u64>,
    /// Hash of the day, and seconds from its midnight.
    acquired: Option<(u64, f64)>,
}

/// Relation of two exposures by their files.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Exposures {
    /// One exposure: the files share a frame of reference.
    OneFrame,
    /// One exposure: the acquisitions are this many seconds apart.
    AtOnce(f64),
    /// Two exposures, this many seconds apart, or on different days.
    Apart(Option<f64>),
    /// The files do not say.
    NotStated,
}

impl Exposures {
    /// Whether the films were exposed together; `None` where the files do not say.
    #[must_use]
    pub const fn together(self) -> Option<bool> {
        match self {
            Self::OneFrame | Self::AtOnce(_) => Some(true),
            Self::Apart(_) => Some(false),
            Self::NotStated => None,
        }
    }
}

impl fmt::Display for Exposures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OneFrame => f.write_str("the files have one Frame of Reference UID"),
            Self::AtOnce(s) | Self::Apart(Some(s)) => {
                write!(f, "the files have Acquisition Times {} s apart", fixed(*s, 0))
            }
            Self::Apart(None) => f.write_str("the files have Acquisition Dates of different days"),
            Self::NotStated => f.write_str(
                "the files do not share a Frame of Reference UID, and their Acquisition Times do not decide",
            ),
        }
    }
}

impl ExposureMarks {
    pub(super) fn read(data: &InMemDicomObject) -> Self {
        let frame = data.text(tags::FRAME_OF_REFERENCE_UID).map(|text| hash(&text));
        Self { frame, acquired: acquired(data) }
    }

    /// Compares the exposures of two files. Distant times take precedence over a shared frame of reference.
    ///
    /// ```
    /// use spineline_films::{ExposureMarks, Exposures};
    /// // Pictures without a DICOM header state nothing.
    /// assert_eq!(ExposureMarks::default().with(&ExposureMarks::default()), Exposures::NotStated);
    /// ```
    #[must_use]
    pub fn with(&self, other: &Self) -> Exposures {
        let times = self.acquired.zip(other.acquired);
        let apart_s = match times {
            Some(((day, _), (other_day, _))) if day != other_day => return Exposures::Apart(None),
            Some(((_, s), (_, other_s))) => Some((s - other_s).abs()),
            None => None,
        };
        match apart_s {
            Some(s) if s > APART_S => Exposures::Apart(Some(s)),
            _ if self.frame.is_some() && self.frame == other.frame => Exposures::OneFrame,
            Some(s) if s <= TOGETHER_S => Exposures::AtOnce(s),
            _ => Exposures::NotStated,
        }
    }
}

/// Day and time of the acquisition. De-identification leaves midnight as the time, so midnight counts as missing.
fn acquired(data: &InMemDicomObject) -> Option<(u64, f64)> {
    let both = data.text(tags::ACQUISITION_DATE_TIME).and_then(|text| {
        let (day, time) = text.split_at_checked(8)?;
        Some((day.to_owned(), time.split(['+', '-', '&']).next().unwrap_or_default().to_owned()))
    });
    let apart = || data.text(tags::ACQUISITION_DATE).zip(data.text(tags::ACQUISITION_TIME));
    let (day, time) = both.or_else(apart)?;
    let seconds = seconds(&time).filter(|s| *s > 0.0)?;
    Some((hash(&day), seconds))
}

/// Seconds from midnight of `HHMMSS.FFFFFF`; hours and minutes alone are not enough.
fn seconds(text: &str) -> Option<f64> {
    let (hours, rest) = text.split_at_checked(2)?;
    let (minutes, seconds) = rest.split_at_checked(2)?;
    let whole = |text: &str, most: u32| text.parse().ok().filter(|value: &u32| *value <= most);
    let (hours, minutes) = (whole(hours, 23)?, whole(minutes, 59)?);
    let plain = seconds.len() >= 2 && seconds.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let seconds: f64 = seconds.parse().ok().filter(|s| plain && *s < 61.0)?;
    Some(f64::from(3600 * hours + 60 * minutes) + seconds)
}

/// A hash of a text, which stays in the program; equal texts have equal hashes.
pub(super) fn hash(text: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    text.hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_seconds() {
        for (text, wanted) in [
            ("101530", Some(36930.0)),
            ("101530.25", Some(36930.25)),
            ("235960", Some(86400.0)),
            ("1015", None),
            ("10", None),
            ("", None),
            ("1015-1", None),
            ("246000", None),
            ("10:15:30", None),
        ] {
            assert_eq!(seconds(text), wanted, "{text}");
        }
    }

    #[test]
    fn a_frame_or_a_moment_decides_and_distant_times_go_first() {
        let marks = |frame: Option<u64>, s: Option<f64>| ExposureMarks {
            frame,
            acquired: s.map(|s| (1, s)),
        };
        let frame = marks(Some(7), None);
        assert_eq!(frame.with(&frame), Exposures::OneFrame);
        assert_eq!(frame.with(&marks(Some(8), None)), Exposures::NotStated);
        let at = |s| marks(Some(7), Some(s));
        assert_eq!(at(100.0).with(&at(195.0)), Exposures::Apart(Some(95.0)));
        assert_eq!(at(100.0).with(&at(110.0)), Exposures::OneFrame);
        let alone = |s| marks(None, Some(s));
        assert_eq!(alone(100.0).with(&alone(101.5)), Exposures::AtOnce(1.5));
        assert_eq!(alone(100.0).with(&alone(110.0)), Exposures::NotStated);
        let other_day = ExposureMarks { acquired: Some((2, 100.0)), ..alone(100.0) };
        assert_eq!(alone(100.0).with(&other_day).together(), Some(false));
    }
}
