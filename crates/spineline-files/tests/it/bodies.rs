//! Vertebral bodies for 3-D views: places, angles and frames, read back from the files.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use spineline::analysis::PersonalisedModel;
use spineline::multibody::{SpineModel, Support};
use spineline::spatial::{Angle, Mat3, Vec3};
use spineline_files::{ExportError, ExportFormat, export};
use spineline_phantom::{SpacePhantom, SpaceSetup, generate_in_space};

use super::exports::{Element, exported, model, named, numbers, read, rotation};

/// Rounding of a shape of 500 mm that is written and read.
const MM: f64 = 1e-10;

/// A model whose vertebrae stand as the true bodies of a synthetic patient with axial rotation.
fn turned() -> (PersonalisedModel, SpacePhantom) {
    let model = model(Support::Free);
    let setup = SpaceSetup { apical_rotation: Angle::from_deg(22.0), ..SpaceSetup::default() };
    let phantom = generate_in_space(&setup);
    let bodies: Vec<_> =
        model.levels.iter().map(|&level| phantom.body(level).expect("L5 to T1")).collect();
    let midpoints = bodies.iter().map(|body| body.midpoint_mm).collect();
    let axes = bodies
        .iter()
        .map(|body| Mat3::from_columns(&[body.anterior, body.left, body.cranial]))
        .collect();
    let centres: Vec<Vec3> =
        model.spine.joints.iter().map(|joint| joint.centre_in_inferior_mm).collect();
    (
        PersonalisedModel { spine: SpineModel::from_poses(midpoints, axes, &centres), ..model },
        phantom,
    )
}

/// Text of the array of this name below this element.
fn text<'a>(all: &'a [Element], parent: &str, name: &str) -> &'a str {
    let found = all.iter().find(|element| {
        element.path.ends_with(&format!("{parent}/DataArray")) && element.attribute("Name") == name
    });
    found.unwrap_or_else(|| panic!("no {name} in {parent}")).text.trim()
}

fn array(all: &[Element], parent: &str, name: &str) -> Vec<f64> {
    numbers(text(all, parent, name))
}

fn whole(all: &[Element], parent: &str, name: &str) -> Vec<usize> {
    text(all, parent, name).split(' ').map(|n| n.parse().expect("a whole number")).collect()
}

/// Six times the volume that triangles enclose; negative where they face inwards.
fn six_volumes(triangles: impl Iterator<Item = [Vec3; 3]>) -> f64 {
    triangles.map(|[a, b, c]| a.dot(&b.cross(&c))).sum()
}

#[test]
fn polydata_has_the_bodies_in_lps_with_their_angles() {
    let (model, phantom) = turned();
    let (all, comments) = read(&exported(&model, ExportFormat::Vtp));
    for word in ["SYNTHETIC", "not a medical device", "phantom-rod-01", "LPS in mm", "NOMINAL"] {
        assert!(comments[0].contains(word), "{word}");
    }
    assert_eq!(named(&all, "Array")[0].text.trim(), "76 80 83 0", "LPS");
    let points: Vec<Vec3> =
        array(&all, "Points", "Points").chunks(3).map(Vec3::from_column_slice).collect();
    assert_eq!(points.len(), 8 * model.levels.len());
    for (level, corners) in model.levels.iter().zip(points.chunks(8)) {
        let body = phantom.body(*level).expect("a level");
        let lps = |v: Vec3| Vec3::new(v.y, -v.x, v.z);
        let middle = corners.iter().sum::<Vec3>() / 8.0;
        assert!((middle - lps(body.midpoint_mm)).norm() < MM, "{level}");
        for (bit, axis) in [body.anterior, body.left, body.cranial].into_iter().enumerate() {
            let edge = corners[1 << bit] - corners[0];
            assert!((edge.normalize() - lps(axis)).norm() < 1e-12, "{level}");
        }
    }
    let connectivity = whole(&all, "Polys", "connectivity");
    let triangles = connectivity.chunks(4).flat_map(|side| {
        let [a, b, c, d] = [0, 1, 2, 3].map(|i| points[side[i]]);
        [[a, b, c], [a, c, d]]
    });
    assert!(six_volumes(triangles) > 0.0, "sides face outwards");
    for parent in ["PointData", "CellData"] {
        let share = if parent == "PointData" { 8 } else { 6 };
        for (name, wanted) in [("lateral_tilt_deg", 0), ("pitch_deg", 1), ("axial_rotation_deg", 2)]
        {
            let values = array(&all, parent, name);
            assert_eq!(values.len(), share * model.levels.len());
            for (level, own) in model.levels.iter().zip(values.chunks(share)) {
                let body = phantom.body(*level).expect("a level");
                let axis = body.cranial;
                let angle = match wanted {
                    0 => Angle::from_sin_cos(-axis.y, axis.z).deg(),
                    1 => Angle::from_sin_cos(axis.x, axis.yz().norm()).deg(),
                    _ => body.axial.deg(),
                };
                assert!(own.iter().all(|value| (value - angle).abs() < 1e-9), "{level} {name}");
            }
        }
    }
    let axial = array(&all, "CellData", "axial_rotation_deg");
    assert!(axial.iter().any(|value| value.abs() > 15.0), "{axial:?}");
}

#[test]
fn gltf_places_a_named_node_per_vertebra_in_its_own_frame() {
    let (model, phantom) = turned();
    let file: Value = serde_json::from_str(&exported(&model, ExportFormat::Gltf)).expect("JSON");
    assert_eq!(file["asset"]["version"], "2.0");
    assert_eq!(file["asset"]["extras"]["synthetic"], true);
    let list = |value: &Value| -> Vec<f64> {
        value.as_array().expect("a list").iter().map(|v| v.as_f64().expect("a number")).collect()
    };
    // +x left, +y up, +z to the front, in m.
    let gltf = |v: Vec3| Vec3::new(v.y, v.z, v.x);
    let nodes = file["nodes"].as_array().expect("nodes");
    assert_eq!(nodes.len(), model.levels.len());
    for (level, node) in model.levels.iter().zip(nodes) {
        let body = phantom.body(*level).expect("a level");
        assert_eq!(node["name"], level.name());
        let place = Vec3::from_column_slice(&list(&node["translation"])) * 1000.0;
        assert!((place - gltf(body.midpoint_mm)).norm() < MM, "{level}");
        let q = list(&node["rotation"]);
        let axes = rotation(&[q[3], q[0], q[1], q[2]]);
        let wanted = Mat3::from_columns(&[body.left, body.cranial, body.anterior].map(gltf));
        assert!((axes - wanted).norm() < 1e-12, "{level}");
        let axial = node["extras"]["axial_rotation_deg"].as_f64().expect("a number");
        assert!((axial - body.axial.deg()).abs() < 1e-9);
    }
    let uri = file["buffers"][0]["uri"].as_str().expect("inside of the file");
    let data = STANDARD.decode(uri.split_once(',').expect("data").1).expect("base64");
    assert_eq!(file["buffers"][0]["byteLength"], data.len());
    let vectors = |bytes: &[u8]| -> Vec<Vec3> {
        let singles = bytes.chunks(4).map(|b| f32::from_le_bytes(b.try_into().expect("four")));
        singles.map(f64::from).collect::<Vec<_>>().chunks(3).map(Vec3::from_column_slice).collect()
    };
    let (places, normals) = (vectors(&data[..288]), vectors(&data[288..576]));
    let corners: Vec<usize> =
        data[576..].chunks(2).map(|b| usize::from(u16::from_le_bytes([b[0], b[1]]))).collect();
    assert_eq!(corners.len(), 36);
    for triangle in corners.chunks(3) {
        let [a, b, c] = [0, 1, 2].map(|i| places[triangle[i]]);
        assert_eq!((b - a).cross(&(c - a)), normals[triangle[0]], "faces outwards");
    }
    let volume = six_volumes(corners.chunks(3).map(|t| [0, 1, 2].map(|i| places[t[i]])));
    assert!((volume - 6.0).abs() < 1e-12, "a box with sides of 1");
}

#[test]
fn bodies_need_no_springs_but_one_name_each() {
    let mut model = model(Support::Free);
    (model.stiffness[2][(0, 1)], model.stiffness[2][(1, 0)]) = (1e3, 1e3);
    for format in [ExportFormat::Vtp, ExportFormat::Gltf] {
        assert_eq!(exported(&model, format), exported(&model, format));
    }
    model.levels[4] = model.levels[3];
    let refused = export(&model, ExportFormat::Gltf, "test").expect_err("two of one name");
    assert_eq!(refused, ExportError::LevelTwice { level: model.levels[3] });
}
