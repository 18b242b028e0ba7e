//! Vertebrae found in the picture of a reading, as proposals.

use std::collections::BTreeMap;

use axum::extract::State;
use axum::http::StatusCode;
use spineline::anatomy::{FilmView, Level, Posture};
use spineline::measure::{CornerName, IliacCrests, ImageGeometry, Origin};
use spineline::spatial::Pixel;
use spineline_detect::{DetectedVertebra, Detection, Picture, SeenBody, bodies_at, detect};
use spineline_marking::{
    ErectFilm, NamelessBody, PartialLandmarks, PartialReading, ProposedVertebra,
};
use spineline_store::{ReadingId, SeenReading};

use super::erect::erect_of;
use super::landmarks::landmarks;
use super::markable::may_mark;
use super::view::corner_view;
use crate::api::{DetectionView, MisfitView, Problem, Proposal};
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
    let Proposing { seen, marked, erect } = proposing(&state, user, reading).await?;
    let film = seen.film;
    if film.view == FilmView::Lateral {
        let text = "the program finds vertebrae on frontal films only".to_owned();
        return Ok(Json(refused(text)));
    }
    let image = film.geometry()?;
    let shown = screen(&state, &film.content).await?;
    let _permit = state.films.decoding().await?;
    // The posture is hidden from a blinded reader.
    let is_other = seen.code.is_none() && film.view != FilmView::Frontal(Posture::Erect);
    let crests = marked.iliac_crests();
    let found = computed(move || {
        let values = values(&shown);
        match detect(&picture(&shown, &image, &values), crests) {
            Ok(found) => view(found, &image, erect.as_ref(), crests, is_other),
            Err(refusal) => refused(refusal.to_string()),
        }
    });
    found.await.map(Json)
}

/// Compares the sure proposals of a reading with the edges in its picture. Nothing is recorded.
#[utoipa::path(post, path = "/api/readings/{reading}/misfits", params(("reading" = i64, Path)),
    responses((status = 200, body = MisfitView), (status = 403, body = Problem),
        (status = 404, body = Problem)))]
pub(super) async fn misfits(
    State(state): State<AppState>,
    user: User,
    Path(reading): Path<i64>,
) -> Answer<Json<MisfitView>> {
    let Proposing { seen, marked, erect } = proposing(&state, user, reading).await?;
    let image = seen.film.geometry()?;
    let shown = screen(&state, &seen.film.content).await?;
    let _permit = state.films.decoding().await?;
    let levels = computed(move || {
        let proposals = marked.propose(&image, seen.film.view.posture(), erect.as_ref());
        let centre = |(&level, landmark): (&Level, &PartialLandmarks)| {
            Some((level, landmark.body(&image)?.midpoint))
        };
        let mut centres: BTreeMap<Level, Pixel> =
            marked.vertebrae.iter().filter_map(centre).collect();
        centres.extend(proposals.iter().map(|one| (one.level, one.centre(&image))));
        let (levels, cranial_first): (Vec<Level>, Vec<Pixel>) = centres.into_iter().rev().unzip();
        let values = values(&shown);
        let bodies = bodies_at(&picture(&shown, &image, &values), &cranial_first);
        let bodies: BTreeMap<Level, SeenBody> = levels.into_iter().zip(bodies).collect();
        let differs = |one: &&ProposedVertebra| {
            let body = bodies.get(&one.level);
            one.is_sure && body.is_some_and(|b| !one.fits(&image, &b.corners, b.sd_share))
        };
        proposals.iter().filter(differs).map(|one| one.level.to_string()).collect()
    });
    Ok(Json(MisfitView { levels: levels.await? }))
}

/// A reading in which vertebrae may be proposed.
struct Proposing {
    seen: SeenReading,
    marked: PartialReading,
    erect: Option<ErectFilm>,
}

async fn proposing(state: &AppState, user: User, reading: i64) -> Answer<Proposing> {
    let found = state.ask(move |store| {
        let seen = may_mark(store, &user, ReadingId(reading))?;
        let marked = landmarks(&seen.state(&[])?, seen.film.view);
        let erect = erect_of(store, &user, &seen)?.map(|erect| erect.film);
        Ok(Proposing { seen, marked, erect })
    });
    let found = found.await?;
    if !found.seen.proposals {
        let text = "the plan of these readings allows no proposals";
        return Err(Failure::new(StatusCode::FORBIDDEN, "no_proposals", text));
    }
    Ok(found)
}

/// Grey values as people see them, on which the networks were trained.
fn values(screen: &Screen) -> Vec<f32> {
    let [centre, width] = screen.default_window;
    let low = centre - width / 2.0;
    let grey = |value: u16| ((f64::from(value) - low) / width * 255.0).clamp(0.0, 255.0) as f32;
    screen.values().into_iter().map(grey).collect()
}

fn picture<'a>(screen: &Screen, image: &ImageGeometry, values: &'a [f32]) -> Picture<'a> {
    Picture {
        columns: screen.columns as usize,
        rows: screen.rows as usize,
        pixel_aspect: pixel_aspect(image.spacing),
        patient_left: image.patient_left,
        values,
    }
}

fn refused(text: String) -> DetectionView {
    DetectionView {
        refused: Some(text),
        levels: String::new(),
        are_levels_doubtful: false,
        remarks: Vec::new(),
        proposals: Vec::new(),
    }
}

fn view(
    found: Detection,
    image: &ImageGeometry,
    erect: Option<&ErectFilm>,
    crests: Option<IliacCrests>,
    is_other_posture: bool,
) -> DetectionView {
    let posture = is_other_posture
        .then(|| "the program was trained on films of standing patients only".to_owned());
    let remarks = found.left_out().into_iter().chain(posture).collect();
    let Detection { mut vertebrae, count, .. } = found;
    let matched = erect.and_then(|erect| {
        vertebrae.retain(|found| found.is_seen);
        let body =
            |found: &DetectedVertebra| NamelessBody { corners: found.corners, votes: found.votes };
        erect.match_levels(image, &vertebrae.iter().map(body).collect::<Vec<_>>(), crests)
    });
    if let Some(matched) = &matched {
        let named = vertebrae.into_iter().zip(&matched.levels);
        let named =
            named.filter_map(|(found, &level)| Some(DetectedVertebra { level: level?, ..found }));
        vertebrae = named.collect();
    }
    let proposal = |found: &DetectedVertebra| Proposal {
        level: found.level.to_string(),
        corners: CornerName::ORDER
            .into_iter()
            .map(|name| corner_view(name, name.of(&found.corners), Origin::Detected))
            .collect(),
        sd_percent: (100.0 * found.sd_share).round(),
        sd_share: Some(found.sd_share),
        is_sure: found.is_clear(),
    };
    let (levels, are_levels_doubtful) = match &matched {
        Some(matched) => (matched.to_string(), !matched.is_clear()),
        None => (count.to_string(), is_other_posture || !count.is_sure()),
    };
    DetectionView {
        refused: None,
        levels,
        are_levels_doubtful,
        remarks,
        proposals: vertebrae.iter().map(proposal).collect(),
    }
}
