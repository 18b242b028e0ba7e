//! The image archives that the administrator allowed, with limits of concurrent requests.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use axum::http::StatusCode;
use spineline_dicomweb::{
    Archive, BadQuery, Client, DicomwebError, FilmUid, Limits, SeriesFound, SeriesUid, StatedUids,
};
use spineline_films::{FilmFile, FilmUids, PatientMarks};
use tokio::sync::Semaphore;

use crate::problem::{Answer, Failure};
use crate::result_cache::computed;

/// Concurrent searches: each holds a thread until the archive answers.
const SEARCHES: usize = 4;
/// Concurrent retrievals: each film is in memory as a whole.
const FILMS: usize = 2;

/// Number of series whose patients are kept for comparison with later files.
const KEPT_SERIES: usize = 10_000;

/// The archives, their limits of requests, and the patients of series that they found.
pub struct Archives {
    all: Vec<Arc<Archive>>,
    client: Client,
    searches: Arc<Semaphore>,
    films: Arc<Semaphore>,
    /// Patients by the name of an archive and a series that it found.
    patients: Mutex<HashMap<(String, SeriesUid), PatientMarks>>,
}

impl Archives {
    pub fn new(all: &[Archive], limits: Limits) -> Self {
        Self {
            all: all.iter().cloned().map(Arc::new).collect(),
            client: Client::new(limits),
            searches: Arc::new(Semaphore::new(SEARCHES)),
            films: Arc::new(Semaphore::new(FILMS)),
            patients: Mutex::default(),
        }
    }

    /// Names that users see and choose.
    pub fn names(&self) -> Vec<String> {
        self.all.iter().map(|archive| archive.name().to_owned()).collect()
    }

    /// An archive by its name.
    ///
    /// # Errors
    /// 404 for an unknown name.
    pub fn named(&self, name: &str) -> Answer<Arc<Archive>> {
        let found = self.all.iter().find(|archive| archive.name() == name);
        found.cloned().ok_or_else(|| {
            let text = "the program was not started with an archive of this name";
            Failure::new(StatusCode::NOT_FOUND, "not_found", text)
                .help("load the page again, and choose an archive of its list")
        })
    }

    /// Searches an archive.
    pub async fn search<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&Client) -> Result<T, DicomwebError> + Send + 'static,
    ) -> Answer<T> {
        self.ask(&self.searches, ask).await
    }

    /// Retrieves a film.
    pub async fn retrieve(
        &self,
        ask: impl FnOnce(&Client) -> Result<Vec<u8>, DicomwebError> + Send + 'static,
    ) -> Answer<Vec<u8>> {
        self.ask(&self.films, ask).await
    }

    /// Keeps the patients of series that an archive found.
    pub fn keep_patients(&self, archive: &Archive, found: &[SeriesFound]) {
        let mut kept = self.patients.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() + found.len() > KEPT_SERIES {
            kept.clear();
        }
        let patients = found.iter().filter_map(|one| Some((one, one.patient.as_ref()?)));
        kept.extend(patients.map(|(one, patient)| {
            let key = (archive.name().to_owned(), one.uid());
            (key, PatientMarks::of_id(patient.value()))
        }));
    }

    /// Refuses a film other than the requested one, or of another patient than the series.
    ///
    /// # Errors
    /// 502 with the UIDs that differ.
    pub fn check(&self, archive: &Archive, asked: &FilmUid, film: &FilmFile) -> Answer<()> {
        let FilmUids { study_instance, series_instance, sop_instance, .. } = &film.tags.uids;
        let stated = StatedUids {
            study: study_instance.as_deref(),
            series: series_instance.as_deref(),
            instance: sop_instance.as_deref(),
        };
        asked.check(archive, stated)?;
        let kept = self.patients.lock().unwrap_or_else(PoisonError::into_inner);
        let patient = kept.get(&(archive.name().to_owned(), asked.series.clone()));
        if patient.is_some_and(|patient| !patient.differences(&film.tags.patient).is_empty()) {
            let (archive, instance) = (archive.name().to_owned(), asked.instance().to_owned());
            return Err(DicomwebError::OtherPatient { archive, instance }.into());
        }
        Ok(())
    }

    /// Runs on a blocking thread. The permit is held until the archive answers, even if the request is dropped.
    async fn ask<T: Send + 'static>(
        &self,
        places: &Arc<Semaphore>,
        ask: impl FnOnce(&Client) -> Result<T, DicomwebError> + Send + 'static,
    ) -> Answer<T> {
        let place = places.clone().acquire_owned().await.expect("it is never closed");
        let client = self.client.clone();
        let answer = computed(move || {
            let _place = place;
            ask(&client)
        });
        Ok(answer.await??)
    }
}

impl From<BadQuery> for Failure {
    fn from(error: BadQuery) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, "bad_search", error.to_string())
            .help(error.help())
    }
}

impl From<DicomwebError> for Failure {
    fn from(error: DicomwebError) -> Self {
        use StatusCode as S;
        let (status, code) = match error {
            DicomwebError::Unreachable { .. } => (S::BAD_GATEWAY, "archive_unreachable"),
            DicomwebError::TooSlow { .. } => (S::GATEWAY_TIMEOUT, "archive_slow"),
            DicomwebError::Login { .. } => (S::BAD_GATEWAY, "archive_login"),
            DicomwebError::NotFound { .. } => (S::NOT_FOUND, "archive_film_missing"),
            DicomwebError::OtherFilm { .. } | DicomwebError::OtherPatient { .. } => {
                (S::BAD_GATEWAY, "archive_other_film")
            }
            DicomwebError::TooLarge { .. } => (S::PAYLOAD_TOO_LARGE, "too_large"),
            _ => (S::BAD_GATEWAY, "archive_answer"),
        };
        Self::new(status, code, error.to_string()).help(error.help())
    }
}
