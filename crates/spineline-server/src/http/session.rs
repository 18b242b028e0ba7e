//! Signing in, and who asks.

use axum::Json;
use axum::extract::{FromRequestParts, State};
use axum::http::StatusCode;
use axum::http::request::Parts;
use axum_extra::extract::CookieJar;
use axum_extra::extract::cookie::{Cookie, SameSite};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::api::{AccessName, Problem, RoleName, SessionView, SignIn, SignInPage};
use super::state::secret;
use super::{Answer, AppState, Failure};
use crate::store::{Name, Signature, Timestamp};

const COOKIE: &str = "spineline_session";

/// Who asks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// Observer or account.
    pub name: Name,
    /// What they may do at most.
    pub role: RoleName,
}

impl User {
    /// Their signature under a change.
    #[must_use]
    pub fn sign(&self, at: Timestamp) -> Signature {
        Signature::new(self.name.clone(), at)
    }
}

impl FromRequestParts<AppState> for User {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Answer<Self> {
        let jar = CookieJar::from_headers(&parts.headers);
        let name = jar.get(COOKIE).and_then(|c| state.sessions().get(c.value()).cloned());
        name.map(|name| Self { name, role: RoleName::Admin }).ok_or_else(|| {
            Failure::new(StatusCode::UNAUTHORIZED, "not_signed_in", "nobody is signed in")
                .help("open the address that `spineline serve` printed")
        })
    }
}

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(sign_in_page)).routes(routes!(session, sign_in, sign_out))
}

/// What the sign-in page needs to know.
#[utoipa::path(get, path = "/api/sign-in", responses((status = 200, body = SignInPage)))]
async fn sign_in_page() -> Json<SignInPage> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    Json(SignInPage { access: AccessName::Token, version })
}

/// Who is signed in.
#[utoipa::path(get, path = "/api/session",
    responses((status = 200, body = SessionView), (status = 401, body = Problem)))]
async fn session(user: User) -> Json<SessionView> {
    Json(view(&user))
}

/// Signs in.
#[utoipa::path(post, path = "/api/session", request_body = SignIn,
    responses((status = 200, body = SessionView), (status = 401, body = Problem)))]
async fn sign_in(
    State(state): State<AppState>,
    jar: CookieJar,
    Json(how): Json<SignIn>,
) -> Answer<(CookieJar, Json<SessionView>)> {
    let refused = || Failure::new(StatusCode::UNAUTHORIZED, "wrong", "that is not right");
    let SignIn::Token { token, observer } = how else { return Err(refused()) };
    if token != state.token() {
        return Err(refused());
    }
    let user = User { name: Name::new(&observer)?, role: RoleName::Admin };
    let id = secret();
    state.sessions().insert(id.clone(), user.name.clone());
    let cookie = Cookie::build((COOKIE, id)).http_only(true).same_site(SameSite::Strict).path("/");
    Ok((jar.add(cookie), Json(view(&user))))
}

/// Signs out.
#[utoipa::path(delete, path = "/api/session", responses((status = 204)))]
async fn sign_out(State(state): State<AppState>, jar: CookieJar) -> (CookieJar, StatusCode) {
    if let Some(cookie) = jar.get(COOKIE) {
        state.sessions().remove(cookie.value());
    }
    (jar.remove(Cookie::build(COOKIE).path("/")), StatusCode::NO_CONTENT)
}

fn view(user: &User) -> SessionView {
    SessionView {
        name: user.name.to_string(),
        role: user.role,
        access: AccessName::Token,
        csrf: String::new(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}
