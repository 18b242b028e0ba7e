//! Studies: list, create, read, edit, plan, export.

mod detail;
mod make;
mod summary;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use spineline_store::{Access, Account, Name, PlanDesign, Role, Store, Visibility, system_random};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{self, study_name};
use crate::api::{NewPlan, Problem, StudyChange, StudyDetail, StudySummary};
use crate::attachment::attachment;
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub use detail::{detail, of_study};
pub use make::stated_spacing;
pub use summary::{film_summary, study_summary};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list))
        .routes(routes!(study))
        .routes(routes!(edit_study))
        .routes(routes!(plan))
        .routes(routes!(case_file))
        .merge(make::routes())
}

/// The studies that the requester may see.
#[utoipa::path(get, path = "/api/studies", responses((status = 200, body = [StudySummary])))]
async fn list(State(state): State<AppState>, user: User) -> Answer<Json<Vec<StudySummary>>> {
    let studies = access::prepared(&state, &user).await?;
    let asker = state.clone();
    let list = state.ask(move |store| {
        let summaries = studies.iter();
        summaries.map(|(study, role)| study_summary(&asker, store, &user, *role, study)).collect()
    });
    list.await.map(Json)
}

/// One study.
#[utoipa::path(get, path = "/api/studies/{study}", params(("study" = String, Path)),
    responses((status = 200, body = StudyDetail), Problem))]
async fn study(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<StudyDetail>> {
    let (study, asker) = (study_name(&study)?, state.clone());
    access::prepare(&state, &user, &study).await?;
    state.ask(move |store| detail(&asker, store, &user, &study)).await.map(Json)
}

/// Renames, archives or restores a study. While its plan runs, an admin may.
#[utoipa::path(post, path = "/api/studies/{study}/edits", params(("study" = String, Path)), request_body = StudyChange,
    responses((status = 200, body = StudyDetail), Problem))]
async fn edit_study(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
    Json(change): Json<StudyChange>,
) -> Answer<Json<StudyDetail>> {
    let (study, by) = (study_name(&study)?, user.sign());
    let asker = state.clone();
    let detail = state.ask(move |store| {
        user.on_study(store, &study)?;
        let is_open = store.observer(&user.name).visibility(&study)? == Visibility::Open;
        user.need_on_study(store, &study, if is_open { Role::Editor } else { Role::Admin })?;
        let edited = store.edit_study(&study, &change.edit, change.expected_revision, &by);
        // A refused edit is reported too, because it is kept.
        asker.changes.send(&study, of_study(&user));
        edited?;
        detail(&asker, store, &user, &study)
    });
    detail.await.map(Json)
}

/// Plans blinded readings, or changes the plan before the first one. With accounts, every observer needs one that may edit the study.
#[utoipa::path(post, path = "/api/studies/{study}/plan", params(("study" = String, Path)), request_body = NewPlan,
    responses((status = 200, body = StudyDetail), Problem))]
async fn plan(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
    Json(new): Json<NewPlan>,
) -> Answer<Json<StudyDetail>> {
    let study = study_name(&study)?;
    let asker = state.clone();
    let detail = state.ask(move |store| {
        user.need_on_study(store, &study, Role::Admin)?;
        let observers = new.observers.iter().map(|name| Name::new(name));
        let observers = observers.collect::<Result<Vec<_>, _>>()?;
        if asker.options.access == Access::Accounts {
            observers.iter().try_for_each(|name| may_read(store, &study, name))?;
        }
        let NewPlan { repeats, washout_days, proposals, replaces, .. } = new;
        let design = PlanDesign { repeats, washout_days, proposals };
        let (random, by) = (&mut system_random, user.sign());
        match replaces {
            None => store.reading_plan(&study, &observers, design, random, &by)?,
            Some(plan) => store.change_plan(&study, plan, &observers, design, random, &by)?,
        };
        asker.changes.send(&study, of_study(&user));
        detail(&asker, store, &user, &study)
    });
    detail.await.map(Json)
}

/// Refuses an observer who could not place landmarks in the study.
fn may_read(store: &Store, study: &Name, observer: &Name) -> Answer<()> {
    let account = store.accounts()?.into_iter().find(|account| account.name == *observer);
    let trouble = match account {
        None => "has no account",
        Some(account) if !account.enabled => "has a disabled account",
        Some(Account { name, role, .. }) => {
            match (User { name, role }).need_on_study(store, study, Role::Editor) {
                Ok(_) => return Ok(()),
                Err(_) => "may not place landmarks in this study",
            }
        }
    };
    let message = format!("the observer {observer} {trouble}");
    Err(Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "observer", message).help(
        "an observer needs an enabled account with the role `editor`, and that role in the study",
    ))
}

/// The case file of a study, with its finished readings.
#[utoipa::path(get, path = "/api/studies/{study}/case", params(("study" = String, Path)),
    responses((status = 200, content_type = "application/json"), Problem))]
async fn case_file(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Response> {
    let study = study_name(&study)?;
    let file = format!("{study}.json");
    let by = user.sign();
    let case = state.ask(move |store| {
        user.on_study(store, &study)?;
        if store.observer(&user.name).visibility(&study)? != Visibility::Open {
            return Err(access::blinded());
        }
        let case = store.export_case(&study)?;
        store.log_export(&study, "case", &by)?;
        Ok(case)
    });
    Ok(attachment(&file, "application/json", case.await?.text))
}
