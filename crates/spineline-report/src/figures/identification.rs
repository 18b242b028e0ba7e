//! The line of best fit to the rotations of every film, beside the line through the inflections.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, BestFitLine, FilmMovement, LineCrossing};
use spineline::number::probability;
use spineline::personalize::Crossing;
use spineline::spatial::Frontal;

use super::frontal::{
    Extent, INFLECTION, VIEW, axes_of_row, drawn, film_panel, frame_px, scale_note,
};
use super::page::Page;
use super::panel::{HeadingKind, Panel};
use super::style::{BLACK, GREY, Ink, Marker, PURPLE, Shape, action_ink};

const TALL_PX: f64 = 460.0;
const SPINE: (Ink, Marker) = (
    Ink::new(GREY, "", 1.6),
    Marker { radius_px: 2.8, ..Marker::new(Shape::Circle, BLACK, false) },
);
const BEST_FIT: Ink = Ink::new(PURPLE, "", 1.8);
const INTERVAL: Ink = Ink::new(PURPLE, "", 4.0);

/// The line through the inflections beside the line of best fit to the rotations of each film, with its 95 % intervals at the
/// heights of the inflections, like figure 7 of the paper. `None` where no film that was moved from the erect posture has
/// either line.
#[must_use]
pub fn line_identification(analysis: &Analysis) -> Option<String> {
    let moved: Vec<&FilmMovement> =
        analysis.movement.films.iter().filter(|p| p.motion.is_some()).collect();
    let through = moved.iter().any(|p| p.inflection_points.is_some());
    let best_fit = moved.iter().any(|p| p.best_fit_line.is_some());
    if !through && !best_fit {
        return None;
    }
    let title = format!("Identification of the line of action, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(match best_fit {
        true => format!(
            "{VIEW} p: the line of best fit runs through both inflections; below 0.05 rejects it."
        ),
        false => VIEW.to_owned(),
    });
    page.notes.extend(scale_note(analysis));
    legend(&mut page, through, best_fit);
    let axes = axes_of_row(moved.iter().map(|p| &p.outline));
    let wide_px = frame_px(page.inner_px(), &axes, moved.len());
    let extents: Vec<Extent> = moved.iter().map(|p| Extent::of(p.outline.locations())).collect();
    let all = extents.iter().copied().reduce(Extent::union).expect("a film was moved");
    let px_per_mm = (TALL_PX / all.height_mm()).min(wide_px / all.width_mm());
    let panels = moved.iter().zip(extents).zip(axes).map(|((posture, mut extent), written)| {
        extent.z_mm = all.z_mm;
        let extent = extent.at_least_wide(wide_px / px_per_mm);
        let mut panel = film_panel(&posture.outline, extent, px_per_mm, written);
        fill(&mut panel, posture, best_fit);
        panel
    });
    page.rows.push(panels.collect());
    Some(page.into_svg())
}

/// Entries for what is drawn: the line through the inflections, the line of best fit, or both.
fn legend(page: &mut Page, through: bool, best_fit: bool) {
    page.entry(SPINE, "measured spine");
    if through {
        page.entry(INFLECTION, "inflections of the erect curve");
        page.entry(action_ink(LineKind::Inflection), "line through them");
    }
    if best_fit {
        page.entry(BEST_FIT, "line of best fit to the rotations");
        page.entry(INTERVAL, "its 95 % interval, for each place alone");
    }
}

/// One posture; `tested` says whether any film of the figure has a line of best fit.
fn fill(panel: &mut Panel, posture: &FilmMovement, tested: bool) {
    let best_fit = posture.best_fit_line.as_ref();
    if tested {
        let test = best_fit.and_then(|line| line.inflection);
        let p_value = test.map(|found| format!("p {}", probability(found.test.p_value)));
        panel.heading(HeadingKind::Plain, p_value.unwrap_or_else(|| "not tested".to_owned()));
    }
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

fn best_fit_line(panel: &mut Panel, found: &BestFitLine) {
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
