//! Export of personalised models for other programs: MJCF, OpenSim and URDF for multibody programs, VTK and glTF for 3-D views.
//!
//! Formats for multibody programs have the content of [`PersonalisedModel`]: bodies in the erect posture, three hinges in series
//! at every joint, and a linear spring on each; and of its films: the pose and the load of each. Other values that they need (masses, damping, shapes to draw) are nominal, and do
//! not change an equilibrium. Formats for 3-D views have only the vertebral bodies, as boxes. Each file states its content, its
//! origin, its frame and its units.

mod assembly;
mod boxes;
mod external_loads;
mod films;
mod format;
mod gltf;
mod header;
mod mjcf;
mod motion;
mod nominal;
mod osim;
mod rotation;
mod standing;
mod urdf;
mod vtp;
mod xml;

use spineline::analysis::PersonalisedModel;

use crate::text_with_hash;
use assembly::{Assembly, vertebrae};
pub use format::{ExportError, ExportFormat};

/// The text of a model in another program's format. The same model gives the same bytes.
///
/// # Errors
/// [`ExportError`] for a model that the format cannot hold.
///
/// # Panics
/// If the model has not one level per vertebra, which [`parse_model`](crate::parse_model) sees to.
pub fn export(
    model: &PersonalisedModel,
    format: ExportFormat,
    generator: &str,
) -> Result<String, ExportError> {
    for (what, text) in [("case_id", &*model.case_id), ("generator", generator)] {
        check_text(what, text)?;
    }
    let vertebrae = vertebrae(model)?;
    let assembly = |vertebrae| Assembly::of(model, vertebrae, format);
    Ok(text_with_hash(match format {
        ExportFormat::Mjcf => mjcf::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Osim => osim::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Sto => motion::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Loads => external_loads::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Urdf => urdf::text(model, &assembly(vertebrae)?, generator),
        ExportFormat::Vtp => vtp::text(model, &vertebrae, generator),
        ExportFormat::Gltf => gltf::text(model, &vertebrae, generator),
    }))
}

/// XML forbids control characters and the two noncharacters, even escaped.
fn check_text(what: &'static str, text: &str) -> Result<(), ExportError> {
    let refused = |c: &char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}');
    match text.chars().find(refused) {
        Some(character) => Err(ExportError::Text { what, character }),
        None => Ok(()),
    }
}
