//! Bones beside the spine: ribs, collarbones, sacrum and iliac wings.

use rayon::prelude::*;
use spineline::anatomy::Level;
use spineline::spatial::Frontal;

use super::anatomy::{Anatomy, Body};
use super::layer::{Layer, Patch, Point, soft_profile, tube_profile};
use super::texture::rough;

/// A rib: its vertebra, the distance of its outermost place from the trunk's middle, its fall from the head to that
/// place and from there to the front end, and the part of the way to the front that it covers.
type Rib = (Level, f32, f32, f32, f32);

const RIBS: [Rib; 12] = [
    (Level::T1, 58.0, 2.0, 20.0, 0.95),
    (Level::T2, 80.0, 10.0, 40.0, 0.90),
    (Level::T3, 96.0, 20.0, 55.0, 0.88),
    (Level::T4, 107.0, 28.0, 66.0, 0.86),
    (Level::T5, 115.0, 36.0, 74.0, 0.84),
    (Level::T6, 121.0, 44.0, 80.0, 0.82),
    (Level::T7, 125.0, 52.0, 84.0, 0.80),
    (Level::T8, 127.0, 60.0, 80.0, 0.74),
    (Level::T9, 126.0, 68.0, 70.0, 0.68),
    (Level::T10, 121.0, 74.0, 60.0, 0.62),
    (Level::T11, 98.0, 66.0, 20.0, 0.44),
    (Level::T12, 66.0, 50.0, 10.0, 0.36),
];

/// All bones on one grid.
pub(super) fn draw(anatomy: &Anatomy) -> Layer {
    let mut layer = anatomy.layer();
    pelvis(anatomy, &mut layer);
    let sides = [1.0_f32, -1.0];
    let paths: Vec<(Rib, f32)> =
        RIBS.iter().flat_map(|&rib| sides.map(|side| (rib, side))).collect();
    let patches: Vec<Patch> =
        paths.par_iter().filter_map(|&(rib, side)| rib_patch(anatomy, &layer, rib, side)).collect();
    let others = sides.map(|side| collarbone(anatomy, &layer, side));
    for patch in patches.iter().chain(&others) {
        layer.add(patch);
    }
    layer
}

/// A rib, from its head beside the vertebra to its front end.
fn rib_patch(anatomy: &Anatomy, layer: &Layer, rib: Rib, side: f32) -> Option<Patch> {
    let (level, reach, fall, further, part) = rib;
    let body = anatomy.body(level)?;
    let scale = anatomy.scale;
    let width = 0.5 * body.superior_width_mm as f32;
    let head = body.point(f64::from(side * (width + 1.0)), 0.22 * body.height_mm);
    let outer_z = head[1] - fall * scale;
    let outer_y = anatomy.middle_at(outer_z) + side * reach * scale;
    let span = outer_y - head[0];
    // From the head (0) over the outermost place (½) to the middle of the front (1).
    let place = |t: f32| -> Point {
        let turn = std::f32::consts::PI * t;
        let rise = 5.0 * scale * (turn * 2.0).sin().max(0.0) * (1.0 - t);
        if t <= 0.5 {
            let out = turn.sin().powf(0.9);
            [head[0] + span * out, head[1] + rise - fall * scale * (1.0 - turn.cos()).powf(1.25)]
        } else {
            let back = turn.sin().powf(0.75);
            let middle = anatomy.middle_at(outer_z) + side * 18.0;
            let forward = ((t - 0.5) * 2.0).powf(0.9);
            [middle + (outer_y - middle) * back, outer_z - further * scale * forward]
        }
    };
    let axis: Vec<(Point, f32)> = (0..=64)
        .map(|k| part * k as f32 / 64.0)
        .map(|t| (place(t), radius(level, t) * scale))
        .collect();
    let tube = tube_profile(0.9, 0.034, 0.0075);
    let profile = move |distance: f32, radius: f32, along: f32| {
        let t = part * along;
        // At its outermost place the beam runs along the rib; its front is thinner, and ends in cartilage.
        let turn = 1.0 + 0.5 * (-((t - 0.5) / 0.05).powi(2)).exp();
        let front = 1.0 - 0.45 * ((t - 0.45) / 0.2).clamp(0.0, 1.0);
        let end = ((1.0 - along) / 0.18).min(1.0);
        tube(distance, radius) * turn * front * end
    };
    Some(layer.tube(&axis, profile))
}

/// Half of a rib's height, typical mm: narrower at its neck, wider in front.
fn radius(level: Level, t: f32) -> f32 {
    let back = if level == Level::T1 { 6.3 } else { 5.4 };
    back - 1.8 * (1.0 - (t / 0.10).min(1.0)) + 1.2 * (t - 0.5).max(0.0)
}

fn collarbone(anatomy: &Anatomy, layer: &Layer, side: f32) -> Patch {
    let z = anatomy.height_of(Level::T3);
    let middle = anatomy.middle_at(z);
    let scale = anatomy.scale;
    let axis: Vec<(Point, f32)> = (0..=30)
        .map(|k| k as f32 / 30.0)
        .map(|t| {
            let sway = 6.0 * (t * 6.2).sin();
            let y = middle + side * (16.0 + 135.0 * t) * scale;
            ([y, z + (2.0 + 34.0 * t + sway) * scale], (7.5 - 2.2 * (t * 3.1).sin()) * scale)
        })
        .collect();
    let tube = tube_profile(1.3, 0.030, 0.008);
    layer.tube(&axis, move |distance, radius, _| tube(distance, radius))
}

/// A place of the pelvis: along the line of the crests from its middle, and across it upwards; typical mm.
fn pelvic(anatomy: &Anatomy, point: Point) -> (f32, f32) {
    let [left, right] = anatomy.crests;
    let across = (left - right) * (1.0 / left.distance_mm(right));
    let from = Frontal::new(f64::from(point[0]), f64::from(point[1])) - (left + right) * 0.5;
    let scale = anatomy.scale;
    (from.dot(across) as f32 / scale, across.cross(from) as f32 / scale)
}

fn pelvis(anatomy: &Anatomy, layer: &mut Layer) {
    let l5 = anatomy.body(Level::L5).copied();
    layer.fill(|point| {
        let (u, v) = pelvic(anatomy, point);
        if v > 30.0 {
            return 0.0;
        }
        let sacrum = l5.map_or(0.0, |l5| sacrum(anatomy, &l5, point));
        wing(u.abs(), v) + sacrum
    });
}

/// An iliac wing: its rim is highest at 110 mm from the middle, where the crest's tip is marked.
fn wing(a: f32, v: f32) -> f32 {
    const TIP: f32 = 110.0;
    let (inner, outer) = (38.0, 152.0);
    if !(inner - 8.0..outer).contains(&a) {
        return 0.0;
    }
    let rim = if a > TIP {
        -60.0 * (1.0 - (1.0 - ((a - TIP) / (outer - TIP)).powi(2)).max(0.0).sqrt())
    } else {
        -40.0 * ((TIP - a) / (TIP - inner)).powf(1.9)
    };
    let inside = rim - v;
    if inside < 0.0 {
        return 0.0;
    }
    let edge = (inside / 0.8).min(1.0) * ((a - inner + 8.0) / 8.0).clamp(0.0, 1.0);
    let crest = 0.50 * (-inside / 3.2).exp() + 0.16 * (-((inside - 8.0) / 4.5).powi(2)).exp();
    let grain = 0.03 * rough(a / 5.0, v / 5.0, 3, 77);
    edge * (0.24 + crest + grain)
}

/// The sacrum below L5: its first endplate and the two wings beside it.
fn sacrum(anatomy: &Anatomy, l5: &Body, point: Point) -> f32 {
    let p = Frontal::new(f64::from(point[0]), f64::from(point[1])) - l5.centre;
    let own = p.rotated(-l5.tilt);
    let scale = anatomy.scale;
    let (a, v) = ((own.y_mm as f32).abs() / scale, own.z_mm as f32 / scale);
    let top = -0.5 * l5.height_mm as f32 / scale - 8.0;
    let ala = if a < 24.0 { top } else { top + 3.0 - 0.012 * (a - 30.0).powi(2) };
    let inside = ala - v;
    if inside < 0.0 || a > 62.0 {
        return 0.0;
    }
    let edge = (inside / 0.8).min(1.0) * ((62.0 - a) / 10.0).clamp(0.0, 1.0);
    let grain = 0.05 * rough(a / 4.0, v / 4.0, 3, 91);
    edge * (0.30 + 0.35 * (-inside / 1.2).exp() + grain)
}

/// A vessel, fainter at its root, where many overlap.
pub(super) fn vessel(layer: &Layer, axis: &[(Point, f32)], strength: f32) -> Patch {
    let soft = soft_profile(strength);
    layer.tube(axis, move |distance, radius, along| soft(distance, radius) * (4.0 * along).min(1.0))
}
