//! The user of a request, by the session behind its cookie.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, StatusCode};
use axum_extra::extract::CookieJar;
use spineline_store::{
    Access, Hash, Name, Role, Session, SessionLimits, Signature, Store, Study, Timestamp,
};

use crate::problem::{Answer, Failure};
use crate::state::AppState;

/// Sessions end after 12 hours without use, and after 7 days in any case.
pub const LIMITS: SessionLimits =
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
    pub fn sign(&self) -> Signature {
        Signature::now(self.name.clone())
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

/// The user of a request by its cookie; the session counts as used.
///
/// # Errors
/// 401 without a session, and errors of reading the store.
pub async fn user_of(state: &AppState, headers: &HeaderMap) -> Answer<User> {
    let access = state.options.access;
    let secret = secret_of(state, headers).ok_or_else(|| not_signed_in(access))?;
    let now = state.now();
    let asked = state.ask(move |store| {
        let session = store.session(&secret, now, LIMITS)?;
        user(store, session, access)
    });
    asked.await
}

/// The user of a session by its secret; the session does not count as used.
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

/// The refusal for a missing session.
pub fn not_signed_in(access: Access) -> Failure {
    let help = match access {
        Access::Token => "open the newest address that `spineline serve` printed",
        Access::Accounts => "sign in with your account",
    };
    Failure::new(StatusCode::UNAUTHORIZED, "not_signed_in", "no session: sign in").help(help)
}

/// Cookies are shared between ports, so the name of the cookie contains the port.
pub fn cookie_name(state: &AppState) -> String {
    format!("spineline_session_{}", state.address.port())
}

/// The secret in a request's cookie.
pub fn secret_of(state: &AppState, headers: &HeaderMap) -> Option<String> {
    let jar = CookieJar::from_headers(headers);
    jar.get(&cookie_name(state)).map(|cookie| cookie.value().to_owned())
}

/// The token that a request needs beside the cookie: a hash of the secret, which it does not reveal.
pub fn csrf_of(secret: &str) -> String {
    Hash::of(format!("spineline csrf {secret}").as_bytes()).to_string()
}
