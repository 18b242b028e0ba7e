//! Lengths and angles of lines that are drawn on a film. They are not stored.

use axum::extract::State;
use axum::http::StatusCode;
use spineline::measure::{ImageGeometry, SpacingPlane};
use spineline::spatial::Pixel;
use spineline_marking::{DrawnFault, DrawnLine};
use spineline_store::FilmId;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::access::seen_film;
use crate::api::{DrawnRequest, DrawnView, Problem};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(drawn))
}

/// Measures a length or an angle that is drawn on a film, and stores nothing.
#[utoipa::path(post, path = "/api/films/{film}/drawn", params(("film" = i64, Path)), request_body = DrawnRequest,
    responses((status = 200, body = DrawnView), Problem))]
async fn drawn(
    State(state): State<AppState>,
    user: User,
    Path(film): Path<i64>,
    Json(request): Json<DrawnRequest>,
) -> Answer<Json<DrawnView>> {
    let film = state.ask(move |store| seen_film(store, &user, FilmId(film))).await?;
    let image = film.geometry()?;
    Ok(Json(match request {
        DrawnRequest::Length { from_px, to_px } => length(&image, &line(from_px, to_px))?,
        DrawnRequest::Angle { first_from_px, first_to_px, second_from_px, second_to_px } => {
            angle(&image, &line(first_from_px, first_to_px), &line(second_from_px, second_to_px))?
        }
    }))
}

fn length(image: &ImageGeometry, line: &DrawnLine) -> Answer<DrawnView> {
    let length = line.length(image).map_err(refused)?;
    let note = match length.scale.plane {
        SpacingPlane::Pixels => "this film has no scale: the length is in pixels".to_owned(),
        SpacingPlane::Detector => format!("{}: larger than in the patient", length.scale),
        SpacingPlane::Patient | SpacingPlane::Unknown => length.scale.to_string(),
    };
    Ok(DrawnView { text: length.text(), note })
}

fn angle(image: &ImageGeometry, first: &DrawnLine, second: &DrawnLine) -> Answer<DrawnView> {
    let angle = first.angle_to(second, image).map_err(refused)?;
    let note = match image.spacing {
        Some(_) => "the smaller angle between the lines",
        None => "the smaller angle between the lines, with pixels taken as square",
    };
    Ok(DrawnView { text: angle.text(), note: note.to_owned() })
}

fn line(from_px: [f64; 2], to_px: [f64; 2]) -> DrawnLine {
    let [from, to] = [from_px, to_px].map(|[column, row]| Pixel::new(column, row));
    DrawnLine { from, to }
}

fn refused(fault: DrawnFault) -> Failure {
    Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "drawn", fault.to_string())
        .help("draw a longer line on the film")
}
