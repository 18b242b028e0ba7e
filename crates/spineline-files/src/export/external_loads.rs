//! The forces of the films as external loads of OpenSim, which its tools of inverse dynamics and static optimization read.

use spineline::analysis::PersonalisedModel;

use super::assembly::Assembly;
use super::header::{Dialect, header};
use super::motion::FORCE;
use super::osim;
use super::xml::Document;

/// The motion that has the forces, beside this file.
const MOTION: &str = "films.sto";

const DIALECT: Dialect = Dialect {
    format: "XML (ExternalLoads of OpenSim 4)",
    notes: "The force on the highest vertebra of the model in the format `osim` at every time of the motion in the format `sto`, which is read as `films.sto` beside this file.",
    films: "one per second in the motion, from 1 s on.",
    ..osim::DIALECT
};

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let mut xml = Document::new();
    xml.comment(&header(model, assembly, generator, &DIALECT));
    xml.open("OpenSimDocument", &[("Version", osim::LAYOUT)]);
    xml.open("ExternalLoads", &[("name", "films")]);
    xml.open("objects", &[]);
    xml.open("ExternalForce", &[("name", "film_force")]);
    xml.text("applied_to_body", model.top().name());
    xml.text("force_expressed_in_body", "ground");
    xml.text("point_expressed_in_body", "ground");
    let [force, point] = FORCE;
    xml.text("force_identifier", force);
    xml.text("point_identifier", point);
    xml.close();
    xml.close();
    xml.text("datafile", MOTION);
    xml.finish()
}
