//! Tables for other programs: CSV with the unit in the name of every column.

use csv::Writer;
use spineline::action::LineKind;
use spineline::analysis::Analysis;
use spineline::anatomy::Level;
use spineline::evaluate::Simulation;
use spineline::measure::LengthScale;

use crate::failure::Failure;

pub fn failed(error: &dyn std::fmt::Display) -> Failure {
    Failure::internal(format!("CSV: {error}"))
}

/// The text of a finished table.
pub fn finish(writer: Writer<Vec<u8>>) -> Result<String, Failure> {
    let bytes = writer.into_inner().map_err(|e| failed(&e))?;
    String::from_utf8(bytes).map_err(|e| failed(&e))
}

/// A length in millimetres; nothing for a film without a spacing.
fn length(scale: &LengthScale, length_mm: f64, places: usize) -> String {
    scale.mm(length_mm).map_or_else(String::new, |mm| format!("{mm:.places$}"))
}

/// One row per patient, posture and segment: the Denavit-Hartenberg table of the chain, and where its joints lie.
pub fn chain_text(analyses: &[Analysis]) -> Result<String, Failure> {
    let mut writer = Writer::from_writer(Vec::new());
    let heading = [
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
    writer.write_record(heading).map_err(|e| failed(&e))?;
    for analysis in analyses {
        for posture in &analysis.postures {
            let table = posture.pose.to_denavit_hartenberg(&analysis.chain);
            let scale = &posture.outline.scale;
            for (segment, (row, joint)) in table.iter().zip(&posture.pose.joints).enumerate() {
                let cells = [
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
                ];
                writer.write_record(&cells).map_err(|e| failed(&e))?;
            }
        }
    }
    finish(writer)
}

/// One row per patient, posture, line and vertebra.
pub fn csv_text(analyses: &[Analysis]) -> Result<String, Failure> {
    let mut writer = Writer::from_writer(Vec::new());
    let heading = [
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
    ];
    writer.write_record(heading).map_err(|e| failed(&e))?;
    for analysis in analyses {
        for posture in &analysis.postures {
            let scale = &posture.outline.scale;
            let simulated: Vec<(LineKind, &Simulation)> = analysis
                .models
                .iter()
                .filter_map(|m| Some((m.kind, m.posture(posture.outline.posture)?)))
                .collect();
            for (i, level) in Level::MODEL.into_iter().enumerate() {
                let vertebra = &posture.outline.vertebrae[i];
                let mut measured = vec![
                    analysis.case_id.clone(),
                    analysis.synthetic.to_string(),
                    posture.outline.posture.key().to_owned(),
                    level.to_string(),
                    length(scale, vertebra.location.y_mm, 4),
                    length(scale, vertebra.location.z_mm, 4),
                    format!("{:.4}", vertebra.tilt.deg()),
                ];
                if simulated.is_empty() {
                    measured.resize(heading.len() - 1, String::new());
                    measured.push(scale.plane.key().to_owned());
                    writer.write_record(&measured).map_err(|e| failed(&e))?;
                }
                for (kind, s) in &simulated {
                    let mut row = measured.clone();
                    let error = (i > 0 && s.is_usable())
                        .then(|| format!("{:.4}", s.location_errors_mm[i - 1]));
                    row.extend([
                        kind.key().to_owned(),
                        s.fitted.to_string(),
                        s.status.key().to_owned(),
                        format!("{:.4}", s.locations[i].y_mm),
                        format!("{:.4}", s.locations[i].z_mm),
                        format!("{:.4}", s.tilts[i].deg()),
                        error.unwrap_or_default(),
                        scale.plane.key().to_owned(),
                    ]);
                    writer.write_record(&row).map_err(|e| failed(&e))?;
                }
            }
        }
    }
    finish(writer)
}
