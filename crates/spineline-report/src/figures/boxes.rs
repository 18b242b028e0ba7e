//! Box charts.

use kuva::render::render::{Primitive, TextAnchor};
use spineline::evaluate::statistics::{BoxSummary, Summary, box_summary};
use spineline::number::fixed;

use super::page::Page;
use super::panel::{Axis, Panel};
use super::style::{
    BLACK, Ink, Marker, Shape, TICK_PX, VERMILLION, WHITE, outlined, text, text_width_px, wrapped,
};
use crate::paper::PaperMean;

/// The rule of all box charts, by [`box_summary`].
pub const RULE: &str = "Boxes: quartiles and median; whiskers: last values within 1.5 IQR of the box; \
     circles: values beyond; diamonds: means. An arrow counts the values above the axis and names the largest.";

/// The paper's mean, with its standard deviation to both sides.
const PAPER: (Ink, Marker) = (
    Ink::new(VERMILLION, "", 2.2),
    Marker { radius_px: 3.6, ..Marker::new(Shape::Square, VERMILLION, true) },
);

/// The axis ends at this number of times the longest whisker, where circles lie further away.
const LONGEST: f64 = 1.5;

/// One box.
#[derive(Debug, Clone)]
pub struct Column {
    /// Boxes of one group stand together, in the order of their first appearance.
    pub group: String,
    /// Name below the box; may be empty.
    pub name: String,
    pub values: Vec<f64>,
    pub fill: &'static str,
    /// The paper's mean of the same quantity.
    pub paper: Option<PaperMean>,
}

/// Adds the paper's means to the legend.
pub fn paper_entry(page: &mut Page) {
    page.entry(PAPER, "the paper: mean ± standard deviation");
}

/// The finite values of a column, and their box.
struct Boxed<'a> {
    column: &'a Column,
    values: Vec<f64>,
    summary: Option<BoxSummary>,
}

impl<'a> Boxed<'a> {
    fn new(column: &'a Column) -> Self {
        let values: Vec<f64> =
            column.values.iter().copied().filter(|value| value.is_finite()).collect();
        Self { column, summary: box_summary(&values), values }
    }
}

/// The largest value that an axis shows. A few values far away do not flatten the boxes.
fn axis_end(boxes: &[Boxed<'_>]) -> f64 {
    let most = |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, f64::max);
    let largest = most(&mut boxes.iter().flat_map(|one| one.values.iter().copied()));
    let whiskers = boxes.iter().filter_map(|one| Some(one.summary.as_ref()?.whiskers[1]));
    let papers = boxes.iter().filter_map(|one| one.column.paper.map(|paper| paper.mean + paper.sd));
    let needed = most(&mut whiskers.chain(papers));
    if largest > 2.0 * LONGEST * needed && needed > 0.0 {
        LONGEST * needed
    } else {
        largest.max(needed)
    }
}

/// A panel of boxes from zero upwards; only finite values are drawn, and `n` counts them.
pub fn box_panel(columns: &[Column], y_label: &str, frame_px: [f64; 2]) -> Panel {
    let mut groups: Vec<&str> = Vec::new();
    for column in columns {
        if !groups.contains(&column.group.as_str()) {
            groups.push(&column.group);
        }
    }
    // Half a box of space between groups.
    let total = columns.len() as f64 + 0.5 * (groups.len() as f64 + 1.0);
    let boxes: Vec<Boxed<'_>> = columns.iter().map(Boxed::new).collect();
    let most = axis_end(&boxes);
    let (x, y) = (Axis::places("", total), Axis::from_zero(y_label, most));
    let mut panel = Panel::new(x, y, frame_px);
    let column_px = frame_px[0] / total;
    // Where names would overlap, only the legend names the boxes, in the same order.
    let wide = |words: &str| words.split(' ').any(|w| text_width_px(w, TICK_PX) > column_px);
    let narrow = columns.iter().any(|column| wide(&column.name));
    let lines = |column: &Column| match narrow {
        true => Vec::new(),
        false => wrapped(&column.name, TICK_PX, column_px),
    };
    let rows = columns.iter().map(|column| lines(column).len()).max().unwrap_or(0);
    if narrow {
        panel.x.label =
            "below each box: number of values; from left to right as in the legend".into();
    }
    let mut at = 0.0;
    for group in groups {
        at += 0.5;
        let start = at;
        for one in boxes.iter().filter(|one| one.column.group == group) {
            add_column(&mut panel, at + 0.5, one);
            let n = one.values.len();
            let count = if narrow { n.to_string() } else { format!("n = {n}") };
            panel.name_below(at + 0.5, 0, lines(one.column), false);
            panel.name_below(at + 0.5, rows, vec![count], false);
            at += 1.0;
        }
        let words = wrapped(group, TICK_PX + 1, (at - start + 0.4) * column_px);
        panel.name_below(0.5 * (start + at), rows + 1, words, true);
    }
    panel
}

fn add_column(panel: &mut Panel, x: f64, Boxed { column, values, summary }: &Boxed<'_>) {
    if let Some(summary) = summary {
        let marks = draw_box(panel, x, summary, Summary::of(values).mean, column.fill);
        panel.marks.extend(marks);
        let above = count_above(panel, x, values);
        panel.marks.extend(above);
    }
    if let Some(PaperMean { mean, sd, .. }) = column.paper {
        let at = |value: f64| panel.px(x + 0.42, value);
        let (low, high) = (at((mean - sd).max(0.0)), at(mean + sd));
        let place = at(mean);
        panel.marks.extend([PAPER.0.stroke(low, high), PAPER.1.at(place.0, place.1)]);
    }
}

/// An arrow with the number of values above the axis and the largest of them.
fn count_above(panel: &Panel, x: f64, values: &[f64]) -> Vec<Primitive> {
    let end = panel.y.range[1];
    let above: Vec<f64> = values.iter().copied().filter(|&value| value > end).collect();
    if above.is_empty() {
        return Vec::new();
    }
    let largest = above.iter().copied().fold(0.0, f64::max);
    let places = if largest < 10.0 { 2 } else { 0 };
    let words = format!("{} to {}", above.len(), fixed(largest, places));
    let (x_px, y_px) = panel.px(x, end);
    let arrow = Marker { radius_px: 4.0, ..Marker::new(Shape::Triangle, BLACK, true) };
    vec![arrow.at(x_px, y_px + 7.0), text((x_px, y_px + 24.0), &words, TICK_PX, TextAnchor::Middle)]
}

fn draw_box(panel: &Panel, x: f64, summary: &BoxSummary, mean: f64, fill: &str) -> Vec<Primitive> {
    let thin = Ink::new(BLACK, "", 1.1);
    let half_px = (0.36 * panel.px(1.0, 0.0).0).min(34.0);
    let at = |value: f64| panel.px(x, value);
    let [low, median, high] = summary.quartiles.map(at);
    let mut marks = Vec::new();
    for (whisker, quartile) in summary.whiskers.map(at).into_iter().zip([low, high]) {
        marks.push(thin.stroke(whisker, quartile));
        let cap = 0.5 * half_px;
        marks.push(thin.stroke((whisker.0 - cap, whisker.1), (whisker.0 + cap, whisker.1)));
    }
    marks.push(outlined(low.0 - half_px, high.1, 2.0 * half_px, low.1 - high.1, fill));
    // White around the median and the mean keeps them visible on dark boxes.
    for ink in [Ink::new(WHITE, "", 4.5), Ink::new(BLACK, "", 2.2)] {
        marks.push(ink.stroke((median.0 - half_px, median.1), (median.0 + half_px, median.1)));
    }
    let circle = Marker { radius_px: 2.6, ..Marker::new(Shape::Circle, BLACK, false) };
    let shown = summary.outliers.iter().filter(|&&value| value <= panel.y.range[1]);
    marks.extend(shown.map(|&value| circle.at(at(value).0, at(value).1)));
    let diamond = Marker { radius_px: 3.6, ..Marker::new(Shape::Diamond, BLACK, false) };
    if mean <= panel.y.range[1] {
        marks.push(diamond.at(at(mean).0, at(mean).1));
    }
    marks
}
