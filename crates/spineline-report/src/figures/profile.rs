//! Profile likelihoods of the multipliers: how much worse the fit becomes where one of them is held at another value.

use spineline::analysis::{Analysis, LineModel};
use spineline::personalize::{Identifiability, Profile};

use super::page::Page;
use super::panel::{Axis, HeadingKind, Panel};
use super::style::{BLACK, BLUE, GREEN, GREY, Ink, Marker, ORANGE, PURPLE, SKY, Shape, VERMILLION};

const COLOURS: [&str; 6] = [BLUE, ORANGE, GREEN, VERMILLION, PURPLE, SKY];
const DASHES: [&str; 3] = ["", "7 3", "2 3"];
const LIMIT: Ink = Ink::new(BLACK, "4 4", 1.3);
const FIT: Ink = Ink::new(GREY, "2 3", 1.0);
const TALL_PX: f64 = 260.0;
/// Twice the limit: what lies above is cut off.
const MOST_RISE: f64 = 2.0 * Profile::LIMIT;

/// One panel per line of action whose fit converged, with a curve per multiplier. `None` without such a line.
///
/// A curve that crosses the dashed limit on both sides has a 95 % interval if the model is exact; one that stays below is not identified.
#[must_use]
pub fn profiles(analysis: &Analysis, found: &[Option<Identifiability>]) -> Option<String> {
    let models: Vec<(&LineModel, &Identifiability)> =
        analysis.models.iter().zip(found).filter_map(|(m, f)| Some((m, f.as_ref()?))).collect();
    let (first, _) = models.first()?;
    let title = format!("Identifiability of the multipliers, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push("Everything else is fitted anew at every value. Below the dashed limit lie the values that the films allow with 95 % confidence if the model is exact.".to_owned());
    for (group, name) in first.groups.titles().enumerate() {
        page.entry((ink(group), marker(group)), name);
    }
    page.entry(LIMIT, "limit of the 95 % interval if the model is exact");
    page.entry(FIT, "the fit");
    let width_px = page.inner_px() / models.len() as f64 - 92.0;
    let points =
        || models.iter().flat_map(|(_, f)| &f.multipliers).flat_map(|one| &one.profile.points);
    let shown = points().filter(|point| point.rise <= MOST_RISE).map(|point| point.log_multiplier);
    let (low, high) = shown.fold((-0.5_f64, 0.5_f64), |(low, high), x| (low.min(x), high.max(x)));
    let panels = models.iter().map(|(model, found)| panel(model, found, [low, high], width_px));
    page.rows.push(panels.collect());
    Some(page.into_svg())
}

fn ink(group: usize) -> Ink {
    let dash = DASHES[group / COLOURS.len() % DASHES.len()];
    Ink::new(COLOURS[group % COLOURS.len()], dash, 1.6)
}

fn marker(group: usize) -> Marker {
    Marker { radius_px: 2.2, ..Marker::new(Shape::Circle, ink(group).colour, true) }
}

fn panel(
    model: &LineModel,
    found: &Identifiability,
    [low, high]: [f64; 2],
    width_px: f64,
) -> Panel {
    let x = Axis::around("ln of the multiplier (1)", low, high, 5.0);
    let y = Axis::numbers("rise of the sum of squares (1)", [0.0, MOST_RISE], 2.0);
    let mut panel = Panel::new(x, y, [width_px, TALL_PX]);
    panel.heading(HeadingKind::Title, model.kind.to_string());
    let [left, right] = panel.x.range;
    panel.curve_layer("limit", LIMIT, [(left, Profile::LIMIT), (right, Profile::LIMIT)]);
    for (group, one) in found.multipliers.iter().enumerate() {
        let at = model.fit.log_multipliers[group];
        panel.curve_layer("fit", FIT, [(at, 0.0), (at, MOST_RISE)]);
        let places = || one.profile.points.iter().map(|p| (p.log_multiplier, p.rise.max(0.0)));
        panel.curves.push((ink(group), places().collect()));
        panel.points(marker(group), places().filter(|(_, rise)| *rise <= MOST_RISE));
    }
    panel
}
