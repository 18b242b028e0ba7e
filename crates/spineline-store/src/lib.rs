//! The study store: one file with studies, films, readings and every event.
//!
//! A [`Store`] is one SQLite file. Everything that is acknowledged is committed and flushed to the disk. Readings are
//! append-only journals of [`Event`]s; their state is a fold over the journal, so that undo survives a reload. Nothing is
//! overwritten: a change based on an old revision is refused **and kept** ([`StoreError::Conflict`],
//! [`Store::conflicts_of_reading`]).
//! Every change has an entry in a hash-chained log. A row that is read is compared with its entry, so a damaged row is
//! an error and never another reading. [`Store::verify`] checks the log itself and finds missing rows.
//!
//! The bytes of films are in the database too, once for all films that share them: only one file must be copied, backed up
//! and locked, and no crash can separate a film from its record.
//!
//! The store keeps permissions ([`Account`], [`StudyGrant`]), and its callers check them. Callers state author and time of
//! each change, or let the store read the clock ([`Signature`]); a blinded reader gets an [`ObserverView`] and nothing else.
//!
//! ```
//! use spineline_store::{Name, Signature, Store, Study, Timestamp};
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("clinic.spineline");
//! let noon = Timestamp::from_unix_ms(1_760_000_000_000).ok_or("a time outside of the calendar")?;
//! let by = Signature::new(Name::new("lead")?, noon);
//! let mut store = Store::create(&path, &by)?;
//! store.add_study(&Study::new(Name::new("S-017")?, None, true), &by)?;
//! assert!(store.verify(None)?.is_clean());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod acceptance;
mod accounts;
mod assembly;
mod audit;
mod backup;
mod beside;
mod cases;
mod computations;
mod conflicts;
mod connection;
mod corrections;
mod current_case;
mod error;
mod event;
mod export;
mod film_edits;
mod films;
mod guessing;
mod heads;
mod journal;
mod log_file;
mod log_steps;
mod names;
mod options;
mod part;
mod password_hash;
mod passwords;
mod plan;
mod plan_design;
mod privacy;
mod readings;
mod restore;
mod schema;
mod sessions;
mod state;
mod study_edits;
mod thumbnails;
mod unsaved;
mod verify;
mod visibility;
mod washout;
mod wire;
mod withdrawals;

#[cfg(test)]
mod full_disk;
#[cfg(test)]
mod restore_killed;
#[cfg(test)]
#[path = "../tests/it/session.rs"]
mod session;

pub use accounts::{Account, AccountChange, Role, RoleName, StudyGrant};
pub use audit::{AuditEntry, Head};
pub use cases::{AddedCase, CaseError, CaseRemark, NewCase};
pub use computations::KeptComputation;
pub use conflicts::{Acknowledged, LostChange};
pub use connection::Store;
pub use current_case::{CaseReadings, ComparedReading, CurrentCase, CurrentFilm};
pub use error::StoreError;
pub use event::{AcceptedVertebra, Corner, CornerName, Event};
pub use export::{ExportRemark, ExportedCase};
pub use film_edits::FilmEdit;
pub use films::{FilmRecord, Stated, Study};
pub use guessing::PasswordFault;
pub use names::{FilmId, Hash, Name, ReadingId, Signature, Timestamp};
pub use options::StudyOptions;
pub use password_hash::PasswordHash;
pub use passwords::Credential;
pub use plan::{BlindFilm, FilmCode, Next, ObserverView, system_random};
pub use plan_design::{OpenPlan, PlanDesign};
pub use privacy::wider_permissions;
pub use readings::ReadingRecord;
pub use restore::Restoration;
pub use sessions::{Access, Session, SessionLimits};
pub use state::{ReadingState, VertebraReading};
pub use study_edits::StudyEdit;
pub use thumbnails::Thumbnails;
pub use verify::{Finding, Verification};
pub use visibility::{ClosedReading, LastChange, SeenReading, Visibility};
pub use wire::{OriginName, SideName, Wire};
pub use withdrawals::{Withdrawal, WithdrawalCause};

// The session of the crash tests is one file, which unit tests use too.
#[cfg(test)]
extern crate self as spineline_store;
