//! The poses of the films as a motion of the OpenSim model.

use spineline::analysis::PersonalisedModel;

use super::assembly::Assembly;
use super::header::{Dialect, header};
use super::osim;
use super::xml::number;

const DIALECT: Dialect = Dialect {
    format: "STO (motion of the OpenSim model)",
    notes: "Columns: the coordinates of the model in the format `osim`, in rad.",
    films: "one row per second, with the erect posture at 0 s.",
    ..osim::DIALECT
};

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let hinges: Vec<&str> =
        assembly.joints.iter().flat_map(|joint| &joint.hinges).map(|h| &*h.name).collect();
    let mut rows = vec![("erect", vec![0.0; hinges.len()])];
    for film in &assembly.films {
        let Ok(angles_rad) = &film.pose else { continue };
        rows.push((film.name(), angles_rad.concat()));
    }
    let mut lines = vec![
        "films".to_owned(),
        "version=1".to_owned(),
        format!("nRows={}", rows.len()),
        format!("nColumns={}", hinges.len() + 1),
        "inDegrees=no".to_owned(),
        header(model, assembly, generator, &DIALECT).replace('=', "\\u003d"),
    ];
    lines.extend(rows.iter().enumerate().map(|(second, (name, _))| format!("{second} s: {name}")));
    lines.push("endheader".to_owned());
    lines.push(["time"].into_iter().chain(hinges).collect::<Vec<_>>().join("\t"));
    for (second, (_, angles_rad)) in rows.iter().enumerate() {
        let numbers: Vec<String> = angles_rad.iter().map(|&angle| number(angle)).collect();
        lines.push(format!("{second}\t{}", numbers.join("\t")));
    }
    lines.push(String::new());
    lines.join("\n")
}
