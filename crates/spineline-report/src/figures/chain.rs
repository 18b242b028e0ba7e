//! The chain of segments on the erect film.

use kuva::render::render::TextAnchor;
use spineline::analysis::Analysis;
use spineline::number::fixed;
use spineline::spatial::Frontal;

use super::arrows::arrow;
use super::frontal::{Extent, INFLECTION, VIEW, drawn, frontal_panel};
use super::page::Page;
use super::panel::{Axis, HeadingKind, Panel, Ticks};
use super::style::{BLACK, GREEN, GREY, Ink, Marker, Shape, TICK_PX, VERMILLION, nice_step, text};

const TALL_PX: f64 = 520.0;
/// Segments that are drawn one by one.
const NEAR: usize = 4;
/// Of the markers on the whole chain.
const EVERY: usize = 100;
const LINK: Ink = Ink::new(GREY, "", 2.2);
const JOINT: Marker = Marker { radius_px: 4.0, ..Marker::new(Shape::Circle, BLACK, false) };
/// The axes of a frame: the first along the link, or the patient's left.
const AXES: [Ink; 2] = [Ink::new(VERMILLION, "", 1.8), Ink::new(GREEN, "", 1.8)];

/// The chain on the erect film, and some segments about the lower inflection or the middle with their frames and joint angles, like figure
/// 4 of the paper.
#[must_use]
pub fn chain(analysis: &Analysis) -> String {
    let movement = &analysis.movement;
    let title = format!("Chain of segments, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(format!(
        "{VIEW} {} segments of {}. A joint angle θ is the turn of a link against the link below.",
        movement.chain.segments,
        movement.scale().text(movement.chain.segment_mm, 3)
    ));
    page.entry((LINK, JOINT), "links and joints");
    page.entry(AXES[0], "first axis: along the link; of G: left");
    page.entry(AXES[1], "second axis; of G: cranial");
    if movement.inflection_segments.is_some() {
        page.entry(INFLECTION, "inflection segments");
    }
    page.rows.push(vec![whole(analysis), near(analysis)]);
    page.into_svg()
}

/// All segments, with a marker at every hundredth joint.
fn whole(analysis: &Analysis) -> Panel {
    let movement = &analysis.movement;
    let joints = &movement.erect().pose.joints;
    let extent = Extent::of(joints.iter().copied());
    let mut panel = frontal_panel(extent, TALL_PX / extent.height_mm(), movement.levels().base());
    panel.heading(HeadingKind::Title, format!("every {EVERY}th joint"));
    panel.curves.push((LINK, joints.iter().copied().map(drawn).collect()));
    frame(&mut panel, Frontal::default(), [Frontal::new(1.0, 0.0), Frontal::new(0.0, 1.0)]);
    panel.points(JOINT, joints.iter().copied().step_by(EVERY).map(drawn));
    let inflections = movement.inflection_segments.into_iter().flatten();
    panel.points(INFLECTION, inflections.filter_map(|k| joints.get(k)).copied().map(drawn));
    panel
}

/// Neighbouring segments with the frame and the angle of each joint.
fn near(analysis: &Analysis) -> Panel {
    let movement = &analysis.movement;
    let pose = &movement.erect().pose;
    let middle = movement.inflection_segments.map_or(pose.segments() / 2, |[lower, _]| lower);
    let first = middle.saturating_sub(NEAR / 2).min(pose.segments().saturating_sub(NEAR));
    let joints: Vec<Frontal> = pose.joints[first..]
        .iter()
        .take(NEAR + 1)
        .map(|&joint| joint - pose.joints[first])
        .collect();
    let room_mm = 0.9 * movement.chain.segment_mm;
    let Extent { x_mm, z_mm } =
        Extent::around(joints.iter().copied()).grown([2.0 * room_mm, room_mm]);
    let px_per_mm = TALL_PX / (z_mm[1] - z_mm[0]);
    let axis = |label: &str, range: [f64; 2], ticks| {
        let step = nice_step(range[1] - range[0], 4.0);
        Axis { label: format!("{label} (mm)"), range, step, ticks }
    };
    let mut panel = Panel::new(
        axis("lateral", x_mm, Ticks::Sides),
        axis(&format!("cranial of joint {first}"), z_mm, Ticks::Numbers),
        [(x_mm[1] - x_mm[0]) * px_per_mm, TALL_PX],
    );
    panel.boxed = true;
    panel.corners = Some(["LEFT", "RIGHT"]);
    panel.heading(HeadingKind::Title, format!("segments {first} to {}", first + NEAR - 1));
    panel.curves.push((LINK, joints.iter().copied().map(drawn).collect()));
    for (place, link) in joints.windows(2).enumerate() {
        let along = (link[1] - link[0]) * (1.0 / link[0].distance_mm(link[1]));
        frame(&mut panel, link[0], [along, Frontal::new(-along.z_mm, along.y_mm)]);
        let (x, y) = panel.place(link[0]);
        let words = pose.joint_angles.get(first + place).map(|theta| fixed(theta.deg(), 3));
        let words = format!("θ {} = {}°", first + place, words.unwrap_or_default());
        panel.marks.push(text((x + 12.0, y - 8.0), &words, TICK_PX, TextAnchor::Start));
    }
    panel.points(JOINT, joints.into_iter().map(drawn));
    panel
}

/// Two axes of equal length at a place.
fn frame(panel: &mut Panel, origin: Frontal, axes: [Frontal; 2]) {
    const LONG_PX: f64 = 28.0;
    let from = panel.place(origin);
    for (ink, axis) in AXES.into_iter().zip(axes) {
        let (right, up) = drawn(axis);
        let to = (from.0 + LONG_PX * right, from.1 - LONG_PX * up);
        panel.layer("frames", arrow(ink, from, to));
    }
}
