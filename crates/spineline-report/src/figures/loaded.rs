//! A personalised spine under loads, beside its erect shape.

use kuva::render::render::{Primitive, TextAnchor};
use spineline::anatomy::Level;
use spineline::multibody::{BodyLoad, Deformed};
use spineline::number::fixed;
use spineline::response::{ActingKind, ActingLoad, acting_loads, erect_shape};
use spineline::spatial::{Frontal, Vec3};
use spineline_files::Simulated;

use super::arrows::{arrow, bar, turning};
use super::frontal::{Extent, VIEW, View, drawn, fit_in_row, frontal_panel, gaps_px};
use super::page::Page;
use super::panel::{HeadingKind, Panel};
use super::style::{
    BLACK, BLUE, GREEN, GREY, Ink, Marker, NOTE_PX, ORANGE, PURPLE, Shape, TICK_PX, VERMILLION,
    bold, wrapped,
};

const TALL_PX: f64 = 560.0;
/// The strongest force; the others in proportion.
const MAX_ARROW_MM: f64 = 55.0;
/// Half the drawn width of vertebrae.
const HALF_BREADTH_MM: f64 = 14.0;
/// Objects farther from the spine, such as the end of a long strap, are clipped.
const MAX_DISTANCE_MM: f64 = 110.0;

const ERECT: (Ink, Marker) =
    (Ink::new(GREY, "", 1.2), Marker { radius_px: 3.2, ..Marker::new(Shape::Circle, GREY, false) });
const RESULT: (Ink, Marker) =
    (Ink::new(BLUE, "", 1.8), Marker { radius_px: 3.2, ..Marker::new(Shape::Circle, BLUE, true) });
const NO_RESULT: (Ink, Marker) = (
    Ink::new(VERMILLION, "3 4", 1.6),
    Marker { radius_px: 3.4, ..Marker::new(Shape::Diamond, VERMILLION, false) },
);
const FORCE: Ink = Ink::new(BLACK, "", 1.6);
const LINE: Ink = Ink::new(BLACK, "7 4", 0.9);
const STRAP: Ink = Ink::new(GREEN, "", 1.4);
const ROD: Ink = Ink::new(ORANGE, "", 4.0);
const MOMENT: Ink = Ink::new(PURPLE, "", 1.8);

/// A spine under loads from behind and from the right, with its erect shape and the loads.
///
/// Without a result, the nearest shape is drawn in another way, and both panels say `not a result` with the status.
#[must_use]
pub fn loaded_spine(input: &Simulated) -> String {
    let title = format!("Spine under loads, case {}", input.model.case_id);
    let mut page = Page::new(title, input.model.synthetic);
    let sagittal = "Right panel: seen from the patient's right, the front is on the right.";
    page.notes.push(format!("Left panel: {VIEW} {sagittal}"));
    let force_unit = input.model.force_unit();
    for (number, load) in input.loads.loads.iter().enumerate() {
        page.notes.push(format!("Load {}: {}", number + 1, load.words(force_unit)));
    }
    page.notes.push(format!("Forces in {force_unit}. {}", state_words(input)));
    let shape = input.response.shape().cloned().unwrap_or_else(|| erect_shape(&input.model.spine));
    let acting = acting(input, &shape);
    legend(&mut page, input, &acting);
    let views = [View::Behind, View::Right];
    let mut extents = views.map(|view| extent(input, &shape, &acting, view));
    let all = extents[0].union(extents[1]);
    for extent in &mut extents {
        extent.z_mm = all.z_mm;
    }
    let row_px = page.inner_px() - gaps_px(&[true, true]);
    let (px_per_mm, extents) = fit_in_row(extents, row_px, TALL_PX);
    let base = input.model.levels[0];
    let panels = views.iter().zip(extents).map(|(&view, extent)| {
        let mut panel = frontal_panel(extent, px_per_mm, base);
        if view == View::Right {
            panel.see_from_right(base);
        }
        fill(&mut panel, input, &shape, &acting, view);
        panel
    });
    page.rows.push(panels.collect());
    page.into_svg()
}

/// Load factor of the shape, and its kind.
fn state_words(input: &Simulated) -> String {
    let response = &input.response;
    match (response.result(), response.nearest()) {
        (Some(result), _) => {
            format!(
                "Factor of the proportional loads: {} ({}).",
                fixed(result.factor, 4),
                response.ending.key()
            )
        }
        (None, Some(point)) => format!(
            "Not a result ({}): the shape nearest to the target is drawn, at a factor of {}.",
            response.ending.key(),
            fixed(point.factor, 4)
        ),
        (None, None) => format!("Not a result ({}).", response.ending.key()),
    }
}

/// The loads on the shape; without a result, pads and straps have no force.
fn acting(input: &Simulated, shape: &Deformed) -> Vec<ActingLoad> {
    match (input.response.result(), input.response.nearest()) {
        (Some(result), _) => {
            acting_loads(&input.placed.loading, shape, result.factor, &result.spring_forces_n)
        }
        (None, Some(point)) => acting_loads(&input.placed.loading, shape, point.factor, &[]),
        (None, None) => Vec::new(),
    }
}

fn shape_style(input: &Simulated) -> (Ink, Marker) {
    if input.response.result().is_some() { RESULT } else { NO_RESULT }
}

fn legend(page: &mut Page, input: &Simulated, acting: &[ActingLoad]) {
    page.entry(ERECT, "erect, before the loads");
    let words = if input.response.result().is_some() { "under load" } else { "not a result" };
    page.entry(shape_style(input), words);
    let items = &input.placed.loading.items;
    let some = |kind: fn(&BodyLoad) -> bool| items.iter().any(|item| kind(&item.load));
    if acting.iter().any(|load| matches!(load.kind, ActingKind::Force(_))) {
        page.entry(FORCE, "force (arrows in proportion)");
    }
    if some(|load| matches!(load, BodyLoad::ForceOnLine { .. })) {
        page.entry(LINE, "line of a force, fixed in space");
    }
    if some(|load| matches!(load, BodyLoad::Strap { .. })) {
        page.entry(STRAP, "strap");
    }
    if some(|load| matches!(load, BodyLoad::Moment { .. } | BodyLoad::FollowerMoment { .. })) {
        page.entry(MOMENT, "moment (its part about the line of sight)");
    }
    if !input.placed.loading.rods.is_empty() {
        page.entry(ROD, "rod");
    }
}

/// Length of a force's arrow, and whether it ends where it acts, as a pad's does.
fn arrow_mm(input: &Simulated, acting: &[ActingLoad], load: &ActingLoad) -> Option<(Vec3, bool)> {
    let size = |load: &ActingLoad| match load.kind {
        ActingKind::Force(force) => force.norm(),
        ActingKind::Moment(_) => 0.0,
    };
    let strongest = acting.iter().map(size).fold(f64::MIN_POSITIVE, f64::max);
    let ActingKind::Force(force) = load.kind else { return None };
    let pushes = matches!(input.placed.loading.items[load.item].load, BodyLoad::Pad { .. });
    Some((force * (MAX_ARROW_MM / strongest), pushes))
}

fn extent(input: &Simulated, shape: &Deformed, acting: &[ActingLoad], view: View) -> Extent {
    let flat = |points: &[Vec3]| points.iter().map(|p| view.flat(p)).collect::<Vec<_>>();
    let erect = Extent::of(flat(&input.model.spine.midpoints_mm));
    let around = erect.grown([MAX_DISTANCE_MM; 2]);
    let usable = input.response.result().is_some();
    let loaded = Extent::of(flat(&shape.midpoints_mm));
    let spine = erect.union(if usable { loaded } else { loaded.common(around) });
    let tips = acting.iter().filter_map(|load| {
        let (along, pushes) = arrow_mm(input, acting, load)?;
        Some(if pushes { load.point_mm - along } else { load.point_mm + along })
    });
    let anchors = input.placed.loading.items.iter().filter_map(|item| match item.load {
        BodyLoad::Strap { anchor_mm, .. } => Some(anchor_mm),
        _ => None,
    });
    let loads = Extent::of(tips.chain(anchors).map(|point| view.flat(&point)));
    spine.union(loads.common(spine.grown([MAX_DISTANCE_MM; 2])))
}

fn fill(panel: &mut Panel, input: &Simulated, shape: &Deformed, acting: &[ActingLoad], view: View) {
    panel.heading(HeadingKind::Title, view.words());
    if input.response.result().is_none() {
        let words = format!("not a result ({})", input.response.ending.key());
        for line in wrapped(&words, TICK_PX, panel.frame_px[0]) {
            panel.heading(HeadingKind::Alarm, line);
        }
    }
    for rod in &input.placed.loading.rods {
        let ends = [rod.inferior, rod.superior].map(|v| view.flat(&shape.midpoints_mm[v]));
        panel.curves.push((ROD, ends.map(drawn).to_vec()));
    }
    let style = shape_style(input);
    let erect = erect_shape(&input.model.spine);
    // The axis of a vertebra that runs across the picture: its x from the right, its y from behind.
    let across = usize::from(view == View::Behind);
    for (shape, (ink, marker)) in [(&erect, ERECT), (shape, style)] {
        let points: Vec<Frontal> = shape.midpoints_mm.iter().map(|p| view.flat(p)).collect();
        for (midpoint, axes) in shape.midpoints_mm.iter().zip(&shape.axes) {
            let half = axes.column(across) * HALF_BREADTH_MM;
            let ends = [midpoint - half, midpoint + half].map(|end| drawn(view.flat(&end)));
            panel.curves.push((Ink { width_px: 1.0, ..ink }, ends.to_vec()));
        }
        panel.spine(&points, ink, marker);
    }
    end_names(panel, &input.model.levels, &erect, view);
    for load in acting {
        draw_load(panel, input, acting, load, view);
    }
}

/// Names the lowest and the uppermost vertebra of the erect spine, beside its vertebrae.
fn end_names(panel: &mut Panel, levels: &[Level], erect: &Deformed, view: View) {
    let ends = [
        (levels.first(), erect.midpoints_mm.first(), 20.0),
        (levels.last(), erect.midpoints_mm.last(), -12.0),
    ];
    for (level, midpoint, down_px) in ends {
        if let (Some(level), Some(midpoint)) = (level, midpoint) {
            let (x, y) = panel.place(view.flat(midpoint));
            panel.marks.push(bold(
                (x, y + down_px),
                level.name(),
                TICK_PX,
                TextAnchor::Middle,
                GREY,
            ));
        }
    }
}

fn draw_load(
    panel: &mut Panel,
    input: &Simulated,
    acting: &[ActingLoad],
    load: &ActingLoad,
    view: View,
) {
    let place = |panel: &Panel, point: &Vec3| panel.place(view.flat(point));
    let item = &input.placed.loading.items[load.item];
    match item.load {
        BodyLoad::ForceOnLine { force_n, .. } => {
            let far = force_n * (2000.0 / force_n.norm().max(f64::MIN_POSITIVE));
            let ends = [load.point_mm - far, load.point_mm + far].map(|p| drawn(view.flat(&p)));
            panel.curves.push((LINE, ends.to_vec()));
        }
        BodyLoad::Strap { anchor_mm, .. } => {
            let ends = [load.point_mm, anchor_mm].map(|p| drawn(view.flat(&p)));
            panel.curves.push((STRAP, ends.to_vec()));
        }
        _ => {}
    }
    let at = place(panel, &load.point_mm);
    let [width, height] = panel.frame_px;
    if !((0.0..=width).contains(&at.0) && (0.0..=height).contains(&at.1)) {
        // A shape that is not a result may leave the picture, with its loads.
        return;
    }
    let marks = if let Some((along, pushes)) = arrow_mm(input, acting, load) {
        let [from, to] = if pushes {
            [load.point_mm - along, load.point_mm]
        } else {
            [load.point_mm, load.point_mm + along]
        };
        let (from, to) = (place(panel, &from), place(panel, &to));
        let mut marks = arrow(FORCE, from, to);
        if pushes {
            marks.extend(bar(FORCE, from, to));
        }
        if !marks.is_empty() {
            let free = if pushes { (to, from) } else { (from, to) };
            marks.extend(number(input, load.item, free));
        }
        marks
    } else if let ActingKind::Moment(moment) = load.kind {
        // The part that turns within the picture, positive clockwise.
        let part = if view == View::Right { moment.y } else { moment.x };
        // Moments about other axes are seen in the other view, or not at all.
        let seen = part.abs() > 0.05 * moment.norm();
        if seen { turning(MOMENT, at, part > 0.0) } else { Vec::new() }
    } else {
        Vec::new()
    };
    panel.marks.extend(marks);
}

/// The number of a load beyond the free end of its arrow; slices of gravity have no number.
fn number(input: &Simulated, item: usize, arrow: ((f64, f64), (f64, f64))) -> Option<Primitive> {
    let load = input.placed.load_of_item[item];
    let alone = input.placed.load_of_item.iter().filter(|other| **other == load).count() == 1;
    let (from, to) = arrow;
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let beyond = 10.0 / dx.hypot(dy).max(1.0);
    let at = (to.0 + beyond * dx, to.1 + beyond * dy + 4.5);
    alone.then(|| bold(at, &(load + 1).to_string(), NOTE_PX, TextAnchor::Middle, BLACK))
}
