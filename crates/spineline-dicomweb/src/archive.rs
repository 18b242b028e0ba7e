//! Archives that an administrator allowed.

use std::fmt;
use std::net::IpAddr;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use ureq::http::Uri;

use crate::encryption;

/// Longest name of an archive.
const MAX_NAME: usize = 32;

/// A DICOMweb archive that an administrator allowed.
#[derive(Clone, PartialEq, Eq)]
pub struct Archive {
    name: String,
    /// Without a slash at its end.
    base: String,
    is_exposed: bool,
    /// Value of the header `Authorization`.
    login: Option<String>,
}

/// An invalid archive.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ArchiveFault {
    /// Not `NAME=ADDRESS`.
    #[error("`{text}` is not NAME=ADDRESS, such as archive=https://pacs.clinic.example/dicom-web")]
    Form {
        /// What was given.
        text: String,
    },
    /// A name with other characters, or too long.
    #[error("the name `{name}` must be 1 to {MAX_NAME} lower-case letters, digits and hyphens")]
    Name {
        /// What was given.
        name: String,
    },
    /// Not a DICOMweb address.
    #[error("the address of `{name}` {fault}")]
    Address {
        /// The archive.
        name: String,
        /// What is wrong.
        fault: &'static str,
    },
    /// An encrypted connection, which needs the feature `https`.
    #[error(
        "`{name}` needs an encrypted connection, which this program was built without: build it with `cargo build \
         --release --features https`, or use the program of the Python wheel"
    )]
    Encryption {
        /// The archive.
        name: String,
    },
    /// Not `USER:PASSWORD`.
    #[error("the login of `{name}` must be one line USER:PASSWORD")]
    Login {
        /// The archive.
        name: String,
    },
}

impl Archive {
    /// Reads `NAME=ADDRESS`, with the address of the DICOMweb service, below which `studies` and `series` are.
    pub fn parse(text: &str) -> Result<Self, ArchiveFault> {
        let (name, address) =
            text.split_once('=').ok_or_else(|| ArchiveFault::Form { text: text.to_owned() })?;
        let is_name_byte =
            |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || byte == b'-';
        if name.is_empty() || name.len() > MAX_NAME || !name.bytes().all(is_name_byte) {
            return Err(ArchiveFault::Name { name: name.to_owned() });
        }
        let fault = |fault| ArchiveFault::Address { name: name.to_owned(), fault };
        let uri: Uri = address.parse().map_err(|_| fault("is not an address"))?;
        let is_plain = match uri.scheme_str() {
            Some("https") => false,
            Some("http") => true,
            _ => return Err(fault("must begin with https:// or http://")),
        };
        let authority = uri.authority().map_or("", |authority| authority.as_str());
        if authority.contains('@') {
            return Err(fault("must be without a user and a password: they belong in a file"));
        }
        let host =
            uri.host().filter(|host| !host.is_empty()).ok_or_else(|| fault("has no host"))?;
        if uri.query().is_some() || address.contains('#') {
            return Err(fault("must end with its path"));
        }
        if !is_plain && !encryption::IS_BUILT {
            return Err(ArchiveFault::Encryption { name: name.to_owned() });
        }
        let base = address.trim_end_matches('/').to_owned();
        Ok(Self {
            name: name.to_owned(),
            base,
            is_exposed: is_plain && !is_loopback(host),
            login: None,
        })
    }

    /// With a user and a password, as `USER:PASSWORD`; sent as HTTP Basic authentication.
    ///
    /// # Errors
    /// [`ArchiveFault::Login`].
    pub fn with_login(self, login: &str) -> Result<Self, ArchiveFault> {
        let login = login.trim_end_matches(['\r', '\n']);
        if !login.contains(':') || login.chars().any(char::is_control) {
            return Err(ArchiveFault::Login { name: self.name });
        }
        Ok(Self { login: Some(format!("Basic {}", STANDARD.encode(login))), ..self })
    }

    /// Its name, which users see and choose.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether films and the login go over a network without encryption.
    #[must_use]
    pub const fn is_exposed(&self) -> bool {
        self.is_exposed
    }

    /// Value of the header `Authorization`.
    pub(crate) fn login(&self) -> Option<&str> {
        self.login.as_deref()
    }

    pub(crate) fn address(&self, path: &str) -> String {
        format!("{}/{path}", self.base)
    }
}

/// Whether a host is this machine.
fn is_loopback(host: &str) -> bool {
    let address = host.trim_matches(['[', ']']).parse::<IpAddr>();
    host.eq_ignore_ascii_case("localhost") || address.is_ok_and(|address| address.is_loopback())
}

/// Without the login.
impl fmt::Debug for Archive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, base, .. } = self;
        f.debug_struct("Archive").field("name", name).field("base", base).finish_non_exhaustive()
    }
}
