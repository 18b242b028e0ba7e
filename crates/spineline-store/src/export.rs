//! A study as a case file.

use std::collections::BTreeMap;

use serde_json::Value;
use spineline::analysis::Case;
use spineline::anatomy::FilmView;
use spineline_files::CaseFile;

use crate::assembly;
use crate::audit::{EXPORT, WHOLE_STORE};
use crate::connection::Store;
use crate::error::StoreError;
use crate::films::{self, FilmRecord};
use crate::journal;
use crate::names::{Name, ReadingId, Signature};
use crate::options;
use crate::readings;
use crate::state::ReadingState;
use crate::withdrawals::{Withdrawal, WithdrawalCause};

/// A case file and the omitted parts.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ExportedCase {
    /// Text of the case file, which `spineline_files::parse_case` has read.
    pub text: String,
    /// Omitted parts.
    pub remarks: Vec<ExportRemark>,
}

/// A part of the study that is not in its case file.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportRemark {
    /// A reading that is not finished.
    #[error("{reading} is not finished; it is not in the case")]
    Unfinished {
        /// Reading.
        reading: ReadingId,
    },
    /// A withdrawn reading, or one that a correction replaces.
    #[error("{reading} was {}; it is not in the case", withdrawn_words(withdrawal))]
    Withdrawn {
        /// Reading.
        reading: ReadingId,
        /// Who withdrew or corrected it, when and why.
        withdrawal: Withdrawal,
    },
    /// A scale measured on the film; the case has the spacing of the image.
    #[error("{reading} holds a scale measured on the film; the case has the spacing of the image")]
    ScaleLeftOut {
        /// Reading.
        reading: ReadingId,
    },
    /// A reading with one iliac crest only.
    #[error("{reading} has only one iliac crest; it is not in the case")]
    OneCrest {
        /// Reading.
        reading: ReadingId,
    },
    /// Model options of the study; a case has no place for them.
    #[error(
        "the study has model options, which are not in the case: analyze it with `{arguments}` for the results of the study"
    )]
    ModelOptions {
        /// The options as the command line takes them.
        arguments: String,
    },
}

fn withdrawn_words(Withdrawal { who, at, cause }: &Withdrawal) -> String {
    match cause {
        WithdrawalCause::Reason(reason) => format!("withdrawn by {who} at {at} ({reason})"),
        WithdrawalCause::CorrectedBy(reading) => format!("corrected by {who} at {at} ({reading})"),
    }
}

impl Store {
    /// The case of a study: its finished readings that are not withdrawn, by posture, observer and repeat. The same store gives the same bytes.
    ///
    /// A case file has one pair of iliac crests per film; it gets the mean of the pairs of all readings. Labels, notes and model
    /// options stay in the store.
    ///
    /// # Errors
    /// [`StoreError::ViewTwice`]; [`StoreError::Case`] where a case file cannot have the images' descriptions;
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn export_case(&self, study: &Name) -> Result<ExportedCase, StoreError> {
        let snapshot = self.connection.unchecked_transaction()?;
        let synthetic = films::study(&snapshot, study)?.synthetic;
        let by_view = assembly::by_view(&snapshot, study)?;
        let mut remarks = Vec::new();
        let readings = readings::of_study(&snapshot, study)?;
        let mut films = Vec::new();
        for film in by_view.values() {
            let mut finished = Vec::new();
            for reading in readings.iter().filter(|reading| reading.film == film.id) {
                if let Some(withdrawal) = reading.withdrawn.clone() {
                    remarks.push(ExportRemark::Withdrawn { reading: reading.id, withdrawal });
                    continue;
                }
                if reading.finished_at.is_none() {
                    remarks.push(ExportRemark::Unfinished { reading: reading.id });
                    continue;
                }
                let state = journal::state(&snapshot, reading)?;
                remarks.extend(left_out(reading.id, &state));
                finished.push((reading, state));
            }
            films.push(assembly::film(film, &finished)?);
        }
        let arguments = options::of_study(&snapshot, study)?.chosen.arguments();
        if !arguments.is_empty() {
            remarks.push(ExportRemark::ModelOptions { arguments });
        }
        let case = assembly::case(study, synthetic, films);
        let text = spineline_files::to_text(&written(&case, &by_view));
        spineline_files::parse_case(&text)?;
        Ok(ExportedCase { text, remarks })
    }

    /// Logs who exported a study, and in which form, such as `report`: the action is `export_report`. The study does not
    /// change.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], and errors of writing, except of a full disk.
    pub fn log_export(
        &mut self,
        study: &Name,
        form: &str,
        by: &Signature,
    ) -> Result<(), StoreError> {
        films::study(&self.connection, study)?;
        self.log_step(&format!("{EXPORT}{form}"), &format!("study/{study}"), by)
    }

    /// Logs who did something with an image archive, such as `retrieve`: the action is `retrieve_NAME`, on the store as a whole. It
    /// contains no data of the patient.
    ///
    /// # Errors
    /// Errors of writing, except of a full disk.
    pub fn log_archive(
        &mut self,
        what: &str,
        archive: &str,
        by: &Signature,
    ) -> Result<(), StoreError> {
        self.log_step(&format!("{what}_{archive}"), WHOLE_STORE, by)
    }
}

fn left_out(reading: ReadingId, state: &ReadingState) -> Vec<ExportRemark> {
    let mut remarks = Vec::new();
    if state.scale_mm.is_some() {
        remarks.push(ExportRemark::ScaleLeftOut { reading });
    }
    if state.iliac_crests_px.len() == 1 {
        remarks.push(ExportRemark::OneCrest { reading });
    }
    remarks
}

/// The case as its file has it, with the images' descriptions unchanged.
fn written(case: &Case, records: &BTreeMap<FilmView, FilmRecord>) -> Value {
    let file = CaseFile::from_case(case);
    let mut value = serde_json::to_value(file).expect("string keys only");
    // Frontal films come first in both.
    let films = value["films"].as_array_mut().into_iter().flatten();
    for (film, record) in films.zip(records.values()) {
        film["image"] = described(record);
    }
    if let Some(record) = records.get(&FilmView::Lateral) {
        value["lateral"]["image"] = described(record);
    }
    value
}

/// The image of a film with its present display.
fn described(film: &FilmRecord) -> Value {
    let mut image = film.image.clone();
    if let Some(image) = image.as_object_mut() {
        image.remove("inverted");
        if film.inverted {
            image.insert("inverted".to_owned(), true.into());
        }
    }
    image
}
