//! Files that a study can be exported to.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::{ExportFormatName, Wire};

spineline::named! {
    /// A file of a study's results.
    pub enum Export {
        /// The report as one HTML file.
        Report = "report",
        /// The report as PDF/A, where the program was built with it.
        Pdf = "pdf",
        /// The analysis as JSON.
        Analysis = "analysis",
        /// All tables as CSV, in an archive.
        TablesCsv = "tables_csv",
        /// All tables as Parquet, in an archive.
        TablesParquet = "tables_parquet",
        /// All figures of the report as SVG and PNG, in an archive.
        Figures = "figures",
        /// Landmarks as point lists of 3D Slicer, in an archive.
        Slicer = "slicer",
        /// Landmarks as DICOM reports, in an archive.
        DicomSr = "dicom_sr",
    }
}

/// A file of a study's results.
pub type ExportName = Wire<Export>;

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
