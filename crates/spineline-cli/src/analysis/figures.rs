//! Figures of one patient as files.

use std::path::Path;

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline_files::Provenance;
use spineline_report::{figures, file_stem};

use crate::run::failure::Failure;
use crate::run::outputs::Outputs;
use crate::run::provenance::in_svg;

pub struct FigureFile {
    name: String,
    svg: String,
}

/// The figures of one patient.
pub fn figures_of(analysis: &Analysis, provenance: &Provenance) -> Vec<FigureFile> {
    let stem = file_stem(&analysis.case_id);
    let file = |name: &str, svg: &str| FigureFile {
        name: format!("{stem}-{name}.svg"),
        svg: in_svg(svg, provenance),
    };
    let mut all = vec![file("overview", &figures::case_overview(analysis))];
    all.extend(figures::rotations(analysis).map(|svg| file("rotations", &svg)));
    all.extend(Posture::MOVED.into_iter().filter_map(|posture| {
        let svg = figures::measured_and_simulated(analysis, posture)?;
        Some(file(&format!("simulated-{}", posture.key()), &svg))
    }));
    all
}

/// Writes figures into a folder.
pub fn write_figures(
    figures: &[FigureFile],
    folder: &Path,
    outputs: &Outputs,
) -> Result<(), Failure> {
    figures.iter().try_for_each(|figure| outputs.write(&folder.join(&figure.name), &*figure.svg))
}
