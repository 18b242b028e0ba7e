//! Checks of every request before its handler, and headers of every answer.

use axum::body::{Body, Bytes};
use axum::extract::{DefaultBodyLimit, FromRequest, Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, StatusCode, Uri, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use subtle::ConstantTimeEq;

use crate::body_rate::TimedBody;
use crate::connection_slots::RequestSlot;
use crate::extract::unread;
use crate::places::{Place, Whose, Work};
use crate::problem::{Answer, Failure};
use crate::request_source::{self, RequestSource};
use crate::state::AppState;
use crate::user;

/// Largest body that any route may take, in bytes: a study's films in one archive.
pub const MAX_UPLOAD_BYTES: usize = 600 << 20;
/// Largest body of a request, in bytes. Routes that take films set their own limit.
pub const MAX_BODY_BYTES: usize = 1 << 20;
/// Largest body of a sign-in, in bytes: a name and a password.
const MAX_SIGN_IN_BYTES: usize = 16 << 10;
/// Header with the session's token, required by every request that changes something.
const CSRF: &str = "x-spineline-csrf";

const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; font-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'";

/// Header of every answer.
const HEADERS: [(&str, &str); 6] = [
    ("content-security-policy", POLICY),
    ("x-content-type-options", "nosniff"),
    ("referrer-policy", "no-referrer"),
    ("cross-origin-opener-policy", "same-origin"),
    ("cross-origin-resource-policy", "same-origin"),
    ("x-frame-options", "DENY"),
];

/// With `--https`: for a year, browsers use https only for this host.
const HTTPS_ONLY: (&str, &str) = ("strict-transport-security", "max-age=31536000");

/// Adds the headers of every answer. Browsers must not cache answers of the interface.
pub async fn headers(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let is_api = is_api(request.uri());
    let mut answer = next.run(request).await;
    let headers = answer.headers_mut();
    let https_only = state.options.https.then_some(HTTPS_ONLY);
    for (name, value) in HEADERS.into_iter().chain(https_only) {
        headers.insert(name, HeaderValue::from_static(value));
    }
    if is_api {
        headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    }
    answer
}

/// Refuses requests from outside of the app, and limits concurrent ones. The user is identified before the body is
/// read, and the body is read before its request takes a place, so that slow bodies hold no places.
pub async fn guard(State(state): State<AppState>, request: Request, next: Next) -> Response {
    match admitted(&state, request).await {
        Ok((request, _place)) => next.run(request).await,
        Err(refusal) => refusal.into_response(),
    }
}

async fn admitted(state: &AppState, mut request: Request) -> Answer<(Request, Option<Place>)> {
    check(state, &request)?;
    let rate = state.options.limits.body;
    request = request.map(|body| Body::new(TimedBody::new(body, rate)));
    // The handler reports errors of reading the session.
    let user = user::user_of(state, request.headers()).await.ok();
    if let (Some(user), Some(slot)) = (&user, request.extensions().get::<RequestSlot>()) {
        slot.keep(&user.name);
    }
    let (work, whose) = if signs_in(&request) {
        let address = request_source::address(state, &request);
        let from = RequestSource::of(state, address, request.headers()).await?;
        let (whose, is_known) = from.whose();
        request.extensions_mut().insert(from);
        request = whole(state, request, MAX_SIGN_IN_BYTES).await?;
        (if is_known { Work::KnownSignIn } else { Work::Stranger }, whose)
    } else if let Some(user) = user {
        let whose = Whose::Account(user.name.clone());
        request.extensions_mut().insert(user);
        if uploads(&request) {
            return Ok((request, None));
        }
        request = whole(state, request, MAX_BODY_BYTES).await?;
        (if marks(&request) { Work::Click } else { Work::Other }, whose)
    } else {
        (Work::Stranger, Whose::Address(request_source::address(state, &request)))
    };
    let place = state.rooms.take(work, whose).await?;
    Ok((request, Some(place)))
}

/// The only request whose body is too large for memory before room is reserved: it takes its place itself.
fn uploads(request: &Request) -> bool {
    request.method() == Method::POST && request.uri().path() == "/api/uploads"
}

/// Whether a request records or finishes a reading.
fn marks(request: &Request) -> bool {
    let path = request.uri().path().strip_prefix("/api/readings/");
    let what = path.and_then(|path| path.split_once('/')).map(|(_, what)| what);
    request.method() == Method::POST && matches!(what, Some("events" | "finish"))
}

/// The only request with a body that needs no session.
fn signs_in(request: &Request) -> bool {
    request.method() == Method::POST && request.uri().path() == "/api/session"
}

/// A request with its body in memory.
async fn whole(state: &AppState, request: Request, most_bytes: usize) -> Answer<Request> {
    let (parts, body) = request.into_parts();
    let mut body = Request::new(body);
    DefaultBodyLimit::max(most_bytes).apply(&mut body);
    let body = Bytes::from_request(body, state).await.map_err(|refused| unread(&refused))?;
    Ok(Request::from_parts(parts, Body::from(body)))
}

fn check(state: &AppState, request: &Request<Body>) -> Answer<()> {
    let headers = request.headers();
    let host = host(request.uri(), headers).filter(|host| state.hosts.allow(host));
    let host = host.ok_or_else(|| {
        let text = "the program does not answer under this name";
        Failure::new(StatusCode::MISDIRECTED_REQUEST, "wrong_host", text)
            .help("open the address that `spineline serve` printed, or start it with --host NAME")
    })?;
    if headers.get(header::CONTENT_ENCODING).is_some_and(|coding| coding != "identity") {
        return Err(Failure::new(
            StatusCode::UNSUPPORTED_MEDIA_TYPE,
            "encoded",
            "the body is compressed; only uncompressed bodies are accepted",
        ));
    }
    if declared_bytes(headers).is_some_and(|bytes| bytes > MAX_UPLOAD_BYTES as u64) {
        return Err(Failure::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            "too_large",
            format!("the body is larger than {} MB", MAX_UPLOAD_BYTES >> 20),
        ));
    }
    let reads = matches!(*request.method(), Method::GET | Method::HEAD);
    if !is_api(request.uri()) {
        return Ok(());
    }
    if !comes_from_here(headers, &host, state.options.https, reads) {
        return Err(Failure::new(
            StatusCode::FORBIDDEN,
            "wrong_origin",
            "the request comes from another site",
        )
        .help("use the app in the window that it was opened in"));
    }
    if reads || signs_in(request) { Ok(()) } else { csrf(state, headers) }
}

/// Size of the body by the headers.
pub fn declared_bytes(headers: &HeaderMap) -> Option<u64> {
    headers.get(header::CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

fn is_api(uri: &Uri) -> bool {
    uri.path() == "/api" || uri.path().starts_with("/api/")
}

/// The one host that a request names, in lower case.
fn host(uri: &Uri, headers: &HeaderMap) -> Option<String> {
    let mut named = headers.get_all(header::HOST).iter();
    let host = named.next()?.to_str().ok()?.to_ascii_lowercase();
    let agrees = uri.authority().is_none_or(|a| a.as_str().eq_ignore_ascii_case(&host));
    (named.next().is_none() && agrees).then_some(host)
}

/// Browsers state the origin of a request. A write must state this site; a read must not state another one.
fn comes_from_here(headers: &HeaderMap, host: &str, https: bool, reads: bool) -> bool {
    let scheme = if https { "https" } else { "http" };
    let site = headers.get("sec-fetch-site");
    let site_is_own = site.map(|site| site == "same-origin" || (reads && site == "none"));
    let own = format!("{scheme}://{host}");
    let origin_is_own = headers
        .get(header::ORIGIN)
        .map(|origin| origin.as_bytes().eq_ignore_ascii_case(own.as_bytes()));
    match (site_is_own, origin_is_own) {
        (None, None) => reads,
        (site, origin) => site != Some(false) && origin != Some(false),
    }
}

/// Without a cookie, the handler reports the missing session.
fn csrf(state: &AppState, headers: &HeaderMap) -> Answer<()> {
    let Some(secret) = user::secret_of(state, headers) else { return Ok(()) };
    let expected = user::csrf_of(&secret);
    let given = headers.get(CSRF).map(HeaderValue::as_bytes).unwrap_or_default();
    if bool::from(given.ct_eq(expected.as_bytes())) {
        return Ok(());
    }
    Err(Failure::new(
        StatusCode::FORBIDDEN,
        "csrf",
        "the request does not carry the token of its session",
    )
    .help("load the page again"))
}
