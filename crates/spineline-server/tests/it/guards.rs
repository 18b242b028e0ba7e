//! Requests from outside of the app, and headers of every answer.

use axum::body::Body;
use axum::http::{Method, Request, StatusCode, header};
use serde_json::json;

use crate::browser::{Answer, App, HOST, ORIGIN, options};
use spineline_store::Access;

const JANE: &str = "Doe^Jane";

#[test]
fn f64_only_files_of_the_app_are_served() {
    let app = App::with_token();
    assert_eq!(app.browser().get("/").status, StatusCode::OK);
    for path in [
        "/../Cargo.toml",
        "/../../Cargo.toml",
        "/assets/../../Cargo.toml",
        "/%2e%2e/Cargo.toml",
        "/%2e%2e%2fCargo.toml",
        "/..%5c..%5cCargo.toml",
        "/..%252f..%252fCargo.toml",
        "//etc/passwd",
        "/etc/passwd",
        "/C:/Windows/win.ini",
        "/index.html%00.js",
        "/./index.html/../Cargo.toml",
    ] {
        let answer = app.browser().get(path);
        assert_eq!(answer.status, StatusCode::NOT_FOUND, "{path}");
        assert!(!answer.text().contains("[package]") && !answer.text().contains("root:"));
    }
}

#[test]
fn f65_a_body_above_the_limit_is_refused() {
    let app = App::with_token();
    let long = json!({ "kind": "token", "token": "x".repeat(1 << 20), "observer": "A" });
    let answer = app.browser().post("/api/session", &long);
    assert_eq!(answer.status, StatusCode::PAYLOAD_TOO_LARGE);
    assert_eq!(answer.code(), "too_large");
}

#[test]
fn an_invalid_body_is_refused_with_a_message() {
    let app = App::with_token();
    let browser = app.browser();
    let post = |kind: &str, body: &str| {
        browser.send(Method::POST, "/api/session", kind, body.as_bytes().to_vec())
    };
    let token = r#"{"kind":"token","token":"t","observer":"A"}"#;
    for kind in ["", "text/plain", "application/x-www-form-urlencoded", "multipart/form-data"] {
        let answer = post(kind, token);
        assert_eq!(answer.status, StatusCode::UNSUPPORTED_MEDIA_TYPE, "{kind}");
        assert_eq!(answer.code(), "not_json");
    }
    assert_eq!(post("application/json", "{").code(), "bad_json");
    assert_eq!(post("application/json; charset=utf-8", token).code(), "wrong");
    for body in [token.replace("}", r#","more":1}"#).as_str(), "[]", r#"{"kind":"token"}"#] {
        let answer = post("application/json", body);
        assert_eq!(answer.status, StatusCode::UNPROCESSABLE_ENTITY, "{body}");
        assert_eq!(answer.code(), "bad_request");
    }
    assert_eq!(browser.json(Method::PATCH, "/api/session", &json!({})).code(), "wrong_method");
    assert_eq!(app.observer("A").get("/api/none").code(), "not_found");
}

/// `serde_json` takes too many values, too large a number, half a letter, and deep lists for errors of syntax.
#[test]
fn json_that_does_not_fit_is_not_called_broken() {
    let app = App::with_token();
    let observer = app.observer("A");
    let turn = |level: &str, place: &str| {
        format!(r#"{{"events":[],"turn_axis":{{"level":"{level}","towards_px":{place}}}}}"#)
    };
    let (deep, fits) = (["[".repeat(200), "]".repeat(200)].concat(), "[1,2]");
    for (body, code) in [
        (turn("T8", "[1,2,3]"), "bad_request"),
        (turn("T8", "[1]"), "bad_request"),
        (turn("T8", "[1e999,2]"), "bad_request"),
        (turn("\\ud800", fits), "bad_request"),
        (format!(r#"{{"events":{deep}}}"#), "bad_request"),
        (turn("T8", "[1,2,]"), "bad_json"),
        (turn("T8", fits) + "{}", "bad_json"),
        (turn("T8", fits), "not_found"),
    ] {
        let path = "/api/readings/1/preview";
        let answer = observer.send(Method::POST, path, "application/json", body.clone().into());
        assert_eq!(answer.code(), code, "{body}");
    }
}

fn assert_carries_headers(answer: &Answer, what: &str) {
    let policy = answer.header("content-security-policy");
    for part in ["default-src 'none'", "script-src 'self'", "frame-ancestors 'none'"] {
        assert!(policy.contains(part), "{what}: {policy}");
    }
    assert!(!policy.contains("unsafe"), "{policy}");
    assert_eq!(answer.header("x-content-type-options"), "nosniff", "{what}");
    assert_eq!(answer.header("referrer-policy"), "no-referrer", "{what}");
    assert_eq!(answer.header("cross-origin-opener-policy"), "same-origin", "{what}");
    assert_eq!(answer.header("cross-origin-resource-policy"), "same-origin", "{what}");
    for name in answer.headers.keys() {
        assert!(!name.as_str().starts_with("access-control"), "{what}: {name}");
    }
}

#[test]
fn f66_every_answer_has_its_type_and_a_content_policy() {
    let app = App::with_token();
    let browser = app.observer("A");
    let of_api = ["/api", "/api/", "/api/none", "/api/session", "/api/studies/<b>/grants"];
    for path in ["/", "/none"].into_iter().chain(of_api) {
        let path = path.replace('<', "%3C").replace('>', "%3E");
        let answer = browser.get(&path);
        assert_carries_headers(&answer, &path);
        if path.starts_with("/api") {
            assert_eq!(answer.header("content-type"), "application/json", "{path}");
            assert_eq!(answer.header("cache-control"), "no-store", "{path}");
        }
    }
    let wrong = Request::get("/").header(header::HOST, "evil.example").body(Body::empty());
    assert_carries_headers(&app.ask(wrong.expect("a request")), "a wrong host");
    assert_eq!(browser.get("/").header("content-type"), "text/html");
    let script = "<script>alert(1)</script>";
    let how = json!({ "kind": "token", "token": app.token(), "observer": script });
    let refused = app.browser().post("/api/session", &how);
    assert_eq!(refused.status, StatusCode::UNPROCESSABLE_ENTITY);
    assert!(!refused.text().contains("script"));
}

#[test]
fn f67_other_host_names_are_refused() {
    let app = App::with_token();
    let ask = |app: &App, hosts: &[&str]| {
        let mut request = Request::get("/api/sign-in");
        for host in hosts {
            request = request.header(header::HOST, *host);
        }
        app.ask(request.body(Body::empty()).expect("a request"))
    };
    for good in [HOST, "localhost:8765", "LOCALHOST:8765", "[::1]:8765"] {
        assert_eq!(ask(&app, &[good]).status, StatusCode::OK, "{good}");
    }
    for bad in [
        "evil.example:8765",
        "127.0.0.1.evil.example:8765",
        "127.0.0.1",
        "127.0.0.1:80",
        "localhost:87650",
        "localhost@evil.example:8765",
        "0.0.0.0:8765",
        "",
    ] {
        let answer = ask(&app, &[bad]);
        assert_eq!(answer.status, StatusCode::MISDIRECTED_REQUEST, "{bad}");
        assert_eq!(answer.code(), "wrong_host");
    }
    assert_eq!(ask(&app, &[]).status, StatusCode::MISDIRECTED_REQUEST);
    assert_eq!(ask(&app, &[HOST, HOST]).status, StatusCode::MISDIRECTED_REQUEST);
    let mut named = options(Access::Token);
    named.hosts.push("spine.clinic.example".to_owned());
    let app = app.restarted(named);
    for (host, expected) in [
        ("spine.clinic.example", StatusCode::OK),
        ("Spine.Clinic.Example:8765", StatusCode::OK),
        ("clinic.example", StatusCode::MISDIRECTED_REQUEST),
        ("spine.clinic.example:1", StatusCode::MISDIRECTED_REQUEST),
    ] {
        assert_eq!(ask(&app, &[host]).status, expected, "{host}");
    }
}

/// A sign-in with the right token and these headers of origin.
fn sign_in_from(app: &App, headers: &[(&str, &str)]) -> Answer {
    let mut request = Request::post("/api/session")
        .header(header::HOST, HOST)
        .header(header::CONTENT_TYPE, "application/json");
    for (name, value) in headers {
        request = request.header(*name, *value);
    }
    let how = json!({ "kind": "token", "token": app.token(), "observer": "A" });
    app.ask(request.body(Body::from(how.to_string())).expect("a request"))
}

#[test]
fn f67_writes_from_other_sites_are_refused() {
    let app = App::with_token();
    for bad in [
        &[][..],
        &[("origin", "http://evil.example")],
        &[("origin", "null")],
        &[("origin", "http://127.0.0.1:9999")],
        &[("origin", "http://localhost:8765")],
        &[("origin", "https://127.0.0.1:8765")],
        &[("origin", ORIGIN), ("sec-fetch-site", "cross-site")],
        &[("origin", "http://evil.example"), ("sec-fetch-site", "same-origin")],
        &[("sec-fetch-site", "same-site")],
        &[("sec-fetch-site", "none")],
    ] {
        let answer = sign_in_from(&app, bad);
        assert_eq!(answer.status, StatusCode::FORBIDDEN, "{bad:?}");
        assert_eq!(answer.code(), "wrong_origin");
    }
    assert_eq!(sign_in_from(&app, &[("origin", ORIGIN)]).status, StatusCode::OK);
    assert_eq!(sign_in_from(&app, &[("sec-fetch-site", "same-origin")]).status, StatusCode::OK);
}

#[test]
fn f67_reads_from_other_sites_are_refused() {
    let app = App::with_token();
    let browser = app.observer("A");
    for (name, value) in [
        ("sec-fetch-site", "cross-site"),
        ("sec-fetch-site", "same-site"),
        ("origin", "http://evil.example"),
    ] {
        let request = browser.request(Method::GET, "/api/session").header(name, value);
        let answer = app.ask(request.body(Body::empty()).expect("a request"));
        assert_eq!(answer.status, StatusCode::FORBIDDEN, "{name}: {value}");
    }
    let preflight = browser
        .request(Method::OPTIONS, "/api/session")
        .header(header::ACCESS_CONTROL_REQUEST_METHOD, "DELETE")
        .body(Body::empty());
    let answer = app.ask(preflight.expect("a request"));
    assert!(answer.status.is_client_error());
    assert_carries_headers(&answer, "a preflight");
}

#[test]
fn f71_refusals_do_not_quote_the_request() {
    let app = App::with_token();
    let browser = app.observer("A");
    let name = |value: &str| json!({ "kind": "token", "token": value, "observer": value });
    let mut key = name("t");
    key[JANE] = json!(1);
    let answers = [
        browser.post("/api/session", &name(JANE)),
        browser.post("/api/session", &key),
        browser.post("/api/session", &json!({ "kind": JANE })),
        browser.post("/api/session", &json!(JANE)),
        browser.put(&format!("/api/accounts/{}", JANE.replace('^', "%5E")), &json!({})),
        browser.put("/api/accounts/A", &json!({ "role": JANE })),
        browser.get(&format!("/api/studies/{}/grants", JANE.replace('^', "%5E"))),
        browser.get(&format!("/api/{}", JANE.replace('^', "%5E"))),
        browser.get(&format!("/{}", JANE.replace('^', "%5E"))),
    ];
    for answer in answers {
        assert!(answer.status.is_client_error(), "{}", answer.text());
        for part in ["Doe", "Jane"] {
            assert!(!answer.text().contains(part), "{}", answer.text());
            assert!(!format!("{:?}", answer.headers).contains(part));
        }
    }
}
