//! Permissions in a study, for admins.

use axum::extract::State;
use spineline_store::{Name, Role, Store, StoreError};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::study_name;
use crate::api::{Grant, Problem, Wire};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(grants, put_grants))
}

/// The grants of a study, by name. Admins need no grant.
#[utoipa::path(get, path = "/api/studies/{id}/grants", params(("id" = String, Path)), responses((status = 200, body = Vec<Grant>), Problem))]
async fn grants(
    State(state): State<AppState>,
    user: User,
    Path(id): Path<String>,
) -> Answer<Json<Vec<Grant>>> {
    let study = study_name(&id)?;
    let grants = state
        .ask(move |store| {
            user.need_on_study(store, &study, Role::Admin)?;
            views(store, &study)
        })
        .await?;
    Ok(Json(grants))
}

/// Replaces the grants of a study. Accounts that are not listed can no longer see it.
#[utoipa::path(put, path = "/api/studies/{id}/grants", request_body = Vec<Grant>,
    params(("id" = String, Path)),
    responses((status = 200, body = Vec<Grant>), Problem))]
async fn put_grants(
    State(state): State<AppState>,
    user: User,
    Path(id): Path<String>,
    Json(wanted): Json<Vec<Grant>>,
) -> Answer<Json<Vec<Grant>>> {
    let study = study_name(&id)?;
    let by = user.sign();
    let grants = state
        .ask(move |store| {
            user.need_on_study(store, &study, Role::Admin)?;
            let wanted = wanted.iter().map(parse).collect::<Answer<Vec<_>>>()?;
            store.set_grants(&study, &wanted, &by).map_err(|error| match error {
                StoreError::Unknown { .. } => Failure::refused("no account has this name"),
                other => other.into(),
            })?;
            views(store, &study)
        })
        .await?;
    state.changes.rights_changed();
    Ok(Json(grants))
}

fn parse(grant: &Grant) -> Answer<(Name, spineline_store::Role)> {
    if grant.role.0 == Role::Admin {
        return Err(Failure::refused("the role in a study must be `reader` or `editor`"));
    }
    Ok((Name::new(&grant.name)?, grant.role.0))
}

fn views(store: &Store, study: &Name) -> Answer<Vec<Grant>> {
    let grants = store.grants(study)?.into_iter();
    Ok(grants.map(|g| Grant { name: g.name.to_string(), role: Wire(g.role) }).collect())
}
