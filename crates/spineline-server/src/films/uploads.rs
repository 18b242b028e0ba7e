//! Uploading films that are not in a study yet.

use spineline_store::Role;

use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, FromRequest, Request, State};
use axum::http::StatusCode;
use axum::response::Response;
use spineline::anatomy::{FilmView, Posture};
use spineline::measure::Spacing;
use spineline::warning::WarningCode;
use spineline_films::{FilmFile, FilmLimits, FilmRemark, Stated, spacing_question};
use spineline_marking::{Stance, View, judge_spacing, judge_view};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{Notice, Problem, Severity, SpacingView, UploadView, Wire};
use crate::attachment::png;
use crate::decoded::decode;
use crate::extract::{Json, Path, unread};
use crate::film_cache::{Reservation, Upload, draw_thumbnails};
use crate::guard::declared_bytes;
use crate::places::{Whose, Work};
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;
use crate::words;

pub fn routes() -> OpenApiRouter<AppState> {
    let largest = usize::try_from(FilmLimits::default().file_bytes).unwrap_or(usize::MAX);
    OpenApiRouter::new()
        .routes(routes!(upload))
        .layer(DefaultBodyLimit::max(largest))
        .routes(routes!(discard))
        .routes(routes!(thumbnail))
}

/// Uploads the file of one film: DICOM, PNG, JPEG or TIFF.
#[utoipa::path(post, path = "/api/uploads",
    request_body(content = Vec<u8>, content_type = "application/octet-stream"),
    responses((status = 200, body = UploadView), Problem))]
async fn upload(
    State(state): State<AppState>,
    user: User,
    request: Request,
) -> Answer<Json<UploadView>> {
    user.need(Role::Editor)?;
    let largest = FilmLimits::default().file_bytes;
    let bytes = declared_bytes(request.headers()).unwrap_or(largest);
    if bytes > largest {
        return Err(too_large());
    }
    // Room for the file is reserved before it is read.
    let room = state.films.uploads.reserve(&user.name, bytes, state.now())?;
    let body = Bytes::from_request(request, &state).await;
    let bytes = body.map_err(|refused| refusal(&refused))?.into();
    let whose = Whose::Account(user.name.clone());
    let _place = state.rooms.take(Work::Other, whose).await?;
    stage(&state, &user, room, bytes, |_| Ok(())).await.map(Json)
}

/// Decodes the file of a film from any source and keeps it for a study.
///
/// # Errors
/// For a file that is not a film, exceeds a limit, is too small to be marked, or fails `check`.
pub async fn stage(
    state: &AppState,
    user: &User,
    room: Reservation,
    bytes: Vec<u8>,
    check: impl FnOnce(&FilmFile) -> Answer<()>,
) -> Answer<UploadView> {
    let _permit = state.films.decoding().await?;
    let film = decode(state, bytes.clone()).await?;
    check(&film)?;
    check_sides(&film)?;
    let (upload, mut view) = computed(move || look(&film, bytes)).await?;
    view.notices.extend(state.films.uploads.twins(&user.name, &upload, state.now()));
    view.upload = room.keep(upload, state.now());
    Ok(view)
}

/// Fewest pixels on a side of a film: with fewer, each of 15 vertebrae has four rows at most (assumption).
const MIN_SIDE_PX: u32 = 64;

/// Refuses a picture in which no vertebra can be marked.
fn check_sides(film: &FilmFile) -> Answer<()> {
    let FilmFile { columns, rows, .. } = *film;
    if columns.min(rows) >= MIN_SIDE_PX {
        return Ok(());
    }
    let text = format!(
        "the picture has {columns} × {rows} pixels; a film has at least {MIN_SIDE_PX} on each side"
    );
    let failure = Failure::new(StatusCode::UNPROCESSABLE_ENTITY, "film", text);
    Err(failure.help("export the film at its own resolution, and not its thumbnail"))
}

fn refusal(refused: &BytesRejection) -> Failure {
    if refused.status() == StatusCode::PAYLOAD_TOO_LARGE {
        return too_large();
    }
    unread(refused).help("upload the file again")
}

fn too_large() -> Failure {
    let limit = FilmLimits::default().file_bytes >> 20;
    let text = format!("the file exceeds the limit of {limit} MB");
    Failure::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", text)
        .help("export only the frontal film")
}

/// Discards an upload that is not in a study.
#[utoipa::path(delete, path = "/api/uploads/{upload}", params(("upload" = String, Path)),
    responses((status = 204), Problem))]
async fn discard(
    State(state): State<AppState>,
    user: User,
    Path(upload): Path<String>,
) -> Answer<StatusCode> {
    let uploads = &state.films.uploads;
    uploads.get(&user.name, &upload, state.now())?;
    uploads.forget(std::iter::once(upload.as_str()));
    Ok(StatusCode::NO_CONTENT)
}

/// A thumbnail of an upload.
#[utoipa::path(get, path = "/api/uploads/{upload}/thumbnail", params(("upload" = String, Path)),
    responses((status = 200, content_type = "image/png"), Problem))]
async fn thumbnail(
    State(state): State<AppState>,
    user: User,
    Path(upload): Path<String>,
) -> Answer<Response> {
    let upload = state.films.uploads.get(&user.name, &upload, state.now())?;
    Ok(png(upload.thumbnail.clone()))
}

/// Values of a film's file, without the patient's identity.
fn look(film: &FilmFile, bytes: Vec<u8>) -> (Upload, UploadView) {
    let spacing = judge_spacing(&film.tags.spacing);
    let judged = judge_view(&film.tags.view, None);
    let is_lateral = judged.view == Some(View::Lateral);
    // Bending and traction films are taken lying; only one frontal film is erect.
    let posture = match film.tags.view.stance {
        _ if is_lateral => Some(FilmView::Lateral),
        Some(Stance::Erect) => Some(FilmView::Frontal(Posture::Erect)),
        _ => None,
    };
    let remarks = film.remarks.iter().map(|remark| notice(code(remark), remark.to_string()));
    let of_spacing =
        spacing.remarks.iter().map(|remark| notice("spacing_remark", remark.to_string()));
    let of_view = judged.questions.iter().map(|asked| notice("view_question", asked.to_string()));
    let view = UploadView {
        upload: String::new(),
        format: match &film.tags.transfer_syntax {
            Some(syntax) => format!("{}, {syntax}", film.kind),
            None => film.kind.to_string(),
        },
        columns: film.columns,
        rows: film.rows,
        pixel_aspect: words::pixel_aspect(spacing.spacing),
        posture: posture.map(Wire),
        is_synthetic: film.tags.is_phantom,
        patient_left: judged.patient_left.or(judged.patient_anterior).map(Wire),
        spacing: spacing.spacing.filter(Spacing::has_millimetres).map(|spacing| SpacingView {
            column_mm: spacing.column_mm,
            row_mm: spacing.row_mm,
            plane: Wire(spacing.plane),
            text: words::spacing_text(Some(spacing)),
        }),
        notices: remarks.chain(of_spacing).chain(of_view).collect(),
    };
    let upload = Upload {
        bytes,
        kind: film.kind,
        columns: film.columns,
        rows: film.rows,
        spacing: spacing.spacing,
        spacing_question: spacing_question(&film.tags, &film.remarks),
        view: film.tags.view,
        is_synthetic: film.tags.is_phantom,
        stated: Stated::of(film),
        picture: film.picture_sha256(),
        instance: film.tags.uids.sop_instance.clone(),
        thumbnail: draw_thumbnails(film).plain,
    };
    (upload, view)
}

fn code(remark: &FilmRemark) -> &'static str {
    match remark {
        FilmRemark::BurnedIn | FilmRemark::BurnedInUnknown => "burned_in_text",
        FilmRemark::OtherBodyPart { .. } => WarningCode::OtherBodyPart.key(),
        FilmRemark::PairReadAs { .. }
        | FilmRemark::PairUnreadable { .. }
        | FilmRemark::UnequalResolution(_) => "spacing_remark",
        _ => "film_remark",
    }
}

fn notice(code: &str, text: String) -> Notice {
    let severity = if code == "film_remark" { Severity::Note } else { Severity::Warning };
    Notice::new(severity, code, text)
}
