//! Accounts: creation, roles and sign-in.

use axum::http::StatusCode;
use rusqlite::Connection;
use serde_json::{Value, json};
use spineline_store::Store;

use crate::browser::{App, Browser, PASSWORD, account};

#[test]
fn only_admins_list_and_create_accounts() {
    let app = App::with_accounts();
    for who in ["reader", "editor"] {
        let browser = app.account(who);
        for answer in [
            browser.get("/api/accounts"),
            browser.put("/api/accounts/reader", &json!({ "role": "admin" })),
        ] {
            assert_eq!(
                (answer.status, answer.code().as_str()),
                (StatusCode::FORBIDDEN, "not_allowed")
            );
        }
    }
    let lead = app.account("lead");
    let made = lead.put("/api/accounts/new", &json!({ "role": "reader", "password": PASSWORD }));
    assert_eq!(made.json(), json!({ "name": "new", "role": "reader", "enabled": true }));
    let all = lead.get("/api/accounts");
    assert!(!all.text().contains("argon2"));
    let names: Vec<Value> = all
        .json()
        .as_array()
        .expect("a list")
        .iter()
        .map(|account| account["name"].clone())
        .collect();
    assert_eq!(names, ["editor", "lead", "new", "reader", "ungranted"]);
    assert_eq!(app.account("new").get("/api/session").json()["role"], "reader");
    let incomplete = lead.put("/api/accounts/newer", &json!({ "role": "reader" }));
    assert_eq!(incomplete.status, StatusCode::UNPROCESSABLE_ENTITY);
    let store = Store::view(&app.store_path()).expect("a store");
    assert!(store.verify(None).expect("verifiable").is_clean());
    let log = store.audit_log().expect("a log");
    assert!(log.iter().any(|entry| entry.object == "account/new" && entry.actor == "lead"));
}

#[test]
fn a_removed_role_takes_effect_at_once() {
    let app = App::with_accounts();
    let (lead, other) = (app.account("lead"), app.account("editor"));
    assert_eq!(
        lead.put("/api/accounts/editor", &json!({ "role": "admin" })).status,
        StatusCode::OK
    );
    assert_eq!(other.get("/api/accounts").status, StatusCode::OK);
    assert_eq!(
        other.put("/api/accounts/lead", &json!({ "role": "reader" })).status,
        StatusCode::OK
    );
    assert_eq!(lead.get("/api/accounts").status, StatusCode::FORBIDDEN);
}

#[test]
fn the_last_enabled_admin_cannot_be_removed() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    for edit in [json!({ "role": "editor" }), json!({ "enabled": false })] {
        let answer = lead.put("/api/accounts/lead", &edit);
        assert_eq!((answer.status, answer.code().as_str()), (StatusCode::CONFLICT, "last_admin"));
    }
    assert_eq!(lead.get("/api/session").json()["role"], "admin");
    assert_eq!(
        lead.put("/api/accounts/editor", &json!({ "role": "admin" })).status,
        StatusCode::OK
    );
    assert_eq!(lead.put("/api/accounts/lead", &json!({ "role": "editor" })).status, StatusCode::OK);
}

#[test]
fn a_new_password_and_being_disabled_end_all_sessions() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    let signed_in = |browser: &Browser<'_>| browser.get("/api/session").status == StatusCode::OK;
    let (first, second) = (app.account("editor"), app.account("editor"));
    let other = "quite another sentence";
    lead.put("/api/accounts/editor", &json!({ "password": other }));
    assert!(!signed_in(&first) && !signed_in(&second) && signed_in(&lead));
    let old = app.browser().sign_in(&account("editor", PASSWORD));
    assert_eq!(old.status, StatusCode::UNAUTHORIZED);
    let mut browser = app.browser();
    assert_eq!(browser.sign_in(&account("editor", other)).status, StatusCode::OK);
    lead.put("/api/accounts/editor", &json!({ "enabled": false }));
    assert!(!signed_in(&browser));
    let disabled = app.browser().sign_in(&account("editor", other));
    let unknown = app.browser().sign_in(&account("who", other));
    assert_eq!(disabled.status, StatusCode::UNAUTHORIZED);
    assert_eq!(disabled.body, unknown.body, "one cannot tell who has an account");
}

#[test]
fn f70_weak_passwords_are_refused() {
    let app = App::with_accounts();
    let lead = app.account("lead");
    for password in [String::new(), "elevenchars".to_owned(), "x".repeat(1025)] {
        let edit = json!({ "role": "reader", "password": password });
        let answer = lead.put("/api/accounts/new", &edit);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY);
        assert_eq!(answer.code(), "bad_password");
        assert!(password.is_empty() || !answer.text().contains(&password));
    }
}

#[test]
fn f70_guessing_passwords_locks_one_name_only() {
    let app = App::with_accounts();
    for _ in 0..5 {
        let answer = app.browser().sign_in(&account("editor", "a wrong password"));
        assert_eq!((answer.status, answer.code().as_str()), (StatusCode::UNAUTHORIZED, "wrong"));
    }
    let right = app.browser().sign_in(&account("editor", PASSWORD));
    assert_eq!(right.status, StatusCode::TOO_MANY_REQUESTS, "not even with the right one");
    assert_eq!(right.code(), "too_many_attempts");
    let wait_s: u32 = right.header("retry-after").parse().expect("seconds");
    assert!((30..=60).contains(&wait_s), "{wait_s}");
    app.account("reader");
}

#[test]
fn f72_a_role_edited_in_the_store_file_is_refused() {
    for (sql, object) in [
        ("UPDATE accounts SET role = 'admin' WHERE name = 'reader'", "account/reader"),
        ("UPDATE grants SET study = 'S-2' WHERE name = 'reader'", "grant/2"),
        ("INSERT INTO grants VALUES (9, 'S-2', 'reader', 'editor')", "grant/9"),
    ] {
        let app = App::with_accounts();
        let reader = app.account("reader");
        Connection::open(app.store_path()).expect("the store").execute(sql, []).expect("an edit");
        let answer = reader.get("/api/studies/S-2/grants");
        assert_eq!(answer.status, StatusCode::INTERNAL_SERVER_ERROR, "{sql}: {}", answer.text());
        let store = Store::view(&app.store_path()).expect("a store");
        let findings = store.verify(None).expect("verifiable").findings;
        assert!(findings.iter().any(|f| f.to_string().contains(object)), "{sql}: {findings:?}");
    }
}
