//! Vertebrae found in the picture of a reading, as proposals.

use axum::extract::State;
use axum::http::StatusCode;
use spineline::anatomy::{FilmView, Posture};
use spineline::measure::{CornerName, ImageGeometry, Origin};
use spineline_detect::{Detection, Picture, Refusal, detect};
use spineline_store::ReadingId;

use super::markable::may_mark;
use super::view::corner_view;
use crate::api::{DetectionView, Problem, Proposal};
use crate::decoded::screen;
use crate::extract::{Json, Path};
use crate::film_cache::Screen;
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;
use crate::words::pixel_aspect;

/// Finds vertebrae in the picture of a reading. Nothing is recorded.
#[utoipa::path(post, path = "/api/readings/{reading}/detection", params(("reading" = i64, Path)),
    responses((status = 200, body = DetectionView), Problem))]
pub(super) async fn detection(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<DetectionView>> {
    let seen = state.ask(move |store| may_mark(store, &user, ReadingId(reading))).await?;
    if !seen.proposals {
        let text = "the plan of these readings allows no proposals";
        return Err(Failure::new(StatusCode::FORBIDDEN, "no_proposals", text));
    }
    let film = seen.film;
    if film.view == FilmView::Lateral {
        let refused = Some("the program finds vertebrae on frontal films only".to_owned());
        return Ok(Json(DetectionView { refused, doubt: None, proposals: Vec::new() }));
    }
    let image = film.geometry()?;
    let shown = screen(&state, &film.content).await?;
    let _permit = state.films().decoding().await?;
    let found = computed(move || in_picture(&shown, &image)).await?;
    // The posture is hidden from a blinded reader.
    let is_other = seen.code.is_none() && film.view != FilmView::Frontal(Posture::Erect);
    Ok(Json(view(found, is_other)))
}

fn in_picture(screen: &Screen, image: &ImageGeometry) -> Result<Detection, Refusal> {
    let [centre, width] = screen.default_window;
    let low = centre - width / 2.0;
    // The networks were trained on pictures as people see them.
    let grey =
        |value: u16| ((f64::from(value) - low) / width * 255.0).clamp(0.0, 255.0) as f32;
    let values: Vec<f32> = screen.values().into_iter().map(grey).collect();
    detect(&Picture {
        columns: screen.columns as usize,
        rows: screen.rows as usize,
        pixel_aspect: pixel_aspect(image.spacing),
        patient_left: image.patient_left,
        values: &values,
    })
}

fn view(found: Result<Detection, Refusal>, is_other_posture: bool) -> DetectionView {
    let Detection { vertebrae, doubts } = match found {
        Ok(found) => found,
        Err(refusal) => {
            return DetectionView {
                refused: Some(refusal.to_string()),
                doubt: None,
                proposals: Vec::new(),
            };
        }
    };
    let mut texts: Vec<String> = doubts.iter().map(ToString::to_string).collect();
    if is_other_posture {
        texts.push("the program was trained on films of standing patients only".to_owned());
    }
    let proposal = |found: &spineline_detect::DetectedVertebra| Proposal {
        level: found.level.to_string(),
        corners: CornerName::ORDER
            .into_iter()
            .map(|name| corner_view(name, name.of(&found.corners), Origin::Detected))
            .collect(),
        sd_percent: (100.0 * found.sd_share).round(),
        sd_share: Some(found.sd_share),
    };
    DetectionView {
        refused: None,
        doubt: (!texts.is_empty()).then(|| texts.join("; ")),
        proposals: vertebrae.iter().map(proposal).collect(),
    }
}
