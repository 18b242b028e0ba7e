//! Studies, their films, and the bytes of films.

use rusqlite::{Connection, OptionalExtension, Row, params};
use serde_json::Value;
use spineline::anatomy::FilmView;
use spineline::measure::ImageGeometry;

use crate::audit::{self, Ledger, next_id};
use crate::connection::Store;
use crate::error::{StoreError, limit};
use crate::names::{FilmId, Hash, Name, Signature};

/// Largest film, in bytes; a frontal radiograph has some tens of millions.
const MAX_FILM_BYTES: usize = 512 << 20;
/// Longest description of an image, in bytes of JSON.
const MAX_IMAGE_BYTES: usize = 1 << 20;
/// Longest label, in characters.
const MAX_LABEL: usize = 200;

/// A study: the films of one subject.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Study {
    /// Identifier, without the patient's name.
    pub id: Name,
    /// Text of one line; a blank one is stored as none. It appears in no error, log, export or blinded view.
    pub label: Option<String>,
    /// Whether the films are synthetic.
    pub synthetic: bool,
    /// Whether it is archived: nothing in it can be changed.
    pub archived: bool,
    /// Number of edits so far.
    pub revision: u64,
}

impl Study {
    /// A new study.
    #[must_use]
    pub fn new(id: Name, label: Option<String>, synthetic: bool) -> Self {
        Self { id, label, synthetic, archived: false, revision: 0 }
    }
}

/// What a person states about a film.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Stated {
    /// Whether it is a lateral film that was exposed together with the erect one, as biplanar scanners do.
    pub simultaneous: bool,
    /// Whether somebody compared it with the patient's records: patient, posture and levels are right.
    pub checked: bool,
}

/// A film of a study.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmRecord {
    /// Film.
    pub id: FilmId,
    /// Study to which it belongs.
    pub study: Name,
    /// What it shows.
    pub view: FilmView,
    /// What a person states about it.
    pub stated: Stated,
    /// Its bytes, for [`Store::content`].
    pub content: Hash,
    /// The `image` of a case file: size, spacing, sides; read by [`FilmRecord::geometry`] only.
    pub image: Value,
    /// Whether it is shown with inverted grey levels.
    pub inverted: bool,
    /// Number of edits so far.
    pub revision: u64,
}

impl FilmRecord {
    /// Size, spacing and sides of its picture.
    ///
    /// # Errors
    /// [`StoreError::Case`] where a case file cannot have the description.
    pub fn geometry(&self) -> Result<ImageGeometry, StoreError> {
        Ok(spineline_files::parse_image(&self.image, self.view)?)
    }
}

impl Store {
    /// Adds a new study.
    ///
    /// # Errors
    /// [`StoreError::Exists`], also where an identifier differs in upper and lower case alone; [`StoreError::TooLarge`] or
    /// [`StoreError::BadLabel`] for its label.
    pub fn add_study(&mut self, study: &Study, by: &Signature) -> Result<(), StoreError> {
        self.write(by, |ledger| insert_study(ledger, study))
    }

    /// A study.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn study(&self, id: &Name) -> Result<Study, StoreError> {
        self::study(&self.connection, id)
    }

    /// A film.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn film(&self, id: FilmId) -> Result<FilmRecord, StoreError> {
        self::film(&self.connection, id)
    }

    /// All studies, by identifier.
    pub fn studies(&self) -> Result<Vec<Study>, StoreError> {
        study_rows(&self.connection, None)
    }

    /// Adds a film to a study without a reading plan. Equal bytes of two studies are stored once.
    ///
    /// # Errors
    /// [`StoreError::AlreadyKnown`] where a film of this study has the same bytes, in any view; [`StoreError::ViewTwice`] for a second
    /// lateral film; [`StoreError::PlanGoverns`], [`StoreError::Archived`], [`StoreError::ImageNotAnObject`], [`StoreError::TooLarge`],
    /// [`StoreError::Unknown`].
    pub fn add_film(
        &mut self,
        study: &Name,
        view: impl Into<FilmView>,
        bytes: &[u8],
        image: &Value,
        by: &Signature,
    ) -> Result<FilmId, StoreError> {
        let view = view.into();
        let film = NewFilm { view, stated: Stated::default(), bytes, image, inverted: false };
        self.write(by, |ledger| add_film(ledger, study, &film))
    }

    /// The films of a study, in the order in which they were added.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn films(&self, study: &Name) -> Result<Vec<FilmRecord>, StoreError> {
        self::study(&self.connection, study)?;
        films(&self.connection, study)
    }

    /// The bytes of a film, compared with their hash. They are the original file, which may contain the patient's name and the
    /// posture: blinded readers must get the decoded picture instead.
    ///
    /// # Errors
    /// [`StoreError::Unknown`], [`StoreError::Damaged`].
    pub fn content(&self, content: &Hash) -> Result<Vec<u8>, StoreError> {
        let object = format!("content/{content}");
        let query = "SELECT bytes FROM contents WHERE hash = ?1";
        let bytes: Option<Vec<u8>> =
            self.connection.query_row(query, [content.as_str()], |row| row.get(0)).optional()?;
        let bytes = bytes.ok_or_else(|| StoreError::Unknown { object: object.clone() })?;
        if Hash::of(&bytes) == *content { Ok(bytes) } else { Err(StoreError::damaged(object)) }
    }
}

/// A film to be added.
pub(crate) struct NewFilm<'a> {
    pub view: FilmView,
    pub stated: Stated,
    pub bytes: &'a [u8],
    pub image: &'a Value,
    pub inverted: bool,
}

pub(crate) fn insert_study(ledger: &Ledger<'_>, study: &Study) -> Result<(), StoreError> {
    let label = checked_label(study.label.as_deref())?;
    let id = study.id.as_str();
    // Names of results contain the identifier, and some file systems ignore case.
    let alike = "SELECT id FROM studies WHERE id = ?1 COLLATE NOCASE";
    let known = ledger.transaction.query_row(alike, [id], |row| row.get::<_, String>(0));
    if let Some(known) = known.optional()? {
        return Err(StoreError::Exists { object: format!("study/{known}") });
    }
    ledger.transaction.execute(
        "INSERT INTO studies VALUES (?1, ?2, ?3, 0, 0)",
        params![id, label, study.synthetic],
    )?;
    ledger.seal("add", "studies", &id).map(drop)
}

/// A label as it is stored: a blank one is none.
pub(crate) fn checked_label(label: Option<&str>) -> Result<Option<&str>, StoreError> {
    let Some(label) = label.filter(|label| !label.trim().is_empty()) else { return Ok(None) };
    limit("the label (in characters)", label.chars().count(), MAX_LABEL)?;
    if label.contains(hides_text) { Err(StoreError::BadLabel) } else { Ok(Some(label)) }
}

/// Whether a character breaks a line, controls a terminal, is invisible, or changes the direction of the text after it. U+200C and U+200D
/// belong to the spelling of some languages.
fn hides_text(c: char) -> bool {
    let directs = matches!(
        c,
        '\u{61c}'
            | '\u{200b}'
            | '\u{200e}'
            | '\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{2069}'
            | '\u{feff}'
    );
    c.is_control() || directs
}

pub(crate) fn add_film(
    ledger: &Ledger<'_>,
    study: &Name,
    new: &NewFilm<'_>,
) -> Result<FilmId, StoreError> {
    limit("the film (in bytes)", new.bytes.len(), MAX_FILM_BYTES)?;
    if !new.image.is_object() {
        return Err(StoreError::ImageNotAnObject);
    }
    let image = described(new.image, new.stated);
    limit("the image's description (in bytes)", image.len(), MAX_IMAGE_BYTES)?;
    let content = Hash::of(new.bytes);
    let transaction = ledger.transaction;
    open_study(transaction, study)?;
    if is_planned(transaction, study)? {
        return Err(StoreError::PlanGoverns { study: study.clone() });
    }
    let others = films(transaction, study)?;
    if let Some(film) = others.iter().find(|film| film.content == content) {
        let (study, film, view) = (study.clone(), film.id, film.view);
        return Err(StoreError::AlreadyKnown { study, film, view });
    }
    if new.view == FilmView::Lateral && others.iter().any(|film| film.view == new.view) {
        return Err(StoreError::ViewTwice { study: study.clone(), view: new.view });
    }
    keep(ledger, &content, new.bytes)?;
    let film = next_id(transaction, "films", "id")?;
    transaction.execute(
        "INSERT INTO films VALUES (?1, ?2, ?3, ?4, ?5, ?6, 0)",
        params![film, study.as_str(), new.view.key(), content.as_str(), image, new.inverted],
    )?;
    ledger.seal("add", "films", &film)?;
    Ok(FilmId(film))
}

/// The description of an image as stored, with what a person states about the film.
pub(crate) fn described(image: &Value, stated: Stated) -> String {
    let mut image = image.clone();
    for (key, is_stated) in [(SIMULTANEOUS, stated.simultaneous), (CHECKED, stated.checked)] {
        if is_stated {
            image[key] = true.into();
        }
    }
    image.to_string()
}

const SIMULTANEOUS: &str = "simultaneous";
const CHECKED: &str = "checked";

/// Stores bytes unless they exist.
fn keep(ledger: &Ledger<'_>, content: &Hash, bytes: &[u8]) -> Result<(), StoreError> {
    let hash = content.as_str();
    if ledger.transaction.prepare("SELECT 1 FROM contents WHERE hash = ?1")?.exists([hash])? {
        return Ok(());
    }
    ledger.transaction.execute("INSERT INTO contents VALUES (?1, ?2)", params![hash, bytes])?;
    ledger.seal("add", "contents", &hash).map(drop)
}

/// Whether the readings of a study are planned.
pub(crate) fn is_planned(connection: &Connection, study: &Name) -> Result<bool, StoreError> {
    Ok(connection.prepare("SELECT 1 FROM plans WHERE study = ?1")?.exists([study.as_str()])?)
}

fn study_rows(connection: &Connection, id: Option<&Name>) -> Result<Vec<Study>, StoreError> {
    let condition = "WHERE ?1 IS NULL OR id = ?1 ORDER BY id";
    audit::load(connection, "studies", condition, [id.map(Name::as_str)], |row| {
        Ok(Study {
            id: Name::new(&row.get::<_, String>("id")?)?,
            label: row.get("label")?,
            synthetic: row.get("synthetic")?,
            archived: row.get("archived")?,
            revision: row.get::<_, i64>("revision")?.unsigned_abs(),
        })
    })
}

pub(crate) fn study(connection: &Connection, id: &Name) -> Result<Study, StoreError> {
    let unknown = || StoreError::Unknown { object: format!("study/{id}") };
    study_rows(connection, Some(id))?.pop().ok_or_else(unknown)
}

/// A study that can be changed.
///
/// # Errors
/// [`StoreError::Archived`], [`StoreError::Unknown`].
pub(crate) fn open_study(connection: &Connection, id: &Name) -> Result<Study, StoreError> {
    let found = self::study(connection, id)?;
    if found.archived { Err(StoreError::Archived { study: found.id }) } else { Ok(found) }
}

pub(crate) fn films(connection: &Connection, study: &Name) -> Result<Vec<FilmRecord>, StoreError> {
    audit::load(connection, "films", "WHERE study = ?1 ORDER BY id", [study.as_str()], read)
}

pub(crate) fn film(connection: &Connection, film: FilmId) -> Result<FilmRecord, StoreError> {
    let mut found = audit::load(connection, "films", "WHERE id = ?1", [film.0], read)?;
    found.pop().ok_or_else(|| StoreError::Unknown { object: film.to_string() })
}

fn read(row: &Row<'_>) -> Result<FilmRecord, StoreError> {
    let id = FilmId(row.get("id")?);
    let damaged = || StoreError::damaged(id.to_string());
    let view: String = row.get("posture")?;
    let image: String = row.get("image")?;
    let mut image: Value = serde_json::from_str(&image).map_err(|_| damaged())?;
    let mut is_stated = |key| {
        let stated = image.as_object_mut().and_then(|image| image.remove(key));
        stated == Some(Value::Bool(true))
    };
    let stated = Stated { simultaneous: is_stated(SIMULTANEOUS), checked: is_stated(CHECKED) };
    Ok(FilmRecord {
        id,
        study: Name::new(&row.get::<_, String>("study")?)?,
        view: view.parse().map_err(|_| damaged())?,
        stated,
        content: Hash(row.get("content")?),
        image,
        inverted: row.get("inverted")?,
        revision: row.get::<_, i64>("revision")?.unsigned_abs(),
    })
}
