//! Searches and their results.

use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::ToSchema;

use crate::answer::{self, Attributes};
use crate::archive::Archive;
use crate::error::DicomwebError;

/// Maximum length of a searched value (LO, SH and UI have at most 64 characters).
const MAX_VALUE: usize = 64;
/// Maximum number of entries of a list.
pub(crate) const MAX_FOUND: usize = 100;

/// Key of a search: exact values that name one patient or one order, so that users cannot browse an archive. Names are not
/// accepted: they match several patients and would enter the program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ArchiveKey)]
pub enum SearchKey {
    /// Patient ID (0010,0020).
    PatientId,
    /// Accession Number (0008,0050).
    AccessionNumber,
}

impl SearchKey {
    /// Name of its parameter, and its tag.
    const fn attribute(self) -> (&'static str, &'static str) {
        match self {
            Self::PatientId => ("PatientID", answer::PATIENT_ID),
            Self::AccessionNumber => ("AccessionNumber", answer::ACCESSION_NUMBER),
        }
    }
}

/// A search for series. Its value is exact: wildcards are refused.
#[derive(Clone, PartialEq, Eq)]
pub struct Search {
    key: SearchKey,
    value: String,
    /// As `YYYYMMDD`.
    day: Option<String>,
}

/// Without the value, which names a patient.
impl std::fmt::Debug for Search {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Search").field("key", &self.key).finish_non_exhaustive()
    }
}

/// An invalid search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum BadQuery {
    /// Nothing, or too much.
    #[error("the value has {length} characters, and must have 1 to {MAX_VALUE}")]
    Length {
        /// Its characters.
        length: usize,
    },
    /// A wildcard, a list or a control character.
    #[error("the value has a character that is not allowed (* ? \\ or a control character)")]
    Character,
    /// Not a date.
    #[error("the date is not of the form YYYY-MM-DD")]
    Day,
    /// Not a UID.
    #[error("a UID has digits and dots only, at most {MAX_VALUE} of them")]
    Uid,
}

impl BadQuery {
    /// What to do about it.
    #[must_use]
    pub const fn help(&self) -> &'static str {
        match self {
            Self::Length { .. } | Self::Character => {
                "type the whole Patient ID or Accession Number, as the archive has it"
            }
            Self::Day => "give the day of the film, such as 2024-05-17, or no date",
            Self::Uid => "search again, and choose from the list",
        }
    }
}

impl Search {
    /// Checks a value.
    pub fn new(key: SearchKey, value: &str) -> Result<Self, BadQuery> {
        let value = value.trim();
        let length = value.chars().count();
        if length == 0 || length > MAX_VALUE {
            return Err(BadQuery::Length { length });
        }
        if value.chars().any(|c| c.is_control() || matches!(c, '*' | '?' | '\\')) {
            return Err(BadQuery::Character);
        }
        Ok(Self { key, value: value.to_owned(), day: None })
    }

    /// Limits the search to one day, as `YYYY-MM-DD`.
    ///
    /// # Errors
    /// [`BadQuery::Day`].
    pub fn on(self, day: &str) -> Result<Self, BadQuery> {
        let digits = day.replace('-', "");
        if crate::query::day(&digits).as_deref() != Some(day) {
            return Err(BadQuery::Day);
        }
        Ok(Self { day: Some(digits), ..self })
    }

    /// Names and values of its parameters.
    pub(crate) fn parameters(&self) -> Vec<(&'static str, &str)> {
        let day = self.day.as_deref().map(|day| ("StudyDate", day));
        [(self.key.attribute().0, &self.value[..])].into_iter().chain(day).collect()
    }

    /// The tag of the key, which an answer should have.
    pub(crate) const fn tag(&self) -> &'static str {
        self.key.attribute().1
    }

    /// Whether an entry matches the search. Archives that do not know a parameter return everything; an entry without
    /// the attribute is accepted.
    pub(crate) fn holds(&self, entry: &Value) -> bool {
        let stated = Attributes(entry).text(self.tag());
        let day = Attributes(entry).text(answer::STUDY_DATE);
        stated.is_none_or(|stated| stated.eq_ignore_ascii_case(&self.value))
            && day.zip(self.day.as_ref()).is_none_or(|(stated, asked)| stated == *asked)
    }

    /// A series of an answer; the searched patient is used if the entry does not state one.
    pub(crate) fn series(&self, entry: &Value) -> Result<SeriesFound, &'static str> {
        let by_search = (self.key == SearchKey::PatientId).then(|| self.value.clone());
        let stated = Attributes(entry).text(answer::PATIENT_ID);
        Ok(SeriesFound { patient: stated.or(by_search).map(PatientId), ..series(entry)? })
    }
}

/// A Patient ID (0010,0020). It is only compared with a file's, and never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct PatientId(String);

impl PatientId {
    /// The value.
    #[must_use]
    pub fn value(&self) -> &str {
        &self.0
    }
}

/// Without the value, which names a patient.
impl std::fmt::Debug for PatientId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_tuple("PatientId").finish_non_exhaustive()
    }
}

/// Checks that a text is a UID, because it becomes part of a path.
fn checked(uid: &str) -> Result<(), BadQuery> {
    let good = !uid.is_empty()
        && uid.len() <= MAX_VALUE
        && uid.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
        && uid.split('.').all(|part| !part.is_empty());
    if good { Ok(()) } else { Err(BadQuery::Uid) }
}

/// A series of a study.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct SeriesUid {
    study: String,
    series: String,
}

impl SeriesUid {
    /// By its UIDs.
    ///
    /// # Errors
    /// [`BadQuery::Uid`].
    pub fn new(study: &str, series: &str) -> Result<Self, BadQuery> {
        checked(study)?;
        checked(series)?;
        Ok(Self { study: study.to_owned(), series: series.to_owned() })
    }

    /// Study Instance UID.
    #[must_use]
    pub fn study(&self) -> &str {
        &self.study
    }

    /// Series Instance UID.
    #[must_use]
    pub fn series(&self) -> &str {
        &self.series
    }
}

/// A film of a series.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilmUid {
    /// Its series.
    pub series: SeriesUid,
    instance: String,
}

impl FilmUid {
    /// By its UID within a series.
    ///
    /// # Errors
    /// [`BadQuery::Uid`].
    pub fn new(series: SeriesUid, instance: &str) -> Result<Self, BadQuery> {
        checked(instance)?;
        Ok(Self { series, instance: instance.to_owned() })
    }

    /// SOP Instance UID.
    #[must_use]
    pub fn instance(&self) -> &str {
        &self.instance
    }

    /// Refuses a file from an archive that is not this film.
    ///
    /// # Errors
    /// [`DicomwebError::OtherFilm`] with the first UID that differs or is not stated.
    ///
    /// ```
    /// use spineline_dicomweb::{Archive, FilmUid, SeriesUid, StatedUids};
    /// let archive = Archive::parse("archive=http://localhost:8042/dicom-web").unwrap();
    /// let film = FilmUid::new(SeriesUid::new("1.2", "1.2.3")?, "1.2.3.4")?;
    /// let file = StatedUids { study: Some("1.9"), series: Some("1.2.3"), instance: Some("1.2.3.4") };
    /// assert!(film.check(&archive, file).is_err());
    /// # Ok::<(), spineline_dicomweb::BadQuery>(())
    /// ```
    pub fn check(&self, archive: &Archive, file: StatedUids<'_>) -> Result<(), DicomwebError> {
        let uids = [
            ("Study Instance UID", self.series.study(), file.study),
            ("Series Instance UID", self.series.series(), file.series),
            ("SOP Instance UID", self.instance(), file.instance),
        ];
        match uids.into_iter().find(|(_, asked, found)| *found != Some(*asked)) {
            None => Ok(()),
            Some((attribute, asked, found)) => Err(DicomwebError::OtherFilm {
                archive: archive.name().to_owned(),
                attribute,
                asked: asked.to_owned(),
                found: found.map(str::to_owned),
            }),
        }
    }
}

/// Entries of an answer, and whether the archive has more.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Found<T> {
    /// At most a hundred.
    pub all: Vec<T>,
    /// Whether the archive has more than these.
    pub has_more: bool,
}

/// UIDs of a film as its file states them.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StatedUids<'a> {
    /// Study Instance UID.
    pub study: Option<&'a str>,
    /// Series Instance UID.
    pub series: Option<&'a str>,
    /// SOP Instance UID.
    pub instance: Option<&'a str>,
}

/// A series of films in an archive. Its JSON has no patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = ArchiveSeries)]
pub struct SeriesFound {
    /// Study Instance UID.
    study: String,
    /// Series Instance UID.
    series: String,
    /// Day of the study, as `YYYY-MM-DD`.
    pub day: Option<String>,
    /// Modality, such as `DX`.
    pub modality: Option<String>,
    /// Description; free text of the archive.
    pub description: Option<String>,
    /// Part of the body.
    pub body_part: Option<String>,
    /// Number of its films.
    pub films: Option<u32>,
    /// Patient of the series, from the archive or from the search; only for comparison.
    #[serde(skip)]
    pub patient: Option<PatientId>,
}

impl SeriesFound {
    /// Its UIDs.
    #[must_use]
    pub fn uid(&self) -> SeriesUid {
        SeriesUid { study: self.study.clone(), series: self.series.clone() }
    }
}

/// A film in an archive, without the patient.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
#[schema(as = ArchiveFilm)]
pub struct FilmFound {
    /// SOP Instance UID.
    pub instance: String,
    /// Its number in the series.
    pub number: Option<u32>,
    /// Pixels in a row.
    pub columns: Option<u32>,
    /// Rows.
    pub rows: Option<u32>,
    /// View, such as `PA`.
    pub view: Option<String>,
}

/// Attributes of a series to request.
pub(crate) const OF_SERIES: [&str; 7] = [
    answer::STUDY_DATE,
    answer::MODALITY,
    answer::STUDY_DESCRIPTION,
    answer::SERIES_DESCRIPTION,
    answer::BODY_PART,
    answer::SERIES_INSTANCES,
    answer::PATIENT_ID,
];
/// Attributes of a film to request.
pub(crate) const OF_FILM: [&str; 4] =
    [answer::INSTANCE_NUMBER, answer::COLUMNS, answer::ROWS, answer::VIEW_POSITION];

pub(crate) fn series(entry: &Value) -> Result<SeriesFound, &'static str> {
    let of = Attributes(entry);
    let uid = SeriesUid::new(&of.uid(answer::STUDY_UID)?, &of.uid(answer::SERIES_UID)?);
    let SeriesUid { study, series } = uid.map_err(|_| "a UID is invalid")?;
    let descriptions = [answer::STUDY_DESCRIPTION, answer::SERIES_DESCRIPTION];
    let mut texts: Vec<String> = descriptions.iter().filter_map(|tag| of.text(tag)).collect();
    texts.dedup();
    Ok(SeriesFound {
        study,
        series,
        day: of.text(answer::STUDY_DATE).and_then(|date| day(&date)),
        modality: of.text(answer::MODALITY),
        description: Some(texts.join(", ")).filter(|text| !text.is_empty()),
        body_part: of.text(answer::BODY_PART),
        films: of.count(answer::SERIES_INSTANCES),
        patient: None,
    })
}

pub(crate) fn film(of_series: &SeriesUid, entry: &Value) -> Result<FilmFound, &'static str> {
    let of = Attributes(entry);
    let asked = [(answer::STUDY_UID, of_series.study()), (answer::SERIES_UID, of_series.series())];
    if asked.iter().any(|(tag, asked)| of.text(tag).is_some_and(|stated| stated != *asked)) {
        return Err("it has films of another series");
    }
    let instance = of.uid(answer::INSTANCE_UID)?;
    checked(&instance).map_err(|_| "a UID is invalid")?;
    Ok(FilmFound {
        instance,
        number: of.count(answer::INSTANCE_NUMBER),
        columns: of.count(answer::COLUMNS),
        rows: of.count(answer::ROWS),
        view: of.text(answer::VIEW_POSITION),
    })
}

/// A date of DICOM as `YYYY-MM-DD`.
fn day(date: &str) -> Option<String> {
    let is_date = date.len() == 8 && date.bytes().all(|byte| byte.is_ascii_digit());
    is_date.then(|| format!("{}-{}-{}", &date[..4], &date[4..6], &date[6..]))
}
