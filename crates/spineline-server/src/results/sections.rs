//! Parts of the report as the browser shows them: the same texts, tables and pictures.

use axum::extract::State;
use spineline::analysis::Analysis;
use spineline_report::document::Section;
use spineline_report::patient::parts;

use crate::access::open_result;
use crate::api::Problem;
use crate::extract::{Json, Path};
use crate::problem::Answer;
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;

/// The lines of action beside predictions without mechanics, the automatic choice, and the line of best fit of every film.
#[utoipa::path(get, path = "/api/studies/{study}/lines", params(("study" = String, Path)),
    responses((status = 200, body = Vec<Section>), Problem))]
pub async fn lines(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<Vec<Section>>> {
    of_analysis(&state, &user, &study, parts::lines).await
}

/// The erect and the lateral film together, with every number in 2-D and 3-D, and axial rotations from pedicles; empty without both.
#[utoipa::path(get, path = "/api/studies/{study}/space", params(("study" = String, Path)),
    responses((status = 200, body = Vec<Section>), Problem))]
pub async fn space(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<Vec<Section>>> {
    of_analysis(&state, &user, &study, parts::space).await
}

/// Parts of the report of a study that has an analysis.
async fn of_analysis(
    state: &AppState,
    user: &User,
    study: &str,
    parts: fn(&Analysis) -> Vec<Section>,
) -> Answer<Json<Vec<Section>>> {
    let result = open_result(state, user, study).await?;
    computed(move || result.analysed().map(parts)).await?.map(Json)
}
