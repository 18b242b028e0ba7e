//! The check of films before any result.

use spineline::analysis::{Analysis, Case};
use spineline::error::Error;
use spineline::measure::Outline;
use spineline::number::fixed;
use spineline::warning::{Step, Warning};

use super::banners;
use super::measured::amplitude;
use crate::document::{Document, Section, Table};

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
        banners: banners(case.synthetic),
        ..Document::new("check of the films", &case.id, generator, vec![section])
    }
}

/// The films of a case with their scale and noise, one per row.
#[must_use]
pub fn films_table(analysis: &Analysis) -> Table {
    let levels = analysis.movement.levels();
    let measured = |film: &Outline, sd: String| {
        if film.noise.is_measured() { sd } else { sd + " assumed" }
    };
    Table::of("", analysis.movement.films.iter().map(|film| &film.outline), |add| {
        add.words("Film", |film| film.posture.to_string());
        add.numbers("Readings", |film| film.readings.to_string());
        add.numbers(format!("{}-{}", levels.base(), levels.top()), |film| {
            film.scale.text(film.polygon_mm(), 0)
        });
        add.words("Lateral tilt against the iliac normal", |film| amplitude(film));
        add.words("Location sd", |film| {
            measured(film, film.scale.residual_text(film.noise.location_mm))
        });
        add.words("Tilt sd (°)", |film| measured(film, fixed(film.noise.tilt.deg(), 2)));
        add.words(
            "Iliac crests",
            |film| {
                if film.iliac_normal.is_some() { "marked" } else { "none" }
            },
        );
        add.words("Lengths", |film| film.scale.to_string());
    })
}

/// Warnings about the films alone; warnings of the fits belong to the results.
pub fn film_warnings(analysis: &Analysis) -> impl Iterator<Item = &Warning> {
    analysis.warnings.all().iter().filter(|warning| warning.code.step() <= Step::Motion)
}
