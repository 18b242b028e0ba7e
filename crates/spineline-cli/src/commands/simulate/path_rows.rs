//! The path of equilibria for other programs: CSV with unit and side in the name of every column.

use spineline::anatomy::Region;
use spineline::multibody::{ForceSign, PathPoint};
use spineline::response::{direction_word, measure_angles};
use spineline_tables::{TableError, rows_to_csv};

use super::outcome::Outcome;

/// One row per shape. Positive Cobb angles, tilt ranges and Ferguson angles are convex to the patient's left.
///
/// # Errors
/// [`TableError::Csv`], though every row has a cell per column.
pub fn csv_text(outcome: &Outcome) -> Result<String, TableError> {
    let paths = outcome.response.paths.iter();
    let points = paths.flat_map(|of| of.path.points.iter().map(move |point| (of.sign, point)));
    rows_to_csv("path", heading(outcome), points.map(|(sign, point)| row(outcome, sign, point)))
}

fn heading(outcome: &Outcome) -> Vec<String> {
    let top =
        outcome.model.levels.last().map_or_else(String::new, |level| level.name().to_lowercase());
    let mut names: Vec<String> = [
        "case_id",
        "synthetic",
        "absolute",
        "status",
        "direction",
        "timing",
        "factor",
        "arc_rad",
        "lateral_tilt_right_deg",
    ]
    .map(str::to_owned)
    .to_vec();
    names.extend(["anterior", "left", "cranial"].map(|way| format!("{top}_{way}_mm")));
    let regions: Vec<Region> = outcome.places.iter().map(|place| place.bounds.region).collect();
    for angle in ["cobb", "tilt_range", "ferguson"] {
        let name = |region: &Region| format!("{angle}_{}_convex_left_deg", region.key());
        names.extend(regions.iter().map(name));
    }
    names.extend(["largest_hinge_rad", "residual_rad", "iterations"].map(str::to_owned));
    names
}

fn row(outcome: &Outcome, sign: ForceSign, point: &PathPoint) -> Vec<String> {
    let angles = measure_angles(&point.deformed, &outcome.places);
    let mut cells = vec![
        outcome.model.case_id.clone(),
        outcome.model.synthetic.to_string(),
        outcome.model.absolute.to_string(),
        outcome.response.ending.key().to_owned(),
        direction_word(sign).to_owned(),
        point.timing.key().to_owned(),
        point.factor.to_string(),
        point.arc_rad.to_string(),
        angles.lateral_tilt.deg().to_string(),
    ];
    let top = &point.deformed.midpoints_mm[point.deformed.midpoints_mm.len() - 1];
    cells.extend(top.iter().map(f64::to_string));
    cells.extend(
        angles
            .curves
            .iter()
            .map(|curve| curve.ends.cobb.map_or_else(String::new, |cobb| cobb.deg().to_string())),
    );
    cells.extend(angles.curves.iter().map(|curve| curve.ends.tilt_range.deg().to_string()));
    cells.extend(angles.curves.iter().map(|curve| curve.ferguson.deg().to_string()));
    cells.push(point.deformed.largest_hinge_rad().to_string());
    cells.push(format!("{:e}", point.residual_rad));
    cells.push(point.iterations.to_string());
    cells
}
