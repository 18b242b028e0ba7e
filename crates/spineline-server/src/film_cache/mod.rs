//! Decoded films and uploads, kept in memory while there is room for them.

mod uploads;

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;
use flate2::Compression;
use spineline_films::{FilmFile, FilmKind};
use spineline_marking::judge_spacing;
use spineline_store::{Hash, Thumbnails};
use tokio::sync::{Semaphore, SemaphorePermit};

use crate::gzip::Gzipped;
use crate::limits::UploadLimits;
use crate::problem::{Answer, Failure};
use crate::words;

pub use uploads::{Reservation, Upload, Uploads};

/// Room for decoded films.
const ROOM_BYTES: usize = 300 << 20;
/// Largest value of a film that is sent with one byte per pixel.
const BYTE_MAX: u16 = u8::MAX as u16;
/// Films that are decoded concurrently; each may take a few hundred megabytes.
const AT_A_TIME: usize = 2;
/// Height of a thumbnail.
const THUMBNAIL_ROWS: u32 = 220;

/// A decoded film in the form for the browser.
#[derive(Debug)]
pub struct Screen {
    /// Values row by row: bytes where the maximum is 255 or less, else 16-bit little-endian words.
    pub packed: Gzipped,
    pub columns: u32,
    pub rows: u32,
    /// Centre and width in these values.
    pub default_window: [f64; 2],
    /// Windows and tables of a DICOM file, as centre and width in these values; empty for other files.
    pub file_windows: Vec<[f64; 2]>,
    /// Maximum value.
    pub max: u16,
}

/// Thumbnails of a decoded film as PNG files, with the pixel aspect of its file.
pub fn draw_thumbnails(film: &FilmFile) -> Thumbnails {
    let aspect = words::pixel_aspect(judge_spacing(&film.tags.spacing).spacing);
    let draw = |inverted| film.display(None, inverted).thumbnail(THUMBNAIL_ROWS, aspect).to_png();
    Thumbnails { plain: draw(false), inverted: draw(true) }
}

impl Screen {
    /// The film as the browser draws it.
    pub fn of(film: &FilmFile) -> Self {
        let values = film.screen_values();
        let max = values.max();
        let bytes = values.to_le_bytes();
        let bytes = if max > BYTE_MAX { bytes } else { bytes.into_iter().step_by(2).collect() };
        Self {
            max,
            packed: Gzipped::new(&bytes, Compression::fast()),
            columns: values.columns,
            rows: values.rows,
            default_window: values.default_window,
            file_windows: match film.kind {
                FilmKind::Dicom => values.file_windows,
                FilmKind::Png | FilmKind::Jpeg | FilmKind::Tiff => Vec::new(),
            },
        }
    }

    /// The values row by row.
    pub fn values(&self) -> Vec<u16> {
        let bytes = self.packed.unpacked();
        if self.max <= BYTE_MAX {
            return bytes.into_iter().map(u16::from).collect();
        }
        bytes.chunks_exact(2).map(|word| u16::from_le_bytes([word[0], word[1]])).collect()
    }
}

/// Decoded films, of which the least recently used is dropped first.
pub struct FilmCache {
    screens: Mutex<Screens>,
    decoding: Semaphore,
    pub uploads: Uploads,
}

type Screens = VecDeque<(Hash, Arc<Screen>)>;

impl FilmCache {
    /// A cache without films.
    pub fn new(uploads: UploadLimits) -> Self {
        Self {
            screens: Mutex::default(),
            decoding: Semaphore::new(AT_A_TIME),
            uploads: Uploads::new(uploads),
        }
    }

    /// Waits until a film may be decoded.
    pub async fn decoding(&self) -> Answer<SemaphorePermit<'_>> {
        let closed = |_| {
            Failure::new(StatusCode::SERVICE_UNAVAILABLE, "ending", "the server is shutting down")
        };
        self.decoding.acquire().await.map_err(closed)
    }

    fn screens(&self) -> MutexGuard<'_, Screens> {
        self.screens.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A decoded film, if it is kept.
    pub fn screen(&self, content: &Hash) -> Option<Arc<Screen>> {
        let screens = &mut self.screens();
        let at = screens.iter().position(|(known, _)| known == content)?;
        let found = screens.remove(at)?;
        let screen = found.1.clone();
        screens.push_back(found);
        Some(screen)
    }

    /// Keeps a decoded film, and drops the oldest ones if memory is short.
    pub fn keep(&self, content: &Hash, screen: Arc<Screen>) {
        let screens = &mut self.screens();
        if screens.iter().all(|(known, _)| known != content) {
            screens.push_back((content.clone(), screen));
        }
        let room = |screens: &Screens| -> usize {
            screens.iter().map(|(_, screen)| screen.packed.len()).sum()
        };
        while screens.len() > 1 && room(screens) > ROOM_BYTES {
            screens.pop_front();
        }
    }
}
