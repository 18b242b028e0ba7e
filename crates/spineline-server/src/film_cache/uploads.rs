//! Uploads that are not in a study yet: in memory, for an hour, and for the user who sent them.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::http::StatusCode;
use spineline::measure::Spacing;
use spineline::warning::WarningCode;
use spineline_films::{FilmKind, Stated};
use spineline_marking::ViewEvidence;
use spineline_store::{Name, Timestamp};

use crate::api::{Notice, Severity};
use crate::limits::{UploadLimits, UploadRoom};
use crate::problem::{Answer, Failure};
use crate::secret::secret;

/// A picture that was decoded once, with its file.
#[derive(Debug)]
pub struct Upload {
    pub bytes: Vec<u8>,
    pub kind: FilmKind,
    pub columns: u32,
    pub rows: u32,
    /// Scale from the file, or the shape of its pixels.
    pub spacing: Option<Spacing>,
    /// Why the user must enter the spacing, where the file leaves it open.
    pub spacing_question: Option<String>,
    /// The file's statements about its view.
    pub view: ViewEvidence,
    pub is_synthetic: bool,
    /// Patient and part of the body as the file states them.
    pub stated: Stated,
    /// Hash of the decoded pixels: equal for the same film in two files.
    pub picture: String,
    /// SOP Instance UID of a DICOM file.
    pub instance: Option<String>,
    /// A thumbnail as PNG.
    pub thumbnail: Vec<u8>,
}

struct Staged {
    owner: Name,
    at: Timestamp,
    /// Size of its file, which may still be arriving.
    bytes: u64,
    /// `None` while it arrives.
    upload: Option<Arc<Upload>>,
}

type Known = BTreeMap<String, Staged>;

/// All uploads by their secret names.
#[derive(Clone)]
pub struct Uploads {
    limits: UploadLimits,
    known: Arc<Mutex<Known>>,
}

/// Room for an arriving upload, freed unless the upload is kept.
pub struct Reservation {
    uploads: Uploads,
    id: String,
}

impl Uploads {
    pub fn new(limits: UploadLimits) -> Self {
        Self { limits, known: Arc::default() }
    }

    fn known(&self) -> MutexGuard<'_, Known> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn kept_ms(&self) -> i64 {
        i64::try_from(self.limits.kept.as_millis()).unwrap_or(i64::MAX)
    }

    fn is_over(&self, staged: &Staged, now: Timestamp) -> bool {
        staged.upload.is_some() && now.unix_ms() - staged.at.unix_ms() >= self.kept_ms()
    }

    /// Reserves room for a file that is about to arrive.
    ///
    /// # Errors
    /// 429 if the room is used up, with a remedy and the time to wait.
    pub fn reserve(&self, owner: &Name, bytes: u64, now: Timestamp) -> Answer<Reservation> {
        self.sweep(now);
        let mut known = self.known();
        let own = || known.values().filter(|staged| staged.owner == *owner);
        if !has_room(own(), self.limits.per_account, bytes) {
            let whose = "your uploaded films that are not in a study";
            let help = "create a study from them, or remove films from the page";
            return Err(self.full(own(), self.limits.per_account, [whose, help], now));
        }
        if !has_room(known.values(), self.limits.in_all, bytes) {
            let whose = "all users' uploaded films that are not in a study";
            let help = "try again later";
            return Err(self.full(known.values(), self.limits.in_all, [whose, help], now));
        }
        let id = secret();
        known.insert(id.clone(), Staged { owner: owner.clone(), at: now, bytes, upload: None });
        Ok(Reservation { uploads: self.clone(), id })
    }

    fn full<'a>(
        &self,
        counted: impl Iterator<Item = &'a Staged>,
        room: UploadRoom,
        [whose, help]: [&str; 2],
        now: Timestamp,
    ) -> Failure {
        let oldest_ms = counted.map(|staged| staged.at.unix_ms()).min();
        let wait_ms = oldest_ms.map_or(0, |at| at + self.kept_ms() - now.unix_ms()).max(0);
        let text = format!(
            "{whose} have reached their limit of {} films or {} MB",
            room.films,
            room.bytes >> 20
        );
        let minutes = wait_ms / 60_000 + 1;
        let help = format!("{help}; the oldest one is dropped in {minutes} min");
        Failure::new(StatusCode::TOO_MANY_REQUESTS, "too_many_uploads", text)
            .help(help)
            .retry_after(u32::try_from(wait_ms / 1000 + 1).unwrap_or(u32::MAX))
    }

    /// An upload of this user.
    pub fn get(&self, owner: &Name, id: &str, now: Timestamp) -> Answer<Arc<Upload>> {
        let known = self.known();
        let found = known.get(id).filter(|s| s.owner == *owner && !self.is_over(s, now));
        found.and_then(|staged| staged.upload.clone()).ok_or_else(|| {
            Failure::new(
                StatusCode::NOT_FOUND,
                "not_found",
                "this upload has expired or does not exist",
            )
            .help("upload the file again; an upload is kept for an hour")
        })
    }

    /// Warnings about a new upload beside others of this user: another file of one film, or another film with its
    /// identifier.
    pub fn twins(&self, owner: &Name, new: &Upload, now: Timestamp) -> Option<Notice> {
        let known = self.known();
        let others = known.values().filter(|s| s.owner == *owner && !self.is_over(s, now));
        let uploads: Vec<&Upload> = others.filter_map(|s| s.upload.as_deref()).collect();
        let (code, text) = if uploads.iter().any(|other| other.picture == new.picture) {
            ("picture_repeated", "another uploaded file holds the same picture")
        } else if uploads.iter().any(|o| o.instance.is_some() && o.instance == new.instance) {
            let text = "another uploaded film has the same SOP Instance UID but different pixels: one was changed without a new identifier";
            (WarningCode::IdentifierRepeated.key(), text)
        } else {
            return None;
        };
        Some(Notice::new(Severity::Warning, code, text))
    }

    /// Forgets uploads that are in a study now, or were discarded.
    pub fn forget<'a>(&self, ids: impl Iterator<Item = &'a str>) {
        let mut known = self.known();
        for id in ids {
            known.remove(id);
        }
    }

    /// Forgets expired uploads.
    pub fn sweep(&self, now: Timestamp) {
        self.known().retain(|_, staged| !self.is_over(staged, now));
    }
}

fn has_room<'a>(
    counted: impl Iterator<Item = &'a Staged>,
    room: UploadRoom,
    new_bytes: u64,
) -> bool {
    let (mut films, mut bytes) = (1, new_bytes);
    for staged in counted {
        films += 1;
        bytes += staged.bytes;
    }
    films <= room.films && bytes <= room.bytes
}

impl Reservation {
    /// Keeps the upload, and returns its secret name.
    pub fn keep(self, upload: Upload, now: Timestamp) -> String {
        if let Some(staged) = self.uploads.known().get_mut(&self.id) {
            let held = upload.bytes.len() + upload.thumbnail.len();
            (staged.at, staged.bytes) = (now, held as u64);
            staged.upload = Some(Arc::new(upload));
        }
        self.id.clone()
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        let mut known = self.uploads.known();
        if known.get(&self.id).is_some_and(|staged| staged.upload.is_none()) {
            known.remove(&self.id);
        }
    }
}
