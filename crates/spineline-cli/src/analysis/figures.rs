//! Figures of one patient as files.

use std::path::Path;

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline_files::Provenance;
use spineline_report::{figures, file_stem};

use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::provenance::in_svg;

/// Draws the figures of one patient as SVG into a folder.
///
/// # Errors
/// If they cannot be written.
pub fn draw_figures(
    analysis: &Analysis,
    provenance: &Provenance,
    folder: &Path,
    outputs: &Outputs,
) -> Result<(), Failure> {
    let stem = file_stem(&analysis.case_id);
    let save = |name: &str, svg: &str| {
        outputs.write(&folder.join(format!("{stem}-{name}.svg")), in_svg(svg, provenance))
    };
    save("overview", &figures::case_overview(analysis))?;
    if let Some(svg) = figures::rotations(analysis) {
        save("rotations", &svg)?;
    }
    for posture in Posture::MOVED {
        if let Some(svg) = figures::measured_and_simulated(analysis, posture) {
            save(&format!("simulated-{}", posture.key()), &svg)?;
        }
    }
    Ok(())
}
