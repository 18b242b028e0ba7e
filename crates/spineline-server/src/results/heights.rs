//! Heights of vertebrae that the erect and the lateral film share.

use spineline::anatomy::{FilmView, Posture};
use spineline::measure::{HeightLine, SharedHeights};
use spineline::number::fixed;
use spineline_store::{CurrentCase, FilmId};

use crate::access::OpenResult;
use crate::api::{HeightView, Problem};
use crate::extract::{Json, Path};
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;

/// Heights on one film of the vertebrae that finished readings mark on the other one of the erect and the lateral film.
#[utoipa::path(get, path = "/api/studies/{study}/films/{film}/heights",
    params(("study" = String, Path), ("film" = i64, Path)),
    responses((status = 200, body = Vec<HeightView>), Problem))]
pub async fn heights(
    OpenResult(result): OpenResult,
    Path((_, film)): Path<(String, i64)>,
) -> Answer<Json<Vec<HeightView>>> {
    let film = result.current.film(FilmId(film)).ok_or_else(Failure::not_found)?;
    let view = film.record.view;
    computed(move || Json(on_film(&result.current, view))).await
}

/// The heights on a film of this view; empty if a film cannot be measured, which its notices report.
pub fn on_film(current: &CurrentCase, view: FilmView) -> Vec<HeightView> {
    let erect = FilmView::Frontal(Posture::Erect);
    let films = current.landmarks(Posture::Erect).zip(current.case.lateral.as_ref());
    let found = films.and_then(|(erect, lateral)| SharedHeights::of(erect, lateral).ok().flatten());
    let Some(found) = found else { return Vec::new() };
    match view {
        FilmView::Lateral => found.on_lateral.iter().map(|line| height(line, erect)).collect(),
        view if view == erect => {
            found.on_erect.iter().map(|line| height(line, FilmView::Lateral)).collect()
        }
        FilmView::Frontal(_) => Vec::new(),
    }
}

fn height(line: &HeightLine, of: FilmView) -> HeightView {
    let [from_px, to_px] = line.ends.map(|end| [end.column_px, end.row_px]);
    let (level, sd_px) = (line.level.to_string(), line.sd_px);
    let text = format!("{level} by the {of} film, ± {} pixels", fixed(sd_px, 1));
    HeightView { level, from_px, to_px, sd_px, text }
}
