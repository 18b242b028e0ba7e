//! Sagittal profiles from lateral films beside the profile of a population.

use kuva::render::render::Primitive;
use spineline::analysis::{Analysis, ProfileVertebra, TemplateError};
use spineline::anatomy::Level;

use super::page::Page;
use super::panel::{Axis, HeadingKind, Panel};
use super::style::{
    BLUE, GREY, Ink, Marker, SKY, Shape, TICK_PX, VERMILLION, nice_step, text_width_px,
};

const TALL_PX: f64 = 380.0;
const MEASURED: Ink = Ink::new(BLUE, "", 1.8);
const INTERVAL: Ink = Ink::new(SKY, "", 5.0);
const TEMPLATE: Ink = Ink::new(VERMILLION, "7 3", 1.8);
const ZERO: Ink = Ink::new(GREY, "2 3", 1.0);
/// One of many patients.
const ONE: Ink = Ink::new(BLUE, "", 0.9);
/// Standard deviations to the end of a normal distribution's 95 % interval.
const WIDE: f64 = 1.96;

/// The profile of a patient from the right, and the pitch of every vertebra with its 95 % interval, beside the profile of a
/// population. `None` without a lateral film.
#[must_use]
pub fn sagittal_profile(analysis: &Analysis) -> Option<String> {
    let movement = &analysis.movement;
    let found = analysis.template_error()?;
    let title = format!("Sagittal profile, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(found.words(movement.scale()));
    let marker = Marker::new(Shape::Circle, BLUE, true);
    page.entry((MEASURED, marker), "from both films");
    page.entry(INTERVAL, "95 % interval");
    page.entry(TEMPLATE, "population, without the lateral film");
    let mut row = Vec::new();
    let mut width_px = page.inner_px() - 92.0;
    if movement.erect().outline.scale.has_millimetres() {
        let panel = from_right(&found, movement.levels().base(), marker);
        width_px -= panel.frame_px[0] + 92.0;
        row.push(panel);
    }
    let levels: Vec<Level> = movement.levels().iter().collect();
    let mut panel = pitch_panel(&levels, [&found], width_px);
    let [low, high] = [-WIDE, WIDE];
    let at = places(&levels, &found.vertebrae);
    let interval = |(x, vertebra): &(f64, &ProfileVertebra)| {
        let end = |share: f64| (*x, (vertebra.measured + vertebra.sd * share).deg());
        panel.trace(INTERVAL, [end(low), end(high)])
    };
    let intervals: Vec<Primitive> = at.iter().map(interval).collect();
    panel.layer("interval", intervals);
    let lines = [
        panel.trace(TEMPLATE, at.iter().map(|(x, vertebra)| (*x, vertebra.template.deg()))),
        panel.trace(MEASURED, at.iter().map(|(x, vertebra)| (*x, vertebra.measured.deg()))),
    ];
    panel.layer("pitch", lines);
    panel.points(marker, at.iter().map(|(x, vertebra)| (*x, vertebra.measured.deg())));
    panel.heading(HeadingKind::Title, "Pitch of the vertebrae, flexion positive");
    row.push(panel);
    page.rows.push(row);
    Some(page.into_svg())
}

/// Pitches of all patients with a lateral film, and the errors of the population's profile. `None`
/// without such a patient.
#[must_use]
pub fn sagittal_profiles(found: &[(&Analysis, TemplateError)]) -> Option<String> {
    if found.is_empty() {
        return None;
    }
    let synthetic = found.iter().any(|(analysis, _)| analysis.synthetic);
    let mut page = Page::new("Sagittal profiles beside a population's", synthetic);
    page.notes.push(
        "Left: pitch of every vertebra from both films, flexion positive, one line per patient. Right: error of the profile of a population."
            .to_owned(),
    );
    page.entry(ONE, "a patient");
    page.entry(TEMPLATE, "population, mean over these patients");
    let levels = Level::MODEL;
    let width_px = 0.5 * page.inner_px() - 92.0;
    let errors = || found.iter().map(|(_, error)| error);
    let mut pitch = pitch_panel(&levels, errors(), width_px);
    let mut off = error_panel(&levels, errors(), width_px);
    for error in errors() {
        let at = places(&levels, &error.vertebrae);
        pitch.curve_layer("patient", ONE, at.iter().map(|(x, v)| (*x, v.measured.deg())));
        off.curve_layer("patient", ONE, at.iter().map(|(x, v)| (*x, v.error().deg())));
    }
    let mean = (0..levels.len()).filter_map(|i| {
        let vertebrae = errors().flat_map(|error| &error.vertebrae);
        let all: Vec<f64> =
            vertebrae.filter(|v| v.level == levels[i]).map(|v| v.template.deg()).collect();
        let sum: f64 = all.iter().sum();
        (!all.is_empty()).then(|| (i as f64 + 0.5, sum / all.len() as f64))
    });
    pitch.curve_layer("population", TEMPLATE, mean);
    pitch.heading(HeadingKind::Title, "Pitch");
    off.heading(HeadingKind::Title, "Population less measured");
    page.rows.push(vec![pitch, off]);
    Some(page.into_svg())
}

/// Place of every vertebra on the horizontal axis.
fn places<'a>(
    levels: &[Level],
    vertebrae: &'a [ProfileVertebra],
) -> Vec<(f64, &'a ProfileVertebra)> {
    let place = |vertebra: &'a ProfileVertebra| {
        let i = levels.iter().position(|level| *level == vertebra.level)?;
        Some((i as f64 + 0.5, vertebra))
    };
    vertebrae.iter().filter_map(place).collect()
}

fn pitch_panel<'a>(
    levels: &[Level],
    errors: impl IntoIterator<Item = &'a TemplateError>,
    width_px: f64,
) -> Panel {
    let values = errors.into_iter().flat_map(|error| &error.vertebrae).flat_map(|vertebra| {
        let wide = vertebra.sd * WIDE;
        let (low, high) = (vertebra.measured - wide, vertebra.measured + wide);
        [low, high, vertebra.template].map(|angle| angle.deg())
    });
    by_level(levels, values, "pitch (deg)", width_px)
}

fn error_panel<'a>(
    levels: &[Level],
    errors: impl IntoIterator<Item = &'a TemplateError>,
    width_px: f64,
) -> Panel {
    let vertebrae = errors.into_iter().flat_map(|error| &error.vertebrae);
    by_level(levels, vertebrae.map(|v| v.error().deg()), "error of the pitch (deg)", width_px)
}

/// The least and the greatest of all values and zero.
fn around_zero(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([0.0_f64; 2], |[low, high], v| [low.min(v), high.max(v)])
}

/// Widens a range to multiples of a step; it ends at least one step above zero.
fn in_steps([low, high]: [f64; 2], step: f64) -> [f64; 2] {
    [step * (low / step).floor(), step * (high / step).ceil().max(1.0)]
}

/// A panel with the names of the vertebrae below, from the lowest on the left, and a line at zero.
fn by_level(
    levels: &[Level],
    values: impl Iterator<Item = f64>,
    label: &str,
    width_px: f64,
) -> Panel {
    let [low, high] = around_zero(values);
    let step = nice_step((high - low).max(1.0), 7.0);
    let most = levels.len() as f64;
    let y = Axis::numbers(label, in_steps([low, high], step), step);
    let mut panel = Panel::new(Axis::places("", most), y, [width_px, TALL_PX]);
    // In two rows where names would meet.
    let rows = if width_px / most < text_width_px("T12", TICK_PX) + 6.0 { 2 } else { 1 };
    for (i, level) in levels.iter().enumerate() {
        panel.name_below(i as f64 + 0.5, i % rows, vec![level.to_string()], false);
    }
    panel.curve_layer("zero", ZERO, [(0.0, 0.0), (most, 0.0)]);
    panel
}

/// Both profiles from the patient's right, at one scale for both axes.
fn from_right(found: &TemplateError, base: Level, marker: Marker) -> Panel {
    let depths = found.vertebrae.iter().flat_map(|v| [v.place_mm[0], v.template_depth_mm]);
    let heights = found.vertebrae.iter().map(|v| v.place_mm[1]);
    let z = in_steps(around_zero(heights), 50.0);
    let [back, front] = in_steps(around_zero(depths), 20.0);
    // Room for the label of the axis.
    let spare = 0.5 * (160.0 - (front - back)).max(0.0);
    let x = in_steps([back - spare, front + spare], 20.0);
    let px_per_mm = TALL_PX / (z[1] - z[0]);
    let mut panel = Panel::new(
        Axis::numbers(format!("anterior of {base} (mm)"), x, 40.0),
        Axis::numbers(format!("cranial of {base} (mm)"), z, 50.0),
        [px_per_mm * (x[1] - x[0]), TALL_PX],
    );
    panel.heading(HeadingKind::Title, "From the right");
    panel.corners = Some(["BACK", "FRONT"]);
    let measured = || found.vertebrae.iter().map(|v| (v.place_mm[0], v.place_mm[1]));
    let template = found.vertebrae.iter().map(|v| (v.template_depth_mm, v.place_mm[1]));
    let lines = [panel.trace(TEMPLATE, template), panel.trace(MEASURED, measured())];
    panel.layer("profile", lines);
    panel.points(Marker { radius_px: 2.6, ..marker }, measured());
    panel
}
