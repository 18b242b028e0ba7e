//! Identifiers, times and signatures.

use std::collections::BTreeSet;
use std::fmt;
use std::time::SystemTime;

use chrono::{DateTime, Days, NaiveTime, SecondsFormat, SubsecRound, Utc};
use serde::Serialize;
use spineline::measure::is_observer_code;
use spineline_files::sha256_hex;

/// The identifier of a study or of an observer: 1 to 64 ASCII letters, digits, `.`, `-` and `_`, without any patient's name. Dots
/// alone are none: in an address, `.` and `..` are this page and the one above.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Name(String);

impl Name {
    /// The identifier, if the text is one.
    pub(crate) fn checked(text: &str) -> Option<Self> {
        let has_more_than_dots = text.contains(|c| c != '.');
        (is_observer_code(text) && has_more_than_dots).then(|| Self(text.to_owned()))
    }

    /// The text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Name {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

/// The first name that is twice in a list.
pub(crate) fn repeated<'a>(names: impl IntoIterator<Item = &'a Name>) -> Option<&'a Name> {
    let mut known = BTreeSet::new();
    names.into_iter().find(|name| !known.insert(*name))
}

/// A moment in UTC, to the millisecond. Callers give it, or the clock by [`Signature::now`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Timestamp(DateTime<Utc>);

impl From<SystemTime> for Timestamp {
    /// The time of a clock, which may be before 1970.
    fn from(time: SystemTime) -> Self {
        Self(DateTime::from(time).trunc_subsecs(3))
    }
}

impl Timestamp {
    /// Milliseconds since 1970-01-01 UTC.
    #[must_use]
    pub fn unix_ms(self) -> i64 {
        self.0.timestamp_millis()
    }

    /// The moment of a Unix time in milliseconds (UTC), if it is in the calendar's range.
    #[must_use]
    pub fn from_unix_ms(unix_ms: i64) -> Option<Self> {
        DateTime::from_timestamp_millis(unix_ms).map(Self)
    }

    /// This number of days of 24 hours later, at most the end of the calendar.
    #[must_use]
    pub fn plus_days(self, days: u32) -> Self {
        Self(self.0.checked_add_days(Days::new(days.into())).unwrap_or(DateTime::<Utc>::MAX_UTC))
    }

    /// The first midnight (UTC) at or after this time.
    #[must_use]
    pub fn midnight_after(self) -> Self {
        let midnight = self.0.with_time(NaiveTime::MIN).single().map(Self);
        midnight.map_or(self, |before| if before < self { before.plus_days(1) } else { before })
    }
}

impl fmt::Display for Timestamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0.to_rfc3339_opts(SecondsFormat::Millis, true))
    }
}

/// Author and time of a change.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Signature {
    /// Who.
    pub who: Name,
    /// When.
    pub at: Timestamp,
    is_by_clock: bool,
}

impl Signature {
    /// A signature at a given time.
    #[must_use]
    pub fn new(who: Name, at: Timestamp) -> Self {
        Self { who, at, is_by_clock: false }
    }

    /// A signature by the clock. A change that waits for another one gets the time at which it begins to write.
    #[must_use]
    pub fn now(who: Name) -> Self {
        Self { who, at: SystemTime::now().into(), is_by_clock: true }
    }

    /// The signature of a change that begins to write.
    pub(crate) fn of_writing(&self) -> Self {
        if self.is_by_clock { Self::now(self.who.clone()) } else { self.clone() }
    }
}

/// A film of a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct FilmId(pub i64);

impl fmt::Display for FilmId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "film/{}", self.0)
    }
}

/// A reading of a store.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct ReadingId(pub i64);

impl fmt::Display for ReadingId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "reading/{}", self.0)
    }
}

/// SHA-256 of some bytes, in lower-case hexadecimal digits.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Hash(pub(crate) String);

impl Hash {
    /// The hash of bytes.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Self {
        Self(sha256_hex(bytes))
    }

    /// The 64 digits.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl fmt::Display for Hash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}
