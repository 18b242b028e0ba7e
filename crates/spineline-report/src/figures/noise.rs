//! Claims over landmark noise.

use super::page::Page;
use super::panel::{Axis, HeadingKind, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Ink, Marker, ORANGE, PURPLE, SKY, Shape, VERMILLION};

/// The loading scenario of the patients of a curve.
#[derive(Debug, Clone)]
pub struct NoiseScenario {
    /// Its name.
    pub name: String,
    /// What it means, in a few words.
    pub meaning: String,
}

/// The curves of all loading scenarios, for one rule.
#[derive(Debug, Clone)]
pub struct NoisePanel {
    /// The rule.
    pub name: String,
    /// One curve per loading scenario: noise in mm; value, lower and upper end of its interval, in percent; the ends are NaN without an
    /// interval.
    pub curves: Vec<Vec<(f64, [f64; 3])>>,
}

/// One claim, for all rules.
#[derive(Debug, Clone)]
pub struct NoiseRow {
    /// The claim.
    pub heading: String,
    /// What is drawn upwards.
    pub y_label: String,
    /// The claim holds above it.
    pub limit_percent: f64,
    /// One panel per rule.
    pub panels: Vec<NoisePanel>,
}

/// Colour, dash and marker in the order of the scenarios: each of the three identifies a scenario.
const STYLES: [(&str, &str, Shape, bool, f64); 7] = [
    (BLACK, "", Shape::Circle, true, 2.2),
    (BLUE, "8 3", Shape::Square, true, 1.5),
    (SKY, "2 2", Shape::Triangle, true, 1.5),
    (GREEN, "8 3 2 3", Shape::Diamond, true, 1.5),
    (ORANGE, "", Shape::TriangleDown, false, 1.5),
    (VERMILLION, "5 3", Shape::Square, false, 1.5),
    (PURPLE, "1 3", Shape::Circle, false, 1.5),
];

const WIDTH_PX: f64 = 1080.0;
/// Shift between curves, so that their intervals do not overlap.
const BESIDE_MM: f64 = 0.012;

fn style(scenario: usize) -> (Ink, Marker) {
    let (colour, dash, shape, filled, width_px) = STYLES[scenario % STYLES.len()];
    let marker = Marker { radius_px: 2.9, ..Marker::new(shape, colour, filled) };
    (Ink::new(colour, dash, width_px), marker)
}

/// Three claims over landmark noise: rows are claims, columns rules of the curves' order, curves loading scenarios.
///
/// `about` says how many patients, and from which seed.
#[must_use]
pub fn noise_study(
    scenarios: &[NoiseScenario],
    rows: &[NoiseRow],
    about: &str,
    synthetic: bool,
) -> String {
    let mut page = Page::new("When do the paper's claims hold?", synthetic);
    page.width_px = WIDTH_PX;
    page.notes.push(format!(
        "Over landmark noise: standard deviation of a corner's coordinate in one reading. {about}. Bars: 95 % intervals over \
         patients. Grey line: the claim holds above it."
    ));
    page.notes.push(
        "Columns: rule for the order of the curves. A claim supports a force through the inflections only where the black \
         curve lies above the others."
            .to_owned(),
    );
    for (i, scenario) in scenarios.iter().enumerate() {
        page.entry(style(i), format!("{}: {}", scenario.name, scenario.meaning));
    }
    let last = rows.len().saturating_sub(1);
    page.rows = rows.iter().enumerate().map(|(i, row)| draw_row(row, &page, i == last)).collect();
    page.into_svg()
}

fn draw_row(row: &NoiseRow, page: &Page, last: bool) -> Vec<Panel> {
    // The first panel has the scale on its left.
    let n = row.panels.len() as f64;
    let width_px = (page.inner_px() - 62.0) / n - 18.0;
    let lowest = row.panels.iter().flat_map(|p| &p.curves).flatten();
    let lowest = lowest.map(|(_, [value, ..])| *value).filter(|v| v.is_finite());
    let from = if lowest.fold(0.0, f64::min) < -5.0 { -50.0 } else { 0.0 };
    let panels = row.panels.iter().enumerate().map(|(i, panel)| {
        let x = Axis::numbers(if last { "noise (mm)" } else { "" }, [-0.05, 1.05], 0.2);
        let y = Axis::numbers(row.y_label.as_str(), [from, 100.0], 25.0);
        let mut drawn = Panel::new(x, y, [width_px, 150.0]);
        drawn.y_written = i == 0;
        drawn.boxed = true;
        // All panels of a row need the same room above.
        drawn.heading(HeadingKind::Title, if i == 0 { &row.heading[..] } else { " " });
        drawn.heading(HeadingKind::Plain, panel.name.clone());
        draw_curves(&mut drawn, panel, row.limit_percent);
        drawn
    });
    panels.collect()
}

fn draw_curves(drawn: &mut Panel, panel: &NoisePanel, limit_percent: f64) {
    let across = drawn.x.range.map(|x| (x, limit_percent)).to_vec();
    drawn.curves.push((Ink::new(GREY, "", 2.6), across));
    let middle = 0.5 * (panel.curves.len() as f64 - 1.0);
    // The first scenario is drawn last, on top.
    for (scenario, curve) in panel.curves.iter().enumerate().rev() {
        let (ink, marker) = style(scenario);
        let beside = BESIDE_MM * (scenario as f64 - middle);
        let [least, most] = drawn.y.range;
        let inside = |v: f64| v.clamp(least, most);
        let mut places = Vec::new();
        for (noise_mm, [value, low, high]) in curve {
            let x = noise_mm + beside;
            if low.is_finite() && high.is_finite() && *high > least {
                let bar = Ink::new(ink.colour, "", 0.9);
                drawn.marks.push(bar.stroke(drawn.px(x, inside(*low)), drawn.px(x, inside(*high))));
            }
            if value.is_finite() {
                places.push((x, *value));
            }
        }
        drawn.curves.push((ink, places.clone()));
        drawn.points(marker, places);
    }
}
