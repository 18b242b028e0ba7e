//! One pair of axes with what is drawn between them.

use std::sync::Arc;

use kuva::plot::LinePlot;
use kuva::render::color::Color;
use kuva::render::layout::{Layout, TickFormat};
use kuva::render::plots::Plot;
use kuva::render::render::{PathData, Primitive, TextAnchor, render_multiple};
use kuva::render::theme::Theme;
use spineline::number::fixed;

use super::style::{
    BLACK, GREY, HEADING_PX, Ink, LABEL_PX, Marker, PALE, TICK_PX, VERMILLION, bold, line_px,
    nice_step, text, text_width_px,
};

/// The attribute of the group that a picture goes into.
pub const PICTURE_SLOT: &str = "data-layer=\"picture\" data-slot=";

/// The mark of a tick below the frame.
const TICK: Ink = Ink::new(BLACK, "", 1.0);
const TICK_MARK_PX: f64 = 5.0;

/// A label may reach this far beyond its frame.
const EDGE_PX: f64 = 6.0;

/// Labels of an axis' ticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ticks {
    /// Numbers.
    Numbers,
    /// Distances to the patient's sides: the axis holds `-y`, so that the patient's left is on the left.
    Sides,
    /// Nothing: the axis has no scale.
    Blank,
    /// Nothing: names are written below by [`Panel::names`].
    None,
}

/// An axis.
#[derive(Debug, Clone)]
pub struct Axis {
    pub label: String,
    pub range: [f64; 2],
    pub step: f64,
    pub ticks: Ticks,
}

impl Axis {
    /// With numbers at its ticks.
    pub fn numbers(label: impl Into<String>, range: [f64; 2], step: f64) -> Self {
        Self { label: label.into(), range, step, ticks: Ticks::Numbers }
    }

    /// From zero to a round number above all values.
    pub fn from_zero(label: &str, most: f64) -> Self {
        let most = if most > 0.0 { 1.03 * most } else { 1.0 };
        let step = nice_step(most, 6.0);
        Self::numbers(label, [0.0, step * (most / step).ceil()], step)
    }

    /// Between round numbers around all values, with about this number of ticks.
    pub fn around(label: impl Into<String>, low: f64, high: f64, ticks: f64) -> Self {
        let step = nice_step(high - low, ticks);
        let range = [step * (low / step).floor(), step * (high / step).ceil()];
        Self::numbers(label, range, step)
    }

    /// Places of equal width without numbers; [`Panel::names`] are written below them.
    pub fn places(label: &str, count: f64) -> Self {
        Self { label: label.to_owned(), range: [0.0, count], step: 1.0, ticks: Ticks::None }
    }

    /// Distances to the patient's sides, in a frame of this width. The step is smaller where fewer than two labels beside 0 have
    /// room.
    pub fn sides(label: &str, range: [f64; 2], step: f64, frame_px: f64) -> Self {
        const SMALLER: [f64; 11] = [100.0, 80.0, 60.0, 50.0, 40.0, 30.0, 20.0, 10.0, 5.0, 2.0, 1.0];
        /// Room for a label and a gap.
        const APART_PX: f64 = 36.0;
        let with = |step| Self { label: label.to_owned(), range, step, ticks: Ticks::Sides };
        let px_per_unit = frame_px / (range[1] - range[0]);
        let fits = |smaller: &f64| *smaller < step && smaller * px_per_unit >= APART_PX;
        let beside_zero =
            |axis: &Self| axis.side_ticks(frame_px).iter().filter(|(x, _)| *x != 0.0).count();
        let mut axes = [step].into_iter().chain(SMALLER.into_iter().filter(fits)).map(with);
        axes.find(|axis| beside_zero(axis) >= 2).unwrap_or_else(|| with(step))
    }

    /// Ticks of distances to the patient's sides with their labels. A tick whose label would reach beyond its frame is left
    /// out: a neighbour stands there.
    fn side_ticks(&self, frame_px: f64) -> Vec<(f64, String)> {
        let ([from, to], places) = (self.range, self.decimals());
        let px_per_unit = frame_px / (to - from);
        // An endless range has no ticks.
        if self.step * px_per_unit < 1.0 {
            return Vec::new();
        }
        let tick = |i: i32| {
            let x = f64::from(i) * self.step;
            let side = match i.signum() {
                0 => "",
                1 => " R",
                _ => " L",
            };
            (x, format!("{}{side}", fixed(x.abs(), places)))
        };
        let has_room = |(x, label): &(f64, String)| {
            let room_px = (x - from).min(to - x) * px_per_unit + EDGE_PX;
            0.5 * text_width_px(label, TICK_PX) <= room_px
        };
        let [first, last] = [(from / self.step).ceil(), (to / self.step).floor()];
        (first as i32..=last as i32).map(tick).filter(has_room).collect()
    }

    /// Decimal places of the step.
    fn decimals(&self) -> usize {
        (-self.step.log10() - 1e-9).ceil().max(0.0) as usize
    }

    /// Labels of the ticks that kuva draws.
    fn format(&self) -> TickFormat {
        let places = self.decimals();
        match self.ticks {
            Ticks::Numbers => TickFormat::Custom(Arc::new(move |x| fixed(x, places))),
            Ticks::Sides | Ticks::Blank | Ticks::None => {
                TickFormat::Custom(Arc::new(|_| String::new()))
            }
        }
    }
}

/// A name below the horizontal axis.
#[derive(Debug, Clone)]
pub struct Name {
    /// Centre, in data units.
    pub x: f64,
    /// Line below the axis, from 0.
    pub row: usize,
    pub text: String,
    pub bold: bool,
}

/// A line of a heading.
#[derive(Debug, Clone)]
pub struct Heading {
    pub text: String,
    pub kind: HeadingKind,
}

/// How a heading is printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HeadingKind {
    Title,
    Plain,
    Alarm,
}

/// A pair of axes.
#[derive(Debug, Clone)]
pub struct Panel {
    pub headings: Vec<Heading>,
    /// Words at the top left and top right of the frame.
    pub corners: Option<[&'static str; 2]>,
    pub x: Axis,
    pub y: Axis,
    /// Size of the frame.
    pub frame_px: [f64; 2],
    /// Whether ticks and label of the vertical axis are written.
    pub y_written: bool,
    pub boxed: bool,
    /// Whether only the marks are drawn, without axes.
    pub bare: bool,
    pub names: Vec<Name>,
    /// Curves in data units, clipped to the frame.
    pub curves: Vec<(Ink, Vec<(f64, f64)>)>,
    /// Anything else, in pixels from the frame's top left.
    pub marks: Vec<Primitive>,
    /// A picture below all marks.
    pub picture: Option<Picture>,
}

/// A picture file within a frame.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Its bytes as PNG.
    pub png: Vec<u8>,
    /// Where its first and its last corner lie, in pixels from the frame's top left; they may lie beyond the frame.
    pub corners_px: [(f64, f64); 2],
}

/// Room on the four sides of the frame.
#[derive(Debug, Clone, Copy)]
pub struct Room {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Panel {
    pub fn new(x: Axis, y: Axis, frame_px: [f64; 2]) -> Self {
        Self {
            headings: Vec::new(),
            corners: None,
            x,
            y,
            frame_px,
            y_written: true,
            boxed: false,
            bare: false,
            names: Vec::new(),
            curves: Vec::new(),
            marks: Vec::new(),
            picture: None,
        }
    }

    /// A place for marks alone.
    pub fn bare(frame_px: [f64; 2]) -> Self {
        let axis = Axis::places("", 1.0);
        Self { y_written: false, bare: true, ..Self::new(axis.clone(), axis, frame_px) }
    }

    pub fn heading(&mut self, kind: HeadingKind, text: impl Into<String>) {
        self.headings.push(Heading { text: text.into(), kind });
    }

    /// Lines of a name below the axis, from a row downwards.
    pub fn name_below(&mut self, x: f64, row: usize, lines: Vec<String>, bold: bool) {
        let name = |(i, text)| Name { x, row: row + i, text, bold };
        self.names.extend(lines.into_iter().enumerate().map(name));
    }

    /// A place in data units as pixels from the frame's top left.
    pub fn px(&self, x: f64, y: f64) -> (f64, f64) {
        let part = |axis: &Axis, v: f64| (v - axis.range[0]) / (axis.range[1] - axis.range[0]);
        (self.frame_px[0] * part(&self.x, x), self.frame_px[1] * (1.0 - part(&self.y, y)))
    }

    /// Markers at places within the frame.
    pub fn points(&mut self, marker: Marker, places: impl IntoIterator<Item = (f64, f64)>) {
        for (x, y) in places {
            let inside = |axis: &Axis, v: f64| (axis.range[0]..=axis.range[1]).contains(&v);
            if inside(&self.x, x) && inside(&self.y, y) {
                let (x, y) = self.px(x, y);
                self.marks.push(marker.at(x, y));
            }
        }
    }

    /// Marks that a reader may hide together, under a fixed name, never a user's text: it is an attribute.
    pub fn layer(&mut self, name: &str, marks: impl IntoIterator<Item = Primitive>) {
        self.marks.push(Primitive::GroupStart {
            transform: None,
            title: None,
            extra_attrs: Some(format!("data-layer=\"{name}\"")),
        });
        self.marks.extend(marks);
        self.marks.push(Primitive::GroupEnd);
    }

    /// A curve through places within the frame, as one layer.
    pub fn curve_layer(
        &mut self,
        name: &str,
        ink: Ink,
        places: impl IntoIterator<Item = (f64, f64)>,
    ) {
        let curve = self.trace(ink, places);
        self.layer(name, [curve]);
    }

    /// A filled area without an edge.
    pub fn area(
        &mut self,
        colour: &'static str,
        opacity: f64,
        outline: impl IntoIterator<Item = (f64, f64)>,
    ) {
        let corners = outline.into_iter().map(|(x, y)| self.px(x, y));
        let corners: Vec<String> = corners.map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.marks.push(Primitive::Path(Box::new(PathData {
            d: format!("M{} Z", corners.join(" L")),
            fill: Some(colour.into()),
            stroke: Color::from(colour),
            stroke_width: 0.0,
            opacity: Some(opacity),
            stroke_dasharray: None,
        })));
    }

    /// A curve through places within the frame.
    pub fn trace(&self, ink: Ink, places: impl IntoIterator<Item = (f64, f64)>) -> Primitive {
        Primitive::PolyLine {
            points: places.into_iter().map(|(x, y)| self.px(x, y)).collect(),
            stroke: ink.colour.into(),
            stroke_width: ink.width_px,
            stroke_dasharray: (!ink.dash.is_empty()).then(|| ink.dash.to_owned()),
        }
    }

    /// Room that ticks, names and headings need.
    pub fn room(&self) -> Room {
        let rows = self.names.iter().map(|name| name.row + 1).max().unwrap_or(1);
        let label = if self.x.label.is_empty() { 4.0 } else { line_px(LABEL_PX) + 4.0 };
        let headings: f64 = self.headings.iter().map(|_| line_px(HEADING_PX)).sum();
        let corners = if self.corners.is_some() { line_px(TICK_PX) } else { 0.0 };
        Room {
            left: if self.y_written { 70.0 } else { 8.0 },
            top: headings + corners + 8.0,
            right: 10.0,
            bottom: 10.0 + rows as f64 * line_px(TICK_PX) + label,
        }
    }

    /// Everything, with the frame's top left at a place of the page. The picture is left to the page, at a group of the
    /// same name.
    pub fn draw(self, at: (f64, f64), clip_id: &str, defs: &mut Vec<String>) -> Vec<Primitive> {
        let room = self.room();
        if self.bare {
            let marks = self.marks.into_iter().chain([Primitive::GroupEnd]);
            return [shift(at.0, at.1)].into_iter().chain(marks).collect();
        }
        let mut drawn = vec![shift(at.0 - room.left, at.1 - room.top)];
        let scene = render_multiple(self.plots(), self.layout(room));
        for def in scene.defs {
            defs.push(renamed(&def, clip_id));
        }
        drawn.extend(scene.elements.into_iter().map(|element| match element {
            Primitive::ClipStart { x, y, width, height, .. } => {
                Primitive::ClipStart { x, y, width, height, id: clip_id.to_owned() }
            }
            other => other,
        }));
        drawn.push(Primitive::GroupEnd);
        drawn.push(shift(at.0, at.1));
        self.write_around(&mut drawn, room);
        if self.picture.is_some() {
            let attribute = format!("{PICTURE_SLOT}\"{clip_id}\"");
            let extra_attrs = Some(attribute);
            drawn.push(Primitive::GroupStart { transform: None, title: None, extra_attrs });
            drawn.push(Primitive::GroupEnd);
        }
        drawn.extend(self.marks);
        drawn.push(Primitive::GroupEnd);
        drawn
    }

    fn plots(&self) -> Vec<Plot> {
        let plot = |(ink, places): &(Ink, Vec<(f64, f64)>)| {
            Plot::Line(
                LinePlot::new()
                    .with_data(places.iter().copied())
                    .with_color(ink.colour)
                    .with_stroke_width(ink.width_px)
                    .with_line_style(ink.line_style()),
            )
        };
        // Without any plot kuva draws no axes.
        let nothing = (Ink::new(BLACK, "", 0.0), Vec::new());
        self.curves.iter().chain([&nothing]).map(plot).collect()
    }

    fn layout(&self, room: Room) -> Layout {
        let pair = |range: [f64; 2]| (range[0], range[1]);
        let mut layout = Layout::new(pair(self.x.range), pair(self.y.range))
            .with_width(self.frame_px[0] + room.left + room.right)
            .with_height(self.frame_px[1] + room.top + room.bottom)
            .with_force_margins(room.left, room.right)
            .with_force_margins_y(room.top, room.bottom)
            .with_x_axis_min(self.x.range[0])
            .with_x_axis_max(self.x.range[1])
            .with_y_axis_min(self.y.range[0])
            .with_y_axis_max(self.y.range[1])
            .with_x_tick_step(self.x.step)
            .with_y_tick_step(self.y.step)
            .with_x_tick_format(self.x.format())
            .with_y_tick_format(self.y.format())
            .with_tick_size(TICK_PX)
            .with_theme(Theme { grid_color: PALE.to_owned(), ..Theme::light() });
        if self.boxed {
            layout = layout.with_box_axes();
        }
        if self.x.ticks == Ticks::None {
            layout = layout.with_x_categories(Vec::new());
        }
        // Ticks to the sides stand where their labels have room.
        layout.suppress_x_ticks = matches!(self.x.ticks, Ticks::Sides | Ticks::Blank);
        layout.suppress_y_ticks = !self.y_written || self.y.ticks == Ticks::Blank;
        layout
    }

    /// Headings, axis labels and names.
    fn write_around(&self, drawn: &mut Vec<Primitive>, room: Room) {
        let [width, height] = self.frame_px;
        let mut y = -room.top + line_px(HEADING_PX) - 4.0;
        for heading in &self.headings {
            let at = (0.0, y);
            drawn.push(match heading.kind {
                HeadingKind::Title => bold(at, &heading.text, HEADING_PX, TextAnchor::Start, BLACK),
                HeadingKind::Plain => text(at, &heading.text, TICK_PX, TextAnchor::Start),
                HeadingKind::Alarm => {
                    bold(at, &heading.text, TICK_PX, TextAnchor::Start, VERMILLION)
                }
            });
            y += line_px(HEADING_PX);
        }
        if let Some([left, right]) = self.corners {
            drawn.push(bold((0.0, -5.0), left, TICK_PX, TextAnchor::Start, GREY));
            drawn.push(bold((width, -5.0), right, TICK_PX, TextAnchor::End, GREY));
        }
        for name in &self.names {
            let at =
                (self.px(name.x, 0.0).0, height + (name.row + 1) as f64 * line_px(TICK_PX) + 4.0);
            drawn.push(if name.bold {
                bold(at, &name.text, TICK_PX, TextAnchor::Middle, BLACK)
            } else {
                text(at, &name.text, TICK_PX, TextAnchor::Middle)
            });
        }
        if self.x.ticks == Ticks::Sides {
            for (x, label) in self.x.side_ticks(width) {
                let at = self.px(x, 0.0).0;
                drawn.push(TICK.stroke((at, height), (at, height + TICK_MARK_PX)));
                let below = (at, height + line_px(TICK_PX));
                drawn.push(text(below, &label, TICK_PX, TextAnchor::Middle));
            }
        }
        let below = (0.5 * width, height + room.bottom - 6.0);
        drawn.push(text(below, &self.x.label, LABEL_PX, TextAnchor::Middle));
        if self.y_written {
            let mut label = text(
                (-room.left + 14.0, 0.5 * height),
                &self.y.label,
                LABEL_PX,
                TextAnchor::Middle,
            );
            if let Primitive::Text { rotate, .. } = &mut label {
                *rotate = Some(-90.0);
            }
            drawn.push(label);
        }
    }
}

fn shift(x: f64, y: f64) -> Primitive {
    Primitive::GroupStart {
        transform: Some(format!("translate({x:.2},{y:.2})")),
        title: None,
        extra_attrs: None,
    }
}

/// kuva numbers its clip paths through the whole program; a name from the figure itself makes equal bytes.
fn renamed(def: &str, id: &str) -> String {
    let mut parts = def.splitn(3, '"');
    match (parts.next(), parts.next(), parts.next()) {
        (Some(head), Some(_), Some(tail)) => format!("{head}\"{id}\"{tail}"),
        _ => def.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_frame_has_a_label_on_both_sides_and_no_tick_without_one() {
        let labels = |range, step, frame_px| -> Vec<String> {
            let axis = Axis::sides("lateral (mm)", range, step, frame_px);
            axis.side_ticks(frame_px).into_iter().map(|(_, label)| label).collect()
        };
        // Labels at 50 mm would reach beyond the frame.
        assert_eq!(labels([-55.0, 55.0], 50.0, 114.0), ["40 L", "0", "40 R"]);
        assert_eq!(labels([-20.0, 90.0], 50.0, 114.0), ["0", "40 R", "80 R"]);
        // The step stays where its labels have room; the ends have no tick.
        assert_eq!(labels([-100.0, 100.0], 50.0, 400.0), ["50 L", "0", "50 R"]);
    }
}
