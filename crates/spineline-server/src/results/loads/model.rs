//! The model of a line of action, alone and under loads.

use axum::http::StatusCode;
use spineline::analysis::{Analysis, LineModel, PersonalisedModel};
use spineline::personalize::FitStatus;
use spineline_files::{LoadFile, ModelFile, Simulated, parse_load, text_with_hash, to_text};

use crate::PROGRAM;
use crate::api::LineKindName;
use crate::problem::{Answer, Failure};
use crate::result_cache::StudyResult;
use crate::results::exports::provenance;

/// Maximum number of loads, more than any plan has.
const MAX_LOADS: usize = 100;

/// Reads a load file.
pub fn parsed(text: &str) -> Answer<LoadFile> {
    let loads = parse_load(text).map_err(|error| Failure::of(&error))?;
    check_count(&loads)?;
    Ok(loads)
}

/// Refuses too many loads.
pub fn check_count(loads: &LoadFile) -> Answer<()> {
    let count = loads.loads.len();
    if count > MAX_LOADS {
        let text = format!("there are {count} loads; the limit is {MAX_LOADS}");
        return Err(
            Failure::refused(text).help("the command line takes more: `spineline simulate --load`")
        );
    }
    Ok(())
}

/// The model of a line of action whose fit gave springs.
///
/// # Errors
/// A refusal if the study lacks this model.
pub fn fitted_model(result: &StudyResult, line: LineKindName) -> Answer<(&Analysis, &LineModel)> {
    let analysis = result.analysed()?;
    let no_model =
        |text: String, help| Failure::new(StatusCode::CONFLICT, "no_model", text).help(help);
    let model = analysis.model(line.0).ok_or_else(|| {
        let text = format!("this study has no model with the {}", line.0);
        no_model(text, "choose a line that has a model")
    })?;
    if model.fit.status != FitStatus::Converged {
        let text = format!("the fit of the {} did not converge", line.0);
        return Err(no_model(text, "its springs are not a result; choose another line"));
    }
    Ok((analysis, model))
}

/// The file of a model.
pub fn model_text(result: &StudyResult, line: LineKindName) -> Answer<String> {
    let (analysis, model) = fitted_model(result, line)?;
    let file = ModelFile::new(analysis, model, PROGRAM, Some(provenance(analysis)));
    Ok(text_with_hash(to_text(&file)))
}

/// The personalised model of a line of action.
pub fn personalised_model(result: &StudyResult, line: LineKindName) -> Answer<PersonalisedModel> {
    let (analysis, model) = fitted_model(result, line)?;
    Ok(analysis.personalised_model(model))
}

/// The model of a line of action under the loads of a file.
///
/// # Errors
/// As [`fitted_model`]; a refusal if the text is not a load file, or its loads cannot be applied.
pub fn simulated_file(result: &StudyResult, line: LineKindName, text: &str) -> Answer<Simulated> {
    simulated(personalised_model(result, line)?, parsed(text)?)
}

/// A model under loads.
pub fn simulated(model: PersonalisedModel, loads: LoadFile) -> Answer<Simulated> {
    Simulated::at_full_load(model, loads).map_err(|error| Failure::of(&error))
}
