//! Uploads that are not in a study yet: in memory, for an hour, and for the user who sent them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;
use spineline::measure::Spacing;
use spineline_films::FilmKind;
use spineline_store::{Name, Timestamp};

use crate::problem::{Answer, Failure};
use crate::secret::secret;

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
    /// Scale from the file.
    pub spacing: Option<Spacing>,
    pub is_lateral: bool,
    pub is_synthetic: bool,
    /// Hash of the decoded pixels: equal for the same film in two files.
    pub picture: String,
    /// A thumbnail as PNG.
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

    /// Keeps an upload, and returns its secret name.
    pub fn keep(&self, owner: &Name, at: Timestamp, upload: Arc<Upload>) -> Answer<String> {
        let mut staged = self.staged();
        staged.retain(|_, old| at.unix_ms() - old.at.unix_ms() < KEPT_MS);
        let size = |own_only: bool| -> usize {
            let counted = staged.values().filter(|s| !own_only || s.owner == *owner);
            counted.map(|staged| staged.upload.bytes.len()).sum()
        };
        let new = upload.bytes.len();
        if size(true) + new > ROOM_BYTES || size(false) + new > WHOLE_ROOM_BYTES {
            let text = format!(
                "the limit for uploaded films that are not in a study is reached; this file has {} MB",
                new >> 20
            );
            return Err(Failure::new(StatusCode::PAYLOAD_TOO_LARGE, "too_large", text)
                .help("create a study from the uploaded films first, or wait an hour"));
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
            Failure::new(
                StatusCode::NOT_FOUND,
                "not_found",
                "this upload has expired or does not exist",
            )
            .help("upload the file again; an upload is kept for an hour")
        })
    }

    /// Removes uploads that are now part of a study.
    pub fn forget<'a>(&self, ids: impl Iterator<Item = &'a str>) {
        let mut staged = self.staged();
        for id in ids {
            staged.remove(id);
        }
    }
}
