//! Counts over a cohort: Lenke types, and cases after every step.

use kuva::render::render::TextAnchor;

use super::arrows::arrow;
use super::page::Page;
use super::panel::{Axis, Panel};
use super::style::{
    BLACK, BLUE, Ink, LABEL_PX, NOTE_PX, SKY, bold, line_px, outlined, text, text_width_px, wrapped,
};

/// Patients per Lenke type, one bar each; `None` without patients.
#[must_use]
pub fn lenke_types(counts: &[(String, usize)], synthetic: bool) -> Option<String> {
    if counts.iter().all(|(_, count)| *count == 0) {
        return None;
    }
    let mut page = Page::new("Lenke types from frontal films", synthetic);
    page.notes.push("Kyphosis and modifiers are not visible on frontal films.".to_owned());
    page.width_px = 640.0;
    let most = counts.iter().map(|(_, count)| *count).max().unwrap_or(0);
    let total = counts.len().max(1) as f64;
    let x = Axis::places("Lenke type", total);
    let frame_px = [page.inner_px() - 84.0, 260.0];
    let mut y = Axis::from_zero("patients", most as f64);
    y.step = y.step.max(1.0).round();
    y.range[1] = y.step * (1.15 * most.max(1) as f64 / y.step).ceil();
    let mut panel = Panel::new(x, y, frame_px);
    for (i, (name, count)) in counts.iter().enumerate() {
        let middle = i as f64 + 0.5;
        let (left, top) = panel.px(i as f64 + 0.15, *count as f64);
        let (right, bottom) = panel.px(i as f64 + 0.85, 0.0);
        panel.marks.push(outlined(left, top, right - left, bottom - top, BLUE));
        let at = (0.5 * (left + right), top - 5.0);
        panel.marks.push(text(at, &count.to_string(), LABEL_PX, TextAnchor::Middle));
        let words = wrapped(name, NOTE_PX, frame_px[0] / total);
        panel.name_below(middle, 0, words, false);
    }
    page.rows.push(vec![panel]);
    Some(page.into_svg())
}

/// A step of the flow of cases.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FlowStep {
    /// Name of the remaining cases, such as `with a model`.
    pub name: String,
    /// Number of remaining cases.
    pub cases: usize,
    /// Excluded cases: reason and number.
    pub lost: Vec<(String, usize)>,
}

/// Number of cases after every step, with excluded cases and reasons.
#[must_use]
pub fn exclusions(steps: &[FlowStep], synthetic: bool) -> String {
    const BOX_PX: f64 = 300.0;
    const WIDE_PX: f64 = 430.0;
    /// From a box to its reasons.
    const ARROW_PX: f64 = 42.0;
    /// The narrowest page, at which a report does not enlarge its letters much.
    const NARROW_PX: f64 = 640.0;
    let mut page = Page::new("Flow of cases and exclusions", synthetic);
    let reasons: Vec<Vec<String>> = steps
        .iter()
        .map(|step| {
            let line = |(why, n): &(String, usize)| format!("{n} not: {why}");
            step.lost.iter().flat_map(|lost| wrapped(&line(lost), NOTE_PX, WIDE_PX)).collect()
        })
        .collect();
    let row_px: Vec<f64> = reasons
        .iter()
        .map(|lines| 84.0_f64.max(lines.len() as f64 * line_px(NOTE_PX) + 30.0))
        .collect();
    let height: f64 = row_px.iter().sum();
    let reasons_px = reasons.iter().flatten().map(|line| ARROW_PX + text_width_px(line, NOTE_PX));
    let wide_px = BOX_PX + reasons_px.fold(0.0, f64::max);
    page.width_px = NARROW_PX.max(wide_px + page.width_px - page.inner_px() + 20.0);
    let mut panel = Panel::bare([page.inner_px() - 20.0, height]);
    let ink = Ink::new(BLACK, "", 1.3);
    let mut y = 0.0;
    for (i, ((step, lines), row)) in steps.iter().zip(&reasons).zip(&row_px).enumerate() {
        let middle = 0.5 * BOX_PX;
        if i > 0 {
            panel.marks.extend(arrow(ink, (middle, y - 24.0), (middle, y)));
        }
        let tall = row - 24.0;
        panel.marks.push(outlined(0.0, y, BOX_PX, tall, SKY));
        let centre = y + 0.5 * tall;
        panel.marks.push(bold(
            (middle, centre - 3.0),
            &step.cases.to_string(),
            LABEL_PX + 2,
            TextAnchor::Middle,
            BLACK,
        ));
        panel.marks.push(text((middle, centre + 16.0), &step.name, LABEL_PX, TextAnchor::Middle));
        if !lines.is_empty() {
            panel.marks.extend(arrow(ink, (BOX_PX, centre), (BOX_PX + 34.0, centre)));
        }
        let first = centre - 0.5 * lines.len() as f64 * line_px(NOTE_PX) + 13.0;
        for (j, line) in lines.iter().enumerate() {
            let at = (BOX_PX + ARROW_PX, first + j as f64 * line_px(NOTE_PX));
            panel.marks.push(text(at, line, NOTE_PX, TextAnchor::Start));
        }
        y += row;
    }
    page.rows.push(vec![panel]);
    page.into_svg()
}
