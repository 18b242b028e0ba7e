//! A study's results as files. Each export has an entry in the log of the store.

mod archive;
mod file;
mod landmarks;
mod menu;
mod model;
mod report;
mod tables;

use axum::extract::State;
use axum::response::Response;
use spineline_files::{results_text, with_hash};
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::computations;
use crate::access::OpenResult;
use crate::api::{Export, ExportName, Problem, Wire};
use crate::attachment::attachment;
use crate::extract::Path;
use crate::problem::Answer;
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;
use file::{Download, file_of};
pub use file::{log, provenance};

const JSON: &str = "application/json";

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(menu::exports))
        .routes(routes!(export))
        .routes(routes!(model::export_model))
}

/// The results of a study from its finished readings as a file. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/exports/{export}",
    params(("study" = String, Path), ("export" = ExportName, Path)),
    responses((status = 200, content_type = "application/octet-stream"), Problem))]
pub async fn export(
    State(state): State<AppState>,
    user: User,
    OpenResult(result): OpenResult,
    Path((_, Wire(export))): Path<(String, ExportName)>,
) -> Answer<Response> {
    result.analysed()?;
    let study = result.study.clone();
    let pictures = match export {
        Export::Report | Export::Pdf | Export::Figures => report::pictures(&state, &result).await?,
        _ => Vec::new(),
    };
    let sources = match export {
        Export::DicomSr => landmarks::sources(&state, &result).await?,
        _ => Default::default(),
    };
    computations::recall(&state, &result).await?;
    let found = state.jobs.computed(&result);
    let made = computed(move || {
        let case = result.current.usable_case();
        let analysis = found.models().map_or_else(|| result.analysed(), Ok)?;
        match export {
            Export::Report | Export::Pdf | Export::Figures => {
                let options = &result.current.options;
                let document = report::document(analysis, &case, options, &pictures, &found);
                report::download(export, &document, analysis)
            }
            Export::Analysis => Ok(Download {
                ending: "-analysis.json",
                kind: JSON,
                bytes: with_hash(results_text(&file_of(analysis, &case, &found)).into_bytes()),
            }),
            Export::TablesCsv => tables::csv(analysis, &case, &found),
            Export::TablesParquet => tables::parquet(analysis, &case, &found),
            Export::Slicer => landmarks::slicer(analysis, &case),
            Export::DicomSr => landmarks::dicom_sr(analysis, &case, &sources),
        }
    });
    let download = made.await??;
    log(&state, &user, &study, export.key()).await?;
    Ok(attachment(&format!("{study}{}", download.ending), download.kind, download.bytes))
}
