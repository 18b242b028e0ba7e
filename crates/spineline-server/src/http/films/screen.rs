//! Decoded films, as long as there is room for them.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::Bytes;
use axum::http::StatusCode;
use spineline::measure::judge_spacing;
use spineline_films::{ChildLimits, FilmError, FilmFile, decode_in_child};
use spineline_store::{Hash, Store, Thumbnails};
use tokio::sync::Semaphore;

use super::super::{Answer, AppState, Failure, words};
use super::uploads::Uploads;

/// Room for decoded films.
const ROOM_BYTES: usize = 300 << 20;
/// Films that are decoded at a time; each may take a few hundred megabytes.
const AT_A_TIME: usize = 2;
/// Height of a small picture.
const THUMBNAIL_ROWS: u32 = 220;

/// A film as the browser draws it.
#[derive(Debug)]
pub struct Screen {
    /// 16-bit little-endian words, row by row.
    pub bytes: Bytes,
    pub columns: u32,
    pub rows: u32,
    /// Centre and width in these values.
    pub default_window: [f64; 2],
    /// Greatest value.
    pub max: u16,
}

/// The small pictures of a decoded film as PNG files, with the pixels' shape as its file tells it.
pub fn draw_thumbnails(film: &FilmFile) -> Thumbnails {
    let aspect = words::pixel_aspect(judge_spacing(&film.tags.spacing).spacing);
    let draw = |inverted| film.display(None, inverted).thumbnail(THUMBNAIL_ROWS, aspect).to_png();
    Thumbnails { plain: draw(false), inverted: draw(true) }
}

impl Screen {
    fn of(film: &FilmFile) -> Self {
        let values = film.screen_values();
        Self {
            max: values.values.iter().copied().max().unwrap_or_default(),
            bytes: values.values.into_iter().flat_map(u16::to_le_bytes).collect(),
            columns: values.columns,
            rows: values.rows,
            default_window: values.default_window,
        }
    }
}

/// Decoded films, the least recently asked for going first.
pub struct Shelf {
    screens: Mutex<Screens>,
    turn: Semaphore,
    pub uploads: Uploads,
}

type Screens = VecDeque<(Hash, Arc<Screen>)>;

impl Default for Shelf {
    fn default() -> Self {
        Self {
            screens: Mutex::default(),
            turn: Semaphore::new(AT_A_TIME),
            uploads: Uploads::default(),
        }
    }
}

impl Shelf {
    fn screens(&self) -> MutexGuard<'_, Screens> {
        self.screens.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn screen(&self, content: &Hash) -> Option<Arc<Screen>> {
        let screens = &mut self.screens();
        let at = screens.iter().position(|(known, _)| known == content)?;
        let found = screens.remove(at)?;
        let screen = found.1.clone();
        screens.push_back(found);
        Some(screen)
    }

    fn keep(&self, content: &Hash, screen: Arc<Screen>) {
        let screens = &mut self.screens();
        if screens.iter().all(|(known, _)| known != content) {
            screens.push_back((content.clone(), screen));
        }
        let room = |screens: &Screens| -> usize {
            screens.iter().map(|(_, screen)| screen.bytes.len()).sum()
        };
        while screens.len() > 1 && room(screens) > ROOM_BYTES {
            screens.pop_front();
        }
    }
}

/// A film of the store, decoded.
pub async fn screen(state: &AppState, content: &Hash) -> Answer<Arc<Screen>> {
    if let Some(screen) = state.films().screen(content) {
        return Ok(screen);
    }
    let _turn = turn(state).await?;
    // Somebody may have had it decoded while this one waited.
    if let Some(screen) = state.films().screen(content) {
        return Ok(screen);
    }
    let film = stored(state, content).await?;
    let made = tokio::task::spawn_blocking(move || Arc::new(Screen::of(&film)));
    let screen = made.await.expect("drawing does not panic");
    state.films().keep(content, screen.clone());
    Ok(screen)
}

/// The small pictures of a film of the store.
pub async fn thumbnails(state: &AppState, content: &Hash) -> Answer<Thumbnails> {
    if let Some(known) = kept_thumbnails(state, content).await? {
        return Ok(known);
    }
    let _turn = turn(state).await?;
    // Somebody may have had them drawn while this one waited.
    if let Some(known) = kept_thumbnails(state, content).await? {
        return Ok(known);
    }
    let film = stored(state, content).await?;
    let drawn = tokio::task::spawn_blocking(move || draw_thumbnails(&film));
    let (thumbnails, content) = (drawn.await.expect("drawing does not panic"), content.clone());
    let keep = move |store: &mut Store| {
        keep_thumbnails(store, &content, &thumbnails);
        Ok(thumbnails)
    };
    state.store(keep).await
}

/// Keeps small pictures; where the store cannot be written now, they are drawn again another time.
pub fn keep_thumbnails(store: &mut Store, content: &Hash, thumbnails: &Thumbnails) {
    let _ = store.keep_thumbnails(content, thumbnails);
}

async fn kept_thumbnails(state: &AppState, content: &Hash) -> Answer<Option<Thumbnails>> {
    let content = content.clone();
    state.store(move |store| store.thumbnails(&content)).await
}

pub async fn turn(state: &AppState) -> Answer<tokio::sync::SemaphorePermit<'_>> {
    let closed = |_| Failure::new(StatusCode::SERVICE_UNAVAILABLE, "ending", "the server ends");
    state.films().turn.acquire().await.map_err(closed)
}

async fn stored(state: &AppState, content: &Hash) -> Answer<FilmFile> {
    let content = content.clone();
    let bytes = state.store(move |store| store.content(&content)).await?;
    Ok(decode(state, bytes).await?)
}

/// Decodes a film in a process of its own.
pub async fn decode(state: &AppState, bytes: Vec<u8>) -> Result<FilmFile, FilmError> {
    let options = state.options().clone();
    let decoded = tokio::task::spawn_blocking(move || {
        let arguments: Vec<&str> = options.decoder_arguments.iter().map(String::as_str).collect();
        decode_in_child(&options.decoder, &arguments, bytes, &ChildLimits::default())
    });
    decoded.await.expect("waiting for a process does not panic")
}
