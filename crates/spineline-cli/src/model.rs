//! Reading a personalised model.

use std::path::Path;

use spineline_files::{FileError, StoredModel, parse_model, read_text};

use crate::failure::Failure;

/// The model in a file; it has at least one joint.
pub fn read_model(path: &Path) -> Result<StoredModel, Failure> {
    let model = read_text(path).and_then(|text| parse_model(&text));
    let model = model.map_err(|error| match &error {
        FileError::Format { .. } => Failure::input(
            &path.display().to_string(),
            &error,
            "this command takes a model; `spineline analyze CASE --model FILE` writes one",
        ),
        _ => Failure::file(path, &error),
    })?;
    if model.spine.joints.is_empty() {
        let place = path.display().to_string();
        return Err(Failure::input(
            &place,
            &"the model has no joint",
            "give a model from L4 to T2",
        ));
    }
    Ok(model)
}
