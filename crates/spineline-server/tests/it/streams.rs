//! Event streams end with the rights that they began with.

use std::time::Duration;

use axum::body::Body;
use axum::http::{Method, StatusCode};
use rusqlite::Connection;
use serde_json::{Value, json};
use spineline_server::{ServeLimits, ServeOptions};
use spineline_store::{Access, AccountChange, Role, Store};

use crate::browser::{App, Browser, PASSWORD, Stream, by, name, options};

/// Long enough for any machine.
const ENOUGH: Duration = Duration::from_secs(60);
/// Wait for events that must not happen.
const A_MOMENT: Duration = Duration::from_millis(200);

/// An app whose streams check their rights this often.
fn app(recheck: Duration) -> App {
    let limits = ServeLimits { recheck, ..ServeLimits::default() };
    App::with_accounts().restarted(ServeOptions { limits, ..options(Access::Accounts) })
}

fn listen<'a>(browser: &Browser<'a>) -> Stream<'a> {
    let request = browser.request(Method::GET, "/api/studies/S-1/changes");
    browser.app.begin(request.body(Body::empty()).expect("a request"))
}

#[test]
fn a_stream_ends_at_once_with_its_session() {
    let app = app(Duration::from_secs(3600));
    let (first, second) = (app.account("editor"), app.account("editor"));
    let (mut ended, mut other) = (listen(&first), listen(&second));
    assert!(!ended.ends_within(A_MOMENT));
    assert_eq!(first.delete("/api/session").status, StatusCode::NO_CONTENT);
    assert!(ended.ends_within(ENOUGH));
    assert!(!other.ends_within(A_MOMENT), "the other session goes on");
}

#[test]
fn a_stream_ends_at_once_with_the_rights_that_it_began_with() {
    let (account, grants) = ("/api/accounts/editor", "/api/studies/S-1/grants");
    let changes: [(&str, Value); 6] = [
        (account, json!({ "role": "reader" })),
        (account, json!({ "role": "admin" })),
        (account, json!({ "enabled": false })),
        (account, json!({ "password": "quite another sentence" })),
        (grants, json!([{ "name": "reader", "role": "reader" }])),
        (
            grants,
            json!([{ "name": "editor", "role": "reader" }, { "name": "reader", "role": "reader" }]),
        ),
    ];
    for (path, change) in changes {
        let app = app(Duration::from_secs(3600));
        let (lead, editor, reader) =
            (app.account("lead"), app.account("editor"), app.account("reader"));
        let (mut ended, mut other) = (listen(&editor), listen(&reader));
        assert_eq!(lead.put(path, &change).status, StatusCode::OK, "{path} {change}");
        assert!(ended.ends_within(ENOUGH), "{path} {change}");
        assert!(!other.ends_within(A_MOMENT), "{path} {change}: not this one's");
    }
}

#[test]
fn a_stream_ends_when_a_plan_hides_the_study() {
    let app = app(Duration::from_secs(3600));
    let (lead, editor, reader) =
        (app.account("lead"), app.account("editor"), app.account("reader"));
    let mut streams = [listen(&lead), listen(&editor), listen(&reader)];
    assert!(!streams[1].ends_within(A_MOMENT));
    let plan = json!({ "observers": ["editor"], "repeats": 1, "washout_days": 0 });
    assert_eq!(lead.post("/api/studies/S-1/plan", &plan).status, StatusCode::OK);
    for stream in &mut streams {
        assert!(stream.ends_within(ENOUGH), "the plan changes what each of them sees");
    }
    let detail = editor.get("/api/studies/S-1").json();
    assert_eq!(detail["plan"]["blinded"], true);
    assert_eq!(detail["summary"]["films"], json!([]));
}

#[test]
fn a_stream_ends_when_another_program_takes_the_account() {
    let app = app(Duration::from_millis(50));
    let mut stream = listen(&app.account("editor"));
    let mut store = Store::open(&app.store_path()).expect("the store");
    let change = AccountChange { enabled: Some(false), ..AccountChange::default() };
    store.edit_account(&name("editor"), &change, &by("lead")).expect("an edit");
    assert!(stream.ends_within(ENOUGH));
    let mut stream = listen(&app.account("reader"));
    let change = AccountChange { role: Some(Role::Admin), ..AccountChange::default() };
    store.edit_account(&name("reader"), &change, &by("lead")).expect("an edit");
    assert!(stream.ends_within(ENOUGH));
}

#[test]
fn a_stream_keeps_no_session_from_ending_by_rest() {
    let app = app(Duration::from_millis(50));
    let browser = app.account("editor");
    let mut stream = listen(&browser);
    let raw = Connection::open(app.store_path()).expect("the store");
    let rest = |hours: i64| {
        let set = "UPDATE sessions SET used_ms = used_ms - ?1";
        raw.execute(set, [hours * 3_600_000]).expect("an older session");
    };
    rest(11);
    assert!(!stream.ends_within(A_MOMENT));
    rest(2);
    assert!(stream.ends_within(ENOUGH), "the request of the stream did not count as use");
    let how = crate::browser::account("editor", PASSWORD);
    assert_eq!(app.browser().sign_in(&how).status, StatusCode::OK);
}
