//! Colours, dashes, markers and letter sizes that all figures share.

use kuva::plot::LineStyle;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, TextAnchor};
use spineline::action::LineKind;
use spineline::anatomy::Posture;

/// Width of a page; all letter sizes are meant for it.
pub const PAGE_WIDTH_PX: f64 = 900.0;
/// Letter sizes.
pub const TITLE_PX: u32 = 19;
pub const HEADING_PX: u32 = 14;
pub const LABEL_PX: u32 = 14;
pub const NOTE_PX: u32 = 13;
pub const TICK_PX: u32 = 12;

/// Colours after Okabe and Ito, distinct for every kind of colour vision.
pub const BLACK: &str = "#1a1a1a";
pub const GREY: &str = "#6b6b6b";
pub const PALE: &str = "#e3e3e3";
pub const WHITE: &str = "#ffffff";
pub const BLUE: &str = "#0072b2";
pub const SKY: &str = "#56b4e9";
pub const GREEN: &str = "#009e73";
pub const ORANGE: &str = "#e69f00";
pub const YELLOW: &str = "#f0e442";
pub const VERMILLION: &str = "#d55e00";
pub const PURPLE: &str = "#cc79a7";

/// Fills of neighbouring boxes and bars: dark, middle and light in turn, distinct in grey too.
pub const FILLS: [&str; 6] = [BLUE, ORANGE, YELLOW, GREEN, PURPLE, SKY];

/// The form of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shape {
    Circle,
    Square,
    Triangle,
    Diamond,
    TriangleDown,
}

/// Markers in the order of a series.
pub const SHAPES: [Shape; 5] =
    [Shape::Triangle, Shape::Square, Shape::Diamond, Shape::TriangleDown, Shape::Circle];

/// A marker with or without a filling.
#[derive(Debug, Clone, Copy)]
pub struct Marker {
    pub shape: Shape,
    pub colour: &'static str,
    pub filled: bool,
    pub radius_px: f64,
}

/// A stroke.
#[derive(Debug, Clone, Copy)]
pub struct Ink {
    pub colour: &'static str,
    /// SVG dash array; empty for a solid line.
    pub dash: &'static str,
    pub width_px: f64,
}

impl Ink {
    pub const fn new(colour: &'static str, dash: &'static str, width_px: f64) -> Self {
        Self { colour, dash, width_px }
    }

    /// In kuva's form.
    pub fn line_style(&self) -> LineStyle {
        if self.dash.is_empty() {
            LineStyle::Solid
        } else {
            LineStyle::Custom(self.dash.to_owned())
        }
    }

    pub fn stroke(&self, from: (f64, f64), to: (f64, f64)) -> Primitive {
        Primitive::Line {
            x1: from.0,
            y1: from.1,
            x2: to.0,
            y2: to.1,
            stroke: self.colour.into(),
            stroke_width: self.width_px,
            stroke_dasharray: (!self.dash.is_empty()).then(|| self.dash.to_owned()),
        }
    }
}

/// How a moved posture is drawn.
pub const fn posture_style(posture: Posture) -> (Ink, Shape) {
    match posture {
        Posture::Erect => (Ink::new(BLACK, "", 1.8), Shape::Circle),
        Posture::LeftBending => (Ink::new(BLUE, "", 1.8), Shape::Circle),
        Posture::RightBending => (Ink::new(VERMILLION, "9 4", 1.8), Shape::Square),
        Posture::Neutral => (Ink::new(GREEN, "2 3", 2.0), Shape::Triangle),
        Posture::Traction => (Ink::new(PURPLE, "9 3 2 3", 2.0), Shape::Diamond),
    }
}

/// How a line of action is drawn.
pub const fn action_ink(kind: LineKind) -> Ink {
    match kind {
        LineKind::Inflection => Ink::new(BLUE, "8 4", 1.5),
        LineKind::Iliac => Ink::new(VERMILLION, "2 3", 1.9),
        LineKind::Estimated => Ink::new(GREEN, "9 3 2 3", 1.5),
        LineKind::Given => Ink::new(PURPLE, "16 5", 1.5),
    }
}

/// The filling of boxes that belong to a line of action: dark, light and middle, distinct in grey.
pub const fn action_fill(kind: LineKind) -> &'static str {
    match kind {
        LineKind::Inflection => BLUE,
        LineKind::Iliac => ORANGE,
        LineKind::Estimated => YELLOW,
        LineKind::Given => PURPLE,
    }
}

/// A piece of text; the bottom of its letters lies at `y`.
pub fn text(place: (f64, f64), content: &str, size: u32, anchor: TextAnchor) -> Primitive {
    let ((x, y), content, color) = (place, printable(content), Some(BLACK.into()));
    Primitive::Text { x, y, content, size, anchor, rotate: None, bold: false, color }
}

/// Bold text in a colour.
pub fn bold(
    place: (f64, f64),
    content: &str,
    size: u32,
    anchor: TextAnchor,
    colour: &str,
) -> Primitive {
    let ((x, y), content, color) = (place, printable(content), Some(colour.into()));
    Primitive::Text { x, y, content, size, anchor, rotate: None, bold: true, color }
}

/// XML forbids control characters, and kuva reads `$…$` as mathematics.
fn printable(content: &str) -> String {
    content.chars().map(|c| if c.is_control() || c == '$' { ' ' } else { c }).collect()
}

/// A rectangle with a dark outline.
pub fn outlined(x: f64, y: f64, width: f64, height: f64, fill: &str) -> Primitive {
    Primitive::Rect {
        x,
        y,
        width,
        height,
        fill: fill.into(),
        stroke: Some(BLACK.into()),
        stroke_width: Some(1.0),
        opacity: None,
    }
}

impl Marker {
    pub const fn new(shape: Shape, colour: &'static str, filled: bool) -> Self {
        Self { shape, colour, filled, radius_px: 4.0 }
    }

    /// The marker at a place.
    pub fn at(&self, x: f64, y: f64) -> Primitive {
        let fill = if self.filled { self.colour } else { WHITE };
        let r = self.radius_px;
        let corners: &[(f64, f64)] = match self.shape {
            Shape::Circle => {
                return Primitive::Circle {
                    cx: x,
                    cy: y,
                    r,
                    fill: fill.into(),
                    fill_opacity: None,
                    stroke: Some(self.colour.into()),
                    stroke_width: Some(1.3),
                };
            }
            Shape::Square => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
            Shape::Triangle => &[(0.0, -1.2), (1.1, 0.8), (-1.1, 0.8)],
            Shape::TriangleDown => &[(0.0, 1.2), (1.1, -0.8), (-1.1, -0.8)],
            Shape::Diamond => &[(0.0, -1.3), (1.1, 0.0), (0.0, 1.3), (-1.1, 0.0)],
        };
        let corners: Vec<String> =
            corners.iter().map(|(dx, dy)| format!("{:.2},{:.2}", x + r * dx, y + r * dy)).collect();
        Primitive::Path(Box::new(PathData {
            d: format!("M{} Z", corners.join(" L")),
            fill: Some(fill.into()),
            stroke: Color::from(self.colour),
            stroke_width: 1.3,
            opacity: None,
            stroke_dasharray: None,
        }))
    }
}

/// Width of text in DejaVu Sans, the widest of the possible fonts, rounded up.
pub fn text_width_px(content: &str, size: u32) -> f64 {
    let ems: f64 = content
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.34,
            'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '-' | '/' => 0.42,
            'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.95,
            '→' | '←' | '—' | '=' | '×' | '+' | '−' => 0.95,
            // Letters of East Asia are squares.
            '\u{1100}'..='\u{115f}' | '\u{2e80}'..='\u{a4cf}' | '\u{ac00}'..='\u{d7a3}' => 1.05,
            '\u{f900}'..='\u{faff}' | '\u{ff00}'..='\u{ff60}' | '\u{1f000}'..='\u{3ffff}' => 1.05,
            c if c.is_uppercase() => 0.72,
            _ => 0.64,
        })
        .sum();
    ems * f64::from(size)
}

/// Breaks text at spaces into lines of at most a given width, and within words where one is wider.
pub fn wrapped(content: &str, size: u32, width_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in content.split_whitespace().flat_map(|word| parted(word, size, width_px)) {
        let word = word.as_str();
        match lines.last_mut() {
            Some(line) if text_width_px(&format!("{line} {word}"), size) <= width_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A word in parts of at most a given width.
fn parted(word: &str, size: u32, width_px: f64) -> Vec<String> {
    let mut parts = vec![String::new()];
    for c in word.chars() {
        let last = parts.last_mut().expect("never empty");
        let longer = format!("{last}{c}");
        if !last.is_empty() && text_width_px(&longer, size) > width_px {
            parts.push(c.to_string());
        } else {
            *last = longer;
        }
    }
    parts
}

/// Height of a line of text.
pub fn line_px(size: u32) -> f64 {
    1.35 * f64::from(size)
}

/// A tick step of 1, 2 or 5 times a power of ten, for about this number of ticks.
pub fn nice_step(span: f64, ticks: f64) -> f64 {
    let raw = (span / ticks).max(f64::MIN_POSITIVE);
    let power = 10.0_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * power >= raw).unwrap_or(10.0);
    factor * power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_steps_are_round_numbers() {
        for (span, step) in [(0.16, 0.05), (940.0, 200.0), (7.0, 2.0), (5.0, 1.0)] {
            assert!((nice_step(span, 5.0) - step).abs() < 1e-12 * step, "{span}");
        }
    }

    #[test]
    fn text_breaks_at_spaces_and_within_overlong_words() {
        assert_eq!(wrapped("inflection line", 12, 80.0), ["inflection", "line"]);
        assert_eq!(wrapped("a 病例病例", 10, 25.0), ["a", "病例", "病例"]);
        assert_eq!(wrapped("inflection line", 12, 900.0), ["inflection line"]);
    }
}
