//! Sessions, and the user of a request.

use axum::extract::{FromRequestParts, State};
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode};
use axum_extra::extract::CookieJar;
use axum_extra::extract::cookie::{Cookie, SameSite};
use spineline::anatomy::Named;
use spineline_store::{
    Access, Hash, Name, Role, Session, SessionLimits, Signature, Store, Study, Timestamp,
};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{Problem, SessionView, SignIn, SignInPage, Wire};
use crate::extract::Json;
use crate::problem::{Answer, Failure};
use crate::secret::secret;
use crate::state::AppState;

/// Sessions end after 12 hours without use, and after 7 days in any case.
const LIMITS: SessionLimits =
    SessionLimits { idle_ms: 12 * 60 * 60 * 1000, whole_ms: 7 * 24 * 60 * 60 * 1000 };

/// The user of a request.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct User {
    /// Observer or account.
    pub name: Name,
    /// Highest permission.
    pub role: Role,
}

impl User {
    /// Author of a change, for the journal.
    #[must_use]
    pub fn sign(&self, at: Timestamp) -> Signature {
        Signature::new(self.name.clone(), at)
    }

    /// Permission in a study.
    ///
    /// # Errors
    /// 404 if the study does not exist or the user may not see it.
    pub fn on_study(&self, store: &Store, study: &Name) -> Answer<Role> {
        let granted = store.granted(study, &self.name)?;
        match (self.role, granted) {
            (Role::Admin, _) => Ok(Role::Admin),
            (role, Some(granted)) => Ok(role.min(granted)),
            (_, None) => Err(Failure::not_found()),
        }
    }

    /// Requires at least this role in a study.
    ///
    /// # Errors
    /// As [`User::on_study`], and 403 if the role is lower.
    pub fn need_on_study(&self, store: &Store, study: &Name, least: Role) -> Answer<Role> {
        let role = self.on_study(store, study)?;
        enough(role, least)?;
        Ok(role)
    }

    /// Requires at least this role of the account.
    ///
    /// # Errors
    /// 403.
    pub fn need(&self, least: Role) -> Answer<()> {
        enough(self.role, least)
    }

    /// The studies that the user may see, with the permission in each, by identifier.
    ///
    /// # Errors
    /// Errors of reading the store.
    pub fn studies(&self, store: &Store) -> Answer<Vec<(Study, Role)>> {
        let studies = store.studies()?.into_iter();
        if self.role == Role::Admin {
            return Ok(studies.map(|study| (study, Role::Admin)).collect());
        }
        let grants = store.grants_of(&self.name)?;
        let role_in = |id: &Name| grants.iter().find(|grant| grant.study == *id).map(|g| g.role);
        Ok(studies
            .filter_map(|study| role_in(&study.id).map(|role| (study, self.role.min(role))))
            .collect())
    }
}

fn enough(role: Role, least: Role) -> Answer<()> {
    if role >= least {
        return Ok(());
    }
    let [role, least] = [role, least].map(Role::key);
    Err(Failure::new(
        StatusCode::FORBIDDEN,
        "not_allowed",
        format!("this needs the role `{least}`; your role is `{role}`"),
    )
    .help("ask an admin"))
}

impl FromRequestParts<AppState> for User {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Answer<Self> {
        match parts.extensions.get::<Self>() {
            Some(known) => Ok(known.clone()),
            None => user_of(state, &parts.headers).await,
        }
    }
}

/// Who asks, by the cookie of a request; their session counts as used.
///
/// # Errors
/// 401 where nobody is signed in, and whatever keeps the store from reading.
pub async fn user_of(state: &AppState, headers: &HeaderMap) -> Answer<User> {
    let access = state.options().access;
    let secret = secret_of(state, headers).ok_or_else(|| not_signed_in(access))?;
    let now = state.now();
    let asked = state.ask(move |store| {
        let session = store.session(&secret, now, LIMITS)?;
        user(store, session, access)
    });
    asked.await
}

/// Who somebody is whose secret this is; their session does not count as used.
///
/// # Errors
/// As [`user_of`].
pub fn user_behind(store: &Store, secret: &str, access: Access, now: Timestamp) -> Answer<User> {
    let session = store.session_unused(secret, now, LIMITS)?;
    user(store, session, access)
}

/// A session is valid only for the way of signing in with which the program was started.
fn user(store: &Store, session: Option<Session>, access: Access) -> Answer<User> {
    let session = session.filter(|session| session.access == access);
    let name = session.ok_or_else(|| not_signed_in(access))?.name;
    let role = match access {
        Access::Token => Role::Admin,
        Access::Accounts => {
            let account = store.account(&name)?;
            if !account.enabled {
                return Err(not_signed_in(access));
            }
            account.role
        }
    };
    Ok(User { name, role })
}

fn not_signed_in(access: Access) -> Failure {
    let help = match access {
        Access::Token => "open the newest address that `spineline serve` printed",
        Access::Accounts => "sign in with your account",
    };
    Failure::new(StatusCode::UNAUTHORIZED, "not_signed_in", "no session: sign in").help(help)
}

/// Cookies are shared between ports, so the name of the cookie contains the port.
fn cookie_name(state: &AppState) -> String {
    format!("spineline_session_{}", state.address().port())
}

/// The secret in a request's cookie.
pub fn secret_of(state: &AppState, headers: &HeaderMap) -> Option<String> {
    let jar = CookieJar::from_headers(headers);
    jar.get(&cookie_name(state)).map(|cookie| cookie.value().to_owned())
}

/// The token that a request needs beside the cookie. It is a hash of the secret, which cannot be derived from it.
pub fn csrf_of(secret: &str) -> String {
    Hash::of(format!("spineline csrf {secret}").as_bytes()).to_string()
}

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(sign_in_page)).routes(routes!(session, sign_in, sign_out))
}

/// Data of the sign-in page.
#[utoipa::path(get, path = "/api/sign-in", responses((status = 200, body = SignInPage)))]
async fn sign_in_page(State(state): State<AppState>) -> Json<SignInPage> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    Json(SignInPage { access: Wire(state.options().access), version })
}

/// The current session.
#[utoipa::path(get, path = "/api/session",
    responses((status = 200, body = SessionView), (status = 401, body = Problem)))]
async fn session(
    State(state): State<AppState>,
    user: User,
    headers: HeaderMap,
) -> Answer<Json<SessionView>> {
    let access = state.options().access;
    let secret = secret_of(&state, &headers).ok_or_else(|| not_signed_in(access))?;
    Ok(Json(view(&user, access, &secret)))
}

/// Signs in. An earlier session of the browser ends.
#[utoipa::path(post, path = "/api/session", request_body = SignIn,
    responses(
        (status = 200, body = SessionView),
        (status = 401, body = Problem),
        (status = 422, body = Problem),
        (status = 429, body = Problem),
    ))]
async fn sign_in(
    State(state): State<AppState>,
    headers: HeaderMap,
    Json(how): Json<SignIn>,
) -> Answer<(CookieJar, Json<SessionView>)> {
    let access = state.options().access;
    let user = match (access, how) {
        (Access::Token, SignIn::Token { token, observer }) => by_token(&state, &token, &observer)?,
        (Access::Accounts, SignIn::Account { name, password }) => {
            by_account(&state, &name, password).await?
        }
        _ => return Err(not_signed_in(access)),
    };
    let id = secret();
    let session = Session { name: user.name.clone(), access };
    let (before, now) = (secret_of(&state, &headers), state.now());
    let begun = id.clone();
    state
        .store(move |store| {
            if let Some(before) = before {
                store.end_session(&before)?;
            }
            store.begin_session(&begun, &session, now, LIMITS)
        })
        .await?;
    state.changes().rights_changed();
    let answer = Json(view(&user, access, &id));
    Ok((CookieJar::new().add(cookie(&state, id)), answer))
}

fn by_token(state: &AppState, token: &str, observer: &str) -> Answer<User> {
    let name = Name::new(observer)?;
    // 192 random bits cannot be guessed, and failed attempts must not lock out the owner, so no limit of attempts applies.
    if !state.token().use_up(token) {
        return Err(wrong("this address was used already, or is not the one in the terminal")
            .help("open the newest address that `spineline serve` printed"));
    }
    Ok(User { name, role: Role::Admin })
}

async fn by_account(state: &AppState, name: &str, password: String) -> Answer<User> {
    let refused = || wrong("no enabled account has this name and this password");
    let name = Name::new(name).map_err(|_| refused())?;
    state.attempts().begin(name.as_str(), state.now().unix_ms())?;
    let asked = name.clone();
    let credential = state.store(move |store| store.credential(&asked)).await?;
    let account = state.with_password(move || credential.check(&password).cloned()).await?;
    let account = account.ok_or_else(refused)?;
    state.attempts().succeeded(name.as_str());
    Ok(User { name, role: account.role })
}

fn wrong(message: &str) -> Failure {
    Failure::new(StatusCode::UNAUTHORIZED, "wrong", message)
}

/// Signs out.
#[utoipa::path(delete, path = "/api/session",
    responses((status = 204), (status = 401, body = Problem), (status = 403, body = Problem)))]
async fn sign_out(
    State(state): State<AppState>,
    _user: User,
    headers: HeaderMap,
) -> Answer<(CookieJar, StatusCode)> {
    if let Some(secret) = secret_of(&state, &headers) {
        state.store(move |store| store.end_session(&secret)).await?;
        state.changes().rights_changed();
    }
    // A cookie without a value that ends now.
    let mut gone = cookie(&state, String::new());
    gone.make_removal();
    Ok((CookieJar::new().add(gone), StatusCode::NO_CONTENT))
}

fn cookie(state: &AppState, secret: String) -> Cookie<'static> {
    Cookie::build((cookie_name(state), secret))
        .http_only(true)
        .same_site(SameSite::Strict)
        .secure(state.options().https)
        .path("/")
        .build()
}

fn view(user: &User, access: Access, secret: &str) -> SessionView {
    SessionView {
        name: user.name.to_string(),
        role: Wire(user.role),
        access: Wire(access),
        csrf: csrf_of(secret),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}
