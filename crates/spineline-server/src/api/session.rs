//! Sessions, accounts and permissions.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{AccessName, RoleName};

/// Data of the sign-in page, available without a session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SignInPage {
    /// How to sign in.
    pub access: AccessName,
    /// Version of the program.
    pub version: String,
}

/// Request to sign in.
#[derive(Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(tag = "kind", rename_all = "snake_case", deny_unknown_fields)]
pub enum SignIn {
    /// With the token in the address that `serve` printed.
    Token {
        /// The token.
        token: String,
        /// Name of the observer: 1 to 64 letters, digits, `.`, `-`, `_`.
        observer: String,
    },
    /// With an account.
    Account {
        /// Its name.
        name: String,
        /// Its password.
        password: String,
    },
}

/// Another password for the account that is signed in.
#[derive(Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct PasswordChange {
    /// The current password.
    pub current: String,
    /// The new one, of at least 12 characters and hard to guess.
    pub password: String,
}

/// The current session.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SessionView {
    /// Observer or account.
    pub name: String,
    /// Role.
    pub role: RoleName,
    /// Way of signing in.
    pub access: AccessName,
    /// To be sent as `X-Spineline-Csrf` with every request that changes data.
    pub csrf: String,
    /// Version of the program.
    pub version: String,
}

/// A new account, or a change of one; absent values do not change.
#[derive(Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AccountEdit {
    /// Role.
    pub role: Option<RoleName>,
    /// New password, of at least 12 characters and hard to guess.
    pub password: Option<String>,
    /// Whether it may sign in.
    pub enabled: Option<bool>,
}

/// Permission of an account in one study. Admins have all permissions in every study.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Grant {
    /// Account.
    pub name: String,
    /// `reader` or `editor`.
    pub role: RoleName,
}
