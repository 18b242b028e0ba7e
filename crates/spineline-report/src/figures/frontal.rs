//! Frontal pictures of a spine, seen from behind and at one scale for both axes.

use kuva::render::render::{Primitive, TextAnchor};
use spineline::action::LineOfAction;
use spineline::analysis::{Analysis, FilmMovement};
use spineline::anatomy::{Level, Levels};
use spineline::measure::Outline;
use spineline::spatial::{Angle, Frontal, Vec3};

use super::panel::{Axis, HeadingKind, Panel, Ticks};
use super::style::{BLACK, Ink, Marker, ORANGE, Shape, TICK_PX, WHITE, bold};

/// The side from which one looks, said on every frontal picture.
pub const VIEW: &str = "Seen from behind: the patient's left (L) is on the left of the picture.";

/// From behind to the oblique view, towards the patient's right.
const OBLIQUE_DEG: f64 = 35.0;

/// How inflections are drawn on a spine.
pub const INFLECTION: Marker =
    Marker { radius_px: 5.0, ..Marker::new(Shape::Diamond, ORANGE, true) };

/// The support of the model, which changes every simulated shape.
pub fn support_note(analysis: &Analysis) -> String {
    format!("Support of the model: {}.", analysis.options.support)
}

/// Room around a spine: beside it, and below and above it for the names of its ends.
const PAD_MM: [f64; 2] = [22.0, 32.0];

/// A rectangle of the frontal plane, grown to hold points.
#[derive(Debug, Clone, Copy)]
pub struct Extent {
    /// Least and greatest `-y`.
    pub x_mm: [f64; 2],
    /// Least and greatest `z`.
    pub z_mm: [f64; 2],
}

/// A point as it is drawn: the patient's left to the left.
pub fn drawn(point: Frontal) -> (f64, f64) {
    (-point.y_mm, point.z_mm)
}

/// The side from which one looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    Behind,
    Right,
    Oblique,
}

impl View {
    pub const ALL: [Self; 3] = [Self::Behind, Self::Right, Self::Oblique];

    pub const fn words(self) -> &'static str {
        match self {
            Self::Behind => "from behind",
            Self::Right => "from the right",
            Self::Oblique => "oblique, from behind right",
        }
    }

    /// A point of `G` such that [`drawn`] puts it where this view has it.
    pub fn flat(self, point: &Vec3) -> Frontal {
        let (sin, cos) = Angle::from_deg(OBLIQUE_DEG).rad().sin_cos();
        let left = match self {
            Self::Behind => point.y,
            Self::Right => -point.x,
            Self::Oblique => -(point.x * sin - point.y * cos),
        };
        Frontal::new(left, point.z)
    }
}

impl Extent {
    /// Holds points, with some room around them.
    pub fn of(points: impl IntoIterator<Item = Frontal>) -> Self {
        Self::around(points).grown(PAD_MM)
    }

    /// Holds points and the origin, and nothing more.
    pub fn around(points: impl IntoIterator<Item = Frontal>) -> Self {
        let mut extent = Self { x_mm: [0.0; 2], z_mm: [0.0; 2] };
        for point in points.into_iter().filter(|point| point.is_finite()) {
            let (x, z) = drawn(point);
            extent.x_mm = [extent.x_mm[0].min(x), extent.x_mm[1].max(x)];
            extent.z_mm = [extent.z_mm[0].min(z), extent.z_mm[1].max(z)];
        }
        extent
    }

    /// The same with more room on all sides.
    pub fn grown(self, by_mm: [f64; 2]) -> Self {
        let grown = |[low, high]: [f64; 2], by: f64| [low - by, high + by];
        Self { x_mm: grown(self.x_mm, by_mm[0]), z_mm: grown(self.z_mm, by_mm[1]) }
    }

    /// The common part of both.
    pub fn common(self, other: Self) -> Self {
        let common = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self { x_mm: common(self.x_mm, other.x_mm), z_mm: common(self.z_mm, other.z_mm) }
    }

    /// The smallest that holds both.
    pub fn union(self, other: Self) -> Self {
        let union = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        Self { x_mm: union(self.x_mm, other.x_mm), z_mm: union(self.z_mm, other.z_mm) }
    }

    /// Widened to at least this width, around the same middle.
    pub fn at_least_wide(mut self, width_mm: f64) -> Self {
        let more = 0.5 * (width_mm - self.width_mm()).max(0.0);
        self.x_mm = [self.x_mm[0] - more, self.x_mm[1] + more];
        self
    }

    pub fn width_mm(&self) -> f64 {
        self.x_mm[1] - self.x_mm[0]
    }

    pub fn height_mm(&self) -> f64 {
        self.z_mm[1] - self.z_mm[0]
    }
}

/// How films without a scale are drawn; `None` where all have one.
pub fn scale_note(analysis: &Analysis) -> Option<String> {
    let mut films = analysis.movement.films.iter();
    let all = films.all(|posture| posture.outline.scale.has_millimetres());
    let words = "Where a film has no scale, it is drawn at the length of the erect film, and an erect film without a scale at a typical length of the spine: only shapes are measured.";
    (!all).then(|| words.to_owned())
}

/// Which panels of a row of films write their vertical axis: the first, and every one that has a scale where the one
/// before it has none, or the reverse.
pub fn axes_of_row<'a>(films: impl IntoIterator<Item = &'a Outline>) -> Vec<bool> {
    let mut before = None;
    let scaled = films.into_iter().map(|outline| outline.scale.is_internal());
    scaled.map(|scaled| before.replace(scaled) != Some(scaled)).collect()
}

/// Width between the frames of a row, without and with a written vertical axis.
const GAPS_PX: [f64; 2] = [18.0, 84.0];

/// Width of the gaps of a row.
pub fn gaps_px(axes: &[bool]) -> f64 {
    axes.iter().map(|written| GAPS_PX[usize::from(*written)]).sum()
}

/// Width of one of the equally wide frames of a row that has room for `most` of them.
pub fn frame_px(row_px: f64, axes: &[bool], most: usize) -> f64 {
    let empty_px = most.saturating_sub(axes.len()) as f64 * GAPS_PX[0];
    (row_px - gaps_px(axes) - empty_px) / most.max(1) as f64
}

/// Places on the fitted curve of a film, from its lower to its upper end.
pub fn fitted_curve(film: &FilmMovement) -> impl Iterator<Item = Frontal> {
    const SAMPLES: i32 = 160;
    let curve = &film.fit.curve;
    (0..=SAMPLES).map(move |i| curve.point(curve.end_mm() * f64::from(i) / f64::from(SAMPLES)))
}

/// An empty panel of a film under the name of its posture. Where the film or the erect film has no scale, its axes have no numbers.
pub fn film_panel(film: &Outline, extent: Extent, px_per_mm: f64, y_written: bool) -> Panel {
    let mut panel = frontal_panel(extent, px_per_mm, film.levels().base());
    panel.y_written = y_written;
    panel.heading(HeadingKind::Title, film.posture.to_string());
    if !film.scale.is_internal() {
        for axis in [&mut panel.x, &mut panel.y] {
            axis.label = axis.label.replace("(mm)", "(no scale)");
            axis.ticks = Ticks::Blank;
        }
    }
    panel
}

/// Fits frames of one height into a row. Returns the scale, and the extents widened until they fill the row; no frame is
/// taller than `tall_px`.
pub fn fit_in_row<const N: usize>(
    extents: [Extent; N],
    row_px: f64,
    tall_px: f64,
) -> (f64, [Extent; N]) {
    let width_mm: f64 = extents.iter().map(Extent::width_mm).sum();
    let px_per_mm = (tall_px / extents[0].height_mm()).min(row_px / width_mm);
    let spare_mm = (row_px / px_per_mm - width_mm) / N as f64;
    (px_per_mm, extents.map(|extent| extent.at_least_wide(extent.width_mm() + spare_mm)))
}

/// An empty panel of an extent at a scale; heights are measured from the base.
pub fn frontal_panel(extent: Extent, px_per_mm: f64, base: Level) -> Panel {
    let step =
        [5.0, 10.0, 20.0, 50.0, 100.0, 200.0].into_iter().find(|step| step * px_per_mm >= 46.0);
    let step = step.unwrap_or(500.0);
    let frame_px = [extent.width_mm() * px_per_mm, extent.height_mm() * px_per_mm];
    let x = Axis::sides("lateral (mm)", extent.x_mm, step, frame_px[0]);
    let y = Axis::numbers(format!("cranial of {base} (mm)"), extent.z_mm, step);
    let mut panel = Panel::new(x, y, frame_px);
    panel.corners = Some(["LEFT", "RIGHT"]);
    panel.boxed = true;
    panel
}

impl Panel {
    /// A point of the frontal plane as pixels from the frame's top left.
    pub fn place(&self, point: Frontal) -> (f64, f64) {
        let (x, z) = drawn(point);
        self.px(x, z)
    }

    /// Makes a frontal panel one that is seen from the patient's right: the front is on the right.
    pub fn see_from_right(&mut self, base: Level) {
        self.x.label = format!("anterior of {base} (mm)");
        self.x.ticks = Ticks::Numbers;
        self.corners = Some(["BACK", "FRONT"]);
    }

    /// A spine as vertebra midpoints, joined by a curve.
    pub fn spine(&mut self, points: &[Frontal], ink: Ink, marker: Marker) {
        self.curves.push((ink, points.iter().copied().map(drawn).collect()));
        self.points(marker, points.iter().copied().map(drawn));
    }

    /// A line of action from edge to edge, as a mark.
    pub fn action_mark(&self, line: &LineOfAction, ink: Ink) -> Option<Primitive> {
        Some(self.trace(ink, clipped(line, self.x.range, self.y.range)?))
    }

    /// A line of action from edge to edge.
    pub fn action(&mut self, line: &LineOfAction, ink: Ink) {
        if let Some([from, to]) = clipped(line, self.x.range, self.y.range) {
            self.curves.push((ink, vec![from, to]));
        }
    }

    /// Writes the name of the base (L4) below the first point of a spine and the name of the top (T2) above the last. Call it before
    /// markers are drawn: it would hide them.
    pub fn end_levels(&mut self, points: &[Frontal], levels: Levels) {
        if let [first, .., last] = points {
            for (point, name, down_px) in
                [(first, levels.base().name(), 18.0), (last, levels.top().name(), -9.0)]
            {
                let (x, y) = self.place(*point);
                let at = (x, y + down_px);
                // A pale ground keeps the letters readable over lines.
                self.marks.push(ground(at));
                self.marks.push(bold(at, name, TICK_PX, TextAnchor::Middle, BLACK));
            }
        }
    }
}

/// A translucent white rectangle behind two letters.
fn ground(at: (f64, f64)) -> Primitive {
    Primitive::Rect {
        x: at.0 - 10.0,
        y: at.1 - 10.5,
        width: 20.0,
        height: 12.0,
        fill: WHITE.into(),
        stroke: None,
        stroke_width: None,
        opacity: Some(0.75),
    }
}

/// The part of a line within a rectangle, as drawn.
fn clipped(line: &LineOfAction, x: [f64; 2], z: [f64; 2]) -> Option<[(f64, f64); 2]> {
    let (from, along) = (drawn(line.point), drawn(line.direction));
    let mut part = [f64::NEG_INFINITY, f64::INFINITY];
    for (start, slope, [low, high]) in [(from.0, along.0, x), (from.1, along.1, z)] {
        if slope.abs() < 1e-12 {
            if !(low..=high).contains(&start) {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - start) / slope, (high - start) / slope);
        part = [part[0].max(a.min(b)), part[1].min(a.max(b))];
    }
    let at = |t: f64| (from.0 + t * along.0, from.1 + t * along.1);
    (part[0] < part[1]).then(|| part.map(at))
}

/// The vertebrae of a model by their ends, such as `L4 to T2`.
pub fn extent_words(analysis: &Analysis) -> String {
    let levels = analysis.movement.levels();
    format!("{} to {}", levels.base(), levels.top())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_clipped_at_the_edges() {
        let up = LineOfAction::leaning(Frontal::new(-10.0, 5.0), Angle::ZERO);
        let cut = clipped(&up, [-50.0, 50.0], [0.0, 100.0]).expect("crosses");
        assert_eq!(cut, [(10.0, 0.0), (10.0, 100.0)]);
        assert_eq!(clipped(&up, [20.0, 50.0], [0.0, 100.0]), None);
    }

    #[test]
    fn the_patients_left_is_on_the_left() {
        assert!(drawn(Frontal::new(30.0, 0.0)).0 < drawn(Frontal::new(-30.0, 0.0)).0);
    }
}
