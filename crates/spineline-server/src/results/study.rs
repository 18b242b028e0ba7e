//! A study's results from its finished readings.

use axum::extract::State;
use axum::response::Response;
use chrono::{SecondsFormat, Utc};
use spineline::analysis::{Analysis, Case};
use spineline::anatomy::Posture;
use spineline_files::{AnalysisFile, CaseFile, FilmOrigin, ProgramRun, Provenance, Request};
use spineline_store::FilmId;

use super::live::overlay_of;
use super::{findings as findings_of, notices};
use crate::access::open_study;
use crate::access::study_result;
use crate::api::{FilmOverlay, LiveStatus, LiveView, Problem};
use crate::attachment::attachment;
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::result_cache::{Outcome, StudyResult, computed};
use crate::session::User;
use crate::state::AppState;
use crate::words::{marked_text, progress};

/// This program and its version, as files name what wrote them.
pub const PROGRAM: &str = concat!("spineline ", env!("CARGO_PKG_VERSION"));

/// The analysis file of a study, as `spineline analyze` writes it.
#[utoipa::path(get, path = "/api/studies/{study}/analysis.json",
    params(("study" = String, Path)),
    responses((status = 200, content_type = "application/json"), (status = 409, body = Problem)))]
pub async fn analysis_file(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Response> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    let file = computed(move || {
        let case = result.current.usable_case();
        result.analysed().map(|analysis| spineline_files::to_text(&file_of(analysis, &case)))
    });
    let text = file.await??;
    Ok(attachment(&format!("{study}-analysis.json"), "application/json", text))
}

/// The analysis file of an analysis of this case. Its input is the store; the case is part of the file.
pub fn file_of(analysis: &Analysis, case: &Case) -> AnalysisFile {
    let run = ProgramRun {
        program: PROGRAM.to_owned(),
        command: vec!["spineline".to_owned(), "serve".to_owned()],
        date_utc: Utc::now().to_rfc3339_opts(SecondsFormat::Secs, true),
    };
    let films = FilmOrigin::of([analysis.synthetic]);
    let request = Request { options: analysis.options.clone(), ..Request::default() };
    let provenance = Provenance::new(run, films, Vec::new()).asking(&request);
    AnalysisFile::new(analysis, CaseFile::from_case(case), provenance)
}

/// Clinical angles and rotations of a study.
#[utoipa::path(get, path = "/api/studies/{study}/findings", params(("study" = String, Path)),
    responses((status = 200, body = LiveView), (status = 403, body = Problem)))]
pub async fn findings(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Json<LiveView>> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    computed(move || Json(view(&result))).await
}

fn view(result: &StudyResult) -> LiveView {
    let (status, status_text) = match &result.outcome {
        Outcome::Waiting => (LiveStatus::Partial, progress(&result.current)),
        Outcome::Refused { text, .. } => (LiveStatus::Refused, text.clone()),
        Outcome::Analysed(_) => {
            let erect = result.current.film(Posture::Erect);
            let missing = erect.map(spineline_store::CurrentFilm::missing).unwrap_or_default();
            (LiveStatus::Complete, format!("{} on the erect film", marked_text(&missing)))
        }
    };
    LiveView {
        status,
        status_text,
        overlay: None,
        study: result.analysis().map(findings_of::of_study),
        notices: notices::of_result(result),
    }
}

/// Results of the finished readings for one film.
#[utoipa::path(get, path = "/api/studies/{study}/films/{film}/overlay",
    params(("study" = String, Path), ("film" = i64, Path)),
    responses((status = 200, body = FilmOverlay), (status = 404, body = Problem)))]
pub async fn overlay(
    State(state): State<AppState>,
    user: User,
    Path((study, film)): Path<(String, i64)>,
) -> Answer<Json<FilmOverlay>> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    let overlay = computed(move || overlay_of(&result, FilmId(film))).await?;
    overlay.map(Json).ok_or_else(Failure::not_found)
}
