//! Words that everything else uses.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{LineName, PostureName};

/// Something that is not right, and that whoever reads a number must see beside it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Notice {
    /// How bad.
    pub severity: Severity,
    /// Key, such as `inflections_not_two`.
    pub code: String,
    /// Film that it is about.
    pub posture: Option<PostureName>,
    /// Vertebra that it is about, such as `T12`.
    pub level: Option<String>,
    /// Line of action that it is about.
    pub line: Option<LineName>,
    /// What, where, which value and which limit; the line is not named again.
    pub text: String,
}

/// How bad a notice is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Worth knowing.
    Note,
    /// Soft problem.
    Warning,
    /// The data speak against the model, or a number is not a result.
    Contradiction,
    /// Nothing can be computed.
    Error,
}

/// Why a request was refused; the body of every answer that is not a success.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Key, such as `conflict`, `not_found`, `not_signed_in`.
    pub code: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: Option<String>,
}
