//! Films from the image archives that the administrator allowed. An opened film becomes an upload.

use axum::extract::State;
use spineline_dicomweb::{Client, FilmUid, Search, SeriesUid};
use spineline_films::FilmFile;
use spineline_store::Role;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{
    ArchiveFilmChoice, ArchiveFilmList, ArchiveSearch, ArchiveSeriesChoice, ArchiveSeriesList,
    Problem, UploadView,
};
use crate::extract::Json;
use crate::films::stage;
use crate::problem::Answer;
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(archives))
        .routes(routes!(search))
        .routes(routes!(films))
        .routes(routes!(open))
}

/// Names of the archives from which films can be opened; none where `serve` was started without `--dicomweb`.
#[utoipa::path(get, path = "/api/archives",
    responses((status = 200, body = Vec<String>), Problem))]
async fn archives(State(state): State<AppState>, _user: User) -> Json<Vec<String>> {
    Json(state.archives.names())
}

/// Searches an archive for the films of one patient or one order. The log of the store has an entry for it, without the value.
#[utoipa::path(post, path = "/api/archives/search", request_body = ArchiveSearch,
    responses((status = 200, body = ArchiveSeriesList), Problem))]
async fn search(
    State(state): State<AppState>,
    user: User,
    Json(asked): Json<ArchiveSearch>,
) -> Answer<Json<ArchiveSeriesList>> {
    user.need(Role::Editor)?;
    let archives = &state.archives;
    let archive = archives.named(&asked.archive)?;
    let search = Search::new(asked.key, &asked.value)?;
    let search = match asked.day {
        Some(day) => search.on(&day)?,
        None => search,
    };
    let asks = archive.clone();
    let ask = move |client: &Client| client.search(&asks, &search);
    let found = archives.search(ask).await?;
    archives.keep_patients(&archive, &found.all);
    log(&state, &user, "search", asked.archive).await?;
    Ok(Json(ArchiveSeriesList { series: found.all, has_more: found.has_more }))
}

/// The films of a series in an archive.
#[utoipa::path(post, path = "/api/archives/films", request_body = ArchiveSeriesChoice,
    responses((status = 200, body = ArchiveFilmList), Problem))]
async fn films(
    State(state): State<AppState>,
    user: User,
    Json(asked): Json<ArchiveSeriesChoice>,
) -> Answer<Json<ArchiveFilmList>> {
    user.need(Role::Editor)?;
    let archives = &state.archives;
    let archive = archives.named(&asked.archive)?;
    let series = SeriesUid::new(&asked.study, &asked.series)?;
    let ask = move |client: &Client| client.films(&archive, &series);
    let found = archives.search(ask).await?;
    Ok(Json(ArchiveFilmList { films: found.all, has_more: found.has_more }))
}

/// Opens a film of an archive, if the answer is that film and belongs to the patient of the search. It becomes an
/// upload, with the same checks and limits. The log of the store has an entry for it.
#[utoipa::path(post, path = "/api/archives/open", request_body = ArchiveFilmChoice,
    responses((status = 200, body = UploadView), Problem))]
async fn open(
    State(state): State<AppState>,
    user: User,
    Json(asked): Json<ArchiveFilmChoice>,
) -> Answer<Json<UploadView>> {
    user.need(Role::Editor)?;
    let archives = &state.archives;
    let archive = archives.named(&asked.archive)?;
    let film = FilmUid::new(SeriesUid::new(&asked.study, &asked.series)?, &asked.instance)?;
    let (asks, asked_film) = (archive.clone(), film.clone());
    let ask = move |client: &Client| client.retrieve(&asks, &asked_film);
    let bytes = archives.retrieve(ask).await?;
    log(&state, &user, "retrieve", asked.archive).await?;
    let room = state.films.uploads.reserve(&user.name, bytes.len() as u64, state.now())?;
    let is_asked = |found: &FilmFile| archives.check(&archive, &film, found);
    stage(&state, &user, room, bytes, is_asked).await.map(Json)
}

/// Logs who queried an archive, but not for which patient.
async fn log(state: &AppState, user: &User, what: &'static str, archive: String) -> Answer<()> {
    let by = user.sign();
    state.store(move |store| store.log_archive(what, &archive, &by)).await
}
