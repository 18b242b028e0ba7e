//! The line of best fit to the rotations of every film, beside the line through the inflections.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, LineCrossing, PostureAnalysis, PreferredLine, probability};
use spineline::personalize::Crossing;
use spineline::spatial::Frontal;

use super::frontal::{Extent, VIEW, drawn, frontal_panel};
use super::page::{Page, Sample};
use super::panel::{HeadingKind, Panel};
use super::style::{BLACK, GREY, Ink, Marker, ORANGE, PURPLE, Shape, action_ink};

const TALL_PX: f64 = 460.0;
const SPINE: (Ink, Marker) = (
    Ink::new(GREY, "", 1.6),
    Marker { radius_px: 2.8, ..Marker::new(Shape::Circle, BLACK, false) },
);
const INFLECTION: Marker = Marker { radius_px: 5.0, ..Marker::new(Shape::Diamond, ORANGE, true) };
const BEST_FIT: Ink = Ink::new(PURPLE, "", 1.8);
const INTERVAL: Ink = Ink::new(PURPLE, "", 4.0);

/// The line through the inflections beside the line of best fit to the rotations of each film, with its 95 % intervals at the
/// heights of the inflections, like figure 7 of the paper. `None` where no film was moved from the erect posture.
#[must_use]
pub fn line_identification(analysis: &Analysis) -> Option<String> {
    let moved: Vec<&PostureAnalysis> =
        analysis.postures.iter().filter(|p| p.motion.is_some()).collect();
    if moved.is_empty() {
        return None;
    }
    let title = format!("Identification of the line of action, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(format!(
        "{VIEW} p: the line of best fit runs through both inflections; below 0.05 rejects it."
    ));
    let line_ink = action_ink(LineKind::Inflection);
    page.legend = vec![
        (Sample::Stroke(SPINE.0, Some(SPINE.1)), "measured spine".to_owned()),
        (Sample::Marker(INFLECTION), "inflections of the erect curve".to_owned()),
        (Sample::Stroke(line_ink, None), "line through them".to_owned()),
        (Sample::Stroke(BEST_FIT, None), "line of best fit to the rotations".to_owned()),
        (Sample::Stroke(INTERVAL, None), "its 95 % interval, for each place alone".to_owned()),
    ];
    let room_px = 84.0 + 18.0 * (moved.len() as f64 - 1.0);
    let cell_px = (page.inner_px() - room_px) / moved.len() as f64;
    let extents: Vec<Extent> = moved.iter().map(|p| Extent::of(p.outline.locations())).collect();
    let all = extents.iter().copied().reduce(Extent::union).expect("a film was moved");
    let px_per_mm = (TALL_PX / all.height_mm()).min(cell_px / all.width_mm());
    let panels = moved.iter().zip(extents).enumerate().map(|(i, (posture, mut extent))| {
        extent.z_mm = all.z_mm;
        let mut panel = frontal_panel(extent.at_least_wide(cell_px / px_per_mm), px_per_mm);
        panel.y_written = i == 0;
        fill(&mut panel, posture);
        panel
    });
    page.rows.push(panels.collect());
    Some(page.into_svg())
}

fn fill(panel: &mut Panel, posture: &PostureAnalysis) {
    panel.heading(HeadingKind::Title, posture.outline.posture.to_string());
    let best_fit = posture.preferred_line.as_ref();
    let test = best_fit.and_then(|line| line.inflection);
    panel.heading(
        HeadingKind::Plain,
        test.map_or_else(
            || "not tested".to_owned(),
            |found| format!("p {}", probability(found.test.p_value)),
        ),
    );
    let locations: Vec<Frontal> = posture.outline.locations().collect();
    panel.end_levels(&locations, posture.outline.levels());
    if let Some([caudal, cranial]) = posture.inflection_points
        && let Ok(line) = spineline::action::LineOfAction::through(caudal, cranial)
        && let Some(mark) = panel.action_mark(&line, action_ink(LineKind::Inflection))
    {
        panel.layer("line through the inflections", [mark]);
    }
    if let Some(found) = best_fit {
        best_fit_line(panel, found);
    }
    panel.spine(&locations, SPINE.0, SPINE.1);
    panel.points(INFLECTION, posture.inflection_points.into_iter().flatten().map(drawn));
}

fn best_fit_line(panel: &mut Panel, found: &PreferredLine) {
    let line = panel.action_mark(&found.line, BEST_FIT);
    let bars: Vec<_> = found.crossings.iter().filter_map(|at| interval(panel, at)).collect();
    panel.layer("line of best fit to the rotations", line.into_iter().chain(bars));
}

/// Where a line may cross a height, as far as the frame reaches.
fn interval(panel: &Panel, at: &LineCrossing) -> Option<kuva::render::render::Primitive> {
    let [left, right] = panel.x.range;
    let [low, high] = match at.within {
        Crossing::Open => [left, right],
        Crossing::Between([low, high]) => [-high, -low].map(|x: f64| x.clamp(left, right)),
    };
    (high > low).then(|| panel.trace(INTERVAL, [(low, at.z_mm), (high, at.z_mm)]))
}
