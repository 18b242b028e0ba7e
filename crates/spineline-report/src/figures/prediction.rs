//! Bends that were left out of the fit: measured, predicted by the best line, and predicted without mechanics.

use spineline::analysis::{Analysis, ComparedFilm, FilmBands, FilmPredictor};
use spineline::evaluate::Band;
use spineline::number::fixed;
use spineline::spatial::Frontal;

use super::frontal::{Extent, VIEW, drawn, extent_words, frame_px, frontal_panel};
use super::page::{Page, Sample};
use super::panel::HeadingKind;
use super::spines::MEASURED;
use super::style::{GREY, Ink, Marker, SKY, Shape, action_ink};
use crate::phrases::sentence_case;

/// Of the 95 % band: lines stay readable over it.
const BAND_OPACITY: f64 = 0.45;
/// Tallest frame; the picture stands on the first page.
const TALL_PX: f64 = 300.0;

/// One panel per film of the ranking of the lines. `None` where no film was predicted.
#[must_use]
pub fn predictions(analysis: &Analysis) -> Option<String> {
    let compared = analysis.comparison();
    let bands = analysis.bands();
    let ranking = compared.ranking()?;
    let kind = ranking.best().0;
    let line = compared.lines.iter().position(|one| one.kind == kind)?;
    let films: Vec<(&ComparedFilm, &FilmBands)> =
        ranking.films.iter().map(|&film| (&compared.films[film], &bands.films[film])).collect();
    let baseline = ranking.baseline.map(|(baseline, _)| baseline);
    let what = sentence_case(ranking.role.films_words());
    let title = format!("{what}, measured and predicted, case {}", analysis.case_id);
    let mut page = Page::new(title, analysis.synthetic);
    page.notes.push(format!("{VIEW} Circles: vertebra midpoints, {}.", extent_words(analysis)));
    let ink = Ink::new(action_ink(kind).colour, "", 1.6);
    let filled = Marker { radius_px: 2.4, ..Marker::new(Shape::Circle, ink.colour, true) };
    let dotted = Ink::new(GREY, "2 3", 1.4);
    page.entry(MEASURED, "measured");
    page.entry((ink, filled), format!("predicted, {kind}"));
    page.entry(Sample::Fill(SKY), format!("95 % band, {kind}"));
    if let Some(baseline) = baseline {
        page.entry(dotted, format!("without mechanics: {baseline}"));
    }
    let measured = |film: &ComparedFilm| -> Vec<Frontal> {
        let posture = analysis.movement.film(film.posture);
        posture.map(|p| p.outline.locations().collect()).unwrap_or_default()
    };
    let extent = Extent::of(films.iter().flat_map(|(film, _)| measured(film)));
    let axes: Vec<bool> = (0..films.len()).map(|i| i == 0).collect();
    // One film alone is as wide as one of two.
    let cell_px = frame_px(page.inner_px(), &axes, films.len().max(2));
    let px_per_mm = (TALL_PX / extent.height_mm()).min(cell_px / extent.width_mm());
    let extent = extent.at_least_wide(cell_px / px_per_mm);
    let mut panels = Vec::new();
    for (film, bands) in films {
        let mut panel = frontal_panel(extent, px_per_mm, analysis.movement.levels().base());
        panel.y_written = panels.is_empty();
        panel.heading(HeadingKind::Title, film.posture.to_string());
        let simulation = film.simulations[line].as_ref()?;
        let without = baseline.and_then(|one| film.baseline(one));
        let mm = format!("{kind} {} mm", fixed(simulation.shape.mean_location_error_mm(), 1));
        panel.heading(HeadingKind::Plain, mm);
        if let Some(band) = bands.band(FilmPredictor::Line(kind)) {
            let radius = format!("95 % band ± {} mm", fixed(band.mean_radius_mm(), 1));
            panel.heading(HeadingKind::Plain, radius);
            panel.area(SKY, BAND_OPACITY, outline(&simulation.shape.locations, band));
        }
        let points = measured(film);
        panel.end_levels(&points, analysis.movement.levels());
        panel.spine(&points, MEASURED.0, Marker { radius_px: 4.4, ..MEASURED.1 });
        if let Some(without) = without {
            panel.spine(&without.shape.locations, dotted, Marker { radius_px: 0.1, ..filled });
        }
        panel.spine(&simulation.shape.locations, ink, filled);
        panels.push(panel);
    }
    page.rows.push(panels);
    Some(page.into_svg())
}

/// The outline of the 95 % band to both sides of a predicted spine.
fn outline(locations: &[Frontal], band: &Band) -> Vec<(f64, f64)> {
    let radii = std::iter::once(0.0).chain(band.radii_mm.iter().copied());
    let half_widths: Vec<(Frontal, f64)> = locations.iter().copied().zip(radii).collect();
    let left = half_widths.iter().map(|&(at, mm)| at + Frontal::new(mm, 0.0));
    let right = half_widths.iter().rev().map(|&(at, mm)| at - Frontal::new(mm, 0.0));
    left.chain(right).map(drawn).collect()
}
