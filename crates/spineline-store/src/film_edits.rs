//! Changes of a film's record.

use rusqlite::{Connection, params};
use serde_json::Value;
use spineline::anatomy::{FilmView, ImageSide, Posture};
use spineline::measure::{ImageGeometry, Spacing};

use crate::conflicts::{Acknowledged, keep_lost};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films::{self, FilmRecord, Stated};
use crate::names::{FilmId, Signature};
use crate::plan;
use crate::readings::{self, ReadingRecord};

/// A change of a film's record.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilmEdit {
    /// Correct the posture of a frontal film.
    Posture(Posture),
    /// Invert grey levels on the screen, or not.
    Inverted(bool),
    /// Set the spacing.
    Spacing(Spacing),
    /// Correct the side of the picture on which the patient's left is, or the patient's front on the lateral film. Landmarks are
    /// named by it, so the film must not have readings.
    PatientLeft(ImageSide),
    /// State that a person compared the film with the patient's records, or not. Another posture and another side of the patient end the
    /// statement. Another scale does not: it changes neither patient, posture, levels nor sides.
    Checked(bool),
}

impl FilmEdit {
    fn json(self) -> Value {
        match self {
            Self::Spacing(spacing) => serde_json::json!({
                "column_spacing_mm": spacing.column_mm, "row_spacing_mm": spacing.row_mm,
                "spacing_plane": spacing.plane.key(), "spacing_source": spacing.source.key(),
            }),
            Self::PatientLeft(side) => serde_json::json!({ "patient_left": side.key() }),
            Self::Posture(posture) => serde_json::json!({ "posture": posture.key() }),
            Self::Inverted(inverted) => serde_json::json!({ "inverted": inverted }),
            Self::Checked(checked) => serde_json::json!({ "checked": checked }),
        }
    }

    /// The film after the change.
    fn applied(self, film: FilmRecord) -> Result<FilmRecord, StoreError> {
        Ok(match self {
            Self::Posture(_) if film.view == FilmView::Lateral => {
                return Err(StoreError::NotFrontal { film: film.id });
            }
            Self::Posture(posture) => FilmRecord {
                view: FilmView::Frontal(posture),
                stated: unchecked(film.stated),
                ..film
            },
            Self::Inverted(inverted) => FilmRecord { inverted, ..film },
            Self::Spacing(spacing) => {
                let set = |image: &mut ImageGeometry| image.spacing = Some(spacing);
                let image = spineline_files::with_geometry(&film.image, film.view, set)?;
                FilmRecord { image, ..film }
            }
            Self::PatientLeft(side) => {
                let set = |image: &mut ImageGeometry| image.patient_left = side;
                let image = spineline_files::with_geometry(&film.image, film.view, set)?;
                FilmRecord { image, stated: unchecked(film.stated), ..film }
            }
            Self::Checked(checked) => {
                FilmRecord { stated: Stated { checked, ..film.stated }, ..film }
            }
        })
    }
}

/// The statements about a film that nobody has compared with the records since.
fn unchecked(stated: Stated) -> Stated {
    Stated { checked: false, ..stated }
}

impl Store {
    /// Changes a film's record, if it has the expected revision. While a plan runs, all its readings have the same film.
    ///
    /// # Errors
    /// [`StoreError::PlanRuns`] until all planned readings are finished; [`StoreError::Archived`];
    /// [`StoreError::Conflict`], and then the edit is among [`Store::conflicts_of_film`]; [`StoreError::Unknown`];
    /// [`StoreError::NotFrontal`] for a posture of the lateral film; [`StoreError::HasReading`] for the patient's side of a read film; [`StoreError::Case`] for a spacing where a case file
    /// cannot have the image's description.
    pub fn edit_film(
        &mut self,
        film: FilmId,
        edit: FilmEdit,
        expected_revision: u64,
        by: &Signature,
    ) -> Result<Acknowledged, StoreError> {
        self.write(by, |ledger| {
            let now = films::film(ledger.transaction, film)?;
            films::open_study(ledger.transaction, &now.study)?;
            plan::need_open(ledger.transaction, &now.study)?;
            if now.revision != expected_revision {
                let change = [edit.json().to_string()];
                let object = film.to_string();
                return keep_lost(ledger, object, expected_revision, now.revision, &change)
                    .map(Err);
            }
            if let FilmEdit::PatientLeft(_) = edit {
                need_unread(ledger.transaction, &now)?;
            }
            let revision = now.revision + 1;
            let FilmRecord { view, image, stated, inverted, .. } = edit.applied(now)?;
            ledger.transaction.execute(
                "UPDATE films SET posture = ?1, image = ?2, inverted = ?3, revision = revision + 1 WHERE id = ?4",
                params![view.key(), films::described(&image, stated), inverted, film.0],
            )?;
            let sequence = ledger.seal("edit", "films", &film.0)?;
            Ok(Ok(Acknowledged { sequence, revision }))
        })?
    }
}

/// Refuses a film with a reading that is not withdrawn.
fn need_unread(connection: &Connection, film: &FilmRecord) -> Result<(), StoreError> {
    let readings = readings::of_study(connection, &film.study)?;
    let stands = |one: &&ReadingRecord| one.film == film.id && one.withdrawn.is_none();
    match readings.iter().find(stands) {
        Some(reading) => Err(StoreError::HasReading { film: film.id, reading: reading.id }),
        None => Ok(()),
    }
}
