//! Studies: listed, made, looked at, exported.

mod summary;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::api::{
    Change, NewPlan, NextReading, PlanView, Problem, RoleName, StudyDetail, StudySummary,
};
use super::{Answer, AppState, Failure, User, readings};
use crate::store::{Name, Next, PlanDesign, Sight, Store, Timestamp};

pub use summary::{Overviews, film_summary, study_summary};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(list))
        .routes(routes!(study))
        .routes(routes!(plan))
        .routes(routes!(case_file))
}

/// A study's name in an address. A name that none can have is not there.
pub fn study_name(text: &str) -> Answer<Name> {
    Name::new(text).map_err(|_| Failure::not_found())
}

/// What a user may do in a study; a study that is not theirs to see is not there.
pub fn role_in(store: &Store, user: &User, study: &Name) -> Answer<RoleName> {
    store.study(study)?;
    Ok(user.role)
}

/// Refuses those who may not change a study.
pub fn may_edit(store: &Store, user: &User, study: &Name) -> Answer<()> {
    match role_in(store, user, study)? {
        RoleName::Reader => Err(forbidden("only its editors change a study")),
        RoleName::Editor | RoleName::Admin => Ok(()),
    }
}

fn forbidden(text: &str) -> Failure {
    Failure::new(axum::http::StatusCode::FORBIDDEN, "forbidden", text)
        .help("ask an admin for the right to do so")
}

/// The studies that the one who asks may see.
#[utoipa::path(get, path = "/api/studies", responses((status = 200, body = [StudySummary])))]
async fn list(State(state): State<AppState>, user: User) -> Answer<Json<Vec<StudySummary>>> {
    let asker = state.clone();
    let list = state.answer(move |store| {
        let mut summaries = Vec::new();
        for study in store.studies()? {
            if let Ok(role) = role_in(store, &user, &study.id) {
                summaries.push(study_summary(asker.studies(), store, &user, role, &study)?);
            }
        }
        Ok(summaries)
    });
    list.await.map(Json)
}

/// One study.
#[utoipa::path(get, path = "/api/studies/{study}",
    responses((status = 200, body = StudyDetail), (status = 404, body = Problem)))]
async fn study(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<StudyDetail>> {
    let (study, now) = (study_name(&study)?, state.now());
    let asker = state.clone();
    state.answer(move |store| detail(asker.studies(), store, &user, &study, now)).await.map(Json)
}

/// A study with its lost changes and its plan.
pub fn detail(
    overviews: &Overviews,
    store: &Store,
    user: &User,
    study: &Name,
    now: Timestamp,
) -> Answer<StudyDetail> {
    let role = role_in(store, user, study)?;
    let record = store.study(study)?;
    let summary = study_summary(overviews, store, user, role, &record)?;
    let sight = store.observer(&user.name).sight(study)?;
    let mut conflicts = Vec::new();
    if sight != Sight::Reader {
        for film in store.films(study)? {
            conflicts.extend(readings::lost_of_film(store, film.id)?);
        }
    }
    if sight == Sight::Open {
        for reading in store.readings(study)? {
            conflicts.extend(readings::lost_of_reading(store, reading.id)?);
        }
    }
    Ok(StudyDetail { summary, conflicts, plan: plan_view(store, user, study, sight, now)? })
}

fn plan_view(
    store: &Store,
    user: &User,
    study: &Name,
    sight: Sight,
    now: Timestamp,
) -> Answer<Option<PlanView>> {
    if !store.has_plan(study)? {
        return Ok(None);
    }
    let next = match store.observer(&user.name).next_film_for(study, now)? {
        Next::Begin(film) => NextReading::Begin { code: film.code.to_string() },
        Next::Continue(film, reading) => {
            NextReading::Continue { code: film.code.to_string(), reading: reading.0 }
        }
        Next::Wait(until) => NextReading::Wait { until_ms: until.unix_ms() },
        Next::Done => NextReading::Done,
    };
    Ok(Some(PlanView { blinded: sight != Sight::Open, next }))
}

/// Plans blinded readings.
#[utoipa::path(post, path = "/api/studies/{study}/plan", request_body = NewPlan,
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
    let detail = state.answer(move |store| {
        if role_in(store, &user, &study)? != RoleName::Admin {
            return Err(forbidden("only an admin plans readings"));
        }
        let observers = new.observers.iter().map(|name| Name::new(name));
        let observers = observers.collect::<Result<Vec<_>, _>>()?;
        let NewPlan { repeats, washout_days, seed, .. } = new;
        let design = PlanDesign { repeats, washout_days, seed };
        store.reading_plan(&study, &observers, design, &user.sign(now))?;
        asker.changes().tell(&study, of_study(&user));
        detail(asker.studies(), store, &user, &study, now)
    });
    detail.await.map(Json)
}

/// A change of the study as a whole.
pub fn of_study(user: &User) -> Change {
    Change { who: user.name.to_string(), film: None, reading: None, revision: None }
}

/// The case file of a study, with its finished readings.
#[utoipa::path(get, path = "/api/studies/{study}/case",
    responses((status = 200, content_type = "application/json"), (status = 404, body = Problem),
        (status = 422, body = Problem)))]
async fn case_file(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Response> {
    let study = study_name(&study)?;
    // A study's name has no character that a file's name may not have.
    let attachment = format!("attachment; filename=\"{study}.json\"");
    let case = state.answer(move |store| {
        role_in(store, &user, &study)?;
        if store.observer(&user.name).sight(&study)? != Sight::Open {
            return Err(forbidden("readings are blinded until all of the plan are finished"));
        }
        Ok(store.export_case(&study)?)
    });
    let headers = [
        (header::CONTENT_TYPE, "application/json".to_owned()),
        (header::CONTENT_DISPOSITION, attachment),
    ];
    Ok((headers, case.await?.text).into_response())
}
