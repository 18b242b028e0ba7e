//! The listener, with limits for slow connections.
//!
//! `axum::serve` cannot replace this loop: it has neither a deadline for the head of a request nor a limit of
//! connections, and its graceful end waits for event streams that never end.

use std::net::SocketAddr;
use std::pin::pin;
use std::time::Duration;

use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use spineline_store::Store;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio::net::TcpListener;
use tokio::sync::watch;
use tower_http::add_extension::AddExtension;

use crate::app::app;
use crate::connection_slots::{ConnectionSlots, RequestSlot};
use crate::session;
use crate::state::{AppState, ServeOptions};

/// Longest wait for the whole head of the next request.
const HEAD_TIMEOUT: Duration = Duration::from_secs(30);
/// Most bytes of a request's head.
const MAX_HEAD_BYTES: usize = 64 << 10;
/// Interval at which expired uploads are dropped and unsaved entries are written.
const SWEEP_EVERY: Duration = Duration::from_secs(60);
/// After a rest of this time, acknowledged changes are in the main file of the store.
const REST: Duration = Duration::from_secs(2);
/// Time for running requests after a shutdown was requested. Event streams never end by themselves.
const END_TIMEOUT: Duration = Duration::from_secs(3);
/// Pause after a connection could not be accepted, for example without free file handles.
const ACCEPT_REST: Duration = Duration::from_millis(100);

/// A server that listens, and can be run.
#[derive(Debug)]
pub struct Server {
    listener: TcpListener,
    state: AppState,
}

impl Server {
    /// Listens.
    pub async fn bind(
        store: Store,
        address: SocketAddr,
        options: ServeOptions,
    ) -> std::io::Result<Self> {
        Self::on(TcpListener::bind(address).await?, store, options)
    }

    /// Uses an existing listener.
    pub fn on(listener: TcpListener, store: Store, options: ServeOptions) -> std::io::Result<Self> {
        let state = AppState::new(store, listener.local_addr()?, options);
        Ok(Self { listener, state })
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.state.address
    }

    /// The successive sign-in tokens, each valid once. A token belongs after `#` of the address, which browsers do not send.
    #[must_use]
    pub fn tokens(&self) -> watch::Receiver<String> {
        self.state.token.follow()
    }

    /// Answers requests until `end` completes, and then waits a few seconds for running ones.
    pub async fn run(self, end: impl Future<Output = ()> + Send + 'static) {
        let app = app(self.state.clone());
        let open = GracefulShutdown::new();
        let slots = ConnectionSlots::new(self.state.options.limits.connections);
        let mut sweeps = tokio::time::interval(SWEEP_EVERY);
        let mut rests = tokio::time::interval(REST);
        rests.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        let mut end = pin!(end);
        loop {
            let accepted = tokio::select! {
                accepted = self.listener.accept() => accepted,
                _ = sweeps.tick() => {
                    self.state.films.uploads.sweep(self.state.now());
                    save_unsaved(&self.state);
                    continue;
                }
                _ = rests.tick() => {
                    let state = self.state.clone();
                    // Changes that could not be written now stay in the log, and are tried again.
                    tokio::spawn(async move { state.store(Store::rest).await });
                    continue;
                }
                () = &mut end => break,
            };
            let Ok((stream, peer)) = accepted else {
                tokio::time::sleep(ACCEPT_REST).await;
                continue;
            };
            // Small answers are sent at once. An error here only makes them slower.
            let _ = stream.set_nodelay(true);
            let slot = slots.take(Some(peer.ip()));
            let app = AddExtension::new(app.clone(), slot.for_requests());
            let connection = open.watch(connection(stream, app));
            tokio::spawn(async move {
                tokio::select! {
                    // A closed connection is not an error of the server.
                    _ = connection => {}
                    () = slot.closed() => {}
                }
            });
        }
        drop(self.listener);
        self.state.changes.close();
        // Remaining connections are closed with the program.
        let _ = tokio::time::timeout(END_TIMEOUT, open.shutdown()).await;
    }
}

/// Writes the changes that had no room on the disk before. Without room they stay in memory.
fn save_unsaved(state: &AppState) {
    let (state, by) = (state.clone(), session::program());
    tokio::spawn(async move { state.store(move |store| store.save_unsaved(&by)).await });
}

type App = AddExtension<axum::Router, RequestSlot>;
type Connection<I> = http1::Connection<TokioIo<I>, TowerToHyperService<App>>;

fn connection<I: AsyncRead + AsyncWrite + Unpin + Send + 'static>(
    stream: I,
    app: App,
) -> Connection<I> {
    http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIMEOUT)
        .max_buf_size(MAX_HEAD_BYTES)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(app))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    use super::{AddExtension, AppState, ConnectionSlots, ServeOptions, app, connection};
    use crate::limits::ServeLimits;

    use spineline_store::{Access, Name, Signature, Store, Timestamp};

    /// Answer to a client that sends this and then stops, until the server closes the connection. Time is simulated.
    async fn answer_to(sent: &str) -> String {
        let folder = tempfile::tempdir().expect("a folder");
        let at = Timestamp::from_unix_ms(1_750_000_000_000).expect("a moment");
        let by = Signature::new(Name::new("lead").expect("a name"), at);
        let store = Store::create(&folder.path().join("store"), &by).expect("a store");
        let options = ServeOptions {
            decoder: PathBuf::new(),
            decoder_arguments: Vec::new(),
            access: Access::Token,
            hosts: Vec::new(),
            https: false,
            archives: Vec::new(),
            limits: ServeLimits::default(),
        };
        let address = "127.0.0.1:8765".parse().expect("an address");
        let slot = ConnectionSlots::new(options.limits.connections).take(None);
        let app = app(AppState::new(store, address, options));
        let app = AddExtension::new(app, slot.for_requests());
        let (mut client, server) = tokio::io::duplex(1 << 16);
        let served = tokio::spawn(async move {
            // The answer shows how the connection ends.
            let _ = connection(server, app).await;
        });
        client.write_all(sent.as_bytes()).await.expect("sent");
        let mut read = Vec::new();
        client.read_to_end(&mut read).await.expect("the server ends the connection");
        served.await.expect("served");
        String::from_utf8(read).expect("text")
    }

    #[tokio::test(start_paused = true)]
    async fn f65_a_request_head_that_never_ends_times_out() {
        for sent in ["", "GET / HT", "GET / HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nX-Slow: "] {
            assert!(!answer_to(sent).await.contains("200 OK"), "{sent}");
        }
    }

    #[tokio::test(start_paused = true)]
    async fn f65_a_request_body_that_never_ends_times_out() {
        let head = "POST /api/session HTTP/1.1\r\nHost: 127.0.0.1:8765\r\nOrigin: http://127.0.0.1:8765\r\nContent-Type: application/json\r\nContent-Length: 1000\r\n\r\n{\"kind\"";
        let answer = answer_to(head).await;
        assert!(answer.starts_with("HTTP/1.1 40"), "{answer}");
    }
}
