//! Films: pixels, thumbnails, and changes of their records.

mod drawn;
mod uploads;

pub use uploads::stage;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode};
use axum::response::Response;
use spineline::measure::{ImageGeometry, Spacing};
use spineline::spatial::Pixel;
use spineline_marking::Calibration;
use spineline_store::{FilmEdit, FilmId, FilmRecord, ReadingId, Role};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::{seen_film, seen_reading};
use crate::api::{Change, FilmChange, FilmEditName, FilmSummary, Problem};
use crate::attachment::png;
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;
use crate::{decoded, studies, words};

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(film_pixels))
        .routes(routes!(reading_pixels))
        .routes(routes!(film_thumbnail))
        .routes(routes!(reading_thumbnail))
        .routes(routes!(edit))
        .merge(drawn::routes())
        .merge(uploads::routes())
}

/// Pixels of a film by rows: bytes where `x-spineline-max` is 255 or less, else 16-bit little-endian words; larger values are
/// brighter.
#[utoipa::path(get, path = "/api/films/{film}/pixels", params(("film" = i64, Path)),
    responses((status = 200, content_type = "application/octet-stream"), Problem))]
async fn film_pixels(
    State(state): State<AppState>,
    user: User,
    Path(film): Path<i64>,
    asked: HeaderMap,
) -> Answer<Response> {
    let film = state.ask(move |store| seen_film(store, &user, FilmId(film))).await?;
    pixels(&state, &film, &asked).await
}

/// Pixels of the film of a reading, in the same format.
#[utoipa::path(get, path = "/api/readings/{reading}/pixels", params(("reading" = i64, Path)),
    responses((status = 200, content_type = "application/octet-stream"), Problem))]
async fn reading_pixels(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
    asked: HeaderMap,
) -> Answer<Response> {
    let seen = state.ask(move |store| seen_reading(store, &user, ReadingId(reading))).await?;
    pixels(&state, &seen.film, &asked).await
}

/// A thumbnail of a film.
#[utoipa::path(get, path = "/api/films/{film}/thumbnail", params(("film" = i64, Path)),
    responses((status = 200, content_type = "image/png"), Problem))]
async fn film_thumbnail(
    State(state): State<AppState>,
    user: User,
    Path(film): Path<i64>,
) -> Answer<Response> {
    let film = state.ask(move |store| seen_film(store, &user, FilmId(film))).await?;
    thumbnail(&state, &film).await
}

/// A thumbnail of the film of a reading.
#[utoipa::path(get, path = "/api/readings/{reading}/thumbnail", params(("reading" = i64, Path)),
    responses((status = 200, content_type = "image/png"), Problem))]
async fn reading_thumbnail(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Response> {
    let seen = state.ask(move |store| seen_reading(store, &user, ReadingId(reading))).await?;
    thumbnail(&state, &seen.film).await
}

/// Changes a film's record.
#[utoipa::path(post, path = "/api/films/{film}/edits", params(("film" = i64, Path)), request_body = FilmChange,
    responses((status = 200, body = FilmSummary), Problem))]
async fn edit(
    State(state): State<AppState>,
    user: User,
    Path(film): Path<i64>,
    Json(change): Json<FilmChange>,
) -> Answer<Json<FilmSummary>> {
    let by = user.sign();
    let asker = state.clone();
    let summary = state.ask(move |store| {
        let film = seen_film(store, &user, FilmId(film))?;
        user.need_on_study(store, &film.study, Role::Editor)?;
        let edit = film_edit(&film, change.edit)?;
        let edited = store.edit_film(film.id, edit, change.expected_revision, &by);
        // A refused edit is reported too, because it is kept.
        let who = user.name.to_string();
        let revision = edited.as_ref().ok().map(|edited| edited.revision);
        let change = Change { who, film: Some(film.id.0), reading: None, revision };
        asker.changes.send(&film.study, change);
        edited?;
        studies::film_summary(&asker, store, &user, film.id)
    });
    summary.await.map(Json)
}

fn film_edit(film: &FilmRecord, edit: FilmEditName) -> Answer<FilmEdit> {
    Ok(match edit {
        FilmEditName::Posture { posture } => FilmEdit::Posture(posture.0),
        FilmEditName::Inverted { inverted } => FilmEdit::Inverted(inverted),
        FilmEditName::Checked { checked } => FilmEdit::Checked(checked),
        FilmEditName::PatientLeft { patient_left } => FilmEdit::PatientLeft(patient_left.0),
        FilmEditName::Stated { column_mm, row_mm, plane } => {
            let spacing = studies::stated_spacing([column_mm, row_mm], plane.0)?;
            sized(&film.geometry()?, spacing, "enter another scale")?
        }
        FilmEditName::Scale { from_px, to_px, length_mm, length_sd_mm, calibrator } => {
            let image = film.geometry()?;
            let calibration = Calibration {
                calibrator: calibrator.0,
                clicks: [from_px, to_px].map(|[column, row]| Pixel::new(column, row)),
                length_mm,
                length_sd_mm,
                click_sd_px: Calibration::CLICK_SD_PX,
                // A ball cannot measure the shape of a pixel.
                pixel_aspect: words::pixel_aspect(image.spacing),
            };
            let spacing = calibration.spacing([image.columns, image.rows]).map_err(|error| {
                Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "scale", error.to_string())
                    .help("place two points on an object of known length")
            })?;
            sized(&image, spacing, "check the true length and the two points")?
        }
    })
}

/// A scale that does not make the film larger or smaller than films of a spine are.
fn sized(image: &ImageGeometry, spacing: Spacing, help: &str) -> Answer<FilmEdit> {
    let scaled = ImageGeometry { spacing: Some(spacing), ..*image };
    scaled.check_size().map_err(|error| {
        Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "scale", error.to_string()).help(help)
    })?;
    Ok(FilmEdit::Spacing(spacing))
}

async fn pixels(state: &AppState, film: &FilmRecord, asked: &HeaderMap) -> Answer<Response> {
    let screen = decoded::screen(state, &film.content).await?;
    let image = film.geometry()?;
    let [center, width] = screen.default_window;
    let of_file: Vec<String> =
        screen.file_windows.iter().map(|[center, width]| format!("{center} {width}")).collect();
    let numbers = [
        ("x-spineline-columns", screen.columns.to_string()),
        ("x-spineline-rows", screen.rows.to_string()),
        ("x-spineline-pixel-aspect", words::pixel_aspect(image.spacing).to_string()),
        ("x-spineline-window-center", center.to_string()),
        ("x-spineline-window-width", width.to_string()),
        ("x-spineline-max", screen.max.to_string()),
        ("x-spineline-file-windows", of_file.join(", ")),
    ];
    let mut response = screen.packed.answer(asked);
    let headers = response.headers_mut();
    for (name, number) in numbers {
        headers.insert(name, HeaderValue::from_str(&number).expect("digits"));
    }
    Ok(response)
}

async fn thumbnail(state: &AppState, film: &FilmRecord) -> Answer<Response> {
    let thumbnails = decoded::thumbnails(state, &film.content).await?;
    Ok(png(if film.inverted { thumbnails.inverted } else { thumbnails.plain }))
}
