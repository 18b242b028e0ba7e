//! The poses of the films as a motion of the OpenSim model.

use spineline::analysis::PersonalisedModel;

use super::assembly::Assembly;
use super::header::{Dialect, header};
use super::osim;
use super::xml::number;

const DIALECT: Dialect = Dialect {
    format: "STO (motion of the OpenSim model)",
    notes: "Columns: the coordinates of the model in the format `osim`, in rad, and the force on the highest vertebra with a point of its line, in the ground.",
    films: "one row per second, with the erect posture at 0 s.",
    ..osim::DIALECT
};

/// Beginnings of the columns of the force and of its point.
pub(super) const FORCE: [&str; 2] = ["film_force_v", "film_force_p"];

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let hinges: Vec<&str> =
        assembly.joints.iter().flat_map(|joint| &joint.hinges).map(|h| &*h.name).collect();
    let force =
        FORCE.into_iter().flat_map(|name| ["x", "y", "z"].map(|axis| format!("{name}{axis}")));
    let columns = hinges.into_iter().map(str::to_owned).chain(force);
    let columns: Vec<String> = ["time".to_owned()].into_iter().chain(columns).collect();
    let mut rows = vec![("erect", vec![0.0; columns.len() - 1])];
    for film in &assembly.films {
        let Ok(pose) = &film.pose else { continue };
        let vectors =
            [film.load.force_vector_n(), pose.point_mm / 1000.0].map(|v| osim::opensim(&v));
        let mut row = pose.angles_rad.concat();
        row.extend(vectors.iter().flatten());
        rows.push((film.name(), row));
    }
    let mut lines = vec![
        "films".to_owned(),
        "version=1".to_owned(),
        format!("nRows={}", rows.len()),
        format!("nColumns={}", columns.len()),
        "inDegrees=no".to_owned(),
        header(model, assembly, generator, &DIALECT).replace('=', "\\u003d"),
    ];
    lines.extend(rows.iter().enumerate().map(|(second, (name, _))| format!("{second} s: {name}")));
    lines.push("endheader".to_owned());
    lines.push(columns.join("\t"));
    for (second, (_, row)) in rows.iter().enumerate() {
        let numbers: Vec<String> = row.iter().map(|&value| number(value)).collect();
        lines.push(format!("{second}\t{}", numbers.join("\t")));
    }
    lines.push(String::new());
    lines.join("\n")
}
