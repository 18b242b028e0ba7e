//! The current case of a study, from which results are computed.

use std::collections::{BTreeMap, BTreeSet};

use rusqlite::Connection;
use spineline::analysis::Case;
use spineline::anatomy::{FilmView, Level, Posture};
use spineline::measure::{Film, ReadingId as Reader, shows_enough};
use spineline_files::method_text::ChosenOptions;

use crate::assembly::{self, AssembledFilm};
use crate::connection::Store;
use crate::error::StoreError;
use crate::event::Event;
use crate::films::{self, FilmRecord};
use crate::journal;
use crate::names::{FilmId, Name, ReadingId};
use crate::options;
use crate::readings::{self, ReadingRecord};
use crate::state::ReadingState;

/// Which readings of a study the current case uses.
#[derive(Debug, Clone, Copy)]
pub enum CaseReadings<'a> {
    /// All that count: finished and not withdrawn.
    Finished,
    /// On the film of an open reading that reading alone, with unrecorded events. On every other film the
    /// same observer's newest reading that is complete, or else all finished ones.
    InHand {
        /// The open reading.
        reading: ReadingId,
        /// Unrecorded events on it.
        pending: &'a [Event],
    },
}

/// A film of the current case.
#[derive(Debug, Clone, PartialEq)]
pub struct CurrentFilm {
    /// The film.
    pub record: FilmRecord,
    /// Number of readings that are used for it.
    pub readings: usize,
    /// Vertebrae of the model with four corners in one of them.
    pub marked: BTreeSet<Level>,
}

impl CurrentFilm {
    /// Vertebrae of the model without landmarks in any of its readings, caudal first.
    #[must_use]
    pub fn missing(&self) -> Vec<Level> {
        Level::MODEL.into_iter().filter(|level| !self.marked.contains(level)).collect()
    }

    /// Whether a frontal film takes part in the analysis: its vertebrae with landmarks are enough.
    #[must_use]
    pub fn is_usable(&self) -> bool {
        shows_enough(&self.marked)
    }
}

/// The current case of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct CurrentCase {
    /// Its frontal films.
    pub films: BTreeMap<Posture, CurrentFilm>,
    /// Its lateral film. Whatever vertebrae it shows take part in the analysis.
    pub lateral: Option<CurrentFilm>,
    /// Landmarks on the films with readings, of any vertebra.
    pub case: Case,
    /// The open reading of a frontal film with all finished readings of this film, to compare it with them.
    pub compared: Option<ComparedReading>,
    /// Model options with which it is analysed.
    pub options: ChosenOptions,
}

/// A reading among all others of its film.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedReading {
    /// The reading.
    pub id: Reader,
    /// Landmarks of this reading and of all finished ones.
    pub film: Film,
}

impl CurrentCase {
    /// One of its films, frontal or lateral.
    #[must_use]
    pub fn film(&self, film: FilmId) -> Option<&CurrentFilm> {
        self.films.values().chain(self.lateral.as_ref()).find(|one| one.record.id == film)
    }

    /// Landmarks on one frontal film.
    #[must_use]
    pub fn landmarks(&self, posture: Posture) -> Option<&Film> {
        self.case.film(posture)
    }

    /// The frontal films that take part in the analysis.
    pub fn usable_films(&self) -> impl Iterator<Item = (Posture, &CurrentFilm)> {
        let films = self.films.iter().map(|(&posture, film)| (posture, film));
        films.filter(|(_, film)| film.is_usable())
    }

    /// The case of the films that take part in the analysis.
    #[must_use]
    pub fn usable_case(&self) -> Case {
        let usable =
            |film: &&Film| self.films.get(&film.posture).is_some_and(CurrentFilm::is_usable);
        let films = self.case.films.iter().filter(usable).cloned().collect();
        Case { films, ..self.case.clone() }
    }
}

impl Store {
    /// The current case of a study.
    ///
    /// # Errors
    /// As [`Store::export_case`]; [`StoreError::BadEvent`] for an invalid pending event.
    pub fn current_case(
        &self,
        study: &Name,
        choice: CaseReadings<'_>,
    ) -> Result<CurrentCase, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let synthetic = films::study(&snapshot, study)?.synthetic;
        let readings = readings::of_study(&snapshot, study)?;
        let (mut films, mut lateral) = (BTreeMap::new(), None);
        let (mut landmarks, mut compared) = (Vec::new(), None);
        for film in assembly::by_view(&snapshot, study)?.into_values() {
            let of_film: Vec<&ReadingRecord> =
                readings.iter().filter(|reading| reading.film == film.id).collect();
            let chosen = match choice {
                CaseReadings::Finished => self.finished(&snapshot, &of_film)?,
                CaseReadings::InHand { reading, pending } => {
                    let unknown = || StoreError::Unknown { object: reading.to_string() };
                    let hand = readings.iter().find(|one| one.id == reading).ok_or_else(unknown)?;
                    if hand.film == film.id {
                        let events = journal::events(&snapshot, hand.id)?;
                        let state = journal::replayed(hand, film.view, events, pending)?;
                        compared = self.compared(&snapshot, &film, hand, &state, &of_film)?;
                        vec![(hand, state)]
                    } else {
                        self.beside(&snapshot, hand, &of_film)?
                    }
                }
            };
            let marked: BTreeSet<Level> =
                chosen.iter().flat_map(|(_, state)| state.complete_levels()).collect();
            if !marked.is_empty() {
                landmarks.push(assembly::film(&film, &chosen)?);
            }
            let (view, readings) = (film.view, chosen.len());
            let current = CurrentFilm { record: film, readings, marked };
            match view {
                FilmView::Frontal(posture) => drop(films.insert(posture, current)),
                FilmView::Lateral => lateral = Some(current),
            }
        }
        let case = assembly::case(study, synthetic, landmarks);
        let options = options::of_study(&snapshot, study)?.chosen;
        Ok(CurrentCase { films, lateral, case, compared, options })
    }

    /// An open reading of a frontal film with the finished ones of the film, except the one that it corrects.
    fn compared(
        &self,
        connection: &Connection,
        film: &FilmRecord,
        hand: &ReadingRecord,
        state: &ReadingState,
        of_film: &[&ReadingRecord],
    ) -> Result<Option<ComparedReading>, StoreError> {
        let mut all = self.finished(connection, of_film)?;
        all.retain(|(other, _)| other.id != hand.id && Some(other.id) != hand.corrects);
        all.insert(0, (hand, state.clone()));
        let AssembledFilm::Frontal(film) = assembly::film(film, &all)? else { return Ok(None) };
        Ok(Some(ComparedReading { id: assembly::reader(hand), film }))
    }

    fn finished<'r>(
        &self,
        connection: &Connection,
        of_film: &[&'r ReadingRecord],
    ) -> Result<Read<'r>, StoreError> {
        let finished = of_film.iter().filter(|reading| reading.counts());
        finished.map(|&reading| Ok((reading, self.state_of(connection, reading)?))).collect()
    }

    /// The readings used for a film beside an open reading of another film.
    fn beside<'r>(
        &self,
        connection: &Connection,
        hand: &ReadingRecord,
        of_film: &[&'r ReadingRecord],
    ) -> Result<Read<'r>, StoreError> {
        let is_own = |reading: &&ReadingRecord| {
            reading.observer == hand.observer && reading.withdrawn.is_none()
        };
        let mut own: Vec<&'r ReadingRecord> = of_film.iter().copied().filter(is_own).collect();
        own.sort_by_key(|reading| std::cmp::Reverse(reading.id));
        for reading in own {
            let state = self.state_of(connection, reading)?;
            if state.complete_levels().count() == Level::MODEL.len() {
                return Ok(vec![(reading, state)]);
            }
        }
        self.finished(connection, of_film)
    }
}

type Read<'r> = Vec<(&'r ReadingRecord, ReadingState)>;
