//! MuJoCo's own XML.

use spineline::action::Application;
use spineline::analysis::PersonalisedModel;
use spineline::number::significant;
use spineline::spatial::Vec3;

use super::assembly::{Assembly, Hinge, Joint, Vertebra};
use super::films::Film;
use super::header::{Dialect, header};
use super::nominal::TIME_S;
use super::rotation::quaternion;
use super::xml::{Document, number, numbers, vector};

const DIALECT: Dialect = Dialect {
    format: "MJCF (MuJoCo)",
    frame: "G: x anterior, y to the patient's left, z cranial; origin at the midpoint of the lowest vertebra.",
    notes: "Springs: `stiffness` and `springref` of each joint. Hinges that are locked are left out. Contacts are off.",
    films: "the pose of a film is the keyframe of its name. Its force is `custom/numeric` NAME_force, and acts at the place of the site NAME_load, which is fixed in space or in the vertebra. Before each step, set `xfrc_applied` of the vertebra to this force and to its moment about the vertebra's `xipos`.",
    nominal: || {
        format!(
            "armature of a hinge {} s2 and damping {} s times its stiffness, so that every hinge is critically damped; {} kg and {} kg m2 of a vertebra",
            number(significant(TIME_S * TIME_S, 6)),
            number(2.0 * TIME_S),
            number(MASS_KG),
            number(INERTIA_KG_M2),
        )
    },
    from_global: |v| *v,
};

/// Of a vertebra; small beside the armature of the hinges.
const MASS_KG: f64 = 1e-3;
const INERTIA_KG_M2: f64 = 1e-6;

/// Minimum extent of the view.
const MIN_EXTENT_M: f64 = 0.1;

const BONE: &str = "0.91 0.87 0.76 1";
const FIXED_BONE: &str = "0.55 0.53 0.48 1";
const DISC: &str = "0.42 0.62 0.78 1";

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, assembly: &Assembly, generator: &str) -> String {
    let mut xml = Document::new();
    xml.comment(&header(model, assembly, generator, &DIALECT));
    xml.open("mujoco", &[("model", &model.case_id)]);
    settings(&mut xml, assembly);
    xml.open("worldbody", &[]);
    xml.empty("light", &[("pos", "1 1 2"), ("dir", "-1 -1 -1.5"), ("directional", "true")]);
    for (i, vertebra) in assembly.vertebrae.iter().enumerate() {
        let below = i.checked_sub(1).map(|j| &assembly.joints[j]);
        open_body(&mut xml, vertebra, below);
        draw(&mut xml, vertebra, below.is_none(), i + 1 < assembly.vertebrae.len());
    }
    let posed: Vec<&Film> = assembly.films.iter().filter(|film| film.pose.is_ok()).collect();
    for film in posed.iter().filter(|film| film.load.application == Application::AtT2) {
        load_site(&mut xml, film, &Vec3::zeros());
    }
    for _ in &assembly.vertebrae {
        xml.close();
    }
    for film in posed.iter().filter(|film| film.load.application == Application::Fixed) {
        load_site(&mut xml, film, &(Vec3::from(film.load.point_mm) / 1000.0));
    }
    xml.close();
    forces(&mut xml, &posed);
    keyframes(&mut xml, &posed, &assembly.joints);
    xml.finish()
}

fn settings(xml: &mut Document, assembly: &Assembly) {
    xml.empty("compiler", &[("angle", "radian"), ("inertiafromgeom", "false")]);
    xml.open("option", &[("gravity", "0 0 0")]);
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
            turning(xml, hinge, &centre, &(joint.superior_from_inferior() * hinge.axis.unit()));
        }
        let inertia = numbers(&[INERTIA_KG_M2; 3]);
        let mass = number(MASS_KG);
        xml.empty("inertial", &[("pos", "0 0 0"), ("mass", &mass), ("diaginertia", &inertia)]);
    }
    xml.empty("site", &[("name", &format!("{}_midpoint", vertebra.name))]);
}

fn turning(xml: &mut Document, hinge: &Hinge, centre: &str, axis: &Vec3) {
    let hinged = [
        ("name", &*hinge.name),
        ("type", "hinge"),
        ("pos", centre),
        ("axis", &vector(axis)),
        ("stiffness", &number(hinge.nm_per_rad)),
        ("springref", "0"),
        ("armature", &number(TIME_S * TIME_S * hinge.nm_per_rad)),
        ("damping", &number(2.0 * TIME_S * hinge.nm_per_rad)),
    ];
    xml.empty("joint", &hinged);
}

/// A point of the line of action of a film.
fn load_site(xml: &mut Document, film: &Film, place_m: &Vec3) {
    xml.empty("site", &[("name", &film.load_name()), ("pos", &vector(place_m))]);
}

fn forces(xml: &mut Document, posed: &[&Film]) {
    xml.open("custom", &[]);
    for film in posed {
        let force_n = vector(&film.load.force_vector_n());
        xml.empty("numeric", &[("name", &format!("{}_force", film.name())), ("data", &force_n)]);
    }
    xml.close();
}

fn keyframes(xml: &mut Document, posed: &[&Film], joints: &[Joint]) {
    xml.open("keyframe", &[]);
    for film in posed {
        let free = film.pose.iter().flat_map(|pose| &pose.angles_rad).zip(joints).flat_map(
            |(angles_rad, joint)| {
                let hinges = joint.hinges.iter().zip(angles_rad).filter(|(hinge, _)| !hinge.locked);
                hinges.map(|(_, &angle_rad)| angle_rad)
            },
        );
        let qpos = numbers(&free.collect::<Vec<f64>>());
        xml.empty("key", &[("name", film.name()), ("qpos", &qpos)]);
    }
    xml.close();
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
