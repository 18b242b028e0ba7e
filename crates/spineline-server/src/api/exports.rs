//! Files that a study can be exported to.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::ExportFormatName;

/// A file of a study's results.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum ExportName {
    /// The report as one HTML file.
    Report,
    /// The report as PDF/A, where the program was built with it.
    Pdf,
    /// The analysis as JSON.
    Analysis,
    /// All tables as CSV, in an archive.
    TablesCsv,
    /// All tables as Parquet, in an archive.
    TablesParquet,
    /// All figures of the report as SVG and PNG, in an archive.
    Figures,
    /// Landmarks as point lists of 3D Slicer, in an archive.
    Slicer,
    /// Landmarks as DICOM reports, in an archive.
    DicomSr,
}

impl ExportName {
    /// Every export.
    pub const ALL: [Self; 8] = [
        Self::Report,
        Self::Pdf,
        Self::Analysis,
        Self::TablesCsv,
        Self::TablesParquet,
        Self::Figures,
        Self::Slicer,
        Self::DicomSr,
    ];

    /// Its name in the log.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Report => "report",
            Self::Pdf => "pdf",
            Self::Analysis => "analysis",
            Self::TablesCsv => "tables_csv",
            Self::TablesParquet => "tables_parquet",
            Self::Figures => "figures",
            Self::Slicer => "slicer",
            Self::DicomSr => "dicom_sr",
        }
    }
}

/// An export for the menu.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ExportView {
    /// Export.
    pub name: ExportName,
    /// Its name for people.
    pub label: String,
    /// What it holds.
    pub text: String,
}

/// A format of other programs, for the menu.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ModelFormatView {
    /// Format.
    pub name: ExportFormatName,
    /// Its name for people.
    pub label: String,
    /// Programs that read it.
    pub text: String,
}

/// What this program writes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ExportList {
    /// Results of a study.
    pub files: Vec<ExportView>,
    /// The model of one line of action.
    pub models: Vec<ModelFormatView>,
}
