//! Passwords: changes, wrong ones, and their entries in the log.

use axum::http::StatusCode;
use serde_json::{Value, json};
use spineline_server::ServeOptions;
use spineline_store::{Access, AuditEntry, Store};

use crate::browser::{App, Browser, PASSWORD, account, options};

const OTHER: &str = "quite another sentence";
const WRONG: &str = "not this sentence";

fn change(browser: &mut Browser<'_>, current: &str, password: &str) -> (StatusCode, Value) {
    let body = json!({ "current": current, "password": password });
    let answer = browser.put("/api/session/password", &body);
    if answer.status == StatusCode::OK {
        browser.keep_session(&answer);
    }
    (answer.status, answer.json())
}

fn is_signed_in(browser: &Browser<'_>) -> bool {
    browser.get("/api/session").status == StatusCode::OK
}

fn log(app: &App) -> Vec<AuditEntry> {
    let store = Store::view(&app.store_path()).expect("a store");
    assert!(store.verify(None).expect("verifiable").is_clean());
    store.audit_log().expect("a log")
}

#[test]
fn weak_passwords_are_refused_with_a_reason() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    for (password, reason) in [
        ("aaaaaaaaaaaa", "1 different character,"),
        ("            ", "0 different characters,"),
        ("abcdefghijkl", "outside of runs"),
        ("password1234", "outside of runs"),
        ("meier-2-meier-2", "outside of runs"),
        ("elevenchars", "at least 12 characters"),
    ] {
        let edit = json!({ "role": "reader", "password": password });
        let answer = lead.put("/api/accounts/meier-2", &edit);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{password}");
        assert_eq!(answer.code(), "bad_password");
        assert!(answer.text().contains(reason), "{password}: {}", answer.text());
        assert!(!answer.text().contains(password));
    }
}

#[test]
fn people_change_their_own_password() {
    let app = App::with_accounts();
    let (mut own, other) = (app.account("reader"), app.account("reader"));
    let (status, view) = change(&mut own, PASSWORD, OTHER);
    assert_eq!(status, StatusCode::OK, "{view}");
    assert_eq!(view["name"], "reader");
    assert!(is_signed_in(&own), "this browser stays signed in");
    assert!(!is_signed_in(&other), "all others are out");
    assert_eq!(
        app.browser().sign_in(&account("reader", PASSWORD)).status,
        StatusCode::UNAUTHORIZED
    );
    assert_eq!(app.browser().sign_in(&account("reader", OTHER)).status, StatusCode::OK);
    let last = log(&app).into_iter().rfind(|one| one.object == "account/reader");
    let last = last.expect("an entry");
    assert_eq!((last.actor.as_str(), last.action.as_str()), ("reader", "edit"));
}

#[test]
fn a_password_is_changed_by_who_knows_it_only() {
    let app = App::with_accounts();
    let mut thief = app.account("editor");
    let (status, _) = change(&mut app.browser(), PASSWORD, OTHER);
    assert_eq!(status, StatusCode::UNAUTHORIZED);
    let (status, problem) = change(&mut thief, PASSWORD, "editoreditor1");
    assert_eq!(status, StatusCode::UNPROCESSABLE_ENTITY, "{problem}");
    for _ in 0..5 {
        let (status, problem) = change(&mut thief, WRONG, OTHER);
        assert_eq!(status, StatusCode::FORBIDDEN, "{problem}");
    }
    let (status, problem) = change(&mut thief, PASSWORD, OTHER);
    assert_eq!(status, StatusCode::TOO_MANY_REQUESTS, "guessing ends: {problem}");
    assert!(is_signed_in(&app.account("editor")), "the owner still signs in");
    let app = App::with_token();
    let (status, problem) = change(&mut app.observer("A"), PASSWORD, OTHER);
    assert_eq!((status, &problem["code"]), (StatusCode::CONFLICT, &json!("no_accounts")));
}

#[test]
fn sign_ins_and_refused_sign_ins_are_in_the_log() {
    let app = App::with_accounts();
    app.account("reader");
    app.browser().sign_in(&account("reader", WRONG));
    app.browser().sign_in(&account("a-password-in-the-wrong-field", WRONG));
    app.browser().sign_in(&account("two words", WRONG));
    let entries = log(&app);
    let last: Vec<[&str; 3]> = entries[entries.len() - 4..]
        .iter()
        .map(|one| [one.actor.as_str(), one.action.as_str(), one.object.as_str()])
        .collect();
    let refused = ["serve", "sign_in_refused", "store"];
    assert_eq!(
        last,
        [
            ["reader", "sign_in", "session/reader"],
            ["serve", "sign_in_refused", "session/reader"],
            refused,
            refused
        ]
    );

    let app = App::with_token();
    app.observer("A");
    let how = json!({ "kind": "token", "token": "guessed", "observer": "A" });
    app.browser().sign_in(&how);
    let entries = log(&app);
    let last: Vec<&str> =
        entries[entries.len() - 2..].iter().map(|one| one.action.as_str()).collect();
    assert_eq!(last, ["sign_in", "sign_in_refused"]);
}

#[test]
fn wrong_passwords_of_strangers_lock_no_other_account() {
    let app = App::with_accounts();
    let mut known = app.account("lead");
    for guess in 0..50 {
        let who = ["lead", "editor", "ungranted", "root", "admin"][guess % 5];
        app.browser().sign_in(&account(who, WRONG));
        app.browser().sign_in(&account(&format!("guess-{guess}"), WRONG));
    }
    let refused = app.browser().sign_in(&account("lead", PASSWORD));
    assert_eq!(refused.status, StatusCode::TOO_MANY_REQUESTS);
    assert!(is_signed_in(&app.account("reader")), "an account without wrong guesses");
    // A browser that signed in lately can sign in, with or without its session.
    known.cookie = known.device.clone();
    assert_eq!(known.sign_in(&account("lead", PASSWORD)).status, StatusCode::OK);
    known.delete("/api/session");
    known.cookie = known.device.clone();
    assert_eq!(known.sign_in(&account("lead", PASSWORD)).status, StatusCode::OK);
    // This holds for that account only, and has a limit of guesses.
    known.cookie = known.device.clone();
    assert_eq!(known.sign_in(&account("editor", PASSWORD)).status, StatusCode::TOO_MANY_REQUESTS);
    for _ in 0..5 {
        assert_eq!(known.sign_in(&account("lead", WRONG)).status, StatusCode::UNAUTHORIZED);
    }
    assert_eq!(known.sign_in(&account("lead", PASSWORD)).status, StatusCode::TOO_MANY_REQUESTS);
}

#[test]
fn a_forged_or_old_proof_of_a_browser_gives_no_way_in() {
    let app = App::with_accounts();
    let (mut own, mut reader) = (app.account("lead"), app.account("reader"));
    for _ in 0..5 {
        app.browser().sign_in(&account("lead", WRONG));
    }
    let of_lead = own.device.clone();
    for forged in [
        reader.device.replace("reader", "lead"),
        format!("{}0", of_lead),
        of_lead.replace("lead", "Lead"),
        "spineline_device_8765_lead=lead/0/0".to_owned(),
        "spineline_device_8765_lead=".to_owned(),
    ] {
        reader.cookie = forged.clone();
        let answer = reader.sign_in(&account("lead", PASSWORD));
        assert_eq!(answer.status, StatusCode::TOO_MANY_REQUESTS, "{forged}");
    }
    change(&mut own, PASSWORD, OTHER);
    reader.cookie = of_lead;
    let answer = reader.sign_in(&account("lead", OTHER));
    assert_eq!(answer.status, StatusCode::TOO_MANY_REQUESTS, "a new password ends old proofs");
    own.cookie = own.device.clone();
    assert_eq!(own.sign_in(&account("lead", OTHER)).status, StatusCode::OK);
}

#[test]
fn browsers_use_https_alone_behind_a_proxy_with_tls() {
    let header =
        |app: &App, path: &str| app.browser().get(path).header("strict-transport-security");
    let app = App::with_accounts();
    assert_eq!(header(&app, "/"), "");
    let app = app.restarted(ServeOptions { https: true, ..options(Access::Accounts) });
    for path in ["/", "/api/sign-in", "/api/session", "/api/none"] {
        assert_eq!(header(&app, path), "max-age=31536000", "{path}");
    }
}
