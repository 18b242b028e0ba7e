//! The check of films before any result.

use spineline::analysis::{Analysis, Case};
use spineline::error::Error;
use spineline::number::fixed;
use spineline::warning::{Step, Warning};

use super::banners;
use super::measured::amplitude;
use crate::document::{Column, Document, Section, Table};

/// A case for a notebook: its films with their scale and noise, and their warnings, or the error that stops its analysis.
#[must_use]
pub fn check(case: &Case, checked: Result<&Analysis, &Error>, generator: &str) -> Document {
    let mut section = Section::new("films", "");
    match checked {
        Ok(analysis) => {
            section.table(films_table(analysis));
            let mut warnings = film_warnings(analysis).peekable();
            if warnings.peek().is_none() {
                section.paragraph("These films have no warnings.");
            }
            warnings.for_each(|warning| section.notice(warning.into()));
        }
        Err(error) => {
            section.paragraph(format!("Error: {error}."));
            section.paragraph(format!("Help: {}.", error.help()));
        }
    }
    Document {
        title: "check of the films".to_owned(),
        subject: case.id.clone(),
        generator: generator.to_owned(),
        banners: banners(case.synthetic),
        sections: vec![section],
        analysis: String::new(),
    }
}

/// The films of a case with their scale and noise, one per row.
#[must_use]
pub fn films_table(analysis: &Analysis) -> Table {
    let levels = analysis.movement.levels();
    let columns = vec![
        Column::words("Film"),
        Column::numbers("Readings"),
        Column::numbers(format!("{}-{}", levels.base(), levels.top())),
        Column::words("Lateral tilt"),
        Column::words("Location sd"),
        Column::words("Tilt sd (°)"),
        Column::words("Iliac crests"),
        Column::words("Lengths"),
    ];
    let mut table = Table::new("", columns);
    for p in &analysis.movement.films {
        let outline = &p.outline;
        let assumed = if outline.noise.is_measured() { "" } else { " assumed" };
        table.row(vec![
            outline.posture.to_string(),
            outline.readings.to_string(),
            outline.scale.text(outline.polygon_mm(), 0),
            amplitude(outline),
            format!("{}{assumed}", outline.scale.residual_text(outline.noise.location_mm)),
            format!("{}{assumed}", fixed(outline.noise.tilt.deg(), 2)),
            if outline.iliac_normal.is_some() { "marked" } else { "none" }.to_owned(),
            outline.scale.to_string(),
        ]);
    }
    table
}

/// Warnings about the films alone; warnings of the fits belong to the results.
pub fn film_warnings(analysis: &Analysis) -> impl Iterator<Item = &Warning> {
    analysis.warnings.all().iter().filter(|warning| warning.code.step() <= Step::Motion)
}
