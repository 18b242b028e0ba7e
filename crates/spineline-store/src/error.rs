//! Errors of a store. They contain identifiers and numbers, never labels, notes or the contents of films.

use std::path::PathBuf;

use rusqlite::ErrorCode;
use rusqlite::ffi::SQLITE_READONLY_DBMOVED;
use spineline::anatomy::{FilmView, Level};

use crate::guessing::PasswordFault;
use crate::names::{FilmId, Name, ReadingId, Timestamp};

const NAME_HELP: &str = "choose another name";
const RIGHTS_HELP: &str =
    "give this user the right to write the file and its folder, or copy the store elsewhere";
const DISK_HELP: &str = "check the disk, its cable or its network, and repeat";

spineline::faults! {
    /// Why the store refused or failed. A refusal changes no state, except that a [`Conflict`](Self::Conflict) stores the refused
    /// event.
    ///
    /// Everything that reads a store may find it [`Damaged`](Self::Damaged) or [`Busy`](Self::Busy): a method names its other errors.
    #[derive(Debug, thiserror::Error)]
    #[non_exhaustive]
    pub enum StoreError {
        /// The file does not exist.
        #[error("{}: store not found", path.display())]
        #[help("check the name, or make a store with `spineline study create STORE`")]
        NotFound {
            path: PathBuf,
        },
        /// The folder of a new store does not exist.
        #[error("{}: its folder does not exist", path.display())]
        #[help("check the path, or make the folder first")]
        NoFolder {
            /// The store.
            path: PathBuf,
        },
        /// A file of this name is there already.
        #[error("{}: exists already", path.display())]
        #[help(NAME_HELP)]
        AlreadyExists {
            path: PathBuf,
        },
        /// The file is not a store.
        #[error("{}: not a Spineline store", path.display())]
        #[help("name a file that Spineline created as a store")]
        NotAStore {
            path: PathBuf,
        },
        /// SQLite's log or journal beside the store is damaged or belongs to another store.
        #[error(
            "{}: this log is damaged, or belongs to another store or to another version of this one; the log and the store were not changed",
            log.display()
        )]
        #[help("to use the store without this log, move the log to another folder; to put a backup in the place of the store, use `spineline study restore BACKUP STORE`")]
        UnfittingLog {
            log: PathBuf,
        },
        /// Another program has the store open, so it cannot be replaced.
        #[error("another program has the store open")]
        #[help("stop the server and other programs that use the store, and repeat")]
        Held,
        /// Backup and store are the same file.
        #[error("{}: a store cannot be restored from itself", path.display())]
        #[help("name a backup")]
        SameFile {
            /// The store.
            path: PathBuf,
        },
        /// A backup that cannot be read.
        #[error("{}; the store was not changed", backup_words(error))]
        #[help(backup_help(error))]
        Backup {
            /// Why.
            error: Box<Self>,
        },
        /// Written by a newer program.
        #[error("the study store has schema {found}; this program supports schemas up to {supported}")]
        #[help("install a newer Spineline; the file was not touched")]
        NewerSchema {
            /// Schema of the file.
            found: i64,
            /// Newest schema known here.
            supported: i64,
        },
        /// The file or its folder is read-only.
        #[error("the store cannot be written: its file or folder is read-only")]
        #[help(RIGHTS_HELP)]
        ReadOnly,
        /// Another file has the name of the store that is open.
        #[error("the store was replaced or moved while it was open; nothing was saved by this step")]
        #[help("start the server again: it then opens the store that has the name now")]
        Replaced,
        /// The file could not be opened.
        #[error("the store, or a file beside it, cannot be opened")]
        #[help(RIGHTS_HELP)]
        CannotOpen,
        /// No room.
        #[error("the disk or its quota is full; nothing was saved by this step")]
        #[help("free disk space and repeat the command")]
        Full,
        /// Another program holds the store.
        #[error("another program is writing to the store, and did not finish in time")]
        #[help("try again; if the error remains, close other programs that use the store")]
        Busy,
        /// The file was changed or damaged.
        #[error("the store is damaged{}", object.as_ref().map(|o| format!(" at {o}")).unwrap_or_default())]
        #[help("verify it, and restore a backup with `spineline study restore BACKUP STORE`, which keeps the damaged file")]
        Damaged {
            /// Which object, where it is known.
            object: Option<String>,
        },
        /// Reading or writing failed below the database.
        #[error("the disk failed (SQLite code {extended_code})")]
        #[help(DISK_HELP)]
        Disk {
            /// SQLite's extended result code.
            extended_code: i32,
        },
        /// A file beside the store.
        #[error("{}: {source}", path.display())]
        #[help(DISK_HELP)]
        File {
            path: PathBuf,
            source: std::io::Error,
        },
        /// SQLite refused a statement for another reason.
        #[error("the database refused (SQLite code {extended_code})")]
        #[help("report this as a bug, with the code")]
        Database {
            /// SQLite's extended result code; 0 where the library and not SQLite refused.
            extended_code: i32,
        },
        /// An invalid identifier. The text is not repeated, because it might be a name.
        #[error(
            "an identifier must have 1 to 64 ASCII letters, digits, `.`, `-` or `_`, and not dots alone; this one with {characters} characters does not"
        )]
        #[help("use a code such as `S-017`, without the patient's name")]
        BadName {
            /// Its length.
            characters: usize,
        },
        /// A label with characters that hide or reorder text. The label is not repeated.
        #[error("the label has a control character, or one that is invisible or changes the direction of text")]
        #[help("type the label again, in one line")]
        BadLabel,
        /// A name that is twice in a list.
        #[error("{name} is given twice")]
        #[help("give every name once")]
        NameTwice {
            name: Name,
        },
        /// The object does not exist.
        #[error("no {object} in this store")]
        #[help("check the name")]
        Unknown {
            /// Such as `film/3`.
            object: String,
        },
        /// An object that is there already.
        #[error("{object} exists already")]
        #[help(exists_help(object))]
        Exists {
            /// Such as `study/S1`.
            object: String,
        },
        /// The study already contains the same bytes.
        #[error("the same picture is already {film}, the {view} film of study {study}")]
        #[help("check whether one film was exported under two names")]
        AlreadyKnown {
            study: Name,
            /// Film that has these bytes.
            film: FilmId,
            view: FilmView,
        },
        /// A password that is too short, too long or easy to guess.
        #[error("{0}")]
        #[help("use an unusual sentence, such as four words that do not belong together")]
        BadPassword(PasswordFault),
        /// No enabled admin would remain.
        #[error("account {name} is the last enabled admin")]
        #[help("give another account the role `admin` first")]
        LastAdmin {
            /// Account.
            name: Name,
        },
        /// Something too large.
        #[error("{what} has {found}; the limit is {limit}")]
        #[help("split it, or remove parts that are not needed")]
        TooLarge {
            what: &'static str,
            /// Its size.
            found: usize,
            limit: usize,
        },
        /// An image description that is not a JSON object.
        #[error("the description of an image must be a JSON object")]
        #[help("give columns, rows, spacing and `patient_left` as a JSON object")]
        ImageNotAnObject,
        /// The change was based on an old revision. It was kept as a conflict.
        #[error(
            "{object} is at revision {found}, not {expected}; the rejected change was kept as conflict {conflict}"
        )]
        #[help("compare both versions, and repeat the change on the newest one")]
        Conflict {
            /// Such as `reading/4`.
            object: String,
            /// Revision on which the change was based.
            expected: u64,
            /// Revision found.
            found: u64,
            /// Where the change was kept.
            conflict: i64,
        },
        /// A finished reading is immutable.
        #[error("{reading} is finished")]
        #[help("correct it: a copy opens as a new reading, and replaces it when it is finished")]
        Finished {
            reading: ReadingId,
        },
        /// A reading with a number that does not follow the observer's earlier readings of the film.
        #[error("{film}: the next reading of this observer is number {next}, not {repeat}")]
        #[help("begin the next reading of the film")]
        BadRepeat {
            film: FilmId,
            /// Number that was asked for.
            repeat: u32,
            /// Number after the observer's last one.
            next: u32,
        },
        /// A reading can be changed by its observer only.
        #[error("{reading} belongs to another observer")]
        #[help("open your own reading of this film")]
        NotYours {
            reading: ReadingId,
        },
        /// An event that is invalid after those before it.
        #[error("{reading}: {reason}")]
        #[help("reload the reading")]
        BadEvent {
            reading: ReadingId,
            reason: &'static str,
        },
        /// A step without any event.
        #[error("a step needs at least one event")]
        #[help("send at least one event")]
        NoEvent,
        /// A vertebra without all four corners.
        #[error("{reading}: {level} has {corners} of four corners")]
        #[help("place the missing corners, or remove the vertebra")]
        Incomplete {
            reading: ReadingId,
            level: Level,
            corners: usize,
        },
        /// Films and readings of a planned study follow the plan.
        #[error("study {study} has a reading plan; the plan determines films, observers and dates")]
        #[help("ask for the observer's next film, or make a new study")]
        PlanGoverns {
            study: Name,
        },
        /// A change of a film, or the withdrawal of a reading, while a plan runs.
        #[error(
            "films and readings of study {study} stay as they are until all planned readings are finished"
        )]
        #[help("repeat the change when the plan is complete")]
        PlanRuns {
            study: Name,
        },
        /// A change of an outdated plan.
        #[error("another plan of study {study} replaced this one")]
        #[help("load the study again, and change its newest plan")]
        PlanReplaced {
            study: Name,
        },
        /// A change in an archived study.
        #[error("study {study} is archived: nothing in it can be changed")]
        #[help("restore the study first: *Edit this study…* does it, or `spineline study archive --undo`")]
        Archived {
            study: Name,
        },
        /// The restoring of a study that is not archived.
        #[error("study {study} is not archived")]
        #[help("check the identifier: `spineline study list` marks archived studies")]
        NotArchived {
            study: Name,
        },
        /// A change of a withdrawn reading.
        #[error("{reading} is withdrawn")]
        #[help("begin a new reading of the film")]
        Withdrawn {
            reading: ReadingId,
        },
        /// A correction of a reading that is not finished.
        #[error("{reading} is not finished")]
        #[help("change its landmarks directly")]
        NotFinished {
            reading: ReadingId,
        },
        /// A withdrawal without a reason.
        #[error("the withdrawal of {reading} has no reason")]
        #[help("give a reason, such as `T6 was placed on T7`")]
        NoReason {
            reading: ReadingId,
        },
        /// A release of a plan in which no finished reading has a time in the future.
        #[error("no finished reading of study {study} has a time ahead of the clock")]
        #[help("wait until the washout is over; `spineline study next` prints when")]
        NothingAhead {
            study: Name,
        },
        /// A plan without films, observers or repeats, or of too many, or with a long washout.
        #[error("a plan needs {needs}")]
        #[help(*remedy)]
        BadPlan {
            needs: &'static str,
            remedy: &'static str,
        },
        /// A film code that is not the observer's next one.
        #[error("this film is not the next one of this observer")]
        #[help("ask for the next film again")]
        OutOfTurn,
        /// A repeat before its washout is over.
        #[error("this film can be read from {until}")]
        #[help("read the film on or after that date")]
        Washout {
            until: Timestamp,
        },
        /// Two films of one posture, or two lateral ones.
        #[error("study {study} has more than one {view} film")]
        #[help(match view {
            FilmView::Lateral => "choose one lateral film",
            FilmView::Frontal(_) => "correct the posture of one of them",
        })]
        ViewTwice {
            study: Name,
            /// What both show.
            view: FilmView,
        },
        /// A posture for the lateral film.
        #[error("{film} is the lateral film and has no posture")]
        #[help("make a new study with this film as a frontal one")]
        NotFrontal {
            film: FilmId,
        },
        /// Another side of the patient on a film whose landmarks are named by the present one.
        #[error("{reading} names the landmarks of {film} by the patient's side")]
        #[help("withdraw all readings of the film first")]
        HasReading {
            film: FilmId,
            reading: ReadingId,
        },
        /// A case file cannot hold the stored data.
        #[error("the study cannot be exported as a case: {0}")]
        #[help(error.help())]
        Case(#[from] spineline_files::FileError as error),
    }
}

impl Name {
    /// Checks an identifier.
    ///
    /// # Errors
    /// [`StoreError::BadName`], which does not repeat the text: it might be a patient's name.
    pub fn new(text: &str) -> Result<Self, StoreError> {
        let characters = text.chars().count();
        Self::checked(text).ok_or(StoreError::BadName { characters })
    }
}

impl StoreError {
    /// Whether a full disk prevents the change, while reading still works.
    pub(crate) fn is_no_room(&self) -> bool {
        matches!(self, Self::Full | Self::Disk { .. } | Self::CannotOpen)
    }

    pub(crate) fn damaged(object: impl Into<String>) -> Self {
        Self::Damaged { object: Some(object.into()) }
    }
}

/// What to do where an object is there already: only studies and accounts have names that a person chooses.
fn exists_help(object: &str) -> &'static str {
    if object.starts_with("reading/") {
        "load the film again, and continue that reading"
    } else if object.starts_with("the plan ") {
        "load the study again: until the first reading begins, *Change the plan…* or `spineline study plan` changes the plan"
    } else if object.starts_with("study/") {
        "choose another name, which differs in more than upper and lower case"
    } else {
        NAME_HELP
    }
}

/// What is wrong with a backup that is to be restored.
fn backup_words(error: &StoreError) -> String {
    match error {
        StoreError::NotFound { path } => format!("{}: backup not found", path.display()),
        StoreError::Damaged { .. } => error.to_string().replacen("store", "backup", 1),
        _ => error.to_string(),
    }
}

fn backup_help(error: &StoreError) -> &'static str {
    match error {
        StoreError::NotFound { .. } => "check the name of the backup",
        StoreError::Damaged { .. } => "restore another backup; `spineline study verify` checks one",
        _ => error.help(),
    }
}

/// Refuses values above a limit.
pub(crate) fn limit(what: &'static str, found: usize, limit: usize) -> Result<(), StoreError> {
    if found > limit { Err(StoreError::TooLarge { what, found, limit }) } else { Ok(()) }
}

impl From<rusqlite::Error> for StoreError {
    /// Keeps the code and drops the text, which may quote stored values.
    fn from(error: rusqlite::Error) -> Self {
        use rusqlite::Error as E;
        let Some(failure) = error.sqlite_error() else {
            return match error {
                // Every statement here is tested, so a column of another type shows a foreign file.
                E::FromSqlConversionFailure(..)
                | E::IntegralValueOutOfRange(..)
                | E::InvalidColumnType(..)
                | E::Utf8Error(..)
                | E::QueryReturnedNoRows => Self::Damaged { object: None },
                _ => Self::Database { extended_code: 0 },
            };
        };
        let extended_code = failure.extended_code;
        match failure.code {
            _ if extended_code == SQLITE_READONLY_DBMOVED => Self::Replaced,
            ErrorCode::DiskFull => Self::Full,
            ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked => Self::Busy,
            ErrorCode::ReadOnly | ErrorCode::PermissionDenied => Self::ReadOnly,
            ErrorCode::CannotOpen => Self::CannotOpen,
            ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase => Self::Damaged { object: None },
            ErrorCode::SystemIoFailure => Self::Disk { extended_code },
            _ => Self::Database { extended_code },
        }
    }
}
