//! The finished erect film beside a reading of another film.

use spineline::anatomy::{FilmView, Posture};
use spineline_marking::ErectFilm;
use spineline_store::{ReadingId, ReadingRecord, SeenReading, Store};

use super::landmarks::landmarks;
use crate::access::seen_reading;
use crate::problem::Answer;
use crate::user::User;

/// A finished reading of the erect film.
pub struct ErectReading {
    pub reading: ReadingId,
    pub film: ErectFilm,
}

/// The last finished reading of the erect film of the study, an own one first; `None` for the erect and the lateral film, and
/// where the reading is blinded or its plan allows no proposals.
pub fn erect_of(store: &Store, user: &User, seen: &SeenReading) -> Answer<Option<ErectReading>> {
    let erect = FilmView::Frontal(Posture::Erect);
    let is_served = seen.film.view != erect && seen.film.view != FilmView::Lateral;
    if seen.code.is_some() || !seen.proposals || !is_served {
        return Ok(None);
    }
    let films = store.films(&seen.study.id)?;
    let Some(film) = films.into_iter().find(|film| film.view == erect) else { return Ok(None) };
    let readings = store.readings(&seen.study.id)?.into_iter();
    let finished = readings.filter(|reading| reading.film == film.id && reading.counts());
    let rank = |reading: &ReadingRecord| (reading.observer == user.name, reading.id);
    let Some(last) = finished.max_by_key(rank) else { return Ok(None) };
    let state = seen_reading(store, user, last.id)?.state(&[])?;
    let film = ErectFilm { image: film.geometry()?, reading: landmarks(&state, erect) };
    Ok(Some(ErectReading { reading: last.id, film }))
}
