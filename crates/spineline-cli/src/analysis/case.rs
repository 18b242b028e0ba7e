//! One case analysed.

use std::path::Path;

use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};

use crate::run::failure::Failure;
use crate::run::inputs::CaseInput;

/// Reads and analyses a case.
///
/// # Errors
/// If the file is no case, or what stops the analysis.
pub fn analyze_file(path: &Path, options: &AnalysisOptions) -> Result<Analysis, Failure> {
    analyze_case(path, &CaseInput::read(path)?.case, options)
}

/// Analyses a case; an error names its file.
///
/// # Errors
/// What stops the analysis.
pub fn analyze_case(
    path: &Path,
    case: &Case,
    options: &AnalysisOptions,
) -> Result<Analysis, Failure> {
    analyze(case, options)
        .map_err(|error| Failure::input(&path.display().to_string(), &error, error.help()))
}
