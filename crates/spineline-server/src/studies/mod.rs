//! Studies: list, create, read, export.

mod make;
mod summary;

use axum::extract::State;
use axum::http::StatusCode;
use axum::response::Response;
use spineline_store::{
    Access, Account, Name, Next, PlanDesign, Role, Store, Timestamp, Visibility, system_random,
};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{self, study_name};
use crate::api::{Change, NewPlan, NextReading, PlanView, Problem, StudyDetail, StudySummary};
use crate::attachment::attachment;
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::readings;
use crate::state::AppState;
use crate::user::User;

pub use summary::{film_summary, study_summary};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list))
        .routes(routes!(study))
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
    responses((status = 200, body = StudyDetail), (status = 404, body = Problem)))]
async fn study(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<StudyDetail>> {
    let (study, asker) = (study_name(&study)?, state.clone());
    access::prepare(&state, &user, &study).await?;
    state.ask(move |store| detail(&asker, store, &user, &study)).await.map(Json)
}

/// A study with its lost changes and its plan.
pub fn detail(state: &AppState, store: &Store, user: &User, study: &Name) -> Answer<StudyDetail> {
    let role = user.on_study(store, study)?;
    let record = store.study(study)?;
    let summary = study_summary(state, store, user, role, &record)?;
    let visibility = store.observer(&user.name).visibility(study)?;
    let mut conflicts = Vec::new();
    if visibility != Visibility::Reader {
        for film in store.films(study)? {
            conflicts.extend(readings::lost_of_film(store, &film)?);
        }
    }
    if visibility == Visibility::Open {
        for reading in store.readings(study)? {
            conflicts.extend(readings::lost_of_reading(store, reading.id)?);
        }
    }
    Ok(StudyDetail {
        summary,
        conflicts,
        plan: plan_view(store, user, study, visibility, state.now())?,
    })
}

fn plan_view(
    store: &Store,
    user: &User,
    study: &Name,
    visibility: Visibility,
    now: Timestamp,
) -> Answer<Option<PlanView>> {
    if !store.has_plan(study)? {
        return Ok(None);
    }
    let next = match store.observer(&user.name).next_film_for(study, now)? {
        // A code opens a film.
        _ if visibility == Visibility::Reader && user.on_study(store, study)? < Role::Editor => {
            NextReading::NotAllowed
        }
        Next::Begin(film) => NextReading::Begin { code: film.code.to_string() },
        Next::Continue(film, reading) => {
            NextReading::Continue { code: film.code.to_string(), reading: reading.0 }
        }
        Next::Wait(until) => NextReading::Wait { until_ms: until.unix_ms() },
        Next::Done => NextReading::Done,
    };
    Ok(Some(PlanView { blinded: visibility != Visibility::Open, next }))
}

/// Plans blinded readings. With accounts, every observer needs one that may edit the study.
#[utoipa::path(post, path = "/api/studies/{study}/plan", params(("study" = String, Path)), request_body = NewPlan,
    responses((status = 200, body = StudyDetail), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn plan(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
    Json(new): Json<NewPlan>,
) -> Answer<Json<StudyDetail>> {
    let (study, now) = (study_name(&study)?, state.now());
    let asker = state.clone();
    let detail = state.ask(move |store| {
        user.need_on_study(store, &study, Role::Admin)?;
        let observers = new.observers.iter().map(|name| Name::new(name));
        let observers = observers.collect::<Result<Vec<_>, _>>()?;
        if asker.options().access == Access::Accounts {
            observers.iter().try_for_each(|name| may_read(store, &study, name))?;
        }
        let NewPlan { repeats, washout_days, proposals, .. } = new;
        let design = PlanDesign { repeats, washout_days, proposals };
        store.reading_plan(&study, &observers, design, &mut system_random, &user.sign(now))?;
        asker.changes().send(&study, of_study(&user));
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

/// A change of the study as a whole.
pub fn of_study(user: &User) -> Change {
    Change { who: user.name.to_string(), film: None, reading: None, revision: None }
}

/// The case file of a study, with its finished readings.
#[utoipa::path(get, path = "/api/studies/{study}/case", params(("study" = String, Path)),
    responses((status = 200, content_type = "application/json"), (status = 404, body = Problem),
        (status = 422, body = Problem)))]
async fn case_file(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Response> {
    let study = study_name(&study)?;
    let file = format!("{study}.json");
    let by = user.sign(state.now());
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
