//! Files of an analysis: their provenance, and their entries in the log.

use std::time::SystemTime;

use chrono::{DateTime, SecondsFormat, Utc};
use spineline::analysis::{Analysis, Case};
use spineline::uncertainty::LandmarkNoise;
use spineline_files::{
    AnalysisFile, CaseFile, FilmOrigin, ProgramRun, Provenance, Replicates, Request,
};
use spineline_store::Name;

use crate::PROGRAM;
use crate::jobs::Computed;
use crate::problem::{Answer, Failure};
use crate::state::AppState;
use crate::user::User;

pub const ZIP: &str = "application/zip";

/// A file to download.
pub struct Download {
    /// End of its name, after the study.
    pub ending: &'static str,
    pub kind: &'static str,
    pub bytes: Vec<u8>,
}

/// Logs the export of a file.
pub async fn log(state: &AppState, user: &User, study: &Name, form: &'static str) -> Answer<()> {
    let (study, by) = (study.clone(), user.sign());
    state.store(move |store| store.log_export(&study, form, &by)).await
}

/// The analysis file of an analysis of this case, with the finished background computations. Its input is the store;
/// the case is part of the file.
pub fn file_of(analysis: &Analysis, case: &Case, found: &Computed) -> AnalysisFile {
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
    let file = AnalysisFile::new(analysis, CaseFile::from_case(case), origin);
    let file = file.with_identifiability(analysis, found.identifiability());
    file.with_uncertainty(analysis, found.uncertainty())
}

/// Program, options and case of an analysis.
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
pub fn internal(reason: &dyn std::fmt::Display) -> Failure {
    Failure::internal(format!("the file could not be written: {reason}"))
}
