//! Rotation of the segments of one patient.

use kuva::render::render::TextAnchor;
use spineline::analysis::Analysis;
use spineline::anatomy::{Level, Posture};
use spineline::motion::{LEAST_SEGMENT_WINDOWS, Motion};

use super::page::Page;
use super::panel::{Axis, Panel};
use super::style::{BLACK, Ink, Marker, TICK_PX, nice_step, posture_style, text, text_width_px};

const INFLECTION: Ink = Ink::new(BLACK, "4 4", 1.3);

/// Rotation of every chain segment from the erect to every other posture, like figure 5 of the paper.
///
/// Dashed verticals are the two inflection segments of the erect curve; markers are the least-rotating segments of both
/// windows. `None` where the case has only an erect film.
#[must_use]
pub fn rotations(analysis: &Analysis) -> Option<String> {
    let movement = &analysis.movement;
    let motions: Vec<(Posture, &Motion)> = movement
        .films
        .iter()
        .filter_map(|p| Some((p.outline.posture, p.motion.as_ref()?)))
        .collect();
    if motions.is_empty() {
        return None;
    }
    let title = format!("Rotation of the chain's segments, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    let [first, second] = LEAST_SEGMENT_WINDOWS.map(|(low, high)| format!("{low}–{high}"));
    page.notes.push(format!(
        "From the erect to every other posture. Markers: the least-rotating segments of {first} and {second}. \
         Segment length {}.",
        movement.scale().text(movement.chain.segment_mm, 3)
    ));
    if movement.inflection_segments.is_none() {
        page.notes.push("The erect curve has no pair of inflections.".to_owned());
    }
    for (posture, _) in &motions {
        let (ink, shape) = posture_style(*posture);
        page.entry((ink, Marker::new(shape, ink.colour, false)), posture.to_string());
    }
    let mut panel = empty_panel(&motions, page.inner_px(), movement.levels().base());
    for (posture, motion) in &motions {
        let (ink, _) = posture_style(*posture);
        let place = |(k, r): (usize, &spineline::spatial::Angle)| (k as f64, r.deg());
        // The first joint is the base's midpoint, which does not turn by definition of the frame.
        let places = motion.rotations.iter().enumerate().skip(1).map(place);
        panel.curve_layer(&posture.to_string(), ink, places);
    }
    if let Some(segments) = movement.inflection_segments {
        page.entry(INFLECTION, "inflection segments of the erect curve");
        mark_inflections(&mut panel, analysis, segments);
    }
    // Drawn last, so that curves do not hide the markers.
    for (posture, motion) in &motions {
        let (ink, shape) = posture_style(*posture);
        let marker = Marker { radius_px: 4.5, ..Marker::new(shape, ink.colour, false) };
        let least =
            motion.least.iter().filter_map(|&k| Some((k as f64, motion.rotations.get(k)?.deg())));
        panel.points(marker, least);
    }
    page.rows.push(vec![panel]);
    Some(page.into_svg())
}

fn empty_panel(motions: &[(Posture, &Motion)], width_px: f64, base: Level) -> Panel {
    let segments = motions.iter().map(|(_, motion)| motion.rotations.len()).max().unwrap_or(1);
    let rotations = motions.iter().flat_map(|(_, motion)| &motion.rotations);
    let most = rotations.map(|r| r.deg()).fold(0.0, f64::max);
    let segments = segments as f64;
    let label = format!("segment number, counted from {base} upwards");
    let x = Axis::numbers(label, [0.0, segments], nice_step(segments, 10.0));
    let y = Axis::from_zero("rotation of a segment (deg)", most);
    let mut panel = Panel::new(x, y, [width_px - 84.0, 400.0]);
    // Room for the words above the inflections.
    panel.corners = Some(["", ""]);
    panel
}

/// Two verticals with their names above the frame, which are moved where they would overlap or leave it.
fn mark_inflections(panel: &mut Panel, analysis: &Analysis, segments: [usize; 2]) {
    let Some(pair) = analysis.movement.inflections.pair else { return };
    let [width, height] = panel.frame_px;
    let x = segments.map(|segment| panel.px(segment as f64, 0.0).0);
    let words: [String; 2] = std::array::from_fn(|i| {
        let (low, high) = pair[i].between;
        let between = || format!("{low}–{high}");
        let place = pair[i].vertebra.map_or_else(between, |level| level.to_string());
        format!("segment {}, {place}", segments[i])
    });
    let half = words.each_ref().map(|words| 0.5 * text_width_px(words, TICK_PX));
    let push = 0.5 * (half[0] + half[1] + 8.0 - (x[1] - x[0])).max(0.0);
    let most = width - 2.0 * half[1] - 8.0;
    let left = (x[0] - push).max(half[0]).min(most - half[0]);
    let right = (x[1] + push).max(left + half[0] + half[1] + 8.0).min(width - half[1]);
    for ((x, middle), words) in x.into_iter().zip([left, right]).zip(words) {
        panel.marks.push(INFLECTION.stroke((x, 0.0), (x, height)));
        panel.marks.push(text((middle, -6.0), &words, TICK_PX, TextAnchor::Middle));
    }
}
