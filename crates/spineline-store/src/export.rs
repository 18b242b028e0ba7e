//! A study as a case file.

use std::collections::BTreeMap;

use rusqlite::Connection;
use serde_json::{Map, Value, json};
use spineline::anatomy::{Posture, Side};

use crate::connection::Store;
use crate::error::StoreError;
use crate::films::{self, FilmRecord};
use crate::journal;
use crate::names::{Name, ReadingId};
use crate::readings::{self, ReadingRecord};
use crate::state::{ReadingState, VertebraMarks};

/// A case file and what it could not hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedCase {
    /// Text of the case file, which `spineline_io::parse_case` has read.
    pub text: String,
    /// What was left out.
    pub remarks: Vec<ExportRemark>,
}

/// Something of the study that is not in its case file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum ExportRemark {
    /// A reading that is not finished.
    Unfinished {
        /// Reading.
        reading: ReadingId,
    },
    /// A scale read off the film. The image's own spacing stands.
    ScaleLeftOut {
        /// Reading.
        reading: ReadingId,
    },
    /// A reading with one iliac crest only.
    OneCrest {
        /// Reading.
        reading: ReadingId,
    },
}

impl std::fmt::Display for ExportRemark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unfinished { reading } => {
                write!(f, "{reading} is not finished, and not in the case")
            }
            Self::ScaleLeftOut { reading } => write!(
                f,
                "{reading} holds a scale read off the film; the image's own spacing stands in the case"
            ),
            Self::OneCrest { reading } => {
                write!(f, "{reading} has one iliac crest only, which is not in the case")
            }
        }
    }
}

impl Store {
    /// The case of a study: its finished readings, by posture, observer and repeat. The same store gives the same bytes.
    ///
    /// A case file has one pair of iliac crests per film; it gets the mean of the pairs of all readings. Labels and notes stay in the store.
    ///
    /// # Errors
    /// [`StoreError::PostureTwice`]; [`StoreError::Case`] where the images' descriptions are not those of a case file;
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn export_case(&self, study: &Name) -> Result<ExportedCase, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let synthetic = films::study(&snapshot, study)?.synthetic;
        let by_posture = by_posture(&snapshot, study)?;
        let mut remarks = Vec::new();
        let readings = readings::of_study(&snapshot, study)?;
        let mut records = Vec::new();
        for film in by_posture.values() {
            let mut finished = Vec::new();
            for reading in readings.iter().filter(|reading| reading.film == film.id) {
                if reading.finished_at.is_none() {
                    remarks.push(ExportRemark::Unfinished { reading: reading.id });
                    continue;
                }
                let state = journal::state(&snapshot, reading)?;
                remarks.extend(left_out(reading.id, &state));
                finished.push((reading, state));
            }
            records.push(film_json(film, &finished));
        }
        let text = spineline_io::to_text(&case_json(study, synthetic, records));
        spineline_io::parse_case(&text)?;
        Ok(ExportedCase { text, remarks })
    }
}

/// The films of a study, of which a case has one per posture.
pub(crate) fn by_posture(
    connection: &Connection,
    study: &Name,
) -> Result<BTreeMap<Posture, FilmRecord>, StoreError> {
    let mut by_posture: BTreeMap<Posture, FilmRecord> = BTreeMap::new();
    for film in films::films(connection, study)? {
        if let Some(other) = by_posture.insert(film.posture, film) {
            let (study, posture) = (study.clone(), other.posture);
            return Err(StoreError::PostureTwice { study, posture });
        }
    }
    Ok(by_posture)
}

pub(crate) fn case_json(study: &Name, synthetic: bool, films: Vec<Value>) -> Value {
    json!({
        "format": "spineline-case", "version": 1, "case_id": study.as_str(),
        "synthetic": synthetic, "films": films,
    })
}

fn left_out(reading: ReadingId, state: &ReadingState) -> Vec<ExportRemark> {
    let mut remarks = Vec::new();
    if state.scale.is_some() {
        remarks.push(ExportRemark::ScaleLeftOut { reading });
    }
    if state.iliac_crests_px.len() == 1 {
        remarks.push(ExportRemark::OneCrest { reading });
    }
    remarks
}

pub(crate) fn film_json(film: &FilmRecord, finished: &[(&ReadingRecord, ReadingState)]) -> Value {
    let mut record = Map::new();
    record.insert("posture".to_owned(), film.posture.key().into());
    let mut image = film.image.clone();
    if let Some(image) = image.as_object_mut() {
        image.remove("inverted");
        if film.inverted {
            image.insert("inverted".to_owned(), true.into());
        }
    }
    record.insert("image".to_owned(), image);
    if let Some(crests) = mean_crests(finished) {
        record.insert("iliac_crests_px".to_owned(), crests);
    }
    let readings: Vec<Value> = finished
        .iter()
        .map(|(reading, state)| {
            let vertebrae: Map<String, Value> = state
                .vertebrae
                .iter()
                .filter(|(_, marks)| marks.is_complete())
                .map(|(level, marks)| (level.name().to_owned(), vertebra_json(marks)))
                .collect();
            json!({
                "observer": reading.observer.as_str(), "repeat": reading.repeat,
                "vertebrae": vertebrae,
            })
        })
        .collect();
    record.insert("readings".to_owned(), readings.into());
    Value::Object(record)
}

fn vertebra_json(marks: &VertebraMarks) -> Value {
    let mut vertebra: Map<String, Value> = marks
        .corners
        .iter()
        .map(|(corner, place)| (corner.key().to_owned(), json!(place)))
        .collect();
    if let Some(axis_deg) = marks.axis_deg {
        vertebra.insert("axis_deg".to_owned(), axis_deg.into());
    }
    Value::Object(vertebra)
}

/// The mean of the readings that have both crests, summed in their order.
fn mean_crests(finished: &[(&ReadingRecord, ReadingState)]) -> Option<Value> {
    let pairs: Vec<[[f64; 2]; 2]> = finished
        .iter()
        .filter_map(|(_, state)| {
            let crest = |side| state.iliac_crests_px.get(&side).copied();
            Some([crest(Side::Left)?, crest(Side::Right)?])
        })
        .collect();
    let mean = |side: usize, axis: usize| {
        pairs.iter().map(|pair| pair[side][axis]).sum::<f64>() / pairs.len() as f64
    };
    (!pairs.is_empty())
        .then(|| json!({ "left": [mean(0, 0), mean(0, 1)], "right": [mean(1, 0), mean(1, 1)] }))
}
