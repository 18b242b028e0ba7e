//! What all requests share.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use spineline_store::{Access, Store, StoreError, Timestamp};
use tokio::sync::Semaphore;

use super::guard::Hosts;
use super::guard_rate::Attempts;
use super::guard_token::OneTimeToken;
use super::{Answer, changes, films, results, studies};

/// Requests that are answered at once. Each may hold a body of some megabytes.
const MOST_IN_FLIGHT: usize = 64;
/// Passwords that are compared at once, at 19 MB each.
const MOST_PASSWORDS: usize = 2;

/// Choices of whoever starts the server.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Program that decodes films in a process of its own.
    pub decoder: PathBuf,
    /// Its arguments.
    pub decoder_arguments: Vec<String>,
    /// How people show who they are.
    pub access: Access,
    /// Names under which the program answers, beside its address and the loopback names.
    pub hosts: Vec<String>,
    /// Whether a proxy serves it by TLS, so that cookies travel there only.
    pub https: bool,
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
    hosts: Hosts,
    token: OneTimeToken,
    attempts: Attempts,
    in_flight: Semaphore,
    passwords: Semaphore,
    films: films::Shelf,
    studies: studies::Overviews,
    changes: changes::Channel,
    results: results::Cache,
}

impl fmt::Debug for AppState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Never the token.
        f.debug_struct("AppState").field("address", &self.shared.address).finish_non_exhaustive()
    }
}

impl AppState {
    /// What the requests to a server at this address share.
    #[must_use]
    pub fn new(store: Store, address: SocketAddr, options: ServeOptions) -> Self {
        let hosts = Hosts::new(address, &options.hosts);
        let shared = Shared {
            store: Mutex::new(store),
            address,
            options,
            hosts,
            token: OneTimeToken::new(),
            attempts: Attempts::default(),
            in_flight: Semaphore::new(MOST_IN_FLIGHT),
            passwords: Semaphore::new(MOST_PASSWORDS),
            films: films::Shelf::default(),
            studies: studies::Overviews::default(),
            changes: changes::Channel::default(),
            results: results::Cache::default(),
        };
        Self { shared: Arc::new(shared) }
    }

    pub(super) fn address(&self) -> SocketAddr {
        self.shared.address
    }

    pub(super) fn options(&self) -> &ServeOptions {
        &self.shared.options
    }

    /// Analyses of studies.
    pub(super) fn results(&self) -> &results::Cache {
        &self.shared.results
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

    pub(super) fn hosts(&self) -> &Hosts {
        &self.shared.hosts
    }

    pub(super) fn token(&self) -> &OneTimeToken {
        &self.shared.token
    }

    pub(super) fn attempts(&self) -> &Attempts {
        &self.shared.attempts
    }

    pub(super) fn in_flight(&self) -> &Semaphore {
        &self.shared.in_flight
    }

    /// The token that signs in next.
    #[must_use]
    pub fn current_token(&self) -> String {
        self.shared.token.follow().borrow().clone()
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
        self.ask(|store| Ok(ask(store)?)).await
    }

    /// Asks the store a question that may be refused for other reasons too, such as [`User::on_study`](super::User::on_study).
    ///
    /// # Errors
    /// Whatever the question refuses.
    ///
    /// # Panics
    /// If the question panics.
    pub async fn ask<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Answer<T> + Send + 'static,
    ) -> Answer<T> {
        let state = self.clone();
        let asked = tokio::task::spawn_blocking(move || {
            // A panic in a question leaves no half-written store: its transaction is rolled back.
            ask(&mut state.shared.store.lock().unwrap_or_else(PoisonError::into_inner))
        });
        asked.await.expect("the question does not panic")
    }

    /// Hashes or compares a password, without keeping the store from others.
    pub(super) async fn with_password<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> T {
        let _place = self.shared.passwords.acquire().await.expect("it is never closed");
        tokio::task::spawn_blocking(work).await.expect("passwords do not panic")
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
