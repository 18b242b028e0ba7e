//! Films that were predicted and not fitted, vertebra by vertebra.

use spineline::analysis::{Analysis, FilmRole};
use spineline::anatomy::{Level, Posture};
use spineline::evaluate::Band;
use spineline::spatial::Frontal;

use crate::Patient;
use crate::define::{Columns, Row, keyed, rows};
use crate::table::Table;

/// A vertebra of a predicted film.
struct Predicted {
    posture: Posture,
    role: FilmRole,
    method: String,
    level: Level,
    location: Frontal,
    error_mm: f64,
    radius_mm: f64,
}

/// One row per patient, predicted film, method and vertebra that the film shows.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| vertebrae(patient.analysis));
    let row = "patient × predicted film × role × method × vertebra that the film shows";
    keyed("predictions", row, &rows, columns)
}

fn vertebrae(analysis: &Analysis) -> Vec<Predicted> {
    let bands = analysis.bands();
    let compared = analysis.comparison();
    let mut all = Vec::new();
    for (film, bands) in compared.films.iter().zip(&bands.films) {
        let Some(measured) = analysis.movement.film(film.posture) else { continue };
        for (by, band) in &bands.bands {
            let Some(shape) = compared.shape(film, *by) else { continue };
            let shown = measured.outline.measured().skip(1).zip(&shape.location_errors_mm);
            all.extend(shown.map(|((i, vertebra), &error_mm)| Predicted {
                posture: film.posture,
                role: film.role,
                method: by.key(),
                level: vertebra.level,
                location: shape.locations[i],
                error_mm,
                radius_mm: band.radii_mm[i - 1],
            }));
        }
    }
    all
}

fn columns(add: &mut Columns<'_, Row<'_, Predicted>>) {
    add.text("posture", "film", |row| row.posture.key());
    add.text(
        "role",
        "`left_out_bend`: stiffness from the other bend; `held_out`: a neutral or traction film",
        |row| row.role.key(),
    );
    add.text(
        "method",
        "line of action, from T2's location or (`…_with_tilt`) its location and tilt, or prediction without mechanics",
        |row| row.method.clone(),
    );
    add.text("level", "vertebra", |row| row.level.to_string());
    add.number("predicted_y_mm", "predicted midpoint, positive to the patient's left", |row| {
        row.location.y_mm
    });
    add.number("predicted_z_mm", "its height", |row| row.location.z_mm);
    add.number(
        "location_error_mm",
        "distance of the predicted midpoint from the measured one",
        |row| row.error_mm,
    );
    add.number(
        "band_95_radius_mm",
        "radius about the predicted midpoint that holds the vertebra on 95 % of films",
        |row| row.radius_mm,
    );
    add.number(
        "band_95_film_radius_mm",
        "the same radius for all vertebrae of a film together",
        |row| Band::WHOLE_FILM * row.radius_mm,
    );
}
