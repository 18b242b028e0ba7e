//! Access of a user to studies, films, readings and results.

use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::StatusCode;
use axum::http::request::Parts;
use serde::Deserialize;
use spineline_store::{
    CaseReadings, FilmId, FilmRecord, Name, ReadingId, Role, SeenReading, Store, StoreError, Study,
    Visibility,
};

use crate::extract::Path;
use crate::problem::{Answer, Failure};
use crate::result_cache::{StudyResult, computed};
use crate::state::AppState;
use crate::user::User;

/// A study's name in an address. An impossible name is answered as not found.
pub fn study_name(text: &str) -> Answer<Name> {
    Name::new(text).map_err(|_| Failure::not_found())
}

/// A film that this user may see.
pub fn seen_film(store: &Store, user: &User, film: FilmId) -> Answer<FilmRecord> {
    let film = store.film(film)?;
    user.on_study(store, &film.study)?;
    // A blinded reader sees codes only.
    match store.observer(&user.name).visibility(&film.study)? {
        Visibility::Reader => Err(Failure::not_found()),
        Visibility::Open | Visibility::Apart => Ok(film),
    }
}

/// A reading that this user may see; a reading of others is answered as not found. While its plan is incomplete, a
/// user's finished reading is hidden.
pub fn seen_reading(store: &Store, user: &User, reading: ReadingId) -> Answer<SeenReading> {
    let seen = store.observer(&user.name).reading(reading).map_err(|error| match error {
        StoreError::NotYours { .. } => Failure::not_found(),
        StoreError::Finished { .. } => {
            let text = "a finished reading is shown when all planned readings are finished";
            let hidden = Failure::new(StatusCode::FORBIDDEN, "blinded", text);
            hidden.help("go on with your next film")
        }
        other => other.into(),
    })?;
    user.on_study(store, &seen.study.id)?;
    Ok(seen)
}

/// Results of the finished readings of a study; the store is not locked during the computation.
pub async fn study_result(state: &AppState, study: &Name) -> Answer<Arc<StudyResult>> {
    let (cache, name) = (state.clone(), study.clone());
    let found = state.store(move |store| {
        let sequence = store.last_result_change(&name)?.sequence;
        Ok(match cache.results.get(&name, sequence) {
            Some(result) => Ok(result),
            None => Err((sequence, store.current_case(&name, CaseReadings::Finished)?)),
        })
    });
    match found.await? {
        Ok(result) => Ok(result),
        Err((sequence, current)) => {
            let (state, name) = (state.clone(), study.clone());
            computed(move || {
                let result = StudyResult::of(&name, current);
                // The list of studies needs it, and reads it while it holds the store.
                result.models_verdict();
                state.results.keep(sequence, result)
            })
            .await
        }
    }
}

/// Whether results of a study may be shown to somebody who may see it.
///
/// While a plan of blinded readings is incomplete, only leaders who do not read see results.
pub fn sees_results(store: &Store, user: &User, study: &Name) -> Result<bool, StoreError> {
    Ok(match store.observer(&user.name).visibility(study)? {
        Visibility::Open => true,
        Visibility::Reader => false,
        Visibility::Apart => user.role == Role::Admin,
    })
}

/// Results are hidden.
pub fn blinded() -> Failure {
    Failure::new(
        StatusCode::FORBIDDEN,
        "blinded",
        "results are shown when all planned readings are finished",
    )
    .help("finish your readings first; until then the study is hidden from its observers")
}

/// The study of an address whose results the requester may see; else a refusal: unknown, or blinded.
pub struct OpenStudy(pub Name);

/// Results of an [`OpenStudy`].
pub struct OpenResult(pub Arc<StudyResult>);

/// Results with an analysis, of an [`OpenStudy`] that the requester may edit.
pub struct EditorResult(pub Arc<StudyResult>);

/// The part of an address that names a study.
#[derive(Deserialize)]
struct InStudy {
    study: String,
}

impl FromRequestParts<AppState> for OpenStudy {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Answer<Self> {
        let user = User::from_request_parts(parts, state).await?;
        let Path(InStudy { study }) = Path::from_request_parts(parts, state).await?;
        let study = study_name(&study)?;
        if shows_results(state, &user, &study).await? { Ok(Self(study)) } else { Err(blinded()) }
    }
}

impl FromRequestParts<AppState> for OpenResult {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Answer<Self> {
        let OpenStudy(study) = OpenStudy::from_request_parts(parts, state).await?;
        study_result(state, &study).await.map(Self)
    }
}

impl FromRequestParts<AppState> for EditorResult {
    type Rejection = Failure;

    async fn from_request_parts(parts: &mut Parts, state: &AppState) -> Answer<Self> {
        let user = User::from_request_parts(parts, state).await?;
        let OpenStudy(study) = OpenStudy::from_request_parts(parts, state).await?;
        let of = study.clone();
        state.ask(move |store| user.need_on_study(store, &of, Role::Editor)).await?;
        let result = study_result(state, &study).await?;
        result.analysed()?;
        Ok(Self(result))
    }
}

/// As [`sees_results`], for a study that the user must be allowed to see.
async fn shows_results(state: &AppState, user: &User, study: &Name) -> Answer<bool> {
    let (user, study) = (user.clone(), study.clone());
    let asked = state.ask(move |store| {
        user.on_study(store, &study)?;
        Ok(sees_results(store, &user, &study)?)
    });
    asked.await
}

/// Computes the results of a study before the store is locked for them; does nothing where they are hidden. Errors of
/// the computation are reported where the results are requested.
///
/// # Errors
/// 404 where the user may not see the study.
pub async fn prepare(state: &AppState, user: &User, study: &Name) -> Answer<()> {
    if shows_results(state, user, study).await? {
        let _ = study_result(state, study).await;
    }
    Ok(())
}

/// The studies that a user may see, with their permissions; [`prepare`] computes the visible results.
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
