//! Withdrawals and corrections of readings.

use axum::extract::State;
use spineline_store::{ReadingId, Role, Withdrawal, WithdrawalCause};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::announced;
use crate::access::seen_reading;
use crate::api::{NewWithdrawal, Problem, ReadingView, WithdrawalView};
use crate::extract::{Json, Path};
use crate::problem::Answer;
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(withdraw)).routes(routes!(correct))
}

/// Withdraws a reading: it stays in the store and counts nowhere. Its observer may do so, or an admin.
#[utoipa::path(post, path = "/api/readings/{reading}/withdrawal", params(("reading" = i64, Path)),
    request_body = NewWithdrawal,
    responses((status = 200, body = ReadingView), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn withdraw(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    Json(new): Json<NewWithdrawal>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign(state.now());
    let asker = state.clone();
    let view = state.ask(move |store| {
        let seen = seen_reading(store, &user, ReadingId(reading))?;
        let is_own = seen.record.observer == user.name;
        let least = if is_own { Role::Editor } else { Role::Admin };
        user.need_on_study(store, &seen.study.id, least)?;
        store.withdraw_reading(seen.record.id, &new.reason, &by)?;
        announced(&asker, store, &user, seen.record.id)
    });
    view.await.map(Json)
}

/// Begins a correction of a finished reading of the requester: a copy with all landmarks, which replaces the reading when it is
/// finished.
#[utoipa::path(post, path = "/api/readings/{reading}/correction", params(("reading" = i64, Path)),
    responses((status = 200, body = ReadingView), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
async fn correct(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<ReadingView>> {
    let by = user.sign(state.now());
    let asker = state.clone();
    let view = state.ask(move |store| {
        let seen = seen_reading(store, &user, ReadingId(reading))?;
        user.need_on_study(store, &seen.study.id, Role::Editor)?;
        let correction = store.correct_reading(seen.record.id, &by)?;
        announced(&asker, store, &user, correction)
    });
    view.await.map(Json)
}

pub fn withdrawal_view(withdrawal: &Withdrawal) -> WithdrawalView {
    WithdrawalView {
        who: withdrawal.who.to_string(),
        at_ms: withdrawal.at.unix_ms(),
        reason: match &withdrawal.cause {
            WithdrawalCause::Reason(reason) => Some(reason.clone()),
            WithdrawalCause::CorrectedBy(_) => None,
        },
    }
}
