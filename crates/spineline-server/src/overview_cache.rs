//! Cache of the list of studies, valid until a study changes.

use std::collections::{BTreeMap, HashMap};
use std::sync::{Arc, Mutex, PoisonError};

use spineline::anatomy::{FilmView, Level, Posture};
use spineline_store::{FilmRecord, Name, ReadingId, ReadingRecord, Store, StoreError};

use crate::api::StudyStatus;

/// Overviews of studies, each with the sequence number of the log that it belongs to.
#[derive(Default)]
pub struct OverviewCache(Mutex<HashMap<String, (i64, Arc<Overview>)>>);

/// Data of a study for the list, for any user.
pub struct Overview {
    pub films: Vec<FilmRecord>,
    pub readings: Vec<ReadingRecord>,
    /// Vertebrae of L4 to T2 with four corners.
    pub complete: BTreeMap<ReadingId, u32>,
    /// Status from the landmarks alone, and its text.
    pub status: (StudyStatus, String),
}

impl OverviewCache {
    /// The overview of a study at a sequence number of the log.
    pub fn of(
        &self,
        store: &Store,
        study: &Name,
        sequence: i64,
    ) -> Result<Arc<Overview>, StoreError> {
        let known = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = known().get(study.as_str()).cloned();
        if let Some((at, overview)) = &before
            && *at == sequence
        {
            return Ok(overview.clone());
        }
        let (films, readings) = (store.films(study)?, store.readings(study)?);
        let mut complete = BTreeMap::new();
        for reading in &readings {
            // A reading that was finished already has not changed.
            let counted = before.as_ref().and_then(|(_, before)| {
                before.readings.iter().find(|known| known.id == reading.id)?.finished_at?;
                before.complete.get(&reading.id).copied()
            });
            let count = match counted {
                Some(count) => count,
                None => store.reading_state(reading.id)?.complete_levels().count() as u32,
            };
            complete.insert(reading.id, count);
        }
        let status = status_of(&films, &readings, &complete);
        let overview = Arc::new(Overview { films, readings, complete, status });
        known().insert(study.to_string(), (sequence, overview.clone()));
        Ok(overview)
    }
}

/// The status of a study from its landmarks alone.
fn status_of(
    films: &[FilmRecord],
    readings: &[ReadingRecord],
    complete: &BTreeMap<ReadingId, u32>,
) -> (StudyStatus, String) {
    let all = Level::MODEL.len();
    let is_marked = |reading: &ReadingRecord| {
        reading.withdrawn.is_none() && complete.get(&reading.id).is_some_and(|&count| count > 0)
    };
    let erect = films.iter().filter(|film| film.view == FilmView::Frontal(Posture::Erect));
    let best = erect
        .flat_map(|film| readings.iter().filter(|reading| reading.film == film.id))
        .filter(|reading| reading.withdrawn.is_none())
        .filter_map(|reading| complete.get(&reading.id).copied())
        .max()
        .unwrap_or(0);
    if best as usize == all {
        (
            StudyStatus::Marking,
            format!("all {all} vertebrae on the erect film; no finished reading"),
        )
    } else if best > 0 || readings.iter().any(is_marked) {
        (StudyStatus::Marking, format!("{best} of {all} vertebrae on the erect film"))
    } else {
        (StudyStatus::ToMark, "no vertebra has landmarks yet".to_owned())
    }
}
