//! The report of a study, as `spineline report` writes it.

use axum::extract::State;
use axum::response::Response;
use spineline_report::figures::FilmPicture;
use spineline_report::html;
use spineline_report::patient::{self, Patient};

use super::study::{PROGRAM, file_of};
use crate::access::{open_study, study_result};
use crate::api::Problem;
use crate::attachment::attachment;
use crate::decoded::picture;
use crate::extract::Path;
use crate::problem::Answer;
use crate::result_cache::{StudyResult, computed};
use crate::session::User;
use crate::state::AppState;

/// The HTML report of a study from its finished readings, with its films. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/report", params(("study" = String, Path)),
    responses((status = 200, content_type = "text/html"), (status = 403, body = Problem),
        (status = 404, body = Problem), (status = 409, body = Problem),
        (status = 422, body = Problem)))]
pub async fn report(
    State(state): State<AppState>,
    user: User,
    Path(study): Path<String>,
) -> Answer<Response> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    result.analysed()?;
    let pictures = pictures(&state, &result).await?;
    let text = computed(move || {
        let case = result.current.usable_case();
        result.analysed().map(|analysis| {
            html(&patient::report(&Patient {
                case: &case,
                analysis,
                pictures: &pictures,
                identifiability: None,
                uncertainty: None,
                generator: PROGRAM,
                json: &spineline_files::to_line(&file_of(analysis, &case)),
            }))
        })
    });
    let text = text.await??;
    let (logged, by) = (study.clone(), user.sign(state.now()));
    state.store(move |store| store.log_report(&logged, &by)).await?;
    Ok(attachment(&format!("{study}.html"), "text/html; charset=utf-8", text))
}

/// The films with landmarks that are used, as pictures.
async fn pictures(state: &AppState, result: &StudyResult) -> Answer<Vec<FilmPicture>> {
    let mut pictures = Vec::new();
    for film in result.current.films.iter().filter(|film| film.is_usable()) {
        let png = picture(state, &film.record).await?;
        pictures.push(FilmPicture { posture: film.record.posture, png });
    }
    Ok(pictures)
}
