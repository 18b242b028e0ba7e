//! State shared by all requests.

use std::fmt;
use std::net::SocketAddr;
use std::ops::Deref;
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
pub struct AppState(Arc<Shared>);

/// The parts of the state.
pub struct Shared {
    store: Mutex<Store>,
    pub(crate) address: SocketAddr,
    pub(crate) options: ServeOptions,
    pub(crate) hosts: Hosts,
    pub(crate) token: OneTimeToken,
    pub(crate) attempts: Attempts,
    /// Counts the refused attempts to sign in that get an entry in the log.
    pub(crate) logged_refusals: LoggedRefusals,
    /// Places for requests.
    pub(crate) rooms: Rooms,
    /// Places to compare passwords of known browsers and users.
    pub(crate) passwords: Semaphore,
    /// Places for the passwords of strangers, so that they do not delay users.
    pub(crate) strangers_passwords: Semaphore,
    /// Decoded films and uploads.
    pub(crate) films: FilmCache,
    pub(crate) archives: Archives,
    /// Overviews for the list of studies.
    pub(crate) overviews: OverviewCache,
    pub(crate) changes: Channel,
    /// Analyses of studies.
    pub(crate) results: ResultCache,
    /// Computations in the background.
    pub(crate) jobs: Jobs<Computation>,
    /// Pads that are tried in the background.
    pub(crate) pad_maps: Jobs<PadMapWork>,
    /// Intervals under loads that are computed in the background.
    pub(crate) load_intervals: Jobs<LoadIntervalWork>,
}

impl Deref for AppState {
    type Target = Shared;

    fn deref(&self) -> &Shared {
        &self.0
    }
}

impl fmt::Debug for AppState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Never the token.
        f.debug_struct("AppState").field("address", &self.address).finish_non_exhaustive()
    }
}

impl AppState {
    /// State of a server at this address.
    #[must_use]
    pub fn new(store: Store, address: SocketAddr, options: ServeOptions) -> Self {
        let hosts = Hosts::new(address, &options.hosts);
        let ServeLimits { requests, uploads, archive, .. } = options.limits;
        let archives = Archives::new(&options.archives, archive);
        Self(Arc::new(Shared {
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
        }))
    }

    /// The token that signs in next.
    #[must_use]
    pub fn current_token(&self) -> String {
        self.token.follow().borrow().clone()
    }

    /// Runs a query of the store on a thread that may wait for the disk.
    pub async fn store<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Result<T, StoreError> + Send + 'static,
    ) -> Answer<T> {
        self.ask(|store| Ok(ask(store)?)).await
    }

    /// Runs a query of the store that may also be refused for other reasons, such as
    /// [`User::on_study`](crate::user::User::on_study).
    pub async fn ask<T: Send + 'static>(
        &self,
        ask: impl FnOnce(&mut Store) -> Answer<T> + Send + 'static,
    ) -> Answer<T> {
        let state = self.clone();
        let asked = computed(move || {
            // After a panic in a query its transaction is rolled back, so the store stays valid.
            ask(&mut state.store.lock().unwrap_or_else(PoisonError::into_inner))
        });
        asked.await?
    }

    /// Hashes or compares a password without a lock on the store, at one of these places.
    ///
    /// # Errors
    /// If the work panics.
    pub(crate) async fn with_password<T: Send + 'static>(
        &self,
        places: &Semaphore,
        work: impl FnOnce() -> T + Send + 'static,
    ) -> Answer<T> {
        let _place = places.acquire().await.expect("it is never closed");
        computed(work).await
    }

    /// Current time.
    #[must_use]
    pub fn now(&self) -> Timestamp {
        SystemTime::now().into()
    }
}
