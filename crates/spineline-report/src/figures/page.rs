//! Title, notes, legend and rows of panels, laid out below one another.

use kuva::backend::svg::SvgBackend;
use kuva::render::render::{Primitive, Scene, TextAnchor};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::panel::{PICTURE_SLOT, Panel, Picture};
use super::style::{
    BLACK, Ink, Marker, NOTE_PX, PAGE_WIDTH_PX, TITLE_PX, VERMILLION, bold, line_px, outlined,
    text, text_width_px, wrapped,
};

const EDGE_PX: f64 = 16.0;
const FONTS: &str = "DejaVu Sans, Verdana, Liberation Sans, Arial, sans-serif";

/// Symbol of a legend entry.
#[derive(Debug, Clone, Copy)]
pub enum Sample {
    /// A stroke, with or without a marker on it.
    Stroke(Ink, Option<Marker>),
    /// A marker alone.
    Marker(Marker),
    /// A filling.
    Fill(&'static str),
}

impl From<Ink> for Sample {
    fn from(ink: Ink) -> Self {
        Self::Stroke(ink, None)
    }
}

impl From<(Ink, Marker)> for Sample {
    fn from((ink, marker): (Ink, Marker)) -> Self {
        Self::Stroke(ink, Some(marker))
    }
}

impl From<Marker> for Sample {
    fn from(marker: Marker) -> Self {
        Self::Marker(marker)
    }
}

/// A figure before it is drawn.
#[derive(Debug, Clone)]
pub struct Page {
    pub title: String,
    pub synthetic: bool,
    pub notes: Vec<String>,
    legend: Vec<(Sample, String)>,
    /// Panels from left to right, rows from top to bottom.
    pub rows: Vec<Vec<Panel>>,
    pub width_px: f64,
}

impl Page {
    pub fn new(title: impl Into<String>, synthetic: bool) -> Self {
        Self {
            title: title.into(),
            synthetic,
            notes: Vec::new(),
            legend: Vec::new(),
            rows: Vec::new(),
            width_px: PAGE_WIDTH_PX,
        }
    }

    /// Adds an entry to the legend.
    pub fn entry(&mut self, sample: impl Into<Sample>, words: impl Into<String>) {
        self.legend.push((sample.into(), words.into()));
    }

    /// Width that panels of one row may share.
    pub fn inner_px(&self) -> f64 {
        self.width_px - 2.0 * EDGE_PX
    }

    /// The SVG text.
    pub fn into_svg(self) -> String {
        let mut elements = Vec::new();
        let mut defs = Vec::new();
        let mut pictures = Vec::new();
        let mut y = 12.0;
        self.write_title(&mut elements, &mut y);
        self.write_legend(&mut elements, &mut y);
        let (name, title, width) = (self.identifier(), self.title, self.width_px);
        for (i, row) in self.rows.into_iter().enumerate() {
            let rooms: Vec<_> = row.iter().map(Panel::room).collect();
            let top = rooms.iter().map(|room| room.top).fold(0.0, f64::max);
            let below = row.iter().zip(&rooms).map(|(p, room)| p.frame_px[1] + room.bottom);
            let height = top + below.fold(0.0, f64::max);
            let mut x = EDGE_PX;
            for (j, (panel, room)) in row.into_iter().zip(rooms).enumerate() {
                let frame_px = panel.frame_px[0];
                let id = format!("{name}-{i}{j}");
                let picture = panel.picture.as_ref().map(|picture| drawn(picture, panel.frame_px));
                pictures.extend(picture.map(|picture| (id.clone(), picture)));
                elements.extend(panel.draw((x + room.left, y + top), &id, &mut defs));
                x += room.left + frame_px + room.right;
            }
            y += height + 10.0;
        }
        let mut scene = Scene::new(width, y.ceil());
        scene.font_family = Some(FONTS.to_owned());
        scene.elements = elements;
        scene.defs = defs;
        let svg = with_view_box(&SvgBackend::new().render_scene(&scene), &title, width, y.ceil());
        pictures.iter().fold(svg, |svg, (id, picture)| {
            let slot = format!("{PICTURE_SLOT}\"{id}\">");
            svg.replacen(&slot, &format!("{slot}{picture}"), 1)
        })
    }

    fn write_title(&self, elements: &mut Vec<Primitive>, y: &mut f64) {
        let at = |y: f64| (EDGE_PX, y);
        for line in wrapped(&self.title, TITLE_PX, 0.94 * self.inner_px()) {
            *y += line_px(TITLE_PX);
            elements.push(bold(at(*y - 6.0), &line, TITLE_PX, TextAnchor::Start, BLACK));
        }
        if self.synthetic {
            *y += line_px(NOTE_PX);
            let words = "synthetic data: generated, not measured on a patient";
            elements.push(bold(at(*y - 3.0), words, NOTE_PX, TextAnchor::Start, VERMILLION));
        }
        for line in self.notes.iter().flat_map(|note| wrapped(note, NOTE_PX, self.inner_px())) {
            *y += line_px(NOTE_PX);
            elements.push(text(at(*y - 3.0), &line, NOTE_PX, TextAnchor::Start));
        }
        *y += 6.0;
    }

    fn write_legend(&self, elements: &mut Vec<Primitive>, y: &mut f64) {
        const SAMPLE_PX: f64 = 34.0;
        let row_px = line_px(NOTE_PX) + 3.0;
        let mut x = EDGE_PX;
        if !self.legend.is_empty() {
            *y += row_px;
        }
        for (sample, label) in &self.legend {
            let width = SAMPLE_PX + 7.0 + text_width_px(label, NOTE_PX) + 16.0;
            if x > EDGE_PX && x + width > self.width_px - EDGE_PX + 16.0 {
                x = EDGE_PX;
                *y += row_px;
            }
            let middle = (x + 0.5 * SAMPLE_PX, *y - 9.0);
            match sample {
                Sample::Stroke(ink, marker) => {
                    elements.push(ink.stroke((x, middle.1), (x + SAMPLE_PX, middle.1)));
                    elements.extend(marker.map(|marker| marker.at(middle.0, middle.1)));
                }
                Sample::Marker(marker) => elements.push(marker.at(middle.0, middle.1)),
                Sample::Fill(fill) => {
                    elements.push(outlined(x + 8.0, middle.1 - 6.0, 20.0, 12.0, fill));
                }
            }
            let at = (x + SAMPLE_PX + 7.0, *y - 4.5);
            elements.push(text(at, label, NOTE_PX, TextAnchor::Start));
            x += width;
        }
        *y += 8.0;
    }

    /// A name for element ids: the FNV-1a hash of all words, the same on every machine.
    fn identifier(&self) -> String {
        let words = self.notes.iter().chain([&self.title]).flat_map(|text| text.bytes());
        let hash = words.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
        format!("spineline-{hash:016x}")
    }
}

/// A picture cut off at the edges of its frame, paler than it is, so that landmarks stand out; kuva draws no pictures.
fn drawn(picture: &Picture, [width, height]: [f64; 2]) -> String {
    let [(x, y), (to_x, to_y)] = picture.corners_px;
    // A picture whose columns run to the left is mirrored about its first one.
    let mirrored = if to_x < x {
        format!(" transform=\"translate({:.2},0) scale(-1,1)\"", 2.0 * x)
    } else {
        String::new()
    };
    let data = STANDARD.encode(&picture.png);
    format!(
        "<svg x=\"0\" y=\"0\" width=\"{width:.2}\" height=\"{height:.2}\" viewBox=\"0 0 {width:.2} {height:.2}\"><image{mirrored} x=\"{x:.2}\" y=\"{y:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" opacity=\"0.6\" href=\"data:image/png;base64,{data}\"/></svg>",
        (to_x - x).abs(),
        to_y - y,
    )
}

/// Lets the picture scale with its place, and gives it a name that is read aloud.
fn with_view_box(svg: &str, title: &str, width: f64, height: f64) -> String {
    let (head, tail) = svg.split_once('>').expect("kuva opens an svg element");
    let title: String = title.chars().filter(|c| !c.is_control()).collect();
    let title = title.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    format!("{head} viewBox=\"0 0 {width} {height}\" role=\"img\"><title>{title}</title>{tail}")
}
