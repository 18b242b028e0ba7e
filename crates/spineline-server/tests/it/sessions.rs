//! Sessions: begin, end, and restart of the program.

use axum::http::StatusCode;
use rusqlite::Connection;
use serde_json::json;

use crate::browser::{App, PASSWORD, account, options};
use spineline_store::Access;

/// Moves the beginning and the last use of all sessions into the past.
fn age(app: &App, begun_hours: i64, used_hours: i64) {
    let raw = Connection::open(app.store_path()).expect("the store");
    raw.execute(
        "UPDATE sessions SET begun_ms = begun_ms - ?1, used_ms = used_ms - ?2",
        [begun_hours * 3_600_000, used_hours * 3_600_000],
    )
    .expect("older sessions");
}

fn sessions(app: &App) -> Vec<(String, String)> {
    let raw = Connection::open(app.store_path()).expect("the store");
    let mut query = raw.prepare("SELECT secret_hash, name FROM sessions").expect("a query");
    let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).expect("rows");
    rows.collect::<Result<_, _>>().expect("sessions")
}

#[test]
fn f70_a_session_ends_after_idle_time_and_after_a_week() {
    for (begun_hours, used_hours, expected) in [
        (11, 11, StatusCode::OK),
        (13, 13, StatusCode::UNAUTHORIZED),
        (24 * 6, 1, StatusCode::OK),
        (24 * 7, 1, StatusCode::UNAUTHORIZED),
    ] {
        let app = App::with_token();
        let browser = app.observer("A");
        age(&app, begun_hours, used_hours);
        let status = browser.get("/api/session").status;
        assert_eq!(status, expected, "begun {begun_hours} h, used {used_hours} h ago");
    }
}

#[test]
fn a_session_of_a_clock_that_was_years_ahead_is_over() {
    for (begun_hours, used_hours) in
        [(-1, -1), (-24 * 365 * 20, -24 * 365 * 20), (1, -20), (-20, 1)]
    {
        let app = App::with_token();
        let browser = app.observer("A");
        age(&app, begun_hours, used_hours);
        let status = browser.get("/api/session").status;
        assert_eq!(
            status,
            StatusCode::UNAUTHORIZED,
            "begun {begun_hours} h, used {used_hours} h ago"
        );
        app.observer("B");
        assert_eq!(sessions(&app).len(), 1, "and it is deleted");
    }
}

#[test]
fn f70_use_prolongs_a_session_and_ended_ones_are_deleted() {
    let app = App::with_token();
    let used = app.observer("A");
    age(&app, 11, 11);
    assert_eq!(used.get("/api/session").status, StatusCode::OK);
    age(&app, 11, 11);
    assert_eq!(used.get("/api/session").status, StatusCode::OK);
    age(&app, 13, 13);
    app.observer("B");
    assert_eq!(sessions(&app).len(), 1);
}

#[test]
fn f70_a_session_fixed_by_an_attacker_is_not_used() {
    let app = App::with_token();
    let mut browser = app.browser();
    browser.cookie = "spineline_session_8765=fixed".to_owned();
    assert_eq!(browser.get("/api/session").status, StatusCode::UNAUTHORIZED);
    let how = json!({ "kind": "token", "token": app.token(), "observer": "A" });
    assert_eq!(browser.sign_in(&how).status, StatusCode::OK);
    assert!(!browser.cookie.contains("fixed"));
    let (first, csrf) = (browser.cookie.clone(), browser.csrf.clone());
    let how = json!({ "kind": "token", "token": app.token(), "observer": "A" });
    assert_eq!(browser.sign_in(&how).status, StatusCode::OK);
    assert!(browser.cookie != first && browser.csrf != csrf);
    browser.cookie = first;
    assert_eq!(browser.get("/api/session").status, StatusCode::UNAUTHORIZED, "the old one ended");
}

#[test]
fn the_cookie_is_http_only_and_same_site() {
    let app = App::with_token();
    let sign_in = |app: &App| {
        let how = json!({ "kind": "token", "token": app.token(), "observer": "A" });
        app.browser().sign_in(&how).header("set-cookie")
    };
    let cookie = sign_in(&app);
    for part in ["HttpOnly", "SameSite=Strict", "Path=/"] {
        assert!(cookie.contains(part), "{cookie}");
    }
    assert!(!cookie.contains("Secure") && !cookie.contains("Domain"), "{cookie}");
    let mut https = options(Access::Token);
    https.https = true;
    let app = app.restarted(https);
    let how = json!({ "kind": "token", "token": app.token(), "observer": "A" });
    let request = app
        .browser()
        .request(axum::http::Method::POST, "/api/session")
        .header("content-type", "application/json");
    let mut request = request.body(axum::body::Body::from(how.to_string())).expect("a request");
    let origin = "https://127.0.0.1:8765".parse().expect("a value");
    request.headers_mut().insert("origin", origin);
    assert!(app.ask(request).header("set-cookie").contains("Secure"));
}

#[test]
fn the_store_contains_no_secret_of_a_session() {
    let app = App::with_token();
    let browser = app.observer("A");
    let secret = browser.cookie.split('=').nth(1).expect("a value");
    let kept = sessions(&app);
    assert_eq!(kept.len(), 1);
    assert!(kept[0].0 != secret && kept[0].0 != browser.csrf && kept[0].1 == "A");
}

#[test]
fn sessions_survive_a_restart() {
    let app = App::with_token();
    let browser = app.observer("A");
    let (cookie, csrf) = (browser.cookie.clone(), browser.csrf.clone());
    let app = app.restarted(options(Access::Token));
    let mut browser = app.browser();
    (browser.cookie, browser.csrf) = (cookie.clone(), csrf);
    let session = browser.get("/api/session").succeeded();
    assert_eq!(session.json()["name"], "A");
    assert_eq!(session.json()["csrf"], browser.csrf.as_str());
    // When a store is later served with accounts, sessions of the token are not valid.
    let app = app.restarted(options(Access::Accounts));
    let mut browser = app.browser();
    browser.cookie = cookie;
    assert_eq!(browser.get("/api/session").status, StatusCode::UNAUTHORIZED);
}

#[test]
fn a_token_signs_in_one_browser() {
    let app = App::with_token();
    let first = app.token();
    let mut browser = app.browser();
    let how = json!({ "kind": "token", "token": first, "observer": "not a name" });
    assert_eq!(browser.sign_in(&how).status, StatusCode::UNPROCESSABLE_ENTITY);
    assert_eq!(app.token(), first, "a mistake costs nothing");
    let how = json!({ "kind": "token", "token": first, "observer": "A" });
    let answer = browser.sign_in(&how).succeeded();
    assert_eq!(answer.json()["role"], "admin");
    let again = app.browser().sign_in(&how);
    assert_eq!((again.status, again.code().as_str()), (StatusCode::UNAUTHORIZED, "wrong"));
    assert_eq!(app.observer("B").get("/api/session").json()["name"], "B");
    assert_eq!(browser.get("/api/session").json()["name"], "A");
    let by_account = app.browser().sign_in(&account("A", PASSWORD));
    assert_eq!(by_account.status, StatusCode::UNAUTHORIZED);
}

#[test]
fn signing_out_ends_the_session_in_the_store() {
    let app = App::with_token();
    let browser = app.observer("A");
    let answer = browser.delete("/api/session");
    assert_eq!(answer.status, StatusCode::NO_CONTENT);
    assert!(answer.header("set-cookie").contains("Max-Age=0"));
    assert_eq!(browser.get("/api/session").status, StatusCode::UNAUTHORIZED);
    assert_eq!(sessions(&app), []);
}
