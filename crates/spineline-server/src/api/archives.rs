//! Films from image archives.

use serde::{Deserialize, Serialize};
use spineline_dicomweb::SearchKey;
use utoipa::ToSchema;

/// A search in an archive.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArchiveSearch {
    /// Name of the archive.
    pub archive: String,
    /// By what is searched.
    pub key: SearchKey,
    /// The whole value, without wildcards.
    pub value: String,
    /// Only films of this day, as `YYYY-MM-DD`.
    pub day: Option<String>,
}

/// Series that were found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchiveSeriesList {
    /// At most a hundred.
    pub series: Vec<ArchiveSeries>,
    /// Whether the archive has more than these.
    pub has_more: bool,
}

/// A series of films in an archive, without the patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchiveSeries {
    /// Study Instance UID.
    pub study: String,
    /// Series Instance UID.
    pub series: String,
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
}

/// A series of an archive whose films are requested.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArchiveSeriesChoice {
    /// Name of the archive.
    pub archive: String,
    /// Study Instance UID.
    pub study: String,
    /// Series Instance UID.
    pub series: String,
}

/// Films of a series.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchiveFilmList {
    /// At most a hundred.
    pub films: Vec<ArchiveFilm>,
    /// Whether the archive has more than these.
    pub has_more: bool,
}

/// A film in an archive, without the patient.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct ArchiveFilm {
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

/// A film of an archive to be opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ArchiveFilmChoice {
    /// Name of the archive.
    pub archive: String,
    /// Study Instance UID.
    pub study: String,
    /// Series Instance UID.
    pub series: String,
    /// SOP Instance UID.
    pub instance: String,
}
