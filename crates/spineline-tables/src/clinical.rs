use spineline::analysis::FilmMovement;
use spineline::anatomy::Posture;
use spineline::clinical::ClinicalCurve;
use spineline::spatial::Angle;

use crate::Patient;
use crate::define::{Columns, Row, keyed, rows};
use crate::table::Table;

/// A clinical curve on a film.
pub(crate) struct Measured<'a> {
    curve: &'a ClinicalCurve,
    posture: Posture,
}

impl Measured<'_> {
    fn angle(&self, all: &[(Posture, Angle)]) -> Option<f64> {
        all.iter().find(|(posture, _)| *posture == self.posture).map(|(_, angle)| angle.deg())
    }

    /// Values that are reported once, in the row of the erect film.
    fn erect(&self) -> Option<&ClinicalCurve> {
        (self.posture == Posture::Erect).then_some(self.curve)
    }
}

/// One row per patient, posture and region.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let movement = &patient.analysis.movement;
        let curves = move |film: &FilmMovement| {
            let posture = film.outline.posture;
            movement.clinical.iter().map(move |curve| Measured { curve, posture })
        };
        movement.films.iter().flat_map(curves)
    });
    let row = "patient × posture × region";
    keyed("clinical", row, &rows, columns_of_curves)
}

fn columns_of_curves(add: &mut Columns<'_, Row<'_, Measured<'_>>>) {
    add.text("posture", "film", |row| row.posture.key());
    add.text("region", "region of the spine", |row| row.curve.region.key());
    add.text("lower_end", "lower end vertebra, chosen on the erect film", |row| {
        row.curve.ends.inferior.to_string()
    });
    add.text("upper_end", "upper end vertebra, chosen on the erect film", |row| {
        row.curve.ends.superior.to_string()
    });
    add.text("apex", "vertebra at the apex of the erect curve", |row| row.curve.apex.to_string());
    add.text("convex", "the patient's side to which the erect curve is convex", |row| {
        row.curve.convex.map(|side| side.to_string())
    });
    add.number(
        "cobb_deg",
        "Cobb angle between endplates; positive where convex to the patient's left; empty where no corners are known",
        |row| row.curve.cobb_in(row.posture).map(Angle::deg),
    );
    add.number(
        "tilt_range_deg",
        "tilt of the upper minus tilt of the lower end vertebra; positive where convex to the patient's left",
        |row| Some(row.curve.angles_in(row.posture)?.tilt_range.deg()),
    );
    add.number(
        "ferguson_deg",
        "Ferguson angle; positive where convex to the patient's left",
        |row| row.angle(&row.curve.ferguson),
    );
    add.number(
        "apical_translation_mm",
        "distance of the apex from the central sacral vertical line on the erect film, positive to the patient's left; only in the row of the erect film",
        |row| {
                let region = row.erect()?.region;
                let balance = row.analysis.movement.balance.as_ref()?;
                row.analysis.movement.scale().mm(balance.apical_translation_mm[region.index()])
            },
    );
    add.number(
        "flexibility",
        "share of the erect Cobb angle (tilt range without corners) that the bend to the convex side corrects; only in the row of the erect film",
        |row| row.erect()?.flexibility,
    );
}
