//! A place on a film, for errors.

use std::fmt;

use super::ReadingId;
use crate::anatomy::{FilmView, Level};

/// A film, and on it a reading and a vertebra.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmPlace {
    /// The film.
    pub film: FilmView,
    /// The reading.
    pub reading: Option<ReadingId>,
    /// The vertebra.
    pub level: Option<Level>,
}

impl FilmPlace {
    /// A reading of a film.
    #[must_use]
    pub fn reading(film: impl Into<FilmView>, id: &ReadingId) -> Self {
        Self { film: film.into(), reading: Some(id.clone()), level: None }
    }

    /// A vertebra in a reading of a film.
    #[must_use]
    pub fn vertebra(film: impl Into<FilmView>, id: &ReadingId, level: Level) -> Self {
        Self { level: Some(level), ..Self::reading(film, id) }
    }
}

impl<F: Into<FilmView>> From<F> for FilmPlace {
    fn from(film: F) -> Self {
        Self { film: film.into(), reading: None, level: None }
    }
}

impl fmt::Display for FilmPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} film", self.film)?;
        if let Some(id) = &self.reading {
            write!(f, ", observer {id}")?;
        }
        if let Some(level) = self.level {
            write!(f, ", {level}")?;
        }
        Ok(())
    }
}
