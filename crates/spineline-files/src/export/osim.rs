//! OpenSim 4 models.

use spineline::action::Application;
use spineline::analysis::PersonalisedModel;
use spineline::spatial::{Mat3, Vec3};

use super::assembly::{Assembly, Hinge, Joint, Vertebra};
use super::films::Film;
use super::header::{Dialect, header};
use super::nominal::{Inertia, Nominal};
use super::rotation::body_xyz;
use super::xml::{Document, number, numbers, vector};

pub(super) const DIALECT: Dialect = Dialect {
    format: "OSIM (OpenSim 4)",
    frame: "OpenSim's: x anterior, y cranial, z to the patient's right (Spineline's G is x, -z, y of this); origin at the midpoint of the lowest vertebra.",
    notes: "Springs: one SpringGeneralizedForce per coordinate. Signs of coordinates are Spineline's: right-handed about the anterior, left and cranial axis. Coordinates that the support locks are locked.",
    films: "the load of a film is the PrescribedForce NAME_load, which acts after its property `appliesForce` is set. The format `sto` of the same program has the poses.",
    nominal: Nominal::words,
    from_global: opensim,
};

/// Version of the document's layout: OpenSim 4.5 and later read it without converting.
pub(super) const LAYOUT: &str = "40500";

/// A vector of `G`, or of a vertebra, in OpenSim's order of axes.
pub(super) fn opensim(v: &Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Rotation vectors and axes change like any other vector, so a rotation does on both sides.
fn opensim_rotation(r: &Mat3) -> Mat3 {
    let change = Mat3::new(1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0);
    change * r * change.transpose()
}

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let mut xml = Document::new();
    xml.comment(&header(model, assembly, generator, &DIALECT));
    xml.open("OpenSimDocument", &[("Version", LAYOUT)]);
    xml.open("Model", &[("name", &component_name(&model.case_id))]);
    xml.text("credits", &format!("{generator}; case {}", model.case_id));
    xml.text("gravity", "0 0 0");
    xml.text("length_units", "meters");
    xml.text("force_units", "N");
    open_set(&mut xml, "BodySet", "bodyset");
    for (vertebra, &inertia) in assembly.vertebrae.iter().zip(&assembly.nominal.inertias) {
        body(&mut xml, vertebra, inertia);
    }
    close_set(&mut xml);
    open_set(&mut xml, "JointSet", "jointset");
    for (i, vertebra) in assembly.vertebrae.iter().enumerate() {
        match i.checked_sub(1) {
            None => weld(&mut xml, vertebra),
            Some(j) => {
                let inferior = assembly.vertebrae[j].name;
                custom_joint(&mut xml, &assembly.joints[j], inferior, vertebra.name);
            }
        }
    }
    close_set(&mut xml);
    open_set(&mut xml, "ForceSet", "forceset");
    for (joint, &damping) in assembly.joints.iter().zip(&assembly.nominal.dampings_nms_per_rad) {
        for hinge in &joint.hinges {
            spring(&mut xml, hinge, damping);
        }
    }
    for film in assembly.films.iter().filter(|film| film.pose.is_ok()) {
        load(&mut xml, film, model.top().name());
    }
    close_set(&mut xml);
    open_set(&mut xml, "MarkerSet", "markerset");
    for vertebra in &assembly.vertebrae {
        marker(&mut xml, vertebra.name);
    }
    xml.finish()
}

/// Names are parts of paths in OpenSim: letters, digits and a few signs stay, others become underscores. The case id as
/// it is stands in the credits and in the comment.
fn component_name(text: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "._-".contains(c) { c } else { '_' };
    let name: String = text.chars().map(plain).collect();
    if name.is_empty() { "spine".to_owned() } else { name }
}

fn open_set(xml: &mut Document, kind: &str, name: &str) {
    xml.open(kind, &[("name", name)]);
    xml.open("objects", &[]);
}

fn close_set(xml: &mut Document) {
    xml.close();
    xml.close();
}

fn body(xml: &mut Document, vertebra: &Vertebra, inertia: Inertia) {
    xml.open("Body", &[("name", vertebra.name)]);
    xml.open("attached_geometry", &[]);
    xml.open("Brick", &[("name", &format!("{}_shape", vertebra.name))]);
    xml.text("socket_frame", "..");
    appearance(xml, "0.91 0.87 0.76");
    let [depth, width, height] = vertebra.size_m.into();
    xml.text("half_lengths", &numbers(&[depth / 2.0, height / 2.0, width / 2.0]));
    xml.close();
    xml.close();
    xml.text("mass", &number(inertia.mass_kg));
    xml.text("mass_center", "0 0 0");
    let moment = inertia.moment_kg_m2;
    xml.text("inertia", &numbers(&[moment, moment, moment, 0.0, 0.0, 0.0]));
    xml.close();
}

fn appearance(xml: &mut Document, colour: &str) {
    xml.open("Appearance", &[]);
    xml.text("color", colour);
    xml.close();
}

/// The lowest vertebra is part of the ground.
fn weld(xml: &mut Document, vertebra: &Vertebra) {
    let name = format!("{}_fixed", vertebra.name);
    xml.open("WeldJoint", &[("name", &name)]);
    xml.text("socket_parent_frame", "ground_offset");
    xml.text("socket_child_frame", &format!("/bodyset/{}", vertebra.name));
    xml.open("frames", &[]);
    offset(xml, "ground_offset", "/ground", &vertebra.midpoint_m, &vertebra.axes, false);
    xml.close();
    xml.close();
}

fn custom_joint(xml: &mut Document, joint: &Joint, inferior: &str, superior: &str) {
    xml.open("CustomJoint", &[("name", &joint.name)]);
    let names = [inferior, superior].map(|vertebra| format!("{vertebra}_offset"));
    xml.text("socket_parent_frame", &names[0]);
    xml.text("socket_child_frame", &names[1]);
    xml.open("coordinates", &[]);
    for hinge in &joint.hinges {
        coordinate(xml, hinge);
    }
    xml.close();
    // Both frames of a joint have the inferior vertebra's axes when erect.
    xml.open("frames", &[]);
    let (below, above) = (format!("/bodyset/{inferior}"), format!("/bodyset/{superior}"));
    offset(xml, &names[0], &below, &joint.centre_in_inferior_m, &Mat3::identity(), true);
    let axes = joint.superior_from_inferior();
    offset(xml, &names[1], &above, &joint.centre_in_superior_m, &axes, false);
    xml.close();
    xml.open("SpatialTransform", &[]);
    for (name, hinge) in ["rotation1", "rotation2", "rotation3"].into_iter().zip(&joint.hinges) {
        xml.open("TransformAxis", &[("name", name)]);
        xml.text("coordinates", &hinge.name);
        xml.text("axis", &vector(&opensim(&hinge.axis.unit())));
        xml.open("LinearFunction", &[("name", "function")]);
        xml.text("coefficients", "1 0");
        xml.close();
        xml.close();
    }
    for (name, axis) in
        [("translation1", "1 0 0"), ("translation2", "0 1 0"), ("translation3", "0 0 1")]
    {
        xml.open("TransformAxis", &[("name", name)]);
        xml.text("axis", axis);
        xml.open("Constant", &[("name", "function")]);
        xml.text("value", "0");
        xml.close();
        xml.close();
    }
    xml.close();
    xml.close();
}

fn coordinate(xml: &mut Document, hinge: &Hinge) {
    xml.open("Coordinate", &[("name", &hinge.name)]);
    xml.text("default_value", "0");
    xml.text("range", "-3.2 3.2");
    xml.text("clamped", "false");
    xml.text("locked", if hinge.locked { "true" } else { "false" });
    xml.close();
}

/// A frame fixed in a body; a small ball shows where the joint is.
fn offset(xml: &mut Document, name: &str, body: &str, place: &Vec3, axes: &Mat3, ball: bool) {
    xml.open("PhysicalOffsetFrame", &[("name", name)]);
    if ball {
        xml.open("attached_geometry", &[]);
        xml.open("Sphere", &[("name", &format!("{name}_centre"))]);
        xml.text("socket_frame", "..");
        appearance(xml, "0.42 0.62 0.78");
        xml.text("radius", "0.003");
        xml.close();
        xml.close();
    }
    xml.text("socket_parent", body);
    xml.text("translation", &vector(&opensim(place)));
    xml.text("orientation", &vector(&body_xyz(&opensim_rotation(axes))));
    xml.close();
}

fn spring(xml: &mut Document, hinge: &Hinge, damping_nms_per_rad: f64) {
    xml.open("SpringGeneralizedForce", &[("name", &format!("{}_spring", hinge.name))]);
    xml.text("coordinate", &hinge.name);
    xml.text("stiffness", &number(hinge.nm_per_rad));
    xml.text("rest_length", "0");
    xml.text("viscosity", &number(damping_nms_per_rad));
    xml.close();
}

/// The force of a film: its direction is fixed in space, its point in space or in the vertebra.
fn load(xml: &mut Document, film: &Film, vertebra: &str) {
    let (is_fixed, point_mm) = match film.load.application {
        Application::Fixed => ("true", Vec3::from(film.load.point_mm)),
        Application::AtT2 => ("false", Vec3::zeros()),
    };
    xml.open("PrescribedForce", &[("name", &film.load_name())]);
    xml.text("appliesForce", "false");
    xml.text("socket_frame", &format!("/bodyset/{vertebra}"));
    xml.text("pointIsGlobal", is_fixed);
    xml.text("forceIsGlobal", "true");
    constants(xml, "forceFunctions", &opensim(&film.load.force_vector_n()));
    constants(xml, "pointFunctions", &opensim(&(point_mm / 1000.0)));
    xml.close();
}

fn constants(xml: &mut Document, name: &str, values: &Vec3) {
    open_set(xml, "FunctionSet", name);
    for &value in values {
        xml.open("Constant", &[]);
        xml.text("value", &number(value));
        xml.close();
    }
    close_set(xml);
}

fn marker(xml: &mut Document, vertebra: &str) {
    xml.open("Marker", &[("name", &format!("{vertebra}_midpoint"))]);
    xml.text("socket_parent_frame", &format!("/bodyset/{vertebra}"));
    xml.text("location", "0 0 0");
    xml.text("fixed", "true");
    xml.close();
}
