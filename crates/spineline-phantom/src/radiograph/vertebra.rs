//! One vertebra, in its own axes: the body with cortex and endplates, and the parts behind it.

use spineline::anatomy::Level;
use spineline::spatial::Frontal;

use super::anatomy::{Anatomy, Body};
use super::texture::clutter;
use super::trunk::soft_edge;

/// Attenuation in addition to soft tissue, per mm.
const CANCELLOUS_PER_MM: f32 = 0.012;
const CORTEX_PER_MM: f32 = 0.048;
/// Wall of a body.
const CORTEX_MM: f32 = 1.1;
/// An endplate, seen along its depth.
const ENDPLATE_PER_MM: f32 = 0.024;
const ENDPLATE_MM: f32 = 0.8;
/// Half of the width over which an endplate's edge fades.
const EDGE_MM: f32 = 0.18;

/// All vertebrae, and two of the neck at the picture's end.
pub(super) fn all(anatomy: &Anatomy, seed: u64) -> Vec<Vertebra> {
    let mut bodies = anatomy.bodies.clone();
    if let Some(&t1) = anatomy.body(Level::T1) {
        let mut last = t1;
        for _ in 0..2 {
            last.centre = last.centre + Frontal::new(0.0, 1.12 * last.height_mm).rotated(last.tilt);
            last.superior_width_mm *= 0.93;
            last.inferior_width_mm *= 0.93;
            last.height_mm *= 0.93;
            bodies.push(last);
        }
    }
    bodies.iter().map(|body| Vertebra::new(body, seed)).collect()
}

/// A vertebra ready to be drawn; lengths in mm along its own axes, from the body's centre.
pub(super) struct Vertebra {
    body: Body,
    seed: u32,
    half_superior: f32,
    half_inferior: f32,
    half_height: f32,
    depth: f32,
    lumbar: bool,
    /// Transverse process beyond the body.
    transverse: f32,
}

impl Vertebra {
    fn new(body: &Body, seed: u64) -> Self {
        let lumbar = body.level <= Level::L1;
        let width = body.superior_width_mm as f32;
        let thoracic_reach = match body.level {
            Level::T12 => 0.18,
            Level::T11 => 0.26,
            _ => 0.40,
        };
        Self {
            body: *body,
            seed: (seed as u32) ^ (body.centre.z_mm as i32 as u32),
            half_superior: 0.5 * width,
            half_inferior: 0.5 * body.inferior_width_mm as f32,
            half_height: 0.5 * body.height_mm as f32,
            depth: if lumbar { 0.76 } else { 0.92 } * width,
            lumbar,
            transverse: width * if lumbar { 0.38 } else { thoracic_reach },
        }
    }

    /// Adds this vertebra to one row of a picture, from a start place with a step per pixel.
    pub fn add_row(&self, start: Frontal, step: Frontal, line: &mut [f32]) {
        let (across, along) = (1.2 * self.half_inferior + self.transverse, 2.4 * self.half_height);
        let to_own = |p: Frontal| p.rotated(-self.body.tilt);
        let (from, by) = (to_own(start - self.body.centre), to_own(step));
        // Columns within the vertebra's reach.
        let mut columns = 0.0..line.len() as f64;
        for (at, by, reach) in
            [(from.y_mm, by.y_mm, f64::from(across)), (from.z_mm, by.z_mm, f64::from(along))]
        {
            if by.abs() < 1e-12 {
                if at.abs() > reach {
                    return;
                }
                continue;
            }
            let ends = [(-reach - at) / by, (reach - at) / by];
            columns.start = columns.start.max(ends[0].min(ends[1]));
            columns.end = columns.end.min(ends[0].max(ends[1]));
        }
        let (first, last) = (columns.start.ceil().max(0.0) as usize, columns.end.floor());
        if last < first as f64 {
            return;
        }
        let last = (last as usize).min(line.len().saturating_sub(1));
        for (column, value) in line.iter_mut().enumerate().take(last + 1).skip(first) {
            let k = column as f64;
            let (u, v) = (from.y_mm + k * by.y_mm, from.z_mm + k * by.z_mm);
            *value += self.attenuation(u as f32, v as f32);
        }
    }

    /// Attenuation at a place of the vertebra, `u` to the left and `v` up.
    fn attenuation(&self, u: f32, v: f32) -> f32 {
        let a = u.abs();
        self.body(u, v) + self.pedicle(a, v) + self.arch(a, v) + self.processes(a, v)
    }

    fn body(&self, u: f32, v: f32) -> f32 {
        let part = (v + self.half_height) / (2.0 * self.half_height);
        if !(-0.1..=1.1).contains(&part) {
            return 0.0;
        }
        let inside = part.clamp(0.0, 1.0);
        let waist =
            0.065 * (self.half_inferior + self.half_superior) * inside * (1.0 - inside) * 4.0;
        let straight = self.half_inferior + inside * (self.half_superior - self.half_inferior);
        // The rims reach the corners; the sides between are hollow.
        let half = straight - waist * (1.0 - (2.0 * inside - 1.0).powi(4)) * 0.8;
        let across = u / half;
        if across.abs() >= 1.0 {
            return 0.0;
        }
        // Endplates dip twice beside their centres, which keep their places.
        let wave = (std::f32::consts::PI * across).sin();
        let dip = if self.lumbar { 0.8 } else { 0.4 } * wave * wave;
        let (below_top, above_base) =
            (self.half_height - v - 0.5 * dip, self.half_height + v - dip);
        let edge = soft_edge(below_top, EDGE_MM) * soft_edge(above_base, EDGE_MM);
        if edge <= 0.0 {
            return 0.0;
        }
        let chord = |q: f32| (1.0 - q.powi(4)).max(0.0).sqrt() * self.depth;
        let outer = chord(across);
        let inner = chord((u / (half - CORTEX_MM)).clamp(-1.0, 1.0));
        let plate = |depth: f32| (-depth.max(0.0) / ENDPLATE_MM).exp();
        let grain = 1.0
            + 0.13 * clutter(u / 0.7, v / 1.5, self.seed)
            + 0.10 * clutter(u / 2.5, v / 3.0, self.seed ^ 1);
        edge * (inner * CANCELLOUS_PER_MM * grain
            + (outer - inner) * CORTEX_PER_MM
            + outer * ENDPLATE_PER_MM * (plate(below_top) + plate(above_base)))
    }

    /// A pedicle appears as an oval ring.
    fn pedicle(&self, a: f32, v: f32) -> f32 {
        let (at, up) = (self.pedicle_place(), 0.34 * self.half_height);
        let (half_width, half_height) = if self.lumbar {
            (0.20 * self.half_superior, 0.54 * self.half_height)
        } else {
            (0.19 * self.half_superior, 0.50 * self.half_height)
        };
        let radius = ((a - at) / half_width).hypot((v - up) / half_height);
        if radius > 1.6 {
            return 0.0;
        }
        let wall = (-((radius - 0.92) / 0.17).powi(2)).exp();
        let core = if radius < 1.0 { 1.0 - radius * radius } else { 0.0 };
        0.36 * wall + 0.10 * core
    }

    fn pedicle_place(&self) -> f32 {
        self.half_superior * if self.lumbar { 0.68 } else { 0.72 }
    }

    /// Laminae, articular processes and the spinous process.
    fn arch(&self, a: f32, v: f32) -> f32 {
        let (w, h) = (self.half_superior, self.half_height);
        let lamina = capsule([a, v], [0.0, -0.25 * h], [0.62 * w, 0.2 * h], 0.34 * w) * 0.10;
        let lower = capsule([a, v], [0.34 * w, -0.3 * h], [0.46 * w, -1.25 * h], 0.19 * w) * 0.11;
        let upper = capsule([a, v], [0.66 * w, 0.5 * h], [0.64 * w, 1.15 * h], 0.17 * w) * 0.10;
        let (centre, tall) = if self.lumbar { (-0.55, 0.62) } else { (-0.95, 0.60) };
        let radius = (a / (0.13 * w + 0.6)).hypot((v - centre * h) / (tall * h));
        let spinous = if radius < 1.6 {
            let core = (1.0 - radius * radius).max(0.0);
            0.22 * (-((radius - 0.86) / 0.22).powi(2)).exp() + 0.13 * core
        } else {
            0.0
        };
        lamina + lower + upper + spinous
    }

    /// Transverse processes: wide at the root, rounded at the end, fainter outwards.
    fn processes(&self, a: f32, v: f32) -> f32 {
        let (w, h) = (self.half_superior, self.half_height);
        let (start, end) = (0.80 * self.pedicle_place(), w + self.transverse);
        let out = (a - start) / (end - start);
        if !(0.0..1.0).contains(&out) {
            return 0.0;
        }
        let (rise, thick, strength) =
            if self.lumbar { (0.10, 0.30, 0.22) } else { (0.40, 0.46, 0.20) };
        // A line that rises outwards and curls a little up at its end.
        let middle = (0.22 + rise * out + 0.16 * out.powi(3)) * h;
        let round = (1.0 - out.powi(4)).sqrt();
        let half = thick * h * (1.0 - 0.35 * (std::f32::consts::PI * out).sin()) * round;
        let across = ((v - middle) / half.max(0.01)).abs();
        if across >= 1.0 {
            return 0.0;
        }
        let rim = ((1.0 - across) * 3.0).min(1.0) * (out * 7.0).min(1.0);
        strength * rim * (0.7 + 0.5 * across * across) * (1.0 - 0.35 * out)
    }
}

/// A rounded bar between two points: one along its middle, slightly more at its rim, zero outside.
fn capsule(p: [f32; 2], from: [f32; 2], to: [f32; 2], radius: f32) -> f32 {
    let (x, y) = (p[0] - from[0], p[1] - from[1]);
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let part = ((x * dx + y * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
    let (ex, ey) = (x - part * dx, y - part * dy);
    let square = (ex * ex + ey * ey) / (radius * radius);
    if square >= 1.0 {
        return 0.0;
    }
    // A wall, and a rim that fades.
    let rim = ((1.0 - square) * 2.2).min(1.0);
    rim * (0.8 + 0.3 * square)
}
