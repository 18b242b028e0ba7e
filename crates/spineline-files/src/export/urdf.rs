//! Unified robot description format, with the springs in SDFormat's extension.

use spineline::analysis::PersonalisedModel;
use spineline::spatial::{Mat3, Vec3};

use super::assembly::{Assembly, Hinge, Joint, Vertebra};
use super::header::{Dialect, header};
use super::nominal::{Inertia, Nominal};
use super::rotation::roll_pitch_yaw;
use super::xml::{Document, number, numbers, vector};

const DIALECT: Dialect = Dialect {
    format: "URDF",
    frame: "G: x anterior, y to the patient's left, z cranial; origin at the midpoint of the lowest vertebra.",
    notes: "Springs: URDF has none. They stand in SDFormat's extension, `springStiffness` and `springReference` in `gazebo` of each hinge's name; a program that does not read it needs them from elsewhere. \
            Each hinge turns a small link that is not a vertebra (a hundredth of the vertebra's nominal mass), and the vertebra is fixed to the last link; hinges that are locked are left out. Limits do not stop a hinge: the format requires them.",
    films: "URDF has no poses and no loads; apply the force from the program.",
    nominal: Nominal::words,
    from_global: |v| *v,
};

/// Share of the nominal mass and inertia that a link between two hinges has.
const BETWEEN_HINGES: f64 = 0.01;

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let mut xml = Document::new();
    xml.comment(&header(model, assembly, generator, &DIALECT));
    xml.open("robot", &[("name", &model.case_id)]);
    xml.empty("link", &[("name", "world")]);
    for (i, v) in assembly.vertebrae.iter().enumerate() {
        match i.checked_sub(1) {
            None => fixed(&mut xml, "world", v.name, &v.midpoint_m, &v.axes),
            Some(j) => joint(&mut xml, assembly, j),
        }
        vertebra(&mut xml, v, assembly.nominal.inertias[i]);
    }
    for hinge in assembly.joints.iter().flat_map(Joint::free) {
        spring(&mut xml, hinge);
    }
    xml.finish()
}

/// Hinges in series, a link after each, and the vertebra on the last of them.
fn joint(xml: &mut Document, assembly: &Assembly, j: usize) {
    let (joint, nominal) = (&assembly.joints[j], &assembly.nominal);
    let [inferior, superior] = [j, j + 1].map(|vertebra| assembly.vertebrae[vertebra].name);
    let damping = number(nominal.dampings_nms_per_rad[j]);
    let mut parent = inferior.to_owned();
    let mut place = joint.centre_in_inferior_m;
    for hinge in joint.free() {
        let child = format!("{}_link", hinge.name);
        revolute(xml, hinge, [&parent, &child], &place, &damping);
        xml.open("link", &[("name", &child)]);
        inertial(xml, nominal.inertias[j + 1].share(BETWEEN_HINGES));
        xml.close();
        parent = child;
        place = Vec3::zeros();
    }
    fixed(xml, &parent, superior, &joint.rise_m, &joint.inferior_from_superior);
}

fn revolute(
    xml: &mut Document,
    hinge: &Hinge,
    [parent, child]: [&str; 2],
    place: &Vec3,
    damping: &str,
) {
    let limit = [("lower", "-3.2"), ("upper", "3.2"), ("effort", "1e6"), ("velocity", "1e3")];
    xml.open("joint", &[("name", &hinge.name), ("type", "revolute")]);
    xml.empty("parent", &[("link", parent)]);
    xml.empty("child", &[("link", child)]);
    xml.empty("origin", &[("xyz", &vector(place)), ("rpy", "0 0 0")]);
    xml.empty("axis", &[("xyz", &vector(&hinge.axis.unit()))]);
    xml.empty("limit", &limit);
    xml.empty("dynamics", &[("damping", damping), ("friction", "0")]);
    xml.close();
}

fn fixed(xml: &mut Document, parent: &str, child: &str, place: &Vec3, axes: &Mat3) {
    xml.open("joint", &[("name", &format!("{child}_fixed")), ("type", "fixed")]);
    xml.empty("parent", &[("link", parent)]);
    xml.empty("child", &[("link", child)]);
    origin(xml, place, axes);
    xml.close();
}

fn origin(xml: &mut Document, place: &Vec3, axes: &Mat3) {
    let angles = vector(&roll_pitch_yaw(axes));
    xml.empty("origin", &[("xyz", &vector(place)), ("rpy", &angles)]);
}

/// A link at the vertebra's midpoint, in its axes.
fn vertebra(xml: &mut Document, vertebra: &Vertebra, inertia: Inertia) {
    xml.open("link", &[("name", vertebra.name)]);
    inertial(xml, inertia);
    xml.open("visual", &[]);
    xml.open("geometry", &[]);
    xml.empty("box", &[("size", &vector(&vertebra.size_m))]);
    xml.close();
    xml.open("material", &[("name", "bone")]);
    xml.empty("color", &[("rgba", "0.91 0.87 0.76 1")]);
    for _ in ["material", "visual", "link"] {
        xml.close();
    }
}

fn inertial(xml: &mut Document, inertia: Inertia) {
    let moment = number(inertia.moment_kg_m2);
    let diagonal = [("ixx", &*moment), ("iyy", &moment), ("izz", &moment)];
    let [x, y, z] = diagonal;
    xml.open("inertial", &[]);
    xml.empty("origin", &[("xyz", &numbers(&[0.0; 3])), ("rpy", "0 0 0")]);
    xml.empty("mass", &[("value", &number(inertia.mass_kg))]);
    xml.empty("inertia", &[x, y, z, ("ixy", "0"), ("ixz", "0"), ("iyz", "0")]);
    xml.close();
}

fn spring(xml: &mut Document, hinge: &Hinge) {
    xml.open("gazebo", &[("reference", &hinge.name)]);
    xml.text("springReference", "0");
    xml.text("springStiffness", &number(hinge.nm_per_rad));
    xml.close();
}
