//! The model of one line of action for other programs.

use axum::extract::State;
use axum::response::Response;

use super::super::loads::personalised_model;
use super::file::log;
use crate::PROGRAM;
use crate::access::OpenResult;
use crate::api::{ExportFormatName, LineKindName, Problem};
use crate::attachment::attachment;
use crate::extract::Path;
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;

/// The model of a line of action in the format of another program. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/models/{line}/{format}",
    params(("study" = String, Path), ("line" = LineKindName, Path), ("format" = ExportFormatName, Path)),
    responses((status = 200, content_type = "application/xml"), Problem))]
pub async fn export_model(
    State(state): State<AppState>,
    user: User,
    OpenResult(result): OpenResult,
    Path((_, line, format)): Path<(String, LineKindName, ExportFormatName)>,
) -> Answer<Response> {
    let study = result.study.clone();
    let text = computed(move || text(&result, line, format)).await??;
    log(&state, &user, &study, format.0.key()).await?;
    let name = format!("{study}-{}.{}", line.0.key(), format.0.file_ending());
    Ok(attachment(&name, format.0.media_type(), text))
}

fn text(result: &StudyResult, line: LineKindName, format: ExportFormatName) -> Answer<String> {
    let model = personalised_model(result, line)?;
    spineline_files::export(&model, format.0, PROGRAM).map_err(|error| Failure::of(&error))
}
