//! MuJoCo's own XML.

use spineline::analysis::PersonalisedModel;
use spineline::spatial::Vec3;

use super::assembly::{Assembly, Joint, NOMINAL_INERTIA_KG_M2, NOMINAL_MASS_KG, Vertebra};
use super::header::{Dialect, header};
use super::rotation::quaternion;
use super::xml::{Document, number, numbers, vector};

const DIALECT: Dialect = Dialect {
    format: "MJCF (MuJoCo)",
    frame: "G: x anterior, y to the patient's left, z cranial; origin at the midpoint of the lowest vertebra.",
    notes: "Springs: `stiffness` and `springref` of each joint. Hinges that are locked are left out. Contacts are off.",
    // MuJoCo treats damping implicitly: enough damping to rest within seconds costs nothing.
    damping_s: 0.1,
    from_global: |v| *v,
};

/// Minimum extent of the view.
const MIN_EXTENT_M: f64 = 0.1;

const BONE: &str = "0.91 0.87 0.76 1";
const FIXED_BONE: &str = "0.55 0.53 0.48 1";
const DISC: &str = "0.42 0.62 0.78 1";

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let mut xml = Document::new();
    xml.comment(&header(model, generator, &DIALECT));
    xml.open("mujoco", &[("model", &model.case_id)]);
    settings(&mut xml, assembly);
    xml.open("worldbody", &[]);
    xml.empty("light", &[("pos", "1 1 2"), ("dir", "-1 -1 -1.5"), ("directional", "true")]);
    for (i, vertebra) in assembly.vertebrae.iter().enumerate() {
        let below = i.checked_sub(1).map(|j| &assembly.joints[j]);
        open_body(&mut xml, vertebra, below);
        draw(&mut xml, vertebra, below.is_none(), i + 1 < assembly.vertebrae.len());
    }
    xml.finish()
}

fn settings(xml: &mut Document, assembly: &Assembly) {
    xml.empty("compiler", &[("angle", "radian"), ("inertiafromgeom", "false")]);
    // Stiff springs on light bodies: damping is taken implicitly.
    let option = [("gravity", "0 0 0"), ("timestep", "0.001"), ("integrator", "implicitfast")];
    xml.open("option", &option);
    xml.empty("flag", &[("contact", "disable")]);
    xml.close();
    let centre: Vec3 = assembly.vertebrae.iter().map(|v| v.midpoint_m).sum::<Vec3>()
        / assembly.vertebrae.len() as f64;
    let ends = [&assembly.vertebrae[0], &assembly.vertebrae[assembly.vertebrae.len() - 1]];
    let extent = (ends[1].midpoint_m - ends[0].midpoint_m).norm().max(MIN_EXTENT_M);
    xml.empty("statistic", &[("center", &vector(&centre)), ("extent", &number(extent))]);
    xml.open("visual", &[]);
    // View from behind: the patient's left is on the left.
    xml.empty("global", &[("azimuth", "20"), ("elevation", "-10")]);
    xml.empty("headlight", &[("ambient", "0.4 0.4 0.4")]);
    xml.close();
    xml.open("default", &[]);
    xml.empty("geom", &[("contype", "0"), ("conaffinity", "0"), ("group", "1")]);
    xml.empty("site", &[("size", "0.003"), ("rgba", "0.8 0.1 0.1 1"), ("group", "2")]);
    xml.close();
}

/// Opens a body and leaves it open for the next one, which hangs on it.
fn open_body(xml: &mut Document, vertebra: &Vertebra, below: Option<&Joint>) {
    let (place, axes) = below.map_or((vertebra.midpoint_m, vertebra.axes), |joint| {
        (joint.centre_in_inferior_m + joint.rise_m, joint.inferior_from_superior)
    });
    let pose = [("pos", &*vector(&place)), ("quat", &numbers(&quaternion(&axes)))];
    xml.open("body", &[("name", vertebra.name), pose[0], pose[1]]);
    if let Some(joint) = below {
        let centre = vector(&joint.centre_in_superior_m);
        for hinge in joint.free() {
            let axis = joint.superior_from_inferior() * hinge.axis.unit();
            xml.empty(
                "joint",
                &[
                    ("name", &*hinge.name),
                    ("type", "hinge"),
                    ("pos", &centre),
                    ("axis", &vector(&axis)),
                    ("stiffness", &number(hinge.nm_per_rad)),
                    ("springref", "0"),
                    ("damping", &number(hinge.damping(DIALECT.damping_s))),
                ],
            );
        }
        let inertia = numbers(&[NOMINAL_INERTIA_KG_M2; 3]);
        let mass = number(NOMINAL_MASS_KG);
        xml.empty("inertial", &[("pos", "0 0 0"), ("mass", &mass), ("diaginertia", &inertia)]);
    }
    xml.empty("site", &[("name", &format!("{}_midpoint", vertebra.name))]);
}

/// A body, its spinous process, and the disc that lies on it.
fn draw(xml: &mut Document, vertebra: &Vertebra, fixed: bool, has_disc: bool) {
    let colour = ("rgba", if fixed { FIXED_BONE } else { BONE });
    let half = vertebra.size_m / 2.0;
    xml.empty("geom", &[("type", "box"), ("size", &vector(&half)), colour]);
    let process = numbers(&[-half.x, 0.0, 0.0, -2.6 * half.x, 0.0, -half.z]);
    let radius = number(0.12 * vertebra.size_m.x);
    xml.empty("geom", &[("type", "capsule"), ("fromto", &process), ("size", &radius), colour]);
    if has_disc {
        let place = vector(&Vec3::new(0.0, 0.0, half.z + vertebra.disc_m / 2.0));
        let size = vector(&Vec3::new(1.08 * half.x, 1.08 * half.y, vertebra.disc_m));
        let disc = [("pos", &*place), ("size", &size), ("rgba", DISC)];
        xml.empty("geom", &[("type", "ellipsoid"), disc[0], disc[1], disc[2]]);
    }
}
