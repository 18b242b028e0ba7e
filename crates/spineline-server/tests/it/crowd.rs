//! Many or slow requests.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use serde_json::json;
use spineline_server::{Places, RequestPlaces, ServeLimits, ServeOptions, Server, Shares};
use spineline_store::{Access, Account, PasswordHash, Role, Store};
use tempfile::TempDir;
use tokio::runtime::Runtime;

use crate::browser::{PASSWORD, by, name, options};
use crate::demo::{STUDY, app_with_demo};
use crate::films::{begin, decoding, record};

struct Listening {
    address: SocketAddr,
    runtime: Option<Runtime>,
    _folder: TempDir,
}

impl Drop for Listening {
    fn drop(&mut self) {
        self.runtime.take().expect("it runs").shutdown_background();
    }
}

fn listening(limits: ServeLimits) -> Listening {
    let folder = tempfile::tempdir().expect("a folder");
    let mut store = Store::create(&folder.path().join("store"), &by("lead")).expect("a store");
    let account = Account { name: name("lead"), role: Role::Admin, enabled: true };
    let password = PasswordHash::new(PASSWORD, &account.name).expect("a password");
    store.add_account(&account, &password, &by("lead")).expect("an account");
    let runtime = Runtime::new().expect("a runtime");
    let options = ServeOptions { limits, ..options(Access::Accounts) };
    let address = "127.0.0.1:0".parse().expect("an address");
    let server = runtime.block_on(Server::bind(store, address, options)).expect("a free port");
    let address = server.address();
    runtime.spawn(server.run(std::future::pending()));
    Listening { address, runtime: Some(runtime), _folder: folder }
}

impl Listening {
    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(self.address).expect("a connection");
        // Long enough for any machine.
        stream.set_read_timeout(Some(Duration::from_secs(120))).expect("a timeout");
        stream
    }

    fn head(&self, line: &str, more: &str) -> String {
        let host = self.address;
        format!("{line} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n{more}\r\n")
    }

    /// Signs in; returns the cookie and the whole answer.
    fn sign_in(&self) -> (String, String) {
        let body = json!({ "kind": "account", "name": "lead", "password": PASSWORD }).to_string();
        let more = format!(
            "Content-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n",
            body.len()
        );
        let answer = answer_to(self.connect(), &(self.head("POST /api/session", &more) + &body));
        let cookie = answer.lines().find_map(|line| line.strip_prefix("set-cookie: "));
        let cookie = cookie.and_then(|cookie| cookie.split(';').next()).unwrap_or_default();
        (cookie.to_owned(), answer)
    }

    /// Signs in; returns the headers of a request with a JSON body of this session.
    fn writer(&self) -> String {
        let (cookie, answer) = self.sign_in();
        let csrf = answer.split("\"csrf\":\"").nth(1).and_then(|rest| rest.split('"').next());
        let csrf = csrf.expect("a token");
        format!(
            "Cookie: {cookie}\r\nX-Spineline-Csrf: {csrf}\r\nContent-Type: application/json\r\n"
        )
    }

    fn who(&self, cookie: &str) -> String {
        let more = format!("Cookie: {cookie}\r\nConnection: close\r\n");
        answer_to(self.connect(), &self.head("GET /api/session", &more))
    }

    /// Connections that send the beginning of a request and nothing more.
    fn crowd(&self, count: usize, sent: &str) -> Vec<TcpStream> {
        let begun = (0..count).map(|_| {
            let mut stream = self.connect();
            stream.write_all(sent.as_bytes()).expect("sent");
            stream
        });
        begun.collect()
    }
}

/// Sends, and reads to the end of the connection.
fn answer_to(mut stream: TcpStream, sent: &str) -> String {
    stream.write_all(sent.as_bytes()).expect("sent");
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).expect("an answer");
    String::from_utf8_lossy(&answer).into_owned()
}

const OK: &str = "HTTP/1.1 200 OK";

#[test]
fn f65_bodies_of_strangers_that_trickle_take_no_places() {
    let one = Places { all: 1, each: 1 };
    let requests = RequestPlaces { clicks: one, users: one, known: one, strangers: one };
    let server = listening(ServeLimits { requests, ..ServeLimits::default() });
    let (cookie, answer) = server.sign_in();
    assert!(answer.starts_with(OK), "{answer}");
    let more = "Content-Type: application/json\r\nContent-Length: 1000\r\n";
    let begun = server.head("POST /api/session", more) + "{\"kind\"";
    let crowd = server.crowd(80, &begun);
    for _ in 0..3 {
        let answer = server.who(&cookie);
        assert!(answer.starts_with(OK), "{answer}");
        let (_, answer) = server.sign_in();
        assert!(answer.starts_with(OK), "others can still sign in: {answer}");
    }
    drop(crowd);
}

#[test]
fn f65_silent_connections_of_strangers_do_not_keep_users_out() {
    let connections = Shares { users: Places { all: 4, each: 4 }, strangers: 8 };
    let server = listening(ServeLimits { connections, ..ServeLimits::default() });
    let (cookie, _) = server.sign_in();
    // A signed-in connection, idle between two requests.
    let kept = server.connect();
    let mut asking = kept.try_clone().expect("a handle");
    let more = format!("Cookie: {cookie}\r\n");
    asking.write_all(server.head("GET /api/session", &more).as_bytes()).expect("sent");
    let mut first = [0; 15];
    asking.read_exact(&mut first).expect("an answer");
    assert_eq!(first, OK.as_bytes());

    let silent = server.crowd(20, "");
    let begun = server.crowd(20, "GET / HTTP/1.1\r\nHost: ");
    let answer = server.who(&cookie);
    assert!(answer.starts_with(OK), "{answer}");
    let more = format!("Cookie: {cookie}\r\nConnection: close\r\n");
    let answer = answer_to(kept, &server.head("GET /api/session", &more));
    assert!(answer.contains(OK), "the connection was not closed for a stranger: {answer}");
    drop((silent, begun));
}

#[test]
fn the_film_of_a_stranger_is_refused_before_it_arrives() {
    let server = listening(ServeLimits::default());
    for cookie in ["", "Cookie: spineline_session_1=guessed\r\n"] {
        let more = format!("{cookie}Content-Length: 100000000\r\n");
        let answer = answer_to(server.connect(), &server.head("POST /api/uploads", &more));
        assert!(answer.starts_with("HTTP/1.1 401"), "{answer}");
    }
}

#[test]
fn slow_bodies_of_somebody_who_is_signed_in_take_no_places() {
    let server = listening(ServeLimits::default());
    let writer = server.writer();
    let mut crowd = Vec::new();
    for path in ["/api/readings/1/events", "/api/readings/1/preview", "/api/studies", "/api/none"] {
        let more = format!("{writer}Content-Length: 1000\r\n");
        let begun = server.head(&format!("POST {path}"), &more) + "{\"events\":[";
        crowd.extend(server.crowd(12, &begun));
    }
    let more = format!("{writer}Content-Length: 2\r\nConnection: close\r\n");
    for path in ["/api/readings/1/events", "/api/studies"] {
        let whole = server.head(&format!("POST {path}"), &more) + "{}";
        let answer = answer_to(server.connect(), &whole);
        assert!(answer.starts_with("HTTP/1.1 422"), "{path}: {answer}");
    }
    let (cookie, answer) = server.sign_in();
    assert!(answer.starts_with(OK), "{answer}");
    assert!(server.who(&cookie).starts_with(OK));
    drop(crowd);
}

#[test]
fn reports_of_one_take_no_places_of_anothers_clicks() {
    let one = Places { all: 1, each: 1 };
    let requests = RequestPlaces { clicks: one, users: one, known: one, strangers: one };
    let limits = ServeLimits { requests, ..ServeLimits::default() };
    let app = app_with_demo().restarted(ServeOptions { limits, ..decoding() });
    let (ann, other) = (app.observer("Ann"), app.observer("Bob"));
    let study = ann.get(&format!("/api/studies/{STUDY}")).json();
    let film = study["summary"]["films"][0]["film"].as_i64().expect("a number");
    let reading = begin(&ann, film);
    let report = format!("/api/studies/{STUDY}/exports/report");
    std::thread::scope(|scope| {
        for _ in 0..6 {
            scope.spawn(|| other.get(&report));
        }
        for click in 0..12_u32 {
            let level = ["L4", "L3", "L2", "L1"][click as usize / 4 % 4];
            let corner = ["superior_left", "superior_right", "inferior_right", "inferior_left"];
            let event = json!([{ "kind": "place_corner", "level": level, "corner": corner[click as usize % 4],
                "column_px": 900.0 + f64::from(click), "row_px": 1800.0 }]);
            let answer = record(&ann, reading, click.into(), event);
            assert_eq!(answer.status, 200, "click {click}: {}", answer.text());
        }
    });
}
