//! A demonstration study of a synthetic patient.

use std::collections::BTreeMap;

use axum::extract::State;
use axum::http::StatusCode;
use rayon::prelude::*;
use spineline::anatomy::Posture;
use spineline_films::{Encoding, FilmLimits, read_film};
use spineline_phantom::{Readers, Scenario, generate};
use spineline_store::{Hash, Name, NewCase, Role, StoreError, Thumbnails};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use crate::api::{Problem, StudyDetail};
use crate::decoded::keep_thumbnails;
use crate::extract::Json;
use crate::film_cache::draw_thumbnails;
use crate::problem::{Answer, Failure};
use crate::result_cache::computed;
use crate::state::AppState;
use crate::studies;
use crate::synthetic::{DrawnFilm, case_file, draw_film};
use crate::user::User;

/// Pixels of 0.2 mm, as in a computed radiograph of a whole spine; phantoms have a quarter of that area per pixel.
const PIXEL_FACTOR: u32 = 2;
const SEED: u64 = 1;
/// Names that are tried.
const MAX_DEMOS: usize = 1000;

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new().routes(routes!(demo))
}

/// Adds a synthetic patient with films and finished readings.
#[utoipa::path(post, path = "/api/studies/demo",
    responses((status = 200, body = StudyDetail), Problem))]
async fn demo(State(state): State<AppState>, user: User) -> Answer<Json<StudyDetail>> {
    user.need(Role::Editor)?;
    let (case, thumbnails) = computed(draw).await??;
    let asker = state.clone();
    let detail = state.ask(move |store| {
        let mut case = case;
        for number in 1..=MAX_DEMOS {
            let name = if number == 1 { "demo-rod-01" } else { &format!("demo-rod-01-{number}") };
            case.study.id = Name::new(name)?;
            match store.add_own_case(&case, &user.sign()) {
                Ok(added) => {
                    for (content, small) in &thumbnails {
                        keep_thumbnails(store, content, small);
                    }
                    asker.changes.send(&added.study, studies::of_study(&user));
                    return studies::detail(&asker, store, &user, &added.study);
                }
                Err(StoreError::Exists { .. }) => {}
                Err(other) => return Err(other.into()),
            }
        }
        Err(StoreError::Exists { object: "study/demo-rod-01".to_owned() }.into())
    });
    detail.await.map(Json)
}

type Drawn = (NewCase, Vec<(Hash, Thumbnails)>);

fn draw() -> Answer<Drawn> {
    let internal = |text: String| Failure::new(StatusCode::INTERNAL_SERVER_ERROR, "demo", text);
    let phantom = generate(0, Scenario::Rod, &Readers::default(), SEED)
        .map_err(|error| internal(error.to_string()))?
        .coarser(PIXEL_FACTOR);
    // Compression keeps one core busy per film.
    let drawn = phantom.films.par_iter().map(|film| -> Answer<_> {
        let drawn = draw_film(&phantom, film, Encoding::JpegLs)
            .map_err(|error| internal(error.to_string()))?;
        // The program has just written this film.
        let read = read_film(&drawn.bytes, &FilmLimits::default())?;
        let thumbnails = (Hash::of(&drawn.bytes), draw_thumbnails(&read));
        Ok(((film.posture, drawn), thumbnails))
    });
    let drawn = drawn.collect::<Answer<Vec<_>>>()?;
    let (films, thumbnails): (BTreeMap<Posture, DrawnFilm>, Vec<_>) = drawn.into_iter().unzip();
    let text = spineline_files::to_text(&case_file(&phantom, &films));
    let bytes_of = |file: &str| {
        let film = films.values().find(|film| film.file == file);
        film.map(|film| film.bytes.clone()).ok_or("a film that was not drawn")
    };
    let mut case = NewCase::read(&text, bytes_of).map_err(|error| internal(error.to_string()))?;
    case.study.label = Some("Synthetic demo patient".to_owned());
    Ok((case, thumbnails))
}
