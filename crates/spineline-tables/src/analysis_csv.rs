//! Tables of analyses as CSV, with the unit in the name of every column.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, PostureAnalysis};
use spineline::anatomy::Level;
use spineline::evaluate::Simulation;
use spineline::measure::LengthScale;

use crate::error::TableError;
use crate::records::rows_to_csv;

/// A length in millimetres; empty for a film without a spacing.
fn length(scale: &LengthScale, length_mm: f64, places: usize) -> String {
    scale.mm(length_mm).map_or_else(String::new, |mm| format!("{mm:.places$}"))
}

const CHAIN_HEADING: [&str; 11] = [
    "case_id",
    "synthetic",
    "posture",
    "segment",
    "a_mm",
    "alpha_deg",
    "d_mm",
    "theta_deg",
    "joint_y_mm",
    "joint_z_mm",
    "lengths",
];

/// One row per patient, posture and segment: the Denavit-Hartenberg table of the chain, and where its joints lie.
///
/// # Errors
/// [`TableError::Csv`], though every row has a cell per column.
pub fn chain_csv(analyses: &[Analysis]) -> Result<String, TableError> {
    let postures = analyses.iter().flat_map(|one| one.postures.iter().map(move |p| (one, p)));
    rows_to_csv(
        "chain",
        CHAIN_HEADING,
        postures.flat_map(|(analysis, posture)| chain_rows(analysis, posture)),
    )
}

fn chain_rows(analysis: &Analysis, posture: &PostureAnalysis) -> Vec<[String; 11]> {
    let table = posture.pose.to_denavit_hartenberg(&analysis.chain);
    let scale = &posture.outline.scale;
    let rows = table.iter().zip(&posture.pose.joints).enumerate();
    rows.map(|(segment, (row, joint))| {
        [
            analysis.case_id.clone(),
            analysis.synthetic.to_string(),
            posture.outline.posture.key().to_owned(),
            segment.to_string(),
            length(scale, row.a_mm, 9),
            format!("{}", row.alpha.deg()),
            length(scale, row.d_mm, 0),
            format!("{:.9}", row.theta.deg()),
            length(scale, joint.y_mm, 6),
            length(scale, joint.z_mm, 6),
            scale.plane.key().to_owned(),
        ]
    })
    .collect()
}

const VERTEBRAE_HEADING: [&str; 16] = [
    "case_id",
    "synthetic",
    "posture",
    "level",
    "measured_y_mm",
    "measured_z_mm",
    "measured_tilt_deg",
    "line",
    "fitted",
    "status",
    "simulated_y_mm",
    "simulated_z_mm",
    "simulated_tilt_deg",
    "location_error_mm",
    "lengths",
    "interpolated",
];

/// One row per patient, posture, line and vertebra.
///
/// # Errors
/// [`TableError::Csv`], though every row has a cell per column.
pub fn vertebrae_csv(analyses: &[Analysis]) -> Result<String, TableError> {
    let postures = analyses.iter().flat_map(|one| one.postures.iter().map(move |p| (one, p)));
    rows_to_csv(
        "vertebrae",
        VERTEBRAE_HEADING,
        postures.flat_map(|(analysis, posture)| vertebra_rows(analysis, posture)),
    )
}

fn vertebra_rows(analysis: &Analysis, posture: &PostureAnalysis) -> Vec<Vec<String>> {
    let scale = &posture.outline.scale;
    let simulated: Vec<(LineKind, &Simulation)> = analysis
        .models
        .iter()
        .filter_map(|m| Some((m.kind, m.posture(posture.outline.posture)?)))
        .collect();
    let mut rows = Vec::new();
    for (i, vertebra) in posture.outline.vertebrae.iter().enumerate() {
        let interpolated = (!vertebra.is_measured()).to_string();
        let mut measured = vec![
            analysis.case_id.clone(),
            analysis.synthetic.to_string(),
            posture.outline.posture.key().to_owned(),
            vertebra.level.to_string(),
            length(scale, vertebra.location.y_mm, 4),
            length(scale, vertebra.location.z_mm, 4),
            format!("{:.4}", vertebra.tilt.deg()),
        ];
        rows.extend(simulated.iter().map(|&(kind, simulation)| {
            let cells = simulated_cells(kind, simulation, (i, vertebra.level));
            let last = [scale.plane.key().to_owned(), interpolated.clone()];
            measured.iter().cloned().chain(cells).chain(last).collect()
        }));
        if simulated.is_empty() {
            measured.resize(VERTEBRAE_HEADING.len() - 2, String::new());
            measured.extend([scale.plane.key().to_owned(), interpolated]);
            rows.push(measured);
        }
    }
    rows
}

/// What a model gives for a vertebra.
fn simulated_cells(
    kind: LineKind,
    simulation: &Simulation,
    (i, level): (usize, Level),
) -> [String; 7] {
    let error = simulation.location_error_mm(level).filter(|_| simulation.is_usable());
    let error = error.map(|error| format!("{error:.4}"));
    [
        kind.key().to_owned(),
        simulation.fitted.to_string(),
        simulation.status.key().to_owned(),
        format!("{:.4}", simulation.locations[i].y_mm),
        format!("{:.4}", simulation.locations[i].z_mm),
        format!("{:.4}", simulation.tilts[i].deg()),
        error.unwrap_or_default(),
    ]
}
