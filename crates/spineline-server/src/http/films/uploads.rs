//! Pictures that were dropped and are not in a study yet: in memory, for an hour, and for whoever dropped them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::Bytes;
use axum::extract::rejection::BytesRejection;
use axum::extract::{DefaultBodyLimit, State};
use axum::http::StatusCode;
use axum::response::Response;
use spineline::anatomy::Posture;
use spineline::measure::{Spacing, Stance, View, judge_spacing, judge_view};
use spineline_files::sha256_hex;
use spineline_films::{FilmFile, FilmKind, FilmLimits, FilmRemark};
use spineline_store::{Name, Role, Timestamp};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::super::api::{Notice, Problem, Severity, SpacingView, UploadView, Wire};
use super::super::extract::{Json, Path};
use super::super::state::secret;
use super::super::{Answer, AppState, Failure, User, words};
use super::png;
use super::screen::{decode, draw_thumbnails, turn};

/// How long an upload is kept.
const KEPT_MS: i64 = 60 * 60 * 1000;
/// Room for the uploads of one user.
const ROOM_BYTES: usize = 600 << 20;
/// Room for all uploads.
const WHOLE_ROOM_BYTES: usize = 1 << 30;

/// A picture that was decoded once, with its file.
#[derive(Debug)]
pub struct Upload {
    pub bytes: Vec<u8>,
    pub kind: FilmKind,
    pub columns: u32,
    pub rows: u32,
    /// Scale as the file supports it.
    pub spacing: Option<Spacing>,
    pub is_lateral: bool,
    pub is_synthetic: bool,
    /// Of the decoded pixels: the same film in two files has the same.
    pub picture: String,
    /// A small picture, as PNG.
    pub thumbnail: Vec<u8>,
}

struct Staged {
    owner: Name,
    at: Timestamp,
    upload: Arc<Upload>,
}

/// All uploads by their secret names.
#[derive(Default)]
pub struct Uploads(Mutex<BTreeMap<String, Staged>>);

impl Uploads {
    fn staged(&self) -> MutexGuard<'_, BTreeMap<String, Staged>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn keep(&self, owner: &Name, at: Timestamp, upload: Arc<Upload>) -> Answer<String> {
        let mut staged = self.staged();
        staged.retain(|_, old| at.unix_ms() - old.at.unix_ms() < KEPT_MS);
        let size = |own_only: bool| -> usize {
            let counted = staged.values().filter(|s| !own_only || s.owner == *owner);
            counted.map(|staged| staged.upload.bytes.len()).sum()
        };
        let new = upload.bytes.len();
        if size(true) + new > ROOM_BYTES || size(false) + new > WHOLE_ROOM_BYTES {
            let text = format!(
                "there is no room for another {} MB of films that are in no study yet",
                new >> 20
            );
            return Err(Failure::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", text)
                .help("make a study of those that were dropped first, or wait an hour"));
        }
        let id = secret();
        staged.insert(id.clone(), Staged { owner: owner.clone(), at, upload });
        Ok(id)
    }

    /// An upload of this user.
    pub fn get(&self, owner: &Name, id: &str, now: Timestamp) -> Answer<Arc<Upload>> {
        let staged = self.staged();
        let found = staged.get(id).filter(|staged| {
            staged.owner == *owner && now.unix_ms() - staged.at.unix_ms() < KEPT_MS
        });
        found.map(|staged| staged.upload.clone()).ok_or_else(|| {
            Failure::new(StatusCode::NOT_FOUND, "not_found", "this upload is no longer there")
                .help("drop the file again; an upload is kept for an hour")
        })
    }

    /// Forgets uploads that are in a study now.
    pub fn forget<'a>(&self, ids: impl Iterator<Item = &'a str>) {
        let mut staged = self.staged();
        for id in ids {
            staged.remove(id);
        }
    }
}

pub fn routes() -> OpenApiRouter<AppState> {
    let largest = usize::try_from(FilmLimits::default().file_bytes).unwrap_or(usize::MAX);
    OpenApiRouter::new()
        .routes(routes!(upload))
        .layer(DefaultBodyLimit::max(largest))
        .routes(routes!(thumbnail))
}

/// Takes one film's file: DICOM, PNG, JPEG or TIFF.
#[utoipa::path(post, path = "/api/uploads",
    request_body(content = Vec<u8>, content_type = "application/octet-stream"),
    responses((status = 200, body = UploadView), (status = 401, body = Problem),
        (status = 403, body = Problem), (status = 413, body = Problem),
        (status = 422, body = Problem)))]
async fn upload(
    State(state): State<AppState>,
    user: User,
    body: Result<Bytes, BytesRejection>,
) -> Answer<Json<UploadView>> {
    user.need(Role::Editor)?;
    let bytes: Vec<u8> = body.map_err(|refused| unread(&refused))?.into();
    let _turn = turn(&state).await?;
    let film = decode(&state, bytes.clone()).await?;
    let looked = tokio::task::spawn_blocking(move || look(&film, bytes));
    let (upload, mut view) = looked.await.expect("looking does not panic");
    view.upload = state.films().uploads.keep(&user.name, state.now(), Arc::new(upload))?;
    Ok(Json(view))
}

fn unread(refused: &BytesRejection) -> Failure {
    let status = refused.status();
    if status == StatusCode::PAYLOAD_TOO_LARGE {
        let limit = FilmLimits::default().file_bytes >> 20;
        let text = format!("the file is larger than {limit} MB, which no radiograph is");
        return Failure::new(status, "too_large", text).help("export the one frontal film alone");
    }
    Failure::new(status, "unread", "the file did not arrive whole").help("drop it again")
}

/// A small picture of an upload.
#[utoipa::path(get, path = "/api/uploads/{upload}/thumbnail",
    responses((status = 200, content_type = "image/png"), (status = 401, body = Problem),
        (status = 404, body = Problem)))]
async fn thumbnail(
    State(state): State<AppState>,
    user: User,
    Path(upload): Path<String>,
) -> Answer<Response> {
    let upload = state.films().uploads.get(&user.name, &upload, state.now())?;
    Ok(png(upload.thumbnail.clone()))
}

/// What a film says of itself; nothing of it names the patient.
fn look(film: &FilmFile, bytes: Vec<u8>) -> (Upload, UploadView) {
    let spacing = judge_spacing(&film.tags.spacing);
    let judged = judge_view(&film.tags.view, None);
    let picture: Vec<u8> = film.stored.iter().flat_map(i32::to_le_bytes).collect();
    let is_lateral = judged.view == Some(View::Lateral);
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
        // Bends and traction are taken lying down; standing, only one film is.
        posture: (film.tags.view.stance == Some(Stance::Erect)).then_some(Wire(Posture::Erect)),
        is_lateral,
        is_synthetic: film.tags.is_phantom,
        patient_left: judged.patient_left.map(Wire),
        spacing: spacing.spacing.map(|spacing| SpacingView {
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
        is_lateral,
        is_synthetic: film.tags.is_phantom,
        picture: sha256_hex(&picture),
        thumbnail: draw_thumbnails(film).plain,
    };
    (upload, view)
}

fn code(remark: &FilmRemark) -> &'static str {
    match remark {
        FilmRemark::BurnedIn | FilmRemark::BurnedInUnknown => "burned_in_text",
        _ => "film_remark",
    }
}

fn notice(code: &str, text: String) -> Notice {
    let severity = if code == "film_remark" { Severity::Note } else { Severity::Warning };
    Notice { severity, code: code.to_owned(), posture: None, level: None, line: None, text }
}
