//! Types shared by all parts of the interface.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use utoipa::openapi::{Content, Ref, RefOr, Response, ResponseBuilder};
use utoipa::{IntoResponses, ToSchema};

use super::{LineKindName, PostureName};

/// A problem that must be shown beside the affected numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Notice {
    /// Severity.
    pub severity: Severity,
    /// Key, such as `inflections_not_two`.
    pub code: String,
    /// Affected film.
    pub posture: Option<PostureName>,
    /// Affected vertebra, such as `T12`.
    pub level: Option<String>,
    /// Affected line of action.
    pub line: Option<LineKindName>,
    /// Message with place, value and limit; the line is not repeated.
    pub text: String,
}

impl Notice {
    /// A notice of a whole study or file.
    pub fn new(severity: Severity, code: &str, text: impl Into<String>) -> Self {
        let code = code.to_owned();
        Self { severity, code, posture: None, level: None, line: None, text: text.into() }
    }
}

/// Severity of a notice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Severity {
    /// Information.
    Note,
    /// A problem that does not stop the analysis.
    Warning,
    /// The data contradict the model, or a number is not a result.
    Contradiction,
    /// No result can be computed.
    Error,
}

/// Reason for a refusal; the body of every error response.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Key, such as `conflict`, `not_found`, `not_signed_in`.
    pub code: String,
    /// Message.
    pub message: String,
    /// Remedy.
    pub help: Option<String>,
}

/// Every request may be refused with a [`Problem`].
impl IntoResponses for Problem {
    fn responses() -> BTreeMap<String, RefOr<Response>> {
        let body = Content::new(Some(Ref::from_schema_name("Problem")));
        let refusal = ResponseBuilder::new()
            .description("Refused: the body says why and what helps")
            .content("application/json", body)
            .build();
        BTreeMap::from([("default".to_owned(), refusal.into())])
    }
}
