//! The image archives that the administrator allowed, and how much is asked of them at a time.

use std::sync::Arc;

use axum::http::StatusCode;
use spineline_dicomweb::{Archive, BadQuery, Client, DicomwebError, Limits};
use tokio::sync::Semaphore;

use crate::problem::{Answer, Failure};
use crate::result_cache::computed;

/// Searches at a time: each holds a thread until the archive answers.
const SEARCHES: usize = 4;
/// Films on their way at a time: each is in memory as a whole.
const FILMS: usize = 2;

/// The archives, and how many requests to them there are at a time.
pub struct Archives {
    all: Vec<Arc<Archive>>,
    client: Client,
    searches: Arc<Semaphore>,
    films: Arc<Semaphore>,
}

impl Archives {
    pub fn new(all: &[Archive], limits: Limits) -> Self {
        Self {
            all: all.iter().cloned().map(Arc::new).collect(),
            client: Client::new(limits),
            searches: Arc::new(Semaphore::new(SEARCHES)),
            films: Arc::new(Semaphore::new(FILMS)),
        }
    }

    /// Names that users see and choose.
    pub fn names(&self) -> Vec<String> {
        self.all.iter().map(|archive| archive.name().to_owned()).collect()
    }

    /// An archive by its name.
    ///
    /// # Errors
    /// 404 where the program has none of this name.
    pub fn named(&self, name: &str) -> Answer<Arc<Archive>> {
        let found = self.all.iter().find(|archive| archive.name() == name);
        found.cloned().ok_or_else(|| {
            let text = "the program was not started with an archive of this name";
            Failure::new(StatusCode::NOT_FOUND, "not_found", text)
                .help("load the page again, and choose an archive of its list")
        })
    }

    /// Asks for what an archive has.
    ///
    /// # Errors
    /// Those of the archive.
    pub async fn search<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&Client) -> Result<T, DicomwebError> + Send + 'static,
    ) -> Answer<T> {
        self.ask(&self.searches, ask).await
    }

    /// Asks for a film.
    ///
    /// # Errors
    /// Those of the archive.
    pub async fn retrieve(
        &self,
        ask: impl FnOnce(&Client) -> Result<Vec<u8>, DicomwebError> + Send + 'static,
    ) -> Answer<Vec<u8>> {
        self.ask(&self.films, ask).await
    }

    /// Asks on a thread that may wait. The place is kept until the archive answers, even where nobody waits any more.
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
            DicomwebError::TooLarge { .. } => (S::PAYLOAD_TOO_LARGE, "too_large"),
            _ => (S::BAD_GATEWAY, "archive_answer"),
        };
        Self::new(status, code, error.to_string()).help(error.help())
    }
}
