//! Films of the store, decoded once and kept.

use std::sync::Arc;

use spineline_films::{ChildLimits, FilmFile, decode_in_child};
use spineline_store::{FilmRecord, Hash, Store, Thumbnails};

use crate::film_cache::{Screen, draw_thumbnails};
use crate::problem::Answer;
use crate::result_cache::computed;
use crate::state::AppState;
use crate::words;

/// A film of the store, decoded.
pub async fn screen(state: &AppState, content: &Hash) -> Answer<Arc<Screen>> {
    if let Some(screen) = state.films.screen(content) {
        return Ok(screen);
    }
    let _permit = state.films.decoding().await?;
    // Another request may have decoded it in the meantime.
    if let Some(screen) = state.films.screen(content) {
        return Ok(screen);
    }
    let film = stored(state, content).await?;
    let screen = computed(move || Arc::new(Screen::of(&film))).await?;
    state.films.keep(content, screen.clone());
    Ok(screen)
}

/// A film of the store as a PNG file of a size for paper, as it is shown.
pub async fn picture(state: &AppState, film: &FilmRecord) -> Answer<Vec<u8>> {
    const ROWS: u32 = 800;
    let image = film.geometry()?;
    let (aspect, rows) = (words::pixel_aspect(image.spacing), ROWS.min(image.rows));
    let _permit = state.films.decoding().await?;
    let (file, inverted) = (stored(state, &film.content).await?, film.inverted);
    computed(move || file.display(None, inverted).thumbnail(rows, aspect).to_png()).await
}

/// SHA-256 of the picture of a film in the store, whatever its file.
pub async fn picture_sha256(state: &AppState, content: &Hash) -> Answer<String> {
    let _permit = state.films.decoding().await?;
    let film = stored(state, content).await?;
    computed(move || film.picture_sha256()).await
}

/// Thumbnails of a film in the store.
pub async fn thumbnails(state: &AppState, content: &Hash) -> Answer<Thumbnails> {
    if let Some(known) = kept_thumbnails(state, content).await? {
        return Ok(known);
    }
    let _permit = state.films.decoding().await?;
    // Another request may have drawn them in the meantime.
    if let Some(known) = kept_thumbnails(state, content).await? {
        return Ok(known);
    }
    let film = stored(state, content).await?;
    let thumbnails = computed(move || draw_thumbnails(&film)).await?;
    let content = content.clone();
    let keep = move |store: &mut Store| {
        keep_thumbnails(store, &content, &thumbnails);
        Ok(thumbnails)
    };
    state.store(keep).await
}

/// Stores thumbnails; if the store cannot be written, they are drawn again later.
pub fn keep_thumbnails(store: &mut Store, content: &Hash, thumbnails: &Thumbnails) {
    let _ = store.keep_thumbnails(content, thumbnails);
}

async fn kept_thumbnails(state: &AppState, content: &Hash) -> Answer<Option<Thumbnails>> {
    let content = content.clone();
    state.store(move |store| store.thumbnails(&content)).await
}

async fn stored(state: &AppState, content: &Hash) -> Answer<FilmFile> {
    let content = content.clone();
    let bytes = state.store(move |store| store.content(&content)).await?;
    decode(state, bytes).await
}

/// Decodes a film in a separate process.
pub async fn decode(state: &AppState, bytes: Vec<u8>) -> Answer<FilmFile> {
    let options = state.options.clone();
    let decoded = computed(move || {
        let arguments: Vec<&str> = options.decoder_arguments.iter().map(String::as_str).collect();
        decode_in_child(&options.decoder, &arguments, bytes, &ChildLimits::default())
    });
    Ok(decoded.await??)
}
