//! Arrows for forces and moments, in pixels.

use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive};

use super::style::Ink;

/// Minimum length of an arrow with a head.
const MIN_LENGTH_PX: f64 = 4.0;
const HEAD_PX: f64 = 8.0;
const TURN_PX: f64 = 16.0;

/// An arrow; empty for a force along the line of sight.
pub fn arrow(ink: Ink, from: (f64, f64), to: (f64, f64)) -> Vec<Primitive> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length < MIN_LENGTH_PX {
        return Vec::new();
    }
    let (dx, dy) = (dx / length, dy / length);
    let head = HEAD_PX.min(0.6 * length);
    let neck = (to.0 - 0.8 * head * dx, to.1 - 0.8 * head * dy);
    vec![ink.stroke(from, neck), tip(ink, to, (dx, dy), head)]
}

/// A filled head that points along a unit vector.
fn tip(ink: Ink, to: (f64, f64), along: (f64, f64), size: f64) -> Primitive {
    let (dx, dy) = along;
    let corner = |side: f64| {
        (to.0 - size * dx - 0.42 * side * size * dy, to.1 - size * dy + 0.42 * side * size * dx)
    };
    let (a, b) = (corner(1.0), corner(-1.0));
    path(
        ink,
        format!("M{:.2},{:.2} L{:.2},{:.2} L{:.2},{:.2} Z", to.0, to.1, a.0, a.1, b.0, b.1),
        true,
    )
}

/// The face of a pad: a bar across the end of its arrow.
pub fn bar(ink: Ink, from: (f64, f64), to: (f64, f64)) -> Option<Primitive> {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    let wide = Ink { width_px: 3.0, ..ink };
    let (x, y) = (-9.0 * dy / length, 9.0 * dx / length);
    (length >= MIN_LENGTH_PX).then(|| wide.stroke((to.0 - x, to.1 - y), (to.0 + x, to.1 + y)))
}

/// Three quarters of a circle with a head, around a place.
pub fn turning(ink: Ink, at: (f64, f64), clockwise: bool) -> Vec<Primitive> {
    let (side, sweep) = if clockwise { (1.0, 1) } else { (-1.0, 0) };
    // From the top, over the near side and the bottom, to the far side.
    let (start, end) = ((at.0, at.1 - TURN_PX), (at.0 - side * TURN_PX, at.1));
    let arc = format!(
        "M{:.2},{:.2} A{TURN_PX},{TURN_PX} 0 1 {sweep} {:.2},{:.2}",
        start.0, start.1, end.0, end.1
    );
    let beyond = (end.0, end.1 - 0.6 * HEAD_PX);
    vec![path(ink, arc, false), tip(ink, beyond, (0.0, -1.0), HEAD_PX)]
}

fn path(ink: Ink, d: String, filled: bool) -> Primitive {
    Primitive::Path(Box::new(PathData {
        d,
        fill: filled.then(|| ink.colour.into()),
        stroke: Color::from(ink.colour),
        stroke_width: if filled { 0.5 } else { ink.width_px },
        opacity: None,
        stroke_dasharray: None,
    }))
}
