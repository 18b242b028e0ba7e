//! State shared by all requests.

use std::fmt;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::SystemTime;

use spineline_dicomweb::Archive;
use spineline_store::{Access, Store, StoreError, Timestamp};
use tokio::sync::Semaphore;

use crate::api::Computation;
use crate::archive_client::Archives;
use crate::channel::Channel;
use crate::film_cache::FilmCache;
use crate::guard_rate::{Attempts, LoggedRefusals};
use crate::guard_token::OneTimeToken;
use crate::hosts::Hosts;
use crate::jobs::{Jobs, LoadIntervalWork, PadMapWork};
use crate::limits::ServeLimits;
use crate::overview_cache::OverviewCache;
use crate::places::Rooms;
use crate::problem::Answer;
use crate::result_cache::{ResultCache, computed};

/// Concurrent comparisons of passwords, of 19 MB each, for known browsers and users.
const MAX_PASSWORDS: usize = 2;
/// The same for strangers: their guesses take at most one processor.
const MAX_STRANGERS_PASSWORDS: usize = 1;

/// Options of the server.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Program that decodes films in a separate process.
    pub decoder: PathBuf,
    /// Its arguments.
    pub decoder_arguments: Vec<String>,
    /// Way of signing in.
    pub access: Access,
    /// Names under which the program answers, beside its address and the loopback names.
    pub hosts: Vec<String>,
    /// Whether a proxy serves it by TLS; cookies are then sent by TLS only.
    pub https: bool,
    /// Image archives from which users may open films.
    pub archives: Vec<Archive>,
    /// Limits of concurrent work.
    pub limits: ServeLimits,
}

/// State shared by all requests; cheap to clone.
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
    logged_refusals: LoggedRefusals,
    rooms: Rooms,
    passwords: Semaphore,
    strangers_passwords: Semaphore,
    films: FilmCache,
    archives: Archives,
    overviews: OverviewCache,
    changes: Channel,
    results: ResultCache,
    jobs: Jobs<Computation>,
    pad_maps: Jobs<PadMapWork>,
    load_intervals: Jobs<LoadIntervalWork>,
}

impl fmt::Debug for AppState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Never the token.
        f.debug_struct("AppState").field("address", &self.shared.address).finish_non_exhaustive()
    }
}

impl AppState {
    /// State of a server at this address.
    #[must_use]
    pub fn new(store: Store, address: SocketAddr, options: ServeOptions) -> Self {
        let hosts = Hosts::new(address, &options.hosts);
        let ServeLimits { requests, uploads, archive, .. } = options.limits;
        let archives = Archives::new(&options.archives, archive);
        let shared = Shared {
            store: Mutex::new(store),
            address,
            options,
            hosts,
            token: OneTimeToken::new(),
            attempts: Attempts::default(),
            logged_refusals: LoggedRefusals::default(),
            rooms: Rooms::new(requests),
            passwords: Semaphore::new(MAX_PASSWORDS),
            strangers_passwords: Semaphore::new(MAX_STRANGERS_PASSWORDS),
            films: FilmCache::new(uploads),
            archives,
            overviews: OverviewCache::default(),
            changes: Channel::default(),
            results: ResultCache::default(),
            jobs: Jobs::default(),
            pad_maps: Jobs::default(),
            load_intervals: Jobs::default(),
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

    /// Computations in the background.
    pub(crate) fn jobs(&self) -> &Jobs<Computation> {
        &self.shared.jobs
    }

    /// Pads that are tried in the background.
    pub(crate) fn pad_maps(&self) -> &Jobs<PadMapWork> {
        &self.shared.pad_maps
    }

    /// Intervals under loads that are computed in the background.
    pub(crate) fn load_intervals(&self) -> &Jobs<LoadIntervalWork> {
        &self.shared.load_intervals
    }

    /// Decoded films and uploads.
    pub(crate) fn films(&self) -> &FilmCache {
        &self.shared.films
    }

    /// Image archives.
    pub(crate) fn archives(&self) -> &Archives {
        &self.shared.archives
    }

    /// Overviews for the list of studies.
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

    /// Counts the refused attempts to sign in that get an entry in the log.
    pub(crate) fn logged_refusals(&self) -> &LoggedRefusals {
        &self.shared.logged_refusals
    }

    /// Places for requests.
    pub(crate) fn rooms(&self) -> &Rooms {
        &self.shared.rooms
    }

    pub(crate) fn limits(&self) -> &ServeLimits {
        &self.shared.options.limits
    }

    /// The token that signs in next.
    #[must_use]
    pub fn current_token(&self) -> String {
        self.shared.token.follow().borrow().clone()
    }

    /// Runs a query of the store on a thread that may wait for the disk.
    ///
    /// # Errors
    /// Errors of the store, or a panic of the query.
    pub async fn store<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Result<T, StoreError> + Send + 'static,
    ) -> Answer<T> {
        self.ask(|store| Ok(ask(store)?)).await
    }

    /// Runs a query of the store that may also be refused for other reasons, such as
    /// [`User::on_study`](crate::user::User::on_study).
    ///
    /// # Errors
    /// Errors of the query, or its panic.
    pub async fn ask<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Answer<T> + Send + 'static,
    ) -> Answer<T> {
        let state = self.clone();
        let asked = computed(move || {
            // After a panic in a query its transaction is rolled back, so the store stays valid.
            ask(&mut state.shared.store.lock().unwrap_or_else(PoisonError::into_inner))
        });
        asked.await?
    }

    /// Hashes or compares a password without a lock on the store.
    ///
    /// # Errors
    /// If the work panics.
    pub(crate) async fn with_password<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Answer<T> {
        let _place = self.shared.passwords.acquire().await.expect("it is never closed");
        computed(work).await
    }

    /// The same for strangers, separately, so that they do not delay users.
    ///
    /// # Errors
    /// If the work panics.
    pub(crate) async fn with_strangers_password<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Answer<T> {
        let _place = self.shared.strangers_passwords.acquire().await.expect("it is never closed");
        computed(work).await
    }

    /// Current time.
    #[must_use]
    pub fn now(&self) -> Timestamp {
        SystemTime::now().into()
    }
}
