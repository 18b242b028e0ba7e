//! A study's results as files. Each export has an entry in the log of the store.

mod archive;
mod landmarks;
mod menu;
mod model;
mod report;
mod tables;

use std::time::SystemTime;

use axum::extract::State;
use axum::response::Response;
use chrono::{DateTime, SecondsFormat, Utc};
use spineline::analysis::{Analysis, Case};
use spineline::uncertainty::LandmarkNoise;
use spineline_files::{
    AnalysisFile, CaseFile, FilmOrigin, ProgramRun, Provenance, Replicates, Request, to_text,
    with_hash,
};
use spineline_store::Name;
use utoipa_axum::router::OpenApiRouter;
use utoipa_axum::routes;

use super::computations;
use crate::PROGRAM;
use crate::access::{open_study, study_result};
use crate::api::{ExportName, Problem};
use crate::attachment::attachment;
use crate::extract::Path;
use crate::jobs::Computed;
use crate::problem::Answer;
use crate::result_cache::computed;
use crate::state::AppState;
use crate::user::User;

const ZIP: &str = "application/zip";
const JSON: &str = "application/json";

pub fn routes() -> OpenApiRouter<AppState> {
    OpenApiRouter::new()
        .routes(routes!(menu::exports))
        .routes(routes!(export))
        .routes(routes!(model::export_model))
}

/// A file to download.
struct Download {
    /// End of its name, after the study.
    ending: &'static str,
    kind: &'static str,
    bytes: Vec<u8>,
}

/// The results of a study from its finished readings as a file. The log of the store has an entry for it.
#[utoipa::path(get, path = "/api/studies/{study}/exports/{export}",
    params(("study" = String, Path), ("export" = ExportName, Path)),
    responses((status = 200, content_type = "application/octet-stream"),
        (status = 403, body = Problem), (status = 404, body = Problem),
        (status = 409, body = Problem), (status = 422, body = Problem)))]
pub async fn export(
    State(state): State<AppState>,
    user: User,
    Path((study, export)): Path<(String, ExportName)>,
) -> Answer<Response> {
    let study = open_study(&state, &user, &study).await?;
    let result = study_result(&state, &study).await?;
    result.analysed()?;
    let pictures = match export {
        ExportName::Report | ExportName::Pdf | ExportName::Figures => {
            report::pictures(&state, &result).await?
        }
        _ => Vec::new(),
    };
    let sources = match export {
        ExportName::DicomSr => landmarks::sources(&state, &result).await?,
        _ => Default::default(),
    };
    computations::recall(&state, &result).await?;
    let found = state.jobs().computed(&result);
    let made = computed(move || {
        let case = result.current.usable_case();
        let analysis = found.models().map_or_else(|| result.analysed(), Ok)?;
        match export {
            ExportName::Report | ExportName::Pdf | ExportName::Figures => {
                let options = &result.current.options;
                report::download(export, analysis, &case, (options, &pictures, &found))
            }
            ExportName::Analysis => Ok(Download {
                ending: "-analysis.json",
                kind: JSON,
                bytes: with_hash(to_text(&file_of(analysis, &case, &found)).into_bytes()),
            }),
            ExportName::TablesCsv => tables::csv(analysis, &case, &found),
            ExportName::TablesParquet => tables::parquet(analysis, &case, &found),
            ExportName::Slicer => landmarks::slicer(analysis, &case),
            ExportName::DicomSr => landmarks::dicom_sr(analysis, &case, &sources),
        }
    });
    let download = made.await??;
    log(&state, &user, &study, export.key()).await?;
    Ok(attachment(&format!("{study}{}", download.ending), download.kind, download.bytes))
}

/// Logs the export of a file.
pub async fn log(state: &AppState, user: &User, study: &Name, form: &'static str) -> Answer<()> {
    let (study, by) = (study.clone(), user.sign(state.now()));
    state.store(move |store| store.log_export(&study, form, &by)).await
}

/// The analysis file of an analysis of this case, with the finished background computations. Its input is the store;
/// the case is part of the file.
fn file_of(analysis: &Analysis, case: &Case, found: &Computed) -> AnalysisFile {
    let request = Request {
        options: analysis.options.clone(),
        replicates: found.uncertainty().map(|found| Replicates {
            count: found.requested,
            noise: LandmarkNoise::Measured,
            seed: found.seed,
        }),
        identifiability: found.identifiability().is_some(),
    };
    let origin = provenance(analysis).asking(&request);
    let mut file = AnalysisFile::new(analysis, CaseFile::from_case(case), origin);
    if let Some(found) = found.identifiability() {
        file = file.with_identifiability(analysis, found);
    }
    if let Some(found) = found.uncertainty() {
        file = file.with_uncertainty(analysis, found);
    }
    file
}

pub fn provenance(analysis: &Analysis) -> Provenance {
    let run = ProgramRun {
        program: PROGRAM.to_owned(),
        command: vec!["spineline".to_owned(), "serve".to_owned()],
        date_utc: DateTime::<Utc>::from(SystemTime::now())
            .to_rfc3339_opts(SecondsFormat::Secs, true),
    };
    let films = FilmOrigin::of([analysis.synthetic]);
    let request = Request { options: analysis.options.clone(), ..Request::default() };
    let provenance = Provenance::new(run, films, Vec::new());
    provenance.of_cases([analysis.case_id.clone()]).asking(&request)
}

/// For a writer of this program that failed on its own results.
pub fn internal(reason: &dyn std::fmt::Display) -> crate::problem::Failure {
    crate::problem::Failure::new(
        axum::http::StatusCode::INTERNAL_SERVER_ERROR,
        "internal",
        format!("the file could not be written: {reason}"),
    )
}
