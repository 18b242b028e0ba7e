//! One case analysed.

use std::path::Path;

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline_files::method_text::missing_known_force;

use crate::analysis::films::check_films;
use crate::run::failure::Failure;
use crate::run::inputs::CaseInput;

/// Reads and analyses a case.
///
/// # Errors
/// If the file is no case, or what stops the analysis.
pub fn analyze_file(path: &Path, options: &AnalysisOptions) -> Result<Analysis, Failure> {
    analyze_input(path, &CaseInput::read(path)?, options)
}

/// Analyses a case that was read, after a comparison of the pictures beside it.
///
/// # Errors
/// If two films are the same picture, or what stops the analysis.
pub fn analyze_input(
    path: &Path,
    input: &CaseInput,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    let repeated = check_films(path, &input.file, &input.case)?;
    let mut analysis = analyze_case(path, &input.case, options)?;
    for one in &repeated {
        one.warn(&mut analysis);
    }
    Ok(analysis)
}

/// Analyses a case; an error names its file.
///
/// # Errors
/// What stops the analysis; wrong usage, where the force of a film is known that the case does not have.
pub fn analyze_case(
    path: &Path,
    case: &Case,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    if let Some(posture) = missing_known_force(options, case) {
        return Err(Failure::usage(format!(
            "{}: --gauge known-force names the {posture} film, and this case has no such film",
            path.display()
        )));
    }
    analyze(case, options)
        .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))
}
