//! Who sees results of a study, and the results of what is seen.

use axum::http::StatusCode;
use spineline_store::{Name, Role, Sight, Store, StoreError, Study};

use super::cache::study_result;
use crate::http::studies::study_name;
use crate::http::{Answer, AppState, Failure, User};

/// Whether results of a study may be shown to somebody who may see it.
///
/// While a plan of blinded readings is incomplete, only those who lead and do not read see results.
///
/// # Errors
/// Whatever the store refuses.
pub fn sees_results(store: &Store, user: &User, study: &Name) -> Result<bool, StoreError> {
    Ok(match store.observer(&user.name).sight(study)? {
        Sight::Open => true,
        Sight::Reader => false,
        Sight::Apart => user.role == Role::Admin,
    })
}

/// Results are hidden.
pub fn blinded() -> Failure {
    Failure::new(
        StatusCode::FORBIDDEN,
        "blinded",
        "results wait until all planned readings are finished",
    )
    .help("finish your readings; nothing of the study is shown to its readers before")
}

/// A study whose results whoever asks may see.
///
/// # Errors
/// A refusal: unknown, or blinded.
pub async fn open_study(state: &AppState, user: &User, study: &str) -> Answer<Name> {
    let name = study_name(study)?;
    if shows_results(state, user, &name).await? { Ok(name) } else { Err(blinded()) }
}

/// As [`sees_results`], of a study that must be theirs to see.
async fn shows_results(state: &AppState, user: &User, study: &Name) -> Answer<bool> {
    let (user, study) = (user.clone(), study.clone());
    let asked = state.ask(move |store| {
        user.on_study(store, &study)?;
        Ok(sees_results(store, &user, &study)?)
    });
    asked.await
}

/// Has the results of a study computed before the store is asked for them, so that it is free meanwhile; nothing where they
/// are hidden. What keeps them from being computed is told where they are asked for.
///
/// # Errors
/// 404 where the study is not theirs to see.
pub async fn prepare(state: &AppState, user: &User, study: &Name) -> Answer<()> {
    if shows_results(state, user, study).await? {
        let _ = study_result(state, study).await;
    }
    Ok(())
}

/// The studies that they may see, with what they may do there; the results that they see are computed, as by [`prepare`].
///
/// # Errors
/// Whatever keeps the store from reading.
pub async fn prepared(state: &AppState, user: &User) -> Answer<Vec<(Study, Role)>> {
    let user = user.clone();
    let found = state.ask(move |store| {
        let studies = user.studies(store)?;
        let mut open = Vec::new();
        for (study, _) in &studies {
            if sees_results(store, &user, &study.id)? {
                open.push(study.id.clone());
            }
        }
        Ok((studies, open))
    });
    let (studies, open) = found.await?;
    for study in &open {
        let _ = study_result(state, study).await;
    }
    Ok(studies)
}
