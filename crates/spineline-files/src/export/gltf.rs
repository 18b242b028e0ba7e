//! Vertebral bodies as glTF 2.0: one mesh, and a node per vertebra that places it. The data are inside of the file.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use spineline::analysis::PersonalisedModel;
use spineline::spatial::{Mat3, Vec3};

use super::assembly::Vertebra;
use super::boxes::{SIDES, corners};
use super::header::about_bodies;
use super::rotation::quaternion;
use super::standing::key;
use crate::content::ContentHash;

/// Format and frame.
const DESCRIBED: [&str; 2] = [
    "glTF 2.0",
    "glTF's, in m: x to the patient's left, y cranial, z anterior. It is Spineline's y, z, x.",
];

/// From `G` to glTF's axes, of the scene and of a node.
const FROM_GLOBAL: Mat3 = Mat3::new(0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0);

/// Numbers that glTF gives to what it holds.
const SINGLE: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;
const VERTEX_BUFFER: u32 = 34962;
const INDEX_BUFFER: u32 = 34963;
const TRIANGLES: u32 = 4;

/// Bytes of the places; as many as of the normals.
const PLACES: usize = SIDES.len() * 4 * 3 * 4;
/// Numbers of the triangles' corners, two triangles a side.
const INDICES: usize = SIDES.len() * 6;

/// The whole file.
pub(super) fn text(model: &PersonalisedModel, vertebrae: &[Vertebra], generator: &str) -> String {
    let nodes: Vec<Value> = vertebrae.iter().map(node).collect();
    let corners_of_sides = SIDES.len() * 4;
    let file = json!({
        "asset": {
            "version": "2.0",
            "generator": generator,
            "extras": {
                "case_ids": [model.case_id],
                "content_sha256": ContentHash,
                "synthetic": model.synthetic,
                "about": about_bodies(model, generator, DESCRIBED),
            },
        },
        "scene": 0,
        "scenes": [{ "name": model.case_id, "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": [{
            "name": "vertebral body",
            "primitives": [{
                "attributes": { "POSITION": 0, "NORMAL": 1 },
                "indices": 2,
                "material": 0,
                "mode": TRIANGLES,
            }],
        }],
        "materials": [{
            "name": "bone",
            "pbrMetallicRoughness": {
                "baseColorFactor": [0.91, 0.87, 0.76, 1.0],
                "metallicFactor": 0.0,
                "roughnessFactor": 0.9,
            },
        }],
        "accessors": [
            { "bufferView": 0, "componentType": SINGLE, "count": corners_of_sides, "type": "VEC3",
              "min": [-0.5, -0.5, -0.5], "max": [0.5, 0.5, 0.5] },
            { "bufferView": 1, "componentType": SINGLE, "count": corners_of_sides, "type": "VEC3" },
            { "bufferView": 2, "componentType": UNSIGNED_SHORT, "count": INDICES, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": PLACES, "target": VERTEX_BUFFER },
            { "buffer": 0, "byteOffset": PLACES, "byteLength": PLACES, "target": VERTEX_BUFFER },
            { "buffer": 0, "byteOffset": 2 * PLACES, "byteLength": 2 * INDICES, "target": INDEX_BUFFER },
        ],
        "buffers": [buffer()],
    });
    format!("{file:#}\n")
}

/// A vertebra: where it is, how it stands, and its angles.
fn node(vertebra: &Vertebra) -> Value {
    let [w, x, y, z] = quaternion(&(FROM_GLOBAL * vertebra.axes * FROM_GLOBAL.transpose()));
    let [lateral_tilt_deg, pitch_deg, axial_rotation_deg] = vertebra.angles_deg();
    json!({
        "name": vertebra.name,
        "mesh": 0,
        "translation": (FROM_GLOBAL * vertebra.midpoint_m).as_slice(),
        "rotation": [x, y, z, w],
        "scale": (FROM_GLOBAL * vertebra.size_m).as_slice(),
        "extras": {
            "lateral_tilt_deg": lateral_tilt_deg,
            "pitch_deg": pitch_deg,
            "axial_rotation_deg": axial_rotation_deg,
            "pitch_from": key(vertebra.pitch_from),
            "axial_rotation_from": key(vertebra.axial_from),
            "width_is_measured": vertebra.width_is_measured,
        },
    })
}

/// Places and normals of the corners of every side, then the triangles.
fn buffer() -> Value {
    let corners = corners();
    let (mut places, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for (side, first) in SIDES.iter().zip((0_u16..).step_by(4)) {
        let middle: Vec3 = side.iter().map(|&corner| corners[corner]).sum();
        for &corner in side {
            put(&mut places, corners[corner]);
            put(&mut normals, middle / 2.0);
        }
        triangles.extend([0, 1, 2, 0, 2, 3].map(|corner| first + corner).map(u16::to_le_bytes));
    }
    let bytes = [places, normals, triangles.concat()].concat();
    let data = STANDARD.encode(&bytes);
    json!({
        "byteLength": bytes.len(),
        "uri": format!("data:application/octet-stream;base64,{data}"),
    })
}

/// A vector in glTF's axes.
fn put(bytes: &mut Vec<u8>, v: Vec3) {
    for &value in (FROM_GLOBAL * v).iter() {
        #[expect(clippy::cast_possible_truncation, reason = "halves and ones are exact")]
        bytes.extend((value as f32).to_le_bytes());
    }
}
