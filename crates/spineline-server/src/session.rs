//! Sessions: signing in and out, and passwords.

use axum::extract::{Extension, State};
use axum::http::header::SET_COOKIE;
use axum::http::{HeaderMap, HeaderName, StatusCode};
use axum::response::AppendHeaders;
use axum_extra::extract::CookieJar;
use axum_extra::extract::cookie::{Cookie, SameSite};
use spineline_store::{Access, Credential, Name, PasswordHash, Role, Session, Signature, Store};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{PasswordChange, Problem, SessionView, SignIn, SignInPage, Wire};
use crate::extract::Json;
use crate::guard_rate::Source;
use crate::problem::{Answer, Failure};
use crate::request_source::{RequestSource, device_cookie};
use crate::secret::secret;
use crate::state::AppState;
use crate::user::{LIMITS, User, cookie_name, csrf_of, not_signed_in, secret_of};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(sign_in_page))
        .routes(routes!(session, sign_in, sign_out))
        .routes(routes!(change_password))
}

/// Data of the sign-in page.
#[utoipa::path(get, path = "/api/sign-in", responses((status = 200, body = SignInPage)))]
async fn sign_in_page(State(state): State<AppState>) -> Json<SignInPage> {
    let version = env!("CARGO_PKG_VERSION").to_owned();
    Json(SignInPage { access: Wire(state.options.access), version })
}

/// The current session.
#[utoipa::path(get, path = "/api/session",
    responses((status = 200, body = SessionView), Problem))]
async fn session(
    State(state): State<AppState>,
    user: User,
    headers: HeaderMap,
) -> Answer<Json<SessionView>> {
    let access = state.options.access;
    let secret = secret_of(&state, &headers).ok_or_else(|| not_signed_in(access))?;
    Ok(Json(view(&user, access, &secret)))
}

/// Signs in. An earlier session of the browser ends.
#[utoipa::path(post, path = "/api/session", request_body = SignIn,
    responses((status = 200, body = SessionView), Problem))]
async fn sign_in(
    State(state): State<AppState>,
    Extension(from): Extension<RequestSource>,
    headers: HeaderMap,
    Json(how): Json<SignIn>,
) -> Answer<Begun> {
    let account = match &how {
        SignIn::Account { name, .. } => Name::new(name).ok(),
        SignIn::Token { .. } => None,
    };
    let found = match (state.options.access, how) {
        (Access::Token, SignIn::Token { token, observer }) => by_token(&state, &token, &observer),
        (Access::Accounts, SignIn::Account { password, .. }) => {
            by_account(&state, &from, account.as_ref(), password).await
        }
        (access, _) => Err(not_signed_in(access)),
    };
    let found = match found {
        Ok(found) => found,
        Err(refusal) => {
            log_refused(&state, account).await;
            return Err(refusal);
        }
    };
    let by = found.user.sign();
    state.store(move |store| store.log_sign_in(&by)).await?;
    begin(&state, &headers, found).await
}

/// A user with a proven identity; for accounts, with the checked credential.
struct Proved {
    user: User,
    credential: Option<Credential>,
}

/// A new session, with its cookie and the cookie by which the browser is known later.
type Begun = (CookieJar, AppendHeaders<Option<(HeaderName, String)>>, Json<SessionView>);

/// Begins a session in a browser.
async fn begin(state: &AppState, headers: &HeaderMap, proved: Proved) -> Answer<Begun> {
    let Proved { user, credential } = proved;
    let (access, id) = (state.options.access, secret());
    let session = Session { name: user.name.clone(), access };
    let (before, now) = (secret_of(state, headers), state.now());
    let (begun, checked) = (id.clone(), credential.clone());
    state
        .ask(move |store| {
            // The password may have been changed while it was compared.
            if let Some(checked) = checked
                && store.credential(&session.name)? != checked
            {
                return Err(wrong_password());
            }
            if let Some(before) = before {
                store.end_session(&before)?;
            }
            Ok(store.begin_session(&begun, &session, now, LIMITS)?)
        })
        .await?;
    state.changes.rights_changed();
    let answer = Json(view(&user, access, &id));
    let proof = credential.and_then(|credential| credential.device(now));
    let device = proof.map(|proof| device_cookie(state, &user.name, proof));
    // The session's cookie comes first, for clients that read one cookie.
    let device = device.map(|cookie| (SET_COOKIE, cookie.encoded().to_string()));
    Ok((CookieJar::new().add(cookie(state, id)), AppendHeaders(device), answer))
}

fn by_token(state: &AppState, token: &str, observer: &str) -> Answer<Proved> {
    let name = Name::new(observer)?;
    // 192 random bits cannot be guessed, and failed attempts must not lock out the owner, so attempts are not limited.
    if !state.token.use_up(token) {
        return Err(wrong("this address was used already, or is not the one in the terminal")
            .help("open the newest address that `spineline serve` printed"));
    }
    Ok(Proved { user: User { name, role: Role::Admin }, credential: None })
}

async fn by_account(
    state: &AppState,
    from: &RequestSource,
    name: Option<&Name>,
    password: String,
) -> Answer<Proved> {
    let name = name.ok_or_else(wrong_password)?;
    let source = from.source(name);
    state.attempts.begin(&source, name, state.now().unix_ms())?;
    let asked = name.clone();
    let credential = state.store(move |store| store.credential(&asked)).await?;
    let compare = move || credential.check(&password).cloned().map(|account| (account, credential));
    let places = match source {
        Source::Device(_) => &state.passwords,
        _ => &state.strangers_passwords,
    };
    let found = state.with_password(places, compare).await?;
    let (account, credential) = found.ok_or_else(wrong_password)?;
    state.attempts.succeeded(&source, name);
    let user = User { name: account.name, role: account.role };
    Ok(Proved { user, credential: Some(credential) })
}

/// Logs a refused attempt. An error here does not change the answer.
async fn log_refused(state: &AppState, account: Option<Name>) {
    let by = program();
    let Some(unlogged) = state.logged_refusals.log(by.at.unix_ms()) else { return };
    let log = move |store: &mut Store| {
        let account = account.filter(|name| store.account(name).is_ok());
        store.log_refused_sign_in(account.as_ref(), unlogged, &by)
    };
    let _ = state.store(log).await;
}

/// The program itself, as the log names it.
pub fn program() -> Signature {
    Signature::now(Name::new("serve").expect("a good name"))
}

fn wrong(message: &str) -> Failure {
    Failure::new(StatusCode::UNAUTHORIZED, "wrong", message)
}

fn wrong_password() -> Failure {
    wrong("no enabled account has this name and this password")
}

/// Changes the user's own password. All other sessions of the account end, and so do the proofs of browsers that
/// signed in lately.
#[utoipa::path(put, path = "/api/session/password", request_body = PasswordChange,
    responses((status = 200, body = SessionView), Problem))]
async fn change_password(
    State(state): State<AppState>,
    user: User,
    headers: HeaderMap,
    Json(PasswordChange { current, password }): Json<PasswordChange>,
) -> Answer<Begun> {
    if state.options.access == Access::Token {
        let text = "this program runs without accounts: it has no passwords";
        return Err(Failure::new(StatusCode::CONFLICT, "no_accounts", text));
    }
    let by = user.sign();
    state.attempts.begin(&Source::Session, &user.name, by.at.unix_ms())?;
    let name = user.name.clone();
    let before = state.store(move |store| store.credential(&name)).await?;
    let name = user.name.clone();
    let made = state.with_password(&state.passwords, move || {
        before.check(&current)?;
        Some(PasswordHash::new(&password, &name).map(|password| (before, password)))
    });
    let made = made.await?.ok_or_else(|| {
        let text = "the current password is wrong; nothing was changed";
        Failure::new(StatusCode::FORBIDDEN, "wrong", text).help("ask an admin if you forgot it")
    })?;
    state.attempts.succeeded(&Source::Session, &user.name);
    let (before, password) = made?;
    let name = user.name.clone();
    let changed = state.store(move |store| {
        store.change_password(&before, &password, &by)?;
        store.credential(&name)
    });
    let proved = Proved { user, credential: Some(changed.await?) };
    begin(&state, &headers, proved).await
}

/// Signs out.
#[utoipa::path(delete, path = "/api/session",
    responses((status = 204), Problem))]
async fn sign_out(
    State(state): State<AppState>,
    _user: User,
    headers: HeaderMap,
) -> Answer<(CookieJar, StatusCode)> {
    if let Some(secret) = secret_of(&state, &headers) {
        state.store(move |store| store.end_session(&secret)).await?;
        state.changes.rights_changed();
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
        .secure(state.options.https)
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
