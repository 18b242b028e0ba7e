//! What all requests share.

use std::collections::HashMap;
use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::{Answer, changes, films, studies};
use crate::store::{Name, Store, StoreError, Timestamp};

/// Choices of whoever starts the server.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Program that decodes films in a process of its own.
    pub decoder: PathBuf,
    /// Its arguments.
    pub decoder_arguments: Vec<String>,
}

/// What all requests share; cheap to clone.
#[derive(Clone)]
pub struct AppState {
    shared: Arc<Shared>,
}

struct Shared {
    store: Mutex<Store>,
    address: SocketAddr,
    options: ServeOptions,
    token: String,
    sessions: Mutex<HashMap<String, Name>>,
    films: films::Shelf,
    studies: studies::Overviews,
    changes: changes::Channel,
}

impl fmt::Debug for AppState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Never the token.
        f.debug_struct("AppState").field("address", &self.shared.address).finish_non_exhaustive()
    }
}

impl AppState {
    pub(super) fn new(store: Store, address: SocketAddr, options: ServeOptions) -> Self {
        let (store, sessions) = (Mutex::new(store), Mutex::default());
        let shared = Shared {
            store,
            address,
            options,
            token: secret(),
            sessions,
            films: films::Shelf::default(),
            studies: studies::Overviews::default(),
            changes: changes::Channel::default(),
        };
        Self { shared: Arc::new(shared) }
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.shared.address
    }

    pub(super) fn token(&self) -> &str {
        &self.shared.token
    }

    pub(super) fn options(&self) -> &ServeOptions {
        &self.shared.options
    }

    /// Decoded films and uploads.
    pub(super) fn films(&self) -> &films::Shelf {
        &self.shared.films
    }

    /// What the list of studies shows.
    pub(super) fn studies(&self) -> &studies::Overviews {
        &self.shared.studies
    }

    /// Who is told of changes.
    pub(super) fn changes(&self) -> &changes::Channel {
        &self.shared.changes
    }

    /// Sessions by their secret.
    pub(super) fn sessions(&self) -> MutexGuard<'_, HashMap<String, Name>> {
        self.shared.sessions.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// As [`AppState::store`], for what may be refused for other reasons than the store's.
    ///
    /// # Errors
    /// Whatever is refused.
    ///
    /// # Panics
    /// If the question panics.
    pub async fn answer<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Answer<T> + Send + 'static,
    ) -> Answer<T> {
        self.store(|store| Ok(ask(store))).await?
    }

    /// Asks the store on a thread that may wait for the disk.
    ///
    /// # Errors
    /// Whatever the store refuses.
    ///
    /// # Panics
    /// If the question panics.
    pub async fn store<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Result<T, StoreError> + Send + 'static,
    ) -> Answer<T> {
        let state = self.clone();
        let asked = tokio::task::spawn_blocking(move || {
            // A panic in a question leaves no half-written store: its transaction is rolled back.
            ask(&mut state.shared.store.lock().unwrap_or_else(PoisonError::into_inner))
        });
        Ok(asked.await.expect("the question does not panic")?)
    }

    /// What time it is.
    #[must_use]
    pub fn now(&self) -> Timestamp {
        chrono::Utc::now().into()
    }
}

/// 192 random bits for an address or a cookie.
pub(super) fn secret() -> String {
    let mut bytes = [0_u8; 24];
    getrandom::fill(&mut bytes).expect("the system has random numbers");
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
