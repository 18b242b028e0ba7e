//! The export formats of this program, for the menu.

use spineline_files::ExportFormat;

use crate::api::{Export, ExportList, ExportView, ModelFormatView, Wire};
use crate::extract::Json;
use crate::user::User;

/// The export formats of a study.
#[utoipa::path(get, path = "/api/exports", responses((status = 200, body = ExportList)))]
pub async fn exports(_user: User) -> Json<ExportList> {
    let written = |name: &Export| *name != Export::Pdf || cfg!(feature = "pdf");
    let model = |&format: &ExportFormat| ModelFormatView {
        name: Wire(format),
        label: format.key().to_uppercase(),
        text: format!("for {}", format.programs()),
    };
    Json(ExportList {
        files: Export::ALL.into_iter().filter(written).map(view).collect(),
        models: ExportFormat::ALL.iter().map(model).collect(),
    })
}

fn view(name: Export) -> ExportView {
    let (label, text) = match name {
        Export::Report => {
            ("Report (HTML)", "one file for a browser, with films, figures and the analysis")
        }
        Export::Pdf => ("Report (PDF)", "PDF/A for paper, with the analysis attached"),
        Export::Analysis => {
            ("Analysis (JSON)", "all results and options; the command rerun repeats it")
        }
        Export::TablesCsv => ("Tables (CSV)", "an archive, with a dictionary of the columns"),
        Export::TablesParquet => ("Tables (Parquet)", "the same for data frames"),
        Export::Figures => ("Figures (SVG and PNG)", "an archive of the report's figures"),
        Export::Slicer => ("Landmarks for 3D Slicer", "one point list per film"),
        Export::DicomSr => {
            ("Landmarks as DICOM SR", "one report per reading, where the films are DICOM files")
        }
    };
    ExportView { name: Wire(name), label: label.to_owned(), text: text.to_owned() }
}
