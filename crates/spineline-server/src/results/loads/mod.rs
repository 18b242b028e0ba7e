//! Loads that users put on a model: the same files and the same simulation as `spineline simulate --load`.

mod menu;
mod view;

use std::ops::ControlFlow;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use spineline::analysis::{Analysis, LineModel, PersonalisedModel};
use spineline::multibody::Goal;
use spineline::personalize::FitStatus;
use spineline_files::{
    LoadFile, ModelFile, Simulated, SimulationError, parse_load, text_with_hash, to_text,
};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::exports::{log, provenance};
use super::load_intervals::recall;
use crate::PROGRAM;
use crate::access::{open_study, study_result};
use crate::api::{FileOfLoads, LineKindName, LoadMenu, LoadedModel, Problem};
use crate::attachment::attachment;
use crate::extract::{Json, JsonText, Path};
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;
pub use menu::RELATIVE_SYMBOL;
pub use view::tables;

/// Maximum number of loads, more than any plan has.
const MAX_LOADS: usize = 100;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(load_menu, simulate_loads))
        .routes(routes!(simulation_file))
        .routes(routes!(model_file))
}

/// Loads that are possible on the model of a line of action.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, body = LoadMenu), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn load_menu(
    State(state): State<AppState>,
    user: User,
    Path((study, line)): Path<(String, LineKindName)>,
) -> Answer<Json<LoadMenu>> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    computed(move || personalised_model(&result, line).map(|model| menu::menu(&model)))
        .await?
        .map(Json)
}

/// The model of a line of action under the loads of a file.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}",
    params(("study" = String, Path), ("line" = LineKindName, Path)), request_body = FileOfLoads,
    responses((status = 200, body = LoadedModel), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn simulate_loads(
    State(state): State<AppState>,
    user: User,
    Path((study, line)): Path<(String, LineKindName)>,
    JsonText(text): JsonText,
) -> Answer<Json<LoadedModel>> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    let answer = computed(move || {
        let (loads, model) = (parsed(&text)?, personalised_model(&result, line)?);
        let faults = loads.faults(&model);
        if !faults.is_empty() {
            return Ok(view::faulty(&loads, faults));
        }
        let simulated = simulated(model, loads)?;
        Ok(view::view(result.analysed()?, &simulated))
    });
    answer.await?.map(Json)
}

/// The same simulation as a file, with its intervals if they are computed. The log of the store has an entry for it.
#[utoipa::path(post, path = "/api/studies/{study}/loads/{line}/simulation",
    params(("study" = String, Path), ("line" = LineKindName, Path)), request_body = FileOfLoads,
    responses((status = 200, content_type = "application/json"), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn simulation_file(
    State(state): State<AppState>,
    user: User,
    Path((study, line)): Path<(String, LineKindName)>,
    JsonText(text): JsonText,
) -> Answer<Response> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    // Intervals from before a restart are saved too.
    recall(&state, &result).await?;
    let intervals = state.load_intervals().of_line(&result, line);
    let made = computed(move || {
        let mut file = simulated_file(&result, line, &text)?.file(PROGRAM);
        let mut origin = provenance(result.analysed()?);
        if let Some((found, request)) = intervals.as_ref().and_then(|job| job.found_of(&text)) {
            file = file.with_uncertainty(found);
            origin = origin.asking(&request);
        }
        Ok::<_, Failure>(text_with_hash(to_text(&file.with_provenance(origin))))
    });
    let text = made.await??;
    log(&state, &user, &study, "simulation").await?;
    let name = format!("{study}-{}-simulation.json", line.0.key());
    Ok(attachment(&name, "application/json", text))
}

/// The model of a line of action as `spineline simulate` reads it. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/loads/{line}/model",
    params(("study" = String, Path), ("line" = LineKindName, Path)),
    responses((status = 200, content_type = "application/json"), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn model_file(
    State(state): State<AppState>,
    user: User,
    Path((study, line)): Path<(String, LineKindName)>,
) -> Answer<Response> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    let text = computed(move || model_text(&result, line)).await??;
    log(&state, &user, &study, "model").await?;
    let name = format!("{study}-{}-model.json", line.0.key());
    Ok(attachment(&name, "application/json", text))
}

pub fn refused(text: impl Into<String>, help: &str) -> Failure {
    Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "refused", text).help(help)
}

fn parsed(text: &str) -> Answer<LoadFile> {
    let loads = parse_load(text).map_err(|error| refused(error.to_string(), error.help()))?;
    check_count(&loads)?;
    Ok(loads)
}

/// Refuses too many loads.
pub fn check_count(loads: &LoadFile) -> Answer<()> {
    let count = loads.loads.len();
    if count > MAX_LOADS {
        let text = format!("there are {count} loads; the limit is {MAX_LOADS}");
        return Err(refused(text, "the command line takes more: `spineline simulate --load`"));
    }
    Ok(())
}

/// The model of a line of action whose fit gave springs.
///
/// # Errors
/// A refusal if the study lacks this model.
pub fn fitted_model(result: &StudyResult, line: LineKindName) -> Answer<(&Analysis, &LineModel)> {
    let analysis = result.analysed()?;
    let no_model =
        |text: String, help| Failure::new(StatusCode::CONFLICT, "no_model", text).help(help);
    let model = analysis.model(line.0).ok_or_else(|| {
        let text = format!("this study has no model with the {}", line.0);
        no_model(text, "choose a line that has a model")
    })?;
    if model.fit.status != FitStatus::Converged {
        let text = format!("the fit of the {} did not converge", line.0);
        return Err(no_model(text, "its springs are not a result; choose another line"));
    }
    Ok((analysis, model))
}

/// The file of a model.
///
/// # Errors
/// As [`fitted_model`].
pub fn model_text(result: &StudyResult, line: LineKindName) -> Answer<String> {
    let (analysis, model) = fitted_model(result, line)?;
    let file = ModelFile::new(analysis, model, PROGRAM).with_provenance(provenance(analysis));
    Ok(text_with_hash(to_text(&file)))
}

/// The personalised model of a line of action.
///
/// # Errors
/// As [`fitted_model`].
pub fn personalised_model(result: &StudyResult, line: LineKindName) -> Answer<PersonalisedModel> {
    let (analysis, model) = fitted_model(result, line)?;
    Ok(analysis.personalised_model(model))
}

/// The model of a line of action under the loads of a file.
///
/// # Errors
/// As [`fitted_model`]; a refusal if the text is not a load file, or its loads cannot be applied.
pub fn simulated_file(result: &StudyResult, line: LineKindName, text: &str) -> Answer<Simulated> {
    simulated(personalised_model(result, line)?, parsed(text)?)
}

fn simulated(model: PersonalisedModel, loads: LoadFile) -> Answer<Simulated> {
    let mut go_on = |_, _: &_| ControlFlow::Continue(());
    Simulated::of(model, loads, Goal::FullLoad, None, Vec::new(), &mut go_on)
        .map_err(|error: SimulationError| refused(error.to_string(), error.help()))
}
