//! An app with its own store, and signed-in browsers.

use std::convert::Infallible;
use std::fs;
use std::future::poll_fn;
use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::task::Context;
use std::thread::sleep;
use std::time::Duration;

use axum::Router;
use axum::body::{Body, HttpBody, to_bytes};
use axum::http::{HeaderMap, Method, Request, StatusCode, header};
use serde_json::{Value, json};
use spineline::anatomy::Posture;
use spineline_server::{AppState, ServeLimits, ServeOptions, app};
use spineline_store::{
    Access, Account, Name, PasswordHash, Role, Signature, Store, Study, Timestamp,
};
use tempfile::TempDir;
use tokio::runtime::Runtime;
use tokio::sync::mpsc;
use tokio_stream::wrappers::ReceiverStream;
use tower::ServiceExt;

pub const HOST: &str = "127.0.0.1:8765";
pub const ORIGIN: &str = "http://127.0.0.1:8765";
pub const PASSWORD: &str = "a long enough sentence";

pub fn name(text: &str) -> Name {
    Name::new(text).expect("a good name")
}

pub fn by(who: &str) -> Signature {
    Signature::new(name(who), Timestamp::from_unix_ms(1_750_000_000_000).expect("a moment"))
}

pub struct App {
    runtime: Runtime,
    router: Router,
    state: AppState,
    folder: TempDir,
}

impl App {
    /// An app with the token of the terminal.
    pub fn with_token() -> Self {
        Self::new(Access::Token, |_| ())
    }

    /// An app with the accounts `lead` (admin), `editor`, `reader` and `ungranted`. `editor` and `reader` have grants
    /// of these roles for the study `S-1`, and `S-2` has no grants. Each study has a film, and `S-2` a reading, by
    /// `lead`.
    pub fn with_accounts() -> Self {
        Self::new(Access::Accounts, |store| {
            let password = PasswordHash::new(PASSWORD, &name("lead")).expect("a password");
            for (who, role) in [
                ("lead", Role::Admin),
                ("editor", Role::Editor),
                ("reader", Role::Reader),
                ("ungranted", Role::Editor),
            ] {
                let account = Account { name: name(who), role, enabled: true };
                store.add_account(&account, &password, &by("lead")).expect("an account");
            }
            for study in ["S-1", "S-2"] {
                let record = Study::new(name(study), None, true);
                store.add_study(&record, &by("lead")).expect("a study");
                let film = store
                    .add_film(&record.id, Posture::Erect, study.as_bytes(), &json!({}), &by("lead"))
                    .expect("a film");
                if study == "S-2" {
                    store.begin_reading(film, 1, &by("lead")).expect("a reading");
                }
            }
            for (who, role) in [("editor", Role::Editor), ("reader", Role::Reader)] {
                store.grant(&name("S-1"), &name(who), role, &by("lead")).expect("a grant");
            }
        })
    }

    pub fn new(access: Access, fill: impl FnOnce(&mut Store)) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let mut store =
            Store::create(&folder.path().join("store"), &by("lead")).expect("a new store");
        fill(&mut store);
        Self::over(folder, store, options(access))
    }

    fn over(folder: TempDir, store: Store, options: ServeOptions) -> Self {
        let runtime = Runtime::new().expect("a runtime");
        spineline::measure::completion::provide_shape(spineline_weights::ERECT_SPINES);
        let address: SocketAddr = HOST.parse().expect("an address");
        let state = AppState::new(store, address, options);
        Self { runtime, router: app(state.clone()), state, folder }
    }

    /// The same store after a restart of the program.
    pub fn restarted(self, options: ServeOptions) -> Self {
        let Self { runtime, router, state, folder } = self;
        drop((router, state, runtime));
        let store = Store::open(&folder.path().join("store")).expect("the store");
        Self::over(folder, store, options)
    }

    /// An app over a copy of a kept store.
    pub fn copy_of(kept: &Path, options: ServeOptions) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        copy(kept, folder.path());
        let store = Store::open(&folder.path().join("store")).expect("the store");
        Self::over(folder, store, options)
    }

    /// Ends the program and keeps the folder of its store in another place.
    pub fn keep(self, place: &Path) {
        let Self { runtime, router, state, folder } = self;
        drop((router, state, runtime));
        // Copied under another name first: the store is complete or absent.
        let beside = place.with_extension("begun");
        copy(folder.path(), &beside);
        fs::rename(&beside, place).expect("moved");
    }

    pub fn store_path(&self) -> PathBuf {
        self.folder.path().join("store")
    }

    pub fn token(&self) -> String {
        self.state.current_token()
    }

    /// Sends a request without additions.
    pub fn ask(&self, request: Request<Body>) -> Answer {
        self.runtime.block_on(async {
            let answer = self.router.clone().oneshot(request).await.expect("an answer");
            let (parts, body) = answer.into_parts();
            let body = to_bytes(body, 64 << 20).await.expect("a body");
            Answer { status: parts.status, headers: parts.headers, body: body.to_vec() }
        })
    }

    /// Sends a request whose body arrives after something else has happened.
    pub fn ask_slowly(
        &self,
        head: axum::http::request::Builder,
        body: Vec<u8>,
        meanwhile: impl FnOnce(),
    ) -> Answer {
        let (sender, receiver) = mpsc::channel::<Result<Vec<u8>, Infallible>>(1);
        let body_of = Body::from_stream(ReceiverStream::new(receiver));
        let request = head.body(body_of).expect("a request");
        self.runtime.block_on(async {
            let asked = tokio::spawn(self.router.clone().oneshot(request));
            tokio::time::sleep(Duration::from_millis(200)).await;
            meanwhile();
            sender.send(Ok(body)).await.expect("somebody reads it");
            drop(sender);
            let answer = asked.await.expect("no panic").expect("an answer");
            let (parts, body) = answer.into_parts();
            let body = to_bytes(body, 64 << 20).await.expect("a body");
            Answer { status: parts.status, headers: parts.headers, body: body.to_vec() }
        })
    }

    /// Begins to read an answer that may be endless.
    pub fn begin(&self, request: Request<Body>) -> Stream<'_> {
        let answer = self.runtime.block_on(self.router.clone().oneshot(request));
        let answer = answer.expect("an answer");
        assert_eq!(answer.status(), StatusCode::OK);
        Stream { app: self, body: answer.into_body() }
    }

    /// A browser without a session.
    pub fn browser(&self) -> Browser<'_> {
        Browser { app: self, cookie: String::new(), csrf: String::new(), device: String::new() }
    }

    /// A browser that used the token.
    pub fn observer(&self, observer: &str) -> Browser<'_> {
        let mut browser = self.browser();
        let how = json!({ "kind": "token", "token": self.token(), "observer": observer });
        browser.sign_in(&how).succeeded();
        browser
    }

    /// A browser that is signed in with an account.
    pub fn account(&self, who: &str) -> Browser<'_> {
        let mut browser = self.browser();
        browser.sign_in(&account(who, PASSWORD)).succeeded();
        browser
    }
}

/// Copies the files of a folder.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder").map(|entry| entry.expect("an entry")) {
        fs::copy(entry.path(), to.join(entry.file_name())).expect("copied");
    }
}

pub fn account(who: &str, password: &str) -> Value {
    json!({ "kind": "account", "name": who, "password": password })
}

/// The body of a request that changes options of a study.
pub fn changed_options(revision: u64, options: &[(&str, &str)]) -> Value {
    let options = options.iter().map(|(name, value)| json!({ "name": name, "value": value }));
    json!({ "expected_revision": revision, "reset": false, "options": options.collect::<Vec<_>>() })
}

pub fn options(access: Access) -> ServeOptions {
    ServeOptions {
        decoder: PathBuf::from("no-decoder-in-this-test"),
        decoder_arguments: Vec::new(),
        access,
        hosts: Vec::new(),
        https: false,
        archives: Vec::new(),
        limits: ServeLimits::default(),
    }
}

pub struct Browser<'a> {
    pub app: &'a App,
    pub cookie: String,
    pub csrf: String,
    /// The cookie by which the browser is known.
    pub device: String,
}

impl Browser<'_> {
    /// Signs in, and keeps the cookie and token.
    pub fn sign_in(&mut self, how: &Value) -> Answer {
        let answer = self.post("/api/session", how);
        if answer.status == StatusCode::OK {
            self.keep_session(&answer);
        }
        answer
    }

    /// Keeps the cookies and the token of an answer.
    pub fn keep_session(&mut self, answer: &Answer) {
        let cookies = answer.headers.get_all(header::SET_COOKIE).iter();
        let mut cookies = cookies.map(|cookie| {
            let cookie = cookie.to_str().expect("text");
            cookie.split(';').next().unwrap_or_default().to_owned()
        });
        self.cookie = cookies.next().expect("a cookie");
        self.device = cookies.next().unwrap_or_default();
        self.csrf = answer.json()["csrf"].as_str().expect("a token").to_owned();
    }

    pub fn get(&self, path: &str) -> Answer {
        self.send(Method::GET, path, "", Vec::new())
    }

    /// The view of a computation after it has ended.
    pub fn ended(&self, path: &str) -> Value {
        for _ in 0..4800 {
            let view = self.get(path).json();
            if view["state"] != "running" {
                return view;
            }
            sleep(Duration::from_millis(50));
        }
        panic!("{path} does not end");
    }

    pub fn post(&self, path: &str, body: &Value) -> Answer {
        self.json(Method::POST, path, body)
    }

    pub fn put(&self, path: &str, body: &Value) -> Answer {
        self.json(Method::PUT, path, body)
    }

    pub fn delete(&self, path: &str) -> Answer {
        self.send(Method::DELETE, path, "", Vec::new())
    }

    pub fn json(&self, method: Method, path: &str, body: &Value) -> Answer {
        self.send(method, path, "application/json", body.to_string().into_bytes())
    }

    pub fn send(&self, method: Method, path: &str, kind: &str, body: Vec<u8>) -> Answer {
        let mut request = self.request(method, path);
        if !kind.is_empty() {
            request = request.header(header::CONTENT_TYPE, kind);
        }
        self.app.ask(request.body(Body::from(body)).expect("a request"))
    }

    /// The head of a request as the app's page sends it.
    pub fn request(&self, method: Method, path: &str) -> axum::http::request::Builder {
        let mut request = Request::builder().uri(path).header(header::HOST, HOST);
        if method != Method::GET {
            request = request.header(header::ORIGIN, ORIGIN).header("X-Spineline-Csrf", &self.csrf);
        }
        if !self.cookie.is_empty() {
            request = request.header(header::COOKIE, &self.cookie);
        }
        request.method(method)
    }
}

/// An answer that is still coming.
pub struct Stream<'a> {
    app: &'a App,
    body: Body,
}

impl Stream<'_> {
    /// Whether it ends within this time.
    pub fn ends_within(&mut self, wait: Duration) -> bool {
        self.app.runtime.block_on(async {
            let frame = |body: &mut Body, cx: &mut Context<'_>| Pin::new(body).poll_frame(cx);
            let end = async { while poll_fn(|cx| frame(&mut self.body, cx)).await.is_some() {} };
            tokio::time::timeout(wait, end).await.is_ok()
        })
    }
}

pub struct Answer {
    pub status: StatusCode,
    pub headers: HeaderMap,
    pub body: Vec<u8>,
}

impl Answer {
    /// The answer to a request that has to succeed.
    #[track_caller]
    pub fn succeeded(self) -> Self {
        assert_eq!(self.status, StatusCode::OK, "{}", self.text());
        self
    }

    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    pub fn json(&self) -> Value {
        serde_json::from_slice(&self.body).expect("JSON")
    }

    /// A header, or nothing.
    pub fn header(&self, name: &str) -> String {
        self.headers.get(name).map_or_else(String::new, |v| v.to_str().expect("text").to_owned())
    }

    /// The key of a refusal, which must be a complete problem.
    pub fn code(&self) -> String {
        assert_eq!(self.header("content-type"), "application/json", "{}", self.text());
        let problem = self.json();
        assert!(problem["message"].is_string(), "{problem}");
        problem["code"].as_str().expect("a code").to_owned()
    }
}
