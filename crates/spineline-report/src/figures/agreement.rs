//! The agreement of the readings of two observers, or of two repeats of one.

use kuva::render::render::Primitive;
use spineline::reliability::{BlandAltman, DesignReliability, QuantityReliability, shown_measure};
use spineline::warning::counted;

use super::page::{Page, Sample};
use super::panel::{Axis, HeadingKind, Panel};
use super::style::{BLACK, BLUE, GREY, Ink, Marker, SKY, Shape, VERMILLION, YELLOW};
use crate::phrases::sentence_case;

const BIAS: Ink = Ink::new(BLUE, "", 1.8);
const LIMIT: Ink = Ink::new(VERMILLION, "8 4", 1.6);
const ZERO: Ink = Ink::new(GREY, "2 3", 1.2);
const BANDS_OPACITY: f64 = 0.35;
const PANELS_PER_ROW: usize = 2;

/// Bland and Altman's plot of every pair of observers or repeats of one design: differences over means, with bias and limits of
/// agreement as lines and their 95 % intervals as bands. `None` where no pair could be compared.
#[must_use]
pub fn bland_altman(
    quantity: &QuantityReliability,
    design: &DesignReliability,
    synthetic: bool,
) -> Option<String> {
    let pairs: Vec<&BlandAltman> =
        design.bland_altman.iter().filter(|pair| !pair.points.is_empty()).collect();
    if pairs.is_empty() {
        return None;
    }
    let title = format!("Agreement of readings: {}, {}", quantity.words(), design.design);
    let mut page = Page::new(title, synthetic);
    page.notes.push(format!("{}.", sentence_case(&quantity.meaning)));
    page.notes.push(format!(
        "{}. Bands: 95 % intervals of bias and limits, as if subjects were independent.",
        counted(design.subjects, "subject")
    ));
    page.notes
        .extend(design.remarks.iter().map(|one| format!("{}.", sentence_case(&one.to_string()))));
    let point = Marker { radius_px: 2.6, ..Marker::new(Shape::Circle, BLACK, false) };
    page.entry(point, "subject");
    page.entry(BIAS, "bias");
    page.entry(Sample::Fill(SKY), "its interval");
    page.entry(LIMIT, "limits of agreement, bias ± 1.96 sd");
    page.entry(Sample::Fill(YELLOW), "their intervals");
    page.entry(ZERO, "no difference");
    let columns = PANELS_PER_ROW.min(pairs.len());
    let width_px = page.inner_px() / columns as f64 - 84.0;
    let panels: Vec<Panel> =
        pairs.iter().map(|pair| panel(pair, &quantity.unit, width_px, point)).collect();
    page.rows = panels.chunks(columns).map(<[Panel]>::to_vec).collect();
    Some(page.into_svg())
}

fn panel(pair: &BlandAltman, unit: &str, width_px: f64, point: Marker) -> Panel {
    let [first, second] = &pair.raters;
    let bounds = pair.limit_intervals.into_iter().flatten().flatten();
    let drawn = bounds.chain(pair.limits).chain([0.0]);
    let y = pair.points.iter().map(|point| point[1]).chain(drawn);
    let x = pair.points.iter().map(|point| point[0]);
    let x = axis(format!("mean of both in {unit}"), x);
    let y = axis(format!("difference in {unit}"), y);
    let mut panel = Panel::new(x, y, [width_px, 300.0]);
    let [lower, upper] = pair.limits.map(shown_measure);
    panel.heading(HeadingKind::Title, format!("{second} minus {first}"));
    let bias = shown_measure(pair.bias);
    let bias = format!("bias {bias} {unit}, limits {lower} to {upper} {unit}");
    panel.heading(HeadingKind::Plain, bias);
    let bands = pair.limit_intervals.into_iter().flatten().map(|band| (band, YELLOW));
    for (band, fill) in bands.chain(pair.bias_interval.map(|band| (band, SKY))) {
        let filling = fill_between(&panel, band, fill);
        panel.marks.push(filling);
    }
    let lines = pair.limits.map(|limit| (LIMIT, limit));
    for (ink, value) in lines.into_iter().chain([(ZERO, 0.0), (BIAS, pair.bias)]) {
        let [left, right] = panel.x.range.map(|x| panel.px(x, value));
        panel.marks.push(ink.stroke(left, right));
    }
    panel.points(point, pair.points.iter().map(|point| (point[0], point[1])));
    panel
}

/// A band over the whole width of a panel.
fn fill_between(panel: &Panel, [low, high]: [f64; 2], fill: &str) -> Primitive {
    let (bottom, top) = (panel.px(0.0, low).1, panel.px(0.0, high).1);
    Primitive::Rect {
        x: 0.0,
        y: top,
        width: panel.frame_px[0],
        height: (bottom - top).max(0.5),
        fill: fill.into(),
        stroke: None,
        stroke_width: None,
        opacity: Some(BANDS_OPACITY),
    }
}

/// An axis around all values.
fn axis(label: String, values: impl Iterator<Item = f64>) -> Axis {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    // Equal values get room on both sides that double precision can tell apart.
    let spare = 0.04 * (high - low).max(1e-6 * low.abs().max(high.abs())).max(1e-9);
    Axis::around(label, low - spare, high + spare, 6.0)
}
