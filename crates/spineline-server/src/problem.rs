//! Refusals and their messages.

use axum::Json;
use axum::http::{StatusCode, header};
use axum::response::{IntoResponse, Response};

use spineline::fault::Remedy;
use spineline_films::FilmError;
use spineline_store::StoreError;

use crate::api::Problem;

/// Result of a handler.
pub type Answer<T> = Result<T, Failure>;

/// A refusal.
#[derive(Debug, Clone, PartialEq)]
pub struct Failure {
    status: StatusCode,
    problem: Problem,
    retry_after_s: Option<u32>,
}

impl Failure {
    /// A refusal with its own message.
    #[must_use]
    pub fn new(status: StatusCode, code: &str, message: impl Into<String>) -> Self {
        let problem = Problem { code: code.to_owned(), message: message.into(), help: None };
        Self { status, problem, retry_after_s: None }
    }

    /// A refusal of what was sent.
    #[must_use]
    pub fn refused(message: impl Into<String>) -> Self {
        Self::new(StatusCode::UNPROCESSABLE_ENTITY, "refused", message)
    }

    /// A refusal by an error, with its remedy.
    #[must_use]
    pub fn of(error: &impl Remedy) -> Self {
        Self::refused(error.to_string()).help(error.help())
    }

    /// A fault of this program or of its machine.
    #[must_use]
    pub fn internal(message: impl Into<String>) -> Self {
        Self::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", message)
    }

    /// Adds the remedy.
    #[must_use]
    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.problem.help = Some(help.into());
        self
    }

    /// The problem that the answer contains.
    #[must_use]
    pub fn into_problem(self) -> Problem {
        self.problem
    }

    /// With the time after which to try again, in seconds.
    #[must_use]
    pub fn retry_after(mut self, seconds: u32) -> Self {
        self.retry_after_s = Some(seconds);
        self
    }

    /// Not found, or not permitted; the answer does not say which.
    #[must_use]
    pub fn not_found() -> Self {
        Self::new(
            StatusCode::NOT_FOUND,
            "not_found",
            "not found, or you have no permission to see it",
        )
    }
}

impl From<StoreError> for Failure {
    fn from(error: StoreError) -> Self {
        use StatusCode as S;
        let (status, code) = match &error {
            StoreError::Unknown { .. } | StoreError::OutOfTurn => return Self::not_found(),
            StoreError::Conflict { .. } => (S::CONFLICT, "conflict"),
            StoreError::NotYours { .. } => (S::FORBIDDEN, "not_yours"),
            StoreError::Finished { .. } => (S::CONFLICT, "finished"),
            StoreError::Exists { .. } | StoreError::AlreadyKnown { .. } => (S::CONFLICT, "exists"),
            StoreError::PlanRuns { .. } => (S::CONFLICT, "plan_runs"),
            StoreError::PlanReplaced { .. } => (S::CONFLICT, "plan_replaced"),
            StoreError::Archived { .. } => (S::CONFLICT, "archived"),
            StoreError::Withdrawn { .. } => (S::CONFLICT, "withdrawn"),
            StoreError::HasReading { .. } => (S::CONFLICT, "has_reading"),
            StoreError::NotFinished { .. } => (S::CONFLICT, "not_finished"),
            StoreError::LastAdmin { .. } => (S::CONFLICT, "last_admin"),
            StoreError::BadPassword { .. } => (S::UNPROCESSABLE_ENTITY, "bad_password"),
            StoreError::TooLarge { .. } => (S::PAYLOAD_TOO_LARGE, "too_large"),
            StoreError::Busy => (S::SERVICE_UNAVAILABLE, "busy"),
            StoreError::Full | StoreError::Disk { .. } => (S::INSUFFICIENT_STORAGE, "disk"),
            StoreError::ReadOnly => (S::FORBIDDEN, "read_only"),
            StoreError::Replaced => (S::SERVICE_UNAVAILABLE, "replaced"),
            StoreError::Damaged { .. } | StoreError::Database { .. } => {
                (S::INTERNAL_SERVER_ERROR, "store")
            }
            _ => (S::UNPROCESSABLE_ENTITY, "refused"),
        };
        Self::new(status, code, words(&error)).help(error.help())
    }
}

/// The store's message without its internal names.
fn words(error: &StoreError) -> String {
    match error {
        StoreError::Conflict { .. } => {
            "another change was saved first: your change was kept, but not applied".to_owned()
        }
        StoreError::Exists { object } if object.starts_with("reading/") => {
            "this reading was begun already".to_owned()
        }
        StoreError::Finished { .. } => "this reading is finished".to_owned(),
        StoreError::NotYours { .. } => "this reading belongs to another observer".to_owned(),
        StoreError::Withdrawn { .. } => "this reading is withdrawn".to_owned(),
        StoreError::NotFinished { .. } => "this reading is not finished".to_owned(),
        StoreError::HasReading { .. } => {
            "readings of this film name its landmarks by the patient's side".to_owned()
        }
        StoreError::NoReason { .. } => "a withdrawal needs a reason".to_owned(),
        StoreError::BadEvent { reason, .. } => (*reason).to_owned(),
        StoreError::Incomplete { level, corners, .. } => {
            format!("{level} has {corners} of four corners")
        }
        other => other.to_string(),
    }
}

impl From<FilmError> for Failure {
    fn from(error: FilmError) -> Self {
        let status = match error {
            FilmError::TooLarge { .. } => StatusCode::PAYLOAD_TOO_LARGE,
            _ => StatusCode::UNPROCESSABLE_ENTITY,
        };
        Self::new(status, "film", error.to_string()).help(error.help())
    }
}

impl IntoResponse for Failure {
    fn into_response(self) -> Response {
        let mut answer = (self.status, Json(self.problem)).into_response();
        if let Some(seconds) = self.retry_after_s {
            answer.headers_mut().insert(header::RETRY_AFTER, seconds.into());
        }
        answer
    }
}
