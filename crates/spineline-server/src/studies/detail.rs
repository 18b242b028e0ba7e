//! One study as a user sees it, and a change of it.

use spineline_store::{Name, Next, Role, Store, Timestamp, Visibility};

use super::summary::study_summary;
use crate::api::{Change, NextReading, PlanView, StudyDetail};
use crate::problem::Answer;
use crate::readings;
use crate::state::AppState;
use crate::user::User;

/// A study with its lost changes and its plan.
pub fn detail(state: &AppState, store: &Store, user: &User, study: &Name) -> Answer<StudyDetail> {
    let role = user.on_study(store, study)?;
    let record = store.study(study)?;
    let summary = study_summary(state, store, user, role, &record)?;
    let visibility = store.observer(&user.name).visibility(study)?;
    let mut conflicts = Vec::new();
    if visibility != Visibility::Reader {
        conflicts.extend(readings::lost_of_study(store, study)?);
        for film in store.films(study)? {
            conflicts.extend(readings::lost_of_film(store, &film)?);
        }
    }
    if visibility == Visibility::Open {
        conflicts.extend(readings::lost_of_options(store, study)?);
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
    // Observers do not see who else reads.
    let is_lead = visibility == Visibility::Apart && user.role == Role::Admin;
    let change = if is_lead { store.open_plan(study)? } else { None };
    Ok(Some(PlanView { blinded: visibility != Visibility::Open, next, change }))
}

/// A change of the study as a whole.
pub fn of_study(user: &User) -> Change {
    Change { who: user.name.to_string(), film: None, reading: None, revision: None }
}
