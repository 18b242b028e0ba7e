//! A study's results from its finished readings.

use spineline::anatomy::Posture;
use spineline_store::FilmId;

use super::live::overlay_of;
use super::{findings as findings_of, notices};
use crate::access::OpenResult;
use crate::api::{FilmOverlay, LiveStatus, LiveView, Problem};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::result_cache::{Outcome, StudyResult, computed};
use crate::words::{marked_text, progress};

/// Clinical angles and rotations of a study.
#[utoipa::path(get, path = "/api/studies/{study}/findings", params(("study" = String, Path)),
    responses((status = 200, body = LiveView), Problem))]
pub async fn findings(OpenResult(result): OpenResult) -> Answer<Json<LiveView>> {
    computed(move || Json(view(&result))).await
}

fn view(result: &StudyResult) -> LiveView {
    let (status, status_text) = match &result.outcome {
        Outcome::Waiting => (LiveStatus::Partial, progress(&result.current)),
        Outcome::Refused { text, .. } => (LiveStatus::Refused, text.clone()),
        Outcome::Analysed(_) => {
            let erect = result.current.films.get(&Posture::Erect);
            let missing = erect.map(spineline_store::CurrentFilm::missing).unwrap_or_default();
            (LiveStatus::Complete, format!("{} on the erect film", marked_text(&missing)))
        }
    };
    LiveView {
        status,
        status_text,
        overlay: None,
        heights: Vec::new(),
        study: result.analysis().map(findings_of::of_study),
        options_text: result.options_text(),
        notices: notices::with_comparison(result),
    }
}

/// Results of the finished readings for one film.
#[utoipa::path(get, path = "/api/studies/{study}/films/{film}/overlay",
    params(("study" = String, Path), ("film" = i64, Path)),
    responses((status = 200, body = FilmOverlay), Problem))]
pub async fn overlay(
    OpenResult(result): OpenResult,
    Path((_, film)): Path<(String, i64)>,
) -> Answer<Json<FilmOverlay>> {
    let overlay = computed(move || overlay_of(&result, FilmId(film))).await?;
    overlay.map(Json).ok_or_else(Failure::not_found)
}
