//! Rules for every route, driven by the description of the interface, so that no route is missed.

use axum::body::Body;
use axum::http::{Method, StatusCode, header};
use serde_json::Value;
use spineline_server::openapi;

use crate::browser::{Answer, App, Browser};
use crate::example;

struct Route {
    method: Method,
    path: String,
    body: Option<(String, Vec<u8>)>,
}

/// Every operation, with the identifiers of study `S-2`, its film, its reading, and a body that is allowed.
fn routes() -> Vec<Route> {
    let description = serde_json::to_value(openapi()).expect("JSON");
    let mut routes = Vec::new();
    for (path, operations) in description["paths"].as_object().expect("paths") {
        for (method, operation) in operations.as_object().expect("operations") {
            let Ok(method) = method.to_ascii_uppercase().parse::<Method>() else { continue };
            let body = operation["requestBody"]["content"].as_object().map(|content| {
                let (kind, media) = content.iter().next().expect("a kind of body");
                let made = example::of(&description, &media["schema"]);
                let bytes =
                    if kind == "application/json" { made.to_string() } else { String::new() };
                (kind.clone(), bytes.into_bytes())
            });
            routes.push(Route { method, path: path.clone(), body });
        }
    }
    assert!(routes.len() > 5);
    routes
}

/// Fills the parameter of a study with this one, and numbers from `S-2`.
fn filled(path: &str, study: &str) -> String {
    let mut parts = path.split('/').map(|part| match part {
        "{id}" if path.starts_with("/api/studies/") => study.to_owned(),
        "{study}" => study.to_owned(),
        "{name}" => "lead".to_owned(),
        "{film}" => "2".to_owned(),
        "{computation}" => "identifiability".to_owned(),
        "{export}" => "analysis".to_owned(),
        "{line}" => "inflection_line".to_owned(),
        "{format}" => "osim".to_owned(),
        part if part.starts_with('{') => "1".to_owned(),
        part => part.to_owned(),
    });
    let first = parts.next().unwrap_or_default();
    parts.fold(first, |path, part| path + "/" + &part)
}

fn ask(browser: &Browser<'_>, route: &Route, study: &str) -> Answer {
    let (kind, body) = route.body.clone().unwrap_or_default();
    browser.send(route.method.clone(), &filled(&route.path, study), &kind, body)
}

fn is_sign_in(route: &Route) -> bool {
    route.path == "/api/sign-in" || (route.path == "/api/session" && route.method == Method::POST)
}

#[test]
fn only_the_sign_in_is_answered_without_a_session() {
    let app = App::with_accounts();
    for route in routes().iter().filter(|route| !is_sign_in(route)) {
        let answer = ask(&app.browser(), route, "S-1");
        let what = format!("{} {}: {}", route.method, route.path, answer.text());
        assert_eq!(answer.status, StatusCode::UNAUTHORIZED, "{what}");
        assert_eq!(answer.code(), "not_signed_in", "{what}");
    }
}

#[test]
fn f68_a_study_without_a_grant_is_answered_as_not_found() {
    let app = App::with_accounts();
    for who in ["ungranted", "editor", "reader"] {
        let browser = app.account(who);
        for route in routes().iter().filter(|route| route.path.contains('{')) {
            let answer = ask(&browser, route, "S-2");
            let what = format!("{who}: {} {}: {}", route.method, route.path, answer.text());
            if route.path.starts_with("/api/accounts/") {
                assert_eq!(answer.status, StatusCode::FORBIDDEN, "{what}");
                continue;
            }
            assert_eq!(answer.status, StatusCode::NOT_FOUND, "{what}");
            let absent = ask(&browser, route, "S-99");
            assert_eq!(absent.status, answer.status, "{what}");
            assert_eq!(absent.body, answer.body, "one can tell: {what}");
        }
    }
}

#[test]
fn f67_every_write_requires_the_session_token() {
    let app = App::with_accounts();
    let mut browser = app.account("lead");
    browser.csrf = app.account("lead").csrf;
    let writes = |route: &&Route| route.method != Method::GET && !is_sign_in(route);
    for route in routes().iter().filter(writes) {
        let answer = ask(&browser, route, "S-1");
        assert_eq!(answer.status, StatusCode::FORBIDDEN, "{} {}", route.method, route.path);
        assert_eq!(answer.code(), "csrf");
    }
    assert_eq!(browser.get("/api/session").status, StatusCode::OK, "still signed in");
}

#[test]
fn f65_every_route_refuses_compressed_and_endless_bodies() {
    let app = App::with_accounts();
    let browser = app.account("lead");
    for route in routes().iter().filter(|route| route.body.is_some()) {
        let head = || browser.request(route.method.clone(), &filled(&route.path, "S-1"));
        for coding in ["gzip", "deflate", "br", "zstd", "identity, gzip"] {
            let request = head().header(header::CONTENT_ENCODING, coding);
            let answer = app.ask(request.body(Body::from("x")).expect("a request"));
            assert_eq!(answer.status, StatusCode::UNSUPPORTED_MEDIA_TYPE, "{}", route.path);
            assert_eq!(answer.code(), "encoded");
        }
        let request = head().header(header::CONTENT_LENGTH, 1_u64 << 32);
        let answer = app.ask(request.body(Body::from("x")).expect("a request"));
        assert_eq!(answer.status, StatusCode::PAYLOAD_TOO_LARGE, "{}", route.path);
        assert_eq!(answer.code(), "too_large");
    }
}

#[test]
fn f69_no_route_accepts_a_token_in_its_query_or_redirects() {
    let app = App::with_token();
    let token = app.token();
    for route in routes() {
        let path = format!(
            "{}?token={token}&url=http://evil.example&next=//evil.example",
            filled(&route.path, "S-1")
        );
        let answer = app.browser().send(route.method.clone(), &path, "", Vec::new());
        assert!(!answer.status.is_redirection() && !answer.status.is_informational());
        assert_eq!(answer.header("location") + &answer.header("set-cookie"), "", "{path}");
    }
    for path in ["/", "/index.html", "//evil.example", "/api", "/api/none", "/none/"] {
        let answer = app.browser().get(&format!("{path}?token={token}"));
        assert!(!answer.status.is_redirection(), "{path}");
        assert_eq!(answer.header("location") + &answer.header("set-cookie"), "", "{path}");
    }
    assert_eq!(app.token(), token, "and the token was not used up");
}

#[test]
fn every_refusal_is_described_as_a_problem() {
    let description = serde_json::to_value(openapi()).expect("JSON");
    for (path, operations) in description["paths"].as_object().expect("paths") {
        for (method, operation) in operations.as_object().expect("operations") {
            let Some(responses) = operation["responses"].as_object() else { continue };
            let refusals = responses.iter().filter(|(status, _)| status.starts_with(['4', '5']));
            for (status, response) in refusals {
                let schema = &response["content"]["application/json"]["schema"];
                assert!(schema != &Value::Null, "{method} {path} {status} has a body");
            }
        }
    }
}
