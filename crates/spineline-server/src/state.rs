//! What all requests share.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use spineline_store::{Access, Store, StoreError, Timestamp};
use tokio::sync::Semaphore;

use crate::channel::Channel;
use crate::film_cache::FilmCache;
use crate::guard_rate::Attempts;
use crate::guard_token::OneTimeToken;
use crate::hosts::Hosts;
use crate::limits::ServeLimits;
use crate::overview_cache::OverviewCache;
use crate::problem::Answer;
use crate::result_cache::ResultCache;

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
    /// What it takes at once.
    pub limits: ServeLimits,
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
    users_in_flight: Semaphore,
    strangers_in_flight: Semaphore,
    passwords: Semaphore,
    films: FilmCache,
    overviews: OverviewCache,
    changes: Channel,
    results: ResultCache,
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
        let ServeLimits { requests, uploads, .. } = options.limits;
        let shared = Shared {
            store: Mutex::new(store),
            address,
            options,
            hosts,
            token: OneTimeToken::new(),
            attempts: Attempts::default(),
            users_in_flight: Semaphore::new(requests.users),
            strangers_in_flight: Semaphore::new(requests.strangers),
            passwords: Semaphore::new(MOST_PASSWORDS),
            films: FilmCache::new(uploads),
            overviews: OverviewCache::default(),
            changes: Channel::default(),
            results: ResultCache::default(),
        };
        Self { shared: Arc::new(shared) }
    }

    pub(crate) fn address(&self) -> SocketAddr {
        self.shared.address
    }

    pub(crate) fn options(&self) -> &ServeOptions {
        &self.shared.options
    }

    /// Analyses of studies.
    pub(crate) fn results(&self) -> &ResultCache {
        &self.shared.results
    }

    /// Decoded films and uploads.
    pub(crate) fn films(&self) -> &FilmCache {
        &self.shared.films
    }

    /// What the list of studies shows.
    pub(crate) fn overviews(&self) -> &OverviewCache {
        &self.shared.overviews
    }

    /// The channel of changes.
    pub(crate) fn changes(&self) -> &Channel {
        &self.shared.changes
    }

    pub(crate) fn hosts(&self) -> &Hosts {
        &self.shared.hosts
    }

    pub(crate) fn token(&self) -> &OneTimeToken {
        &self.shared.token
    }

    pub(crate) fn attempts(&self) -> &Attempts {
        &self.shared.attempts
    }

    /// Places for requests of those who are signed in, or of the others.
    pub(crate) fn in_flight(&self, signed_in: bool) -> &Semaphore {
        if signed_in { &self.shared.users_in_flight } else { &self.shared.strangers_in_flight }
    }

    pub(crate) fn limits(&self) -> &ServeLimits {
        &self.shared.options.limits
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

    /// Asks the store a question that may be refused for other reasons too, such as [`User::on_study`](crate::session::User::on_study).
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
    pub(crate) async fn with_password<T: Send + 'static>(
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
