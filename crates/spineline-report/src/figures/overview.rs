//! All postures of one patient side by side.

use spineline::analysis::{Analysis, FilmMovement};
use spineline::spatial::Frontal;

use super::frontal::{
    Extent, INFLECTION, VIEW, axes_of_row, drawn, extent_words, film_panel, fitted_curve, gaps_px,
    scale_note, support_note,
};
use super::page::Page;
use super::panel::Panel;
use super::style::{BLACK, GREY, Ink, Marker, Shape, action_ink};

/// Narrowest panel, so that its heading fits.
const NARROW_PX: f64 = 114.0;
const TALL_PX: f64 = 520.0;

const CURVE: Ink = Ink::new(GREY, "", 2.2);
const VERTEBRA: Marker = Marker { radius_px: 3.2, ..Marker::new(Shape::Circle, BLACK, false) };
const INTERPOLATED: Marker = Marker { radius_px: 3.6, ..Marker::new(Shape::Square, GREY, false) };

/// The films of one patient at one scale: vertebrae, fitted curve, inflections and lines of action.
#[must_use]
pub fn case_overview(analysis: &Analysis) -> String {
    let movement = &analysis.movement;
    let title = format!("Measured spine and candidate lines of action, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    let base = movement.levels().base();
    page.notes.push(format!("{VIEW} All panels have the same scale; {base} is at the origin."));
    if !analysis.models.is_empty() {
        page.notes.push(support_note(analysis));
    }
    page.notes.extend(scale_note(analysis));
    page.entry(VERTEBRA, format!("vertebra midpoints, {}", extent_words(analysis)));
    if movement.films.iter().any(|p| p.outline.interpolated().next().is_some()) {
        page.entry(INTERPOLATED, "not marked on this film, interpolated");
    }
    page.entry(CURVE, "fitted curve");
    if movement.inflection_segments.is_some() {
        page.entry(INFLECTION, "inflections of the erect curve, where they lie in each posture");
    }
    for model in &analysis.models {
        page.entry(action_ink(model.kind), model.kind.to_string());
    }
    let axes = axes_of_row(movement.films.iter().map(|posture| &posture.outline));
    let (extents, px_per_mm) = scaled(analysis, page.inner_px() - gaps_px(&axes));
    let mut panels: Vec<Panel> = Vec::new();
    for ((posture, extent), written) in movement.films.iter().zip(extents).zip(axes) {
        let mut panel = film_panel(&posture.outline, extent, px_per_mm, written);
        fill(&mut panel, analysis, posture);
        panels.push(panel);
    }
    page.rows.push(panels);
    page.into_svg()
}

/// Extents of the postures and the scale with which their frames together have a given width.
fn scaled(analysis: &Analysis, width_px: f64) -> (Vec<Extent>, f64) {
    let mut px_per_mm = 1.0;
    // The least width is in pixels and so depends on the scale; a few rounds are enough.
    for _ in 0..6 {
        let extents = extents(analysis, NARROW_PX / px_per_mm);
        let width_mm: f64 = extents.iter().map(Extent::width_mm).sum();
        let height_mm = extents.first().map_or(1.0, Extent::height_mm);
        px_per_mm = (TALL_PX / height_mm).min(width_px / width_mm);
    }
    (extents(analysis, NARROW_PX / px_per_mm), px_per_mm)
}

/// As wide as each posture needs, and all equally high.
fn extents(analysis: &Analysis, least_mm: f64) -> Vec<Extent> {
    let of = |posture: &FilmMovement| {
        let points: Vec<Frontal> = posture.outline.locations().collect();
        Extent::of(points).at_least_wide(least_mm)
    };
    let mut extents: Vec<Extent> = analysis.movement.films.iter().map(of).collect();
    let Some(all) = extents.iter().copied().reduce(Extent::union) else { return extents };
    for extent in &mut extents {
        extent.z_mm = all.z_mm;
    }
    extents
}

fn fill(panel: &mut Panel, analysis: &Analysis, posture: &FilmMovement) {
    for model in &analysis.models {
        if let Some(simulation) = model.simulation(posture.outline.posture) {
            panel.action(&simulation.line, action_ink(model.kind));
        }
    }
    panel.curves.push((CURVE, fitted_curve(posture).map(drawn).collect()));
    let locations: Vec<Frontal> = posture.outline.locations().collect();
    panel.end_levels(&locations, analysis.movement.levels());
    panel.points(VERTEBRA, posture.outline.measured().map(|(_, v)| drawn(v.location)));
    panel.points(INTERPOLATED, posture.outline.interpolated().map(|(v, _)| drawn(v.location)));
    if let Some(points) = posture.inflection_points {
        panel.points(INFLECTION, points.map(drawn));
    }
}
