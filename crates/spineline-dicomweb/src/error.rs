//! Errors between this program and a DICOMweb archive. Messages never quote an answer or a searched value.

use std::time::Duration;

/// A request to a DICOMweb archive without a usable answer.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DicomwebError {
    /// No connection.
    #[error("the archive `{archive}` cannot be reached: {reason}")]
    Unreachable {
        /// The archive.
        archive: String,
        /// Why, by the kind of the error.
        reason: String,
    },
    /// It took too long.
    #[error("the archive `{archive}` did not answer within {} s", limit.as_secs())]
    TooSlow {
        /// The archive.
        archive: String,
        /// The limit.
        limit: Duration,
    },
    /// It refused the login.
    #[error("the archive `{archive}` refuses the login of this program (HTTP {status})")]
    Login {
        /// The archive.
        archive: String,
        /// 401 or 403.
        status: u16,
    },
    /// It does not have the film.
    #[error("the archive `{archive}` does not have this film")]
    NotFound {
        /// The archive.
        archive: String,
    },
    /// It sent this program to another address.
    #[error(
        "the archive `{archive}` redirects to another address, which is not followed (HTTP {status})"
    )]
    Redirect {
        /// The archive.
        archive: String,
        /// 300 to 399.
        status: u16,
    },
    /// It refused for another reason.
    #[error("the archive `{archive}` refused the request (HTTP {status})")]
    Refused {
        /// The archive.
        archive: String,
        /// Status of the answer.
        status: u16,
    },
    /// The answer exceeds the limit.
    #[error("the answer of the archive `{archive}` exceeds the limit of {} MB", limit_bytes >> 20)]
    TooLarge {
        /// The archive.
        archive: String,
        /// The limit.
        limit_bytes: u64,
    },
    /// It answered with another film than requested.
    #[error(
        "the archive `{archive}` answered with another film: its {attribute} is {} instead of {asked}",
        found.as_deref().unwrap_or("not stated")
    )]
    OtherFilm {
        /// The archive.
        archive: String,
        /// Name of the attribute that differs.
        attribute: &'static str,
        /// UID of the requested film.
        asked: String,
        /// UID of the received film; `None` if it is not stated.
        found: Option<String>,
    },
    /// It answered with a film of another patient than the search found.
    #[error(
        "the archive `{archive}` answered with a film of another patient than its search: the Patient ID in the file of SOP Instance UID {instance} differs"
    )]
    OtherPatient {
        /// The archive.
        archive: String,
        /// SOP Instance UID of the film.
        instance: String,
    },
    /// Not a DICOMweb answer.
    #[error("the answer of the archive `{archive}` cannot be read: {what}")]
    BadAnswer {
        /// The archive.
        archive: String,
        /// The error in the answer.
        what: &'static str,
    },
}

impl DicomwebError {
    /// What to do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Unreachable { .. } | Self::TooSlow { .. } => {
                "try again; if the error remains, an administrator checks the address and the network"
            }
            Self::Login { .. } => {
                "an administrator checks the login that `spineline serve` was given"
            }
            Self::NotFound { .. } => "search again: the film may have been moved or deleted",
            Self::Redirect { .. } => {
                "an administrator gives `spineline serve` the address to which the archive redirects"
            }
            Self::Refused { .. } | Self::BadAnswer { .. } => {
                "an administrator checks that the address belongs to the DICOMweb service (QIDO-RS and WADO-RS)"
            }
            Self::OtherFilm { .. } | Self::OtherPatient { .. } => {
                "do not use this film: an administrator checks the archive, because its index and its files contradict each other"
            }
            Self::TooLarge { .. } => "export the film from its archive, and upload the file",
        }
    }
}
