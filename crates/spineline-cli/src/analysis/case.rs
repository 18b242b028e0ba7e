//! One case analysed.

use std::path::Path;

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::cohort::{RefusalStep, RefusedCase};
use spineline_files::method_text::missing_known_force;

use crate::analysis::films::check_films;
use crate::analysis::record::RunRecord;
use crate::run::failure::Failure;
use crate::run::inputs::CaseInput;
use crate::run::provenance::shown_name;

/// A case without a result, and what to do about it.
pub struct Refusal {
    pub case: Box<RefusedCase>,
    pub failure: Failure,
}

impl Refusal {
    /// The refusal of a case file; `input` is the case, if it was read.
    pub fn new(
        path: &Path,
        input: Option<&CaseInput>,
        step: RefusalStep,
        failure: Failure,
    ) -> Self {
        let file = shown_name(path);
        // Failures name the file as the command line does.
        let reason = failure.what().replace(&path.display().to_string(), &file);
        let reason = reason.strip_prefix(&format!("{file}: ")).unwrap_or(&reason).to_owned();
        let case_id = input.map(|input| input.case.id.clone());
        Self { case: Box::new(RefusedCase { file, case_id, step, reason }), failure }
    }
}

/// Reads and analyses a case of a cohort.
///
/// # Errors
/// If the file does not hold a case, the record refuses it, or the analysis fails.
pub fn analyze_member(path: &Path, record: &RunRecord) -> Result<(CaseInput, Analysis), Refusal> {
    let input = CaseInput::read(path)
        .map_err(|failure| Refusal::new(path, None, RefusalStep::Reading, failure))?;
    let analyzed = record
        .check_learned(&input)
        .and_then(|()| analyze_input(path, &input, &record.request.options));
    match analyzed {
        Ok(analysis) => Ok((input, analysis)),
        Err(failure) => Err(Refusal::new(path, Some(&input), RefusalStep::Analysis, failure)),
    }
}

/// Analyses a case that was read, after a comparison of the pictures beside it.
///
/// # Errors
/// If two films are the same picture, or the case cannot be analysed.
pub fn analyze_input(
    path: &Path,
    input: &CaseInput,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    let found = check_films(path, &input.file, &input.case)?;
    let mut analysis = analyze_case(path, &input.case, options)?;
    analysis.warnings.merge(&found);
    Ok(analysis)
}

/// Analyses a case; an error names its file.
///
/// # Errors
/// What stops the analysis; wrong usage if `--gauge` names a film that the case lacks.
pub fn analyze_case(
    path: &Path,
    case: &Case,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    if let Some(posture) = missing_known_force(options, case) {
        return Err(Failure::usage(format!(
            "{}: --gauge known-force names the {posture} film, which this case lacks",
            path.display()
        )));
    }
    analyze(case, options).map_err(|error| Failure::of(path.display(), &error))
}
