//! Two neighbouring vertebrae in both bends.

use spineline::analysis::{Analysis, Case};
use spineline::anatomy::{Level, Posture};
use spineline::measure::endplate_centres;
use spineline::number::fixed;
use spineline::spatial::Frontal;

use super::arrows::arrow;
use super::films::{BODY, Displayed};
use super::frontal::{Extent, VIEW, drawn, frontal_panel};
use super::page::Page;
use super::panel::{HeadingKind, Panel};
use super::style::{BLACK, Ink, Marker, Shape, posture_style};

/// The films, from left to right.
const FILMS: [Posture; 3] = [Posture::LeftBending, Posture::Erect, Posture::RightBending];
const TALL_PX: f64 = 380.0;
const FORCE_MM: f64 = 4.0;
const INFERIOR: Marker = Marker { radius_px: 4.0, ..Marker::new(Shape::Circle, BLACK, false) };

/// Two vertebrae on one film.
struct Unit {
    /// Centres of the superior and inferior endplate of both, of the lower vertebra first, on the film as it was taken.
    centres: [[Frontal; 2]; 2],
    /// Corners of both by every reading.
    corners: Vec<[Frontal; 4]>,
}

impl Unit {
    fn of(film: &Displayed<'_>, levels: [Level; 2]) -> Option<Self> {
        let frame = film.frame.as_ref()?;
        let of_level = |level| endplate_centres(film.film, frame, level);
        let [Some(lower), Some(upper)] = levels.map(of_level) else { return None };
        let own = |(level, mark)| levels.contains(level).then(|| film.corners(mark)).flatten();
        let origin = film.place(lower[0]);
        Some(Self {
            centres: [lower, upper].map(|two| two.map(|point| film.place(point) - origin)),
            corners: film.marks().filter_map(own).map(|c| c.map(|p| p - origin)).collect(),
        })
    }

    /// Superior and inferior centre of the upper vertebra, where the axis of the lower one is upright.
    fn upper_on_lower(&self) -> [Frontal; 2] {
        let [[superior, inferior], upper] = self.centres;
        upper.map(|point| (point - superior).rotated(-(superior - inferior).lateral_tilt()))
    }
}

/// How far the superior centre of the upper vertebra moves against the left and the right bend.
fn against_mm(units: &[Unit; 3]) -> [f64; 2] {
    let [left, erect, right] = units.each_ref().map(|unit| unit.upper_on_lower()[0].y_mm);
    [erect - left, right - erect]
}

/// Centres of the endplates of two vertebrae, on the films and relative to the lower vertebra, like figure 2 of the paper: the two vertebrae
/// of which the upper one moves most against a bend. `None` without the corners of both bends.
#[must_use]
pub fn functional_unit(case: &Case, analysis: &Analysis) -> Option<String> {
    let film = |posture| {
        let film = case.film(posture)?;
        Some(Displayed::of(film, &analysis.movement.film(posture)?.outline))
    };
    let [Some(left), Some(erect), Some(right)] = FILMS.map(film) else { return None };
    let vertebrae = &erect.outline.vertebrae;
    let units = vertebrae.windows(2).filter_map(|pair| {
        let levels = [pair[0].level, pair[1].level];
        let of = |film| Unit::of(film, levels);
        Some((levels, [of(&left)?, of(&erect)?, of(&right)?]))
    });
    let most = |units: &[Unit; 3]| against_mm(units).into_iter().fold(f64::MIN, f64::max);
    let (levels, units) = units.max_by(|a, b| most(&a.1).total_cmp(&most(&b.1)))?;
    let [lower, upper] = levels;
    let title = format!("Endplate centres of {upper} and {lower}, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    let against = against_mm(&units).map(|mm| fixed(mm, 1));
    page.notes.push(format!(
        "{VIEW} On {lower}, the superior centre of {upper} moves against the left bend by {} mm and against the right bend by {} mm; \
         negative: with the bend. {lower}'s superior centre is at the origin.",
        against[0], against[1]
    ));
    page.entry(INFERIOR, "inferior centre");
    for posture in FILMS {
        page.entry(style(posture), format!("superior centre, {posture}"));
    }
    page.entry(BODY, "marked corners, every reading");
    page.rows = panels(&units, levels, page.inner_px());
    Some(page.into_svg())
}

fn style(posture: Posture) -> (Ink, Marker) {
    let (ink, shape) = posture_style(posture);
    (ink, Marker { radius_px: 4.5, ..Marker::new(shape, ink.colour, true) })
}

/// A row with the unit on each film, and a row relative to the lower vertebra with the direction of the force in each bend.
fn panels(units: &[Unit; 3], [lower, upper]: [Level; 2], row_px: f64) -> Vec<Vec<Panel>> {
    const ROOM_MM: [f64; 2] = [4.0, 4.0];
    let all = units.iter().flat_map(|unit| unit.corners.iter().flatten().copied());
    let extent = Extent::around(all).grown(ROOM_MM);
    let wide_px = row_px / 3.0 - 90.0;
    let px_per_mm = (TALL_PX / extent.height_mm()).min(wide_px / extent.width_mm());
    let on_film = |(posture, unit): (Posture, &Unit)| {
        let mut panel = frontal_panel(extent, px_per_mm, lower);
        panel.heading(HeadingKind::Title, posture.to_string());
        let outline = |[a, b, c, d]: [Frontal; 4]| panel.trace(BODY, [a, b, c, d, a].map(drawn));
        let bodies: Vec<_> = unit.corners.iter().copied().map(outline).collect();
        panel.layer("marked corners", bodies);
        unit.centres.iter().for_each(|&two| centres(&mut panel, posture, two));
        panel
    };
    let on_films: Vec<Panel> = FILMS.into_iter().zip(units).map(on_film).collect();
    let places = units.each_ref().map(Unit::upper_on_lower);
    let extent = Extent::around(places.into_iter().flatten()).grown([2.0 + FORCE_MM, 4.0]);
    let px_per_mm = (TALL_PX / extent.height_mm()).min(wide_px / extent.width_mm());
    let mut panel = frontal_panel(extent, px_per_mm, lower);
    panel.heading(HeadingKind::Title, format!("{upper} on {lower}; arrows: force of the bend"));
    let [_, [erect, _], _] = places;
    for (posture, side) in [(Posture::LeftBending, 1.0), (Posture::RightBending, -1.0)] {
        let end = erect + Frontal::new(side * FORCE_MM, 0.0);
        let [from, to] = [erect, end].map(|point| panel.place(point));
        panel.layer("force of the bend", arrow(style(posture).0, from, to));
    }
    for (posture, two) in FILMS.into_iter().zip(places) {
        centres(&mut panel, posture, two);
    }
    vec![on_films, vec![panel]]
}

/// The axis of a vertebra with the centres of its superior and inferior endplate.
fn centres(panel: &mut Panel, posture: Posture, [superior, inferior]: [Frontal; 2]) {
    let (ink, marker) = style(posture);
    panel.curves.push((ink, vec![drawn(inferior), drawn(superior)]));
    panel.points(INFERIOR, [drawn(inferior)]);
    panel.points(marker, [drawn(superior)]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use spineline::spatial::Angle;

    #[test]
    fn a_turn_of_the_upper_vertebra_counts_and_a_turn_of_both_does_not() {
        let up = |mm: f64| Frontal::new(0.0, mm);
        let unit = |turn_deg: f64, both_deg: f64| {
            let upper = [up(38.0), up(8.0)].map(|p| p.rotated(Angle::from_deg(turn_deg)));
            let centres = [[up(0.0), up(-30.0)], upper];
            let all = centres.map(|two| two.map(|p| p.rotated(Angle::from_deg(both_deg))));
            Unit { centres: all, corners: Vec::new() }
        };
        // Closed form: a positive turn is to the right, so that the superior centre moves by 38 mm times its sine.
        let moved_mm = |deg: f64| 38.0 * Angle::from_deg(deg).rad().sin();
        let [left, right] = against_mm(&[unit(5.0, -20.0), unit(0.0, 10.0), unit(3.0, 25.0)]);
        assert!((left - moved_mm(5.0)).abs() < 1e-9, "{left}");
        assert!((right + moved_mm(3.0)).abs() < 1e-9, "{right}");
    }
}
