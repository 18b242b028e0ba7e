//! Measured spines beside simulated ones.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, LineModel};
use spineline::anatomy::Posture;
use spineline::evaluate::Simulation;
use spineline::number::fixed;
use spineline::spatial::Frontal;

use super::frontal::{Extent, VIEW, extent_words, frontal_panel, support_note};
use super::page::Page;
use super::panel::{HeadingKind, Panel};
use super::style::{
    BLACK, BLUE, GREEN, Ink, Marker, ORANGE, PURPLE, SHAPES, Shape, VERMILLION, action_ink,
};

/// Tallest frame of a frontal picture.
const TALL_PX: f64 = 540.0;

/// How measured spines are drawn.
pub const MEASURED: (Ink, Marker) =
    (Ink::new(BLACK, "", 1.0), Marker::new(Shape::Circle, BLACK, false));

const LINE: Ink = Ink::new(BLACK, "7 4", 1.0);

/// One panel per line of action: the measured spine of a posture and the simulated one, like figure 9 of the paper.
///
/// Every panel gives the mean location error, whether the model was fitted to this film or the film was held out, and
/// the words `not a result` with the status where the force was not found. `None` where no model has this posture.
#[must_use]
pub fn measured_and_simulated(analysis: &Analysis, posture: Posture) -> Option<String> {
    let measured: Vec<Frontal> = analysis.movement.film(posture)?.outline.locations().collect();
    let shown: Vec<(&LineModel, &Simulation)> =
        analysis.models.iter().filter_map(|m| Some((m, m.simulation(posture)?))).collect();
    if shown.is_empty() {
        return None;
    }
    let title = format!("Measured and simulated spine, {posture}, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(format!("{VIEW} Circles: vertebra midpoints, {}.", extent_words(analysis)));
    page.notes.push(support_note(analysis));
    page.entry(MEASURED, "measured");
    let extent = extent_of(&measured, shown.iter().map(|(_, simulation)| *simulation));
    let room_px = 84.0 + 18.0 * (shown.len() as f64 - 1.0);
    let cell_px = (page.inner_px() - room_px) / shown.len() as f64;
    let px_per_mm = (TALL_PX / extent.height_mm()).min(cell_px / extent.width_mm());
    let extent = extent.at_least_wide(cell_px / px_per_mm);
    let alarm = shown.iter().any(|(_, simulation)| !simulation.is_usable());
    let mut panels = Vec::new();
    for (model, simulation) in shown {
        let ink = action_ink(model.kind);
        let filled = Marker::new(Shape::Circle, ink.colour, true);
        let solid = Ink::new(ink.colour, "", 1.6);
        page.entry((solid, filled), format!("simulated, {}", model.kind));
        let mut panel = frontal_panel(extent, px_per_mm, analysis.movement.levels().base());
        panel.y_written = panels.is_empty();
        head(&mut panel, model.kind, simulation, alarm);
        panel.action(&simulation.line, LINE);
        panel.end_levels(&measured, analysis.movement.levels());
        // The simulated spine above the measured one, smaller, so that both are seen where they agree.
        let marker = Marker { radius_px: 5.0, ..MEASURED.1 };
        panel.spine(&measured, MEASURED.0, marker);
        panel.spine(&simulation.shape.locations, solid, Marker { radius_px: 2.8, ..filled });
        panels.push(panel);
    }
    page.entry(LINE, "line of action");
    page.rows.push(panels);
    Some(page.into_svg())
}

/// Where one panel has an alarm, the others keep its line free, so that all headings stand equally high.
fn head(panel: &mut Panel, kind: LineKind, simulation: &Simulation, alarm: bool) {
    let fitted = if simulation.fitted { "fitted" } else { "held out" };
    panel.heading(HeadingKind::Title, format!("{kind} ({fitted})"));
    let error = simulation.shape.mean_location_error_mm();
    panel.heading(HeadingKind::Plain, format!("mean location error {} mm", fixed(error, 2)));
    if !simulation.is_usable() {
        let words = format!("not a result ({})", simulation.status.key());
        panel.heading(HeadingKind::Alarm, words);
    } else if alarm {
        panel.heading(HeadingKind::Plain, "");
    }
}

/// Contains the measured spine and usable simulations; other shapes may be clipped.
fn extent_of<'a>(
    measured: &[Frontal],
    simulations: impl Iterator<Item = &'a Simulation>,
) -> Extent {
    let mut extent = Extent::of(measured.iter().copied());
    let around = extent.grown([60.0; 2]);
    for simulation in simulations {
        let simulated = Extent::of(simulation.shape.locations.iter().copied());
        let seen = if simulation.is_usable() { simulated } else { simulated.common(around) };
        extent = extent.union(seen);
    }
    extent
}

/// The measured spine of a posture and simulated ones at increasing force, like figure 11 of the paper.
///
/// `shapes` are forces with the locations of L4…T2, drawn in their order; `force_unit` follows each number in the
/// legend, such as `N` where the gauge makes forces known, else `× the final force`.
#[must_use]
pub fn force_path(
    analysis: &Analysis,
    posture: Posture,
    kind: LineKind,
    shapes: &[(f64, Vec<Frontal>)],
    force_unit: &str,
) -> String {
    let title = format!("Spine under increasing force, {posture}, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.width_px = 640.0;
    page.notes.push(format!("Force along the {kind}. {VIEW} {}", support_note(analysis)));
    let measured: Vec<Frontal> = analysis
        .movement
        .film(posture)
        .map(|p| p.outline.locations().collect())
        .unwrap_or_default();
    let points = shapes.iter().flat_map(|(_, points)| points).chain(&measured).copied();
    let extent = Extent::of(points);
    let frame_px = page.inner_px() - 84.0;
    let px_per_mm = (1.1 * TALL_PX / extent.height_mm()).min(frame_px / extent.width_mm());
    let extent = extent.at_least_wide(frame_px / px_per_mm);
    let mut panel = frontal_panel(extent, px_per_mm, analysis.movement.levels().base());
    let line = analysis.model(kind).and_then(|m| m.simulation(posture));
    if let Some(simulation) = line {
        panel.action(&simulation.line, LINE);
        page.entry(LINE, "line of action");
    }
    if !measured.is_empty() {
        panel.end_levels(&measured, analysis.movement.levels());
        panel.spine(&measured, MEASURED.0, Marker { radius_px: 5.0, ..MEASURED.1 });
        page.entry(MEASURED, "measured");
    }
    let colours = [GREEN, ORANGE, BLUE, VERMILLION, PURPLE];
    for (i, (force, locations)) in shapes.iter().enumerate() {
        let colour = colours[i % colours.len()];
        // After one round of shapes the filling changes, so that ten forces look different.
        let filled = (i / SHAPES.len()).is_multiple_of(2);
        let marker =
            Marker { radius_px: 3.6, ..Marker::new(SHAPES[i % SHAPES.len()], colour, filled) };
        let ink = Ink::new(colour, "", 1.2);
        panel.spine(locations, ink, marker);
        page.entry((ink, marker), format!("{} {force_unit}", fixed(*force, 2)));
    }
    page.rows.push(vec![panel]);
    page.into_svg()
}
