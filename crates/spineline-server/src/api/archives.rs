//! Films from image archives.

use serde::{Deserialize, Serialize};
use spineline_dicomweb::{FilmFound, SearchKey, SeriesFound};
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
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ArchiveSeriesList {
    /// At most a hundred.
    pub series: Vec<SeriesFound>,
    /// Whether the archive has more than these.
    pub has_more: bool,
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
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct ArchiveFilmList {
    /// At most a hundred.
    pub films: Vec<FilmFound>,
    /// Whether the archive has more than these.
    pub has_more: bool,
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
