//! Local accounts, for admins.

use axum::extract::State;
use spineline_store::{Account, AccountChange, Name, PasswordHash, Role, StoreError};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{AccountEdit, Problem};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(accounts)).routes(routes!(put_account))
}

/// All accounts, by name.
#[utoipa::path(get, path = "/api/accounts", responses((status = 200, body = Vec<Account>), Problem))]
async fn accounts(State(state): State<AppState>, user: User) -> Answer<Json<Vec<Account>>> {
    user.need(Role::Admin)?;
    state.store(|store| store.accounts()).await.map(Json)
}

/// Makes an account, or changes one.
#[utoipa::path(put, path = "/api/accounts/{name}", request_body = AccountEdit,
    params(("name" = String, Path)),
    responses((status = 200, body = Account), Problem))]
async fn put_account(
    State(state): State<AppState>,
    user: User,
    Path(name): Path<String>,
    Json(edit): Json<AccountEdit>,
) -> Answer<Json<Account>> {
    user.need(Role::Admin)?;
    let name = Name::new(&name)?;
    let AccountEdit { role, password, enabled } = edit;
    let password = match password {
        Some(text) => {
            let account = name.clone();
            let made = move || PasswordHash::new(&text, &account);
            Some(state.with_password(&state.passwords, made).await??)
        }
        None => None,
    };
    let by = user.sign();
    let change = AccountChange { role: role.map(|role| role.0), password, enabled };
    let account = state
        .ask(move |store| match store.account(&name) {
            Ok(_) => Ok(store.edit_account(&name, &change, &by)?),
            Err(StoreError::Unknown { .. }) => {
                let (Some(role), Some(password)) = (change.role, &change.password) else {
                    return Err(Failure::refused("a new account needs a role and a password"));
                };
                let account = Account { name, role, enabled: change.enabled.unwrap_or(true) };
                store.add_account(&account, password, &by)?;
                Ok(account)
            }
            Err(error) => Err(error.into()),
        })
        .await?;
    state.changes.rights_changed();
    Ok(Json(account))
}
