//! Loads that users put on a model: the same files and the same simulation as `spineline simulate --load`.

mod menu;
mod model;
mod view;

use axum::extract::State;
use axum::response::Response;
use spineline_files::{results_text, text_with_hash};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::exports::{log, provenance};
use super::load_intervals::recall;
use crate::PROGRAM;
use crate::access::OpenResult;
use crate::api::{FileOfLoads, LineKindName, LoadMenu, LoadedModel, Problem};
use crate::attachment::attachment;
use crate::extract::{Json, JsonText, Path, WithBody};
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;
pub use menu::RELATIVE_SYMBOL;
pub use model::{check_count, fitted_model, personalised_model, simulated_file};
use model::{model_text, parsed, simulated};
pub use view::tables;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(load_menu, simulate_loads))
        .routes(routes!(simulation_file))
        .routes(routes!(model_file))
}

/// Loads that are possible on the model of a line of action.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = LoadMenu), Problem))]
async fn load_menu(
    OpenResult(result): OpenResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Json<LoadMenu>> {
    computed(move || personalised_model(&result, line).map(|model| menu::menu(&model)))
        .await?
        .map(Json)
}

/// The model of a line of action under the loads of a file.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}",
    params(("study" = String, Path), ("line" = LineKindName, Path)), request_body = FileOfLoads,
    responses((status = 200, body = LoadedModel), Problem))]
async fn simulate_loads(
    Path((_, line)): Path<(String, LineKindName)>,
    WithBody(JsonText(text), OpenResult(result)): WithBody<JsonText, OpenResult>,
) -> Answer<Json<LoadedModel>> {
    let answer = computed(move || {
        let (loads, model) = (parsed(&text)?, personalised_model(&result, line)?);
        let faults = loads.faults(&model);
        if !faults.is_empty() {
            return Ok(view::faulty(&model, &loads, faults));
        }
        let simulated = simulated(model, loads)?;
        Ok(view::view(result.analysed()?, &simulated))
    });
    answer.await?.map(Json)
}

/// The same simulation as a file, with its intervals if they are computed. The log of the store has an entry for it.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}/simulation",
    params(("study" = String, Path), ("line" = LineKindName, Path)), request_body = FileOfLoads,
    responses((status = 200, content_type = "application/json"), Problem))]
async fn simulation_file(
    State(state): State<AppState>,
    user: User,
    Path((_, line)): Path<(String, LineKindName)>,
    WithBody(JsonText(text), OpenResult(result)): WithBody<JsonText, OpenResult>,
) -> Answer<Response> {
    let study = result.study.clone();
    // Intervals from before a restart are saved too.
    recall(&state, &result).await?;
    let intervals = state.load_intervals.of_line(&result, line);
    let made = computed(move || {
        let mut file = simulated_file(&result, line, &text)?.file(PROGRAM);
        let mut origin = provenance(result.analysed()?);
        if let Some((found, request)) = intervals.as_ref().and_then(|job| job.found_of(&text)) {
            file = file.with_uncertainty(found);
            origin = origin.asking(&request);
        }
        Ok::<_, Failure>(text_with_hash(results_text(&file.with_provenance(origin))))
    });
    let text = made.await??;
    log(&state, &user, &study, "simulation").await?;
    let name = format!("{study}-{}-simulation.json", line.0.key());
    Ok(attachment(&name, "application/json", text))
}

/// The model of a line of action as `spineline simulate` reads it. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}/model",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, content_type = "application/json"), Problem))]
async fn model_file(
    State(state): State<AppState>,
    user: User,
    OpenResult(result): OpenResult,
    Path((_, line)): Path<(String, LineKindName)>,
) -> Answer<Response> {
    let study = result.study.clone();
    let text = computed(move || model_text(&result, line)).await??;
    log(&state, &user, &study, "model").await?;
    let name = format!("{study}-{}-model.json", line.0.key());
    Ok(attachment(&name, "application/json", text))
}
