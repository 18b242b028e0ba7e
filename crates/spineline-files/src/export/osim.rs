//! OpenSim 4 models.

use spineline::analysis::PersonalisedModel;
use spineline::spatial::{Mat3, Vec3};

use super::assembly::{Assembly, Hinge, Joint, NOMINAL_INERTIA_KG_M2, NOMINAL_MASS_KG, Vertebra};
use super::header::{Dialect, header};
use super::rotation::body_xyz;
use super::xml::{Document, number, numbers, vector};

const DIALECT: Dialect = Dialect {
    format: "OSIM (OpenSim 4)",
    frame: "OpenSim's: x anterior, y cranial, z to the patient's right (Spineline's G is x, -z, y of this); origin at the midpoint of the lowest vertebra.",
    notes: "Springs: one SpringGeneralizedForce per coordinate. Signs of coordinates are Spineline's: right-handed about the anterior, left and cranial axis. Coordinates that the support locks are locked.",
    // OpenSim's integrators are explicit: more would make their steps tiny.
    damping_s: 0.001,
    from_global: opensim,
};

/// Version of the document's layout: OpenSim 4.5 and later read it without converting.
const LAYOUT: &str = "40500";

/// A vector of `G`, or of a vertebra, in OpenSim's order of axes.
fn opensim(v: &Vec3) -> Vec3 {
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
    xml.comment(&header(model, generator, &DIALECT));
    xml.open("OpenSimDocument", &[("Version", LAYOUT)]);
    xml.open("Model", &[("name", &component_name(&model.case_id))]);
    xml.text("credits", &format!("{generator}; case {}", model.case_id));
    xml.text("gravity", "0 0 0");
    xml.text("length_units", "meters");
    xml.text("force_units", "N");
    open_set(&mut xml, "BodySet", "bodyset");
    for vertebra in &assembly.vertebrae {
        body(&mut xml, vertebra);
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
    for hinge in assembly.joints.iter().flat_map(|joint| &joint.hinges) {
        spring(&mut xml, hinge);
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

fn body(xml: &mut Document, vertebra: &Vertebra) {
    xml.open("Body", &[("name", vertebra.name)]);
    xml.open("attached_geometry", &[]);
    xml.open("Brick", &[("name", &format!("{}_shape", vertebra.name))]);
    xml.text("socket_frame", "..");
    appearance(xml, "0.91 0.87 0.76");
    let [depth, width, height] = vertebra.size_m.into();
    xml.text("half_lengths", &numbers(&[depth / 2.0, height / 2.0, width / 2.0]));
    xml.close();
    xml.close();
    xml.text("mass", &number(NOMINAL_MASS_KG));
    xml.text("mass_center", "0 0 0");
    let i = NOMINAL_INERTIA_KG_M2;
    xml.text("inertia", &numbers(&[i, i, i, 0.0, 0.0, 0.0]));
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

fn spring(xml: &mut Document, hinge: &Hinge) {
    xml.open("SpringGeneralizedForce", &[("name", &format!("{}_spring", hinge.name))]);
    xml.text("coordinate", &hinge.name);
    xml.text("stiffness", &number(hinge.nm_per_rad));
    xml.text("rest_length", "0");
    xml.text("viscosity", &number(hinge.damping(DIALECT.damping_s)));
    xml.close();
}

fn marker(xml: &mut Document, vertebra: &str) {
    xml.open("Marker", &[("name", &format!("{vertebra}_midpoint"))]);
    xml.text("socket_parent_frame", &format!("/bodyset/{vertebra}"));
    xml.text("location", "0 0 0");
    xml.text("fixed", "true");
    xml.close();
}
