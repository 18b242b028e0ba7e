//! The landmarks of a study for other programs, as `spineline export` writes them.

use std::collections::BTreeMap;
use std::time::SystemTime;

use chrono::{DateTime, Utc};
use spineline::analysis::{Analysis, Case};
use spineline::anatomy::Posture;
use spineline_landmarks::{LandmarkTarget, SourceImage, export_landmarks, parse_source};

use super::archive::archive;
use super::file::{Download, provenance};
use crate::problem::{Answer, Failure};
use crate::result_cache::StudyResult;
use crate::state::AppState;

/// Identifiers of the films, from their DICOM files.
pub async fn sources(
    state: &AppState,
    result: &StudyResult,
) -> Answer<BTreeMap<Posture, SourceImage>> {
    let mut sources = BTreeMap::new();
    let films: Vec<_> = result.current.usable_films().collect();
    for (posture, film) in films {
        let content = film.record.content.clone();
        let bytes = state.store(move |store| store.content(&content)).await?;
        let name = format!("{posture} film");
        sources.insert(posture, parse_source(&bytes, &name).map_err(|error| Failure::of(&error))?);
    }
    Ok(sources)
}

pub fn slicer(analysis: &Analysis, case: &Case) -> Answer<Download> {
    written(analysis, case, "-slicer.zip", LandmarkTarget::Slicer)
}

pub fn dicom_sr(
    analysis: &Analysis,
    case: &Case,
    sources: &BTreeMap<Posture, SourceImage>,
) -> Answer<Download> {
    let curves = analysis.movement.end_vertebrae();
    let now = DateTime::<Utc>::from(SystemTime::now());
    let [date, time] = ["%Y%m%d", "%H%M%S"].map(|form| now.format(form).to_string());
    let target = LandmarkTarget::DicomSr { sources, curves: &curves, written: [&date, &time] };
    written(analysis, case, "-dicom-sr.zip", target)
}

fn written(
    analysis: &Analysis,
    case: &Case,
    ending: &'static str,
    target: LandmarkTarget<'_>,
) -> Answer<Download> {
    let files = export_landmarks(case, None, target).map_err(|error| Failure::of(&error))?;
    let files = files.into_iter().map(|file| (file.name, file.bytes)).collect();
    archive(ending, files, provenance(analysis))
}
