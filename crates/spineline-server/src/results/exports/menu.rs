//! The export formats of this program, for the menu.

use spineline_files::ExportFormat;

use crate::api::{ExportList, ExportName, ExportView, ModelFormatView, Wire};
use crate::extract::Json;
use crate::user::User;

/// The export formats of a study.
#[utoipa::path(get, path = "/api/exports", responses((status = 200, body = ExportList)))]
pub async fn exports(_user: User) -> Json<ExportList> {
    let written = |name: &ExportName| *name != ExportName::Pdf || cfg!(feature = "pdf");
    let model = |&format: &ExportFormat| ModelFormatView {
        name: Wire(format),
        label: format.key().to_uppercase(),
        text: format!("for {}", format.programs()),
    };
    Json(ExportList {
        files: ExportName::ALL.into_iter().filter(written).map(view).collect(),
        models: ExportFormat::ALL.iter().map(model).collect(),
    })
}

fn view(name: ExportName) -> ExportView {
    let (label, text) = match name {
        ExportName::Report => {
            ("Report (HTML)", "one file for a browser, with films, figures and the analysis")
        }
        ExportName::Pdf => ("Report (PDF)", "PDF/A for paper, with the analysis attached"),
        ExportName::Analysis => {
            ("Analysis (JSON)", "all results and options; the command rerun repeats it")
        }
        ExportName::TablesCsv => ("Tables (CSV)", "an archive, with a dictionary of the columns"),
        ExportName::TablesParquet => ("Tables (Parquet)", "the same for data frames"),
        ExportName::Figures => ("Figures (SVG and PNG)", "an archive of the report's figures"),
        ExportName::Slicer => ("Landmarks for 3D Slicer", "one point list per film"),
        ExportName::DicomSr => {
            ("Landmarks as DICOM SR", "one report per reading, where the films are DICOM files")
        }
    };
    ExportView { name, label: label.to_owned(), text: text.to_owned() }
}
