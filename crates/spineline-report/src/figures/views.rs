//! The multibody model in space: from behind, from the right and obliquely.

use spineline::analysis::{Analysis, LineModel};
use spineline::multibody::{BodySize, Deformed};
use spineline::response::erect_shape;
use spineline::spatial::Vec3;

use super::frontal::{Extent, View, drawn, extent_words, fit_in_row, frontal_panel, gaps_px};
use super::page::Page;
use super::panel::{HeadingKind, Panel, Ticks};
use super::style::{GREY, Ink, posture_style};
use crate::document::{Space, SpaceLayer};

const TALL_PX: f64 = 520.0;
const ERECT: Ink = Ink::new(GREY, "", 1.0);

struct Shape {
    name: String,
    ink: Ink,
    lines: Vec<Vec<Vec3>>,
}

/// The model of a patient in its erect posture and, as far as forces were found, in every simulated one: a flat figure of
/// three views, and the same lines in space. `None` where the erect film has no scale: the size of its model is not known.
#[must_use]
pub fn spine_in_space(analysis: &Analysis) -> Option<(String, Space)> {
    if !analysis.movement.erect().outline.scale.has_millimetres() {
        return None;
    }
    let title = format!("The multibody model in space, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    let shapes = shapes(analysis);
    page.notes.push(format!(
        "Vertebrae {} as boxes about their measured midpoints, as wide as their corners on the erect film where a person placed these, of typical depth and height; {}.",
        extent_words(analysis),
        analysis.profile_words()
    ));
    for shape in &shapes {
        page.entry(shape.ink, shape.name.clone());
    }
    let extents = View::ALL.map(|view| {
        let points = shapes.iter().flat_map(|shape| shape.lines.iter().flatten());
        Extent::of(points.map(|point| view.flat(point)))
    });
    // Only the first panel writes its vertical axis.
    let row_px = page.inner_px() - gaps_px(&[true, false, false]);
    let (px_per_mm, extents) = fit_in_row(extents, row_px, TALL_PX);
    let base = analysis.movement.levels().base();
    let panels = View::ALL.into_iter().zip(extents).enumerate().map(|(i, (view, extent))| {
        let mut panel = frontal_panel(extent, px_per_mm, base);
        panel.y_written = i == 0;
        panel.heading(HeadingKind::Title, view.words());
        match view {
            View::Behind => {}
            View::Right => panel.see_from_right(base),
            View::Oblique => {
                panel.x.label = "across the picture (mm)".to_owned();
                panel.x.ticks = Ticks::Numbers;
                panel.corners = Some(["LEFT, BACK", "RIGHT, FRONT"]);
            }
        }
        for shape in &shapes {
            draw(&mut panel, shape, view);
        }
        panel
    });
    page.rows.push(panels.collect());
    let layers = shapes.iter().enumerate().map(|(i, shape)| layer(shape, i < 2)).collect();
    Some((page.into_svg(), Space { layers }))
}

fn draw(panel: &mut Panel, shape: &Shape, view: View) {
    let lines: Vec<_> = shape
        .lines
        .iter()
        .map(|line| panel.trace(shape.ink, line.iter().map(|point| drawn(view.flat(point)))))
        .collect();
    panel.layer(&shape.name, lines);
}

fn layer(shape: &Shape, shown: bool) -> SpaceLayer {
    let rounded = |v: f64| (v * 10.0).round() / 10.0;
    let point = |p: &Vec3| [p.x, p.y, p.z].map(rounded);
    SpaceLayer {
        name: shape.name.clone(),
        colour: shape.ink.colour,
        dash: shape.ink.dash,
        shown,
        lines: shape.lines.iter().map(|line| line.iter().map(point).collect()).collect(),
    }
}

/// The erect shape, then the shapes of the first line's model.
fn shapes(analysis: &Analysis) -> Vec<Shape> {
    let sizes = analysis.body_sizes();
    let erect = erect_shape(&analysis.movement.spine);
    let mut all =
        vec![Shape { name: "erect".to_owned(), ink: ERECT, lines: outlines(&erect, &sizes) }];
    let Some(model) = analysis.models.first() else { return all };
    for simulation in model.simulations.iter().filter(|simulation| simulation.is_usable()) {
        let posture = simulation.shape.posture;
        let shape = simulated(analysis, model, posture);
        all.extend(shape.map(|shape| Shape {
            name: format!("{posture}, {}", model.kind),
            ink: Ink { width_px: 1.1, ..posture_style(posture).0 },
            lines: outlines(&shape, &sizes),
        }));
    }
    all
}

fn simulated(
    analysis: &Analysis,
    model: &LineModel,
    posture: spineline::anatomy::Posture,
) -> Option<Deformed> {
    analysis.force_shapes(model, posture, &[1.0])?.into_iter().next()
}

/// The line through all midpoints, and per vertebra a ring around each endplate and the four edges between them.
fn outlines(shape: &Deformed, sizes: &[BodySize]) -> Vec<Vec<Vec3>> {
    let mut lines = vec![shape.midpoints_mm.clone()];
    for ((midpoint, axes), size) in shape.midpoints_mm.iter().zip(&shape.axes).zip(sizes) {
        let half = [0.5 * size.depth_mm, 0.5 * size.width_mm, 0.5 * size.height_mm];
        let corner = |front: f64, left: f64, up: f64| {
            midpoint + axes * Vec3::new(front * half[0], left * half[1], up * half[2])
        };
        let ring = [(1.0, 1.0), (1.0, -1.0), (-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)];
        for up in [-1.0, 1.0] {
            lines.push(ring.iter().map(|&(front, left)| corner(front, left, up)).collect());
        }
        let edge =
            |&(front, left): &(f64, f64)| vec![corner(front, left, -1.0), corner(front, left, 1.0)];
        lines.extend(ring[..4].iter().map(edge));
    }
    lines
}
