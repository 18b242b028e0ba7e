use spineline::action::LineKind;
use spineline::analysis::FilmMovement;
use spineline::measure::FilmLength;
use spineline::spatial::Angle;

use crate::Patient;
use crate::define::{Columns, ENDS_95, LENGTHS, Row, keyed, rows};
use crate::table::Table;

type PostureRow<'a> = Row<'a, &'a FilmMovement>;

/// One row per patient and posture.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| &patient.analysis.movement.films);
    keyed("postures", "patient × posture", &rows, |add| {
        film(add);
        curve(add);
        film_scale(add);
        movement(add);
        own_line(add);
    })
}

fn film(add: &mut Columns<'_, PostureRow<'_>>) {
    add.text("posture", "film", |row| row.outline.posture.key());
    add.text("lengths", LENGTHS, |row| row.outline.scale.plane.key());
    add.text(
        "doubted",
        "codes of the warnings that doubt this film, with spaces between them; empty without any",
        |row| {
            let posture = Some(row.outline.posture);
            let doubts = row.analysis.film_doubts();
            let codes: Vec<&str> =
                doubts.filter(|one| one.posture == posture).map(|one| one.code.key()).collect();
            (!codes.is_empty()).then(|| codes.join(" "))
        },
    );
    add.count("readings", "readings of the film", |row| row.outline.readings);
    add.number(
        "spine_mm",
        "length of the polygon through the midpoints from the base to the top",
        |row| row.outline.scale.mm(row.outline.polygon_mm()),
    );
    add.number(
        "amplitude_deg",
        "lateral tilt of the line between two vertebrae against the normal of the iliac line, or without iliac crests against the axis of the lowest vertebra of the model; positive to the patient's right",
        |row| row.outline.amplitude().deg(),
    );
    add.text("amplitude_between", "vertebrae of the amplitude, the lower one first", |row| {
        row.outline.amplitude_levels().map(|level| level.to_string()).join("/")
    });
    add.number("noise_location_mm", "standard deviation of a coordinate of a location", |row| {
        row.outline.scale.mm(row.outline.noise.location_mm)
    });
    add.number("noise_tilt_deg", "standard deviation of a tilt", |row| {
        row.outline.noise.tilt.deg()
    });
    add.truth(
        "noise_measured",
        "whether these standard deviations come from repeated readings; else they are assumed",
        |row| row.outline.noise.is_measured(),
    );
}

fn curve(add: &mut Columns<'_, PostureRow<'_>>) {
    add.count("curve_order", "order of the curve's polynomial", |row| row.fit.order);
    add.text("curve_form", "`graph` (y of z) or `parametric`", |row| row.fit.curve.form().key());
    add.number(
        "curve_rmse_mm",
        "root mean square distance of the curve from the locations",
        |row| row.outline.scale.mm(row.fit.rmse_mm),
    );
    add.number("curve_rmse_px", "the same where the film has no spacing", |row| {
        row.outline.scale.px(row.fit.rmse_mm)
    });
    add.number(
        "curve_rmse_deg",
        "root mean square difference between the tilt of the curve and the measured tilts",
        |row| row.fit.rmse_tilt.deg(),
    );
    add.count("segments", "number of segments of the chain on this curve (n_i)", |row| {
        row.pose.segments()
    });
}

fn length(row: &PostureRow<'_>) -> Option<FilmLength> {
    let scales = [&row.outline.scale, row.analysis.movement.scale()];
    let is_known = row.motion.is_some() && scales.iter().all(|scale| scale.has_millimetres());
    is_known.then_some(row.outline.length)
}

/// The film's length against the erect one, where both have a spacing.
fn film_scale(add: &mut Columns<'_, PostureRow<'_>>) {
    add.number(
        "film_scale_measured",
        "length of the spine on this film over its length on the erect film, from the locations alone",
        |row| length(row).map(|length| length.measured.factor),
    );
    add.number(
        "film_scale",
        "the same with its prior; locations are divided by it. 1 where the scale is fixed",
        |row| length(row).map(|length| length.scale.factor),
    );
    add.interval(["film_scale_95_low", "film_scale_95_high"], ENDS_95, |row| {
        length(row).filter(FilmLength::is_free).map(|length| length.scale.interval_95())
    });
}

fn movement(add: &mut Columns<'_, PostureRow<'_>>) {
    add.number(
        "mean_rotation_deg",
        "mean rotation of the segments from the erect posture",
        |row| row.mean_rotation().map(Angle::deg),
    );
    let of_end = [
        (
            "caudal_inflection",
            "distance from the segment of the caudal inflection to the least-rotating segment",
            "rotation of the segment of the caudal inflection",
        ),
        (
            "cranial_inflection",
            "distance from the segment of the cranial inflection to the least-rotating segment",
            "rotation of the segment of the cranial inflection",
        ),
    ];
    for (end, (name, distance, rotation)) in of_end.into_iter().enumerate() {
        let estimate = |row: &PostureRow<'_>| row.inflection_estimates.map(|pair| pair[end]);
        add.number(&format!("{name}_to_least_segments"), distance, |row| {
            estimate(row).map(|found| found.distance_segments as f64)
        });
        add.number(&format!("{name}_to_least_mm"), "the same along the erect curve", |row| {
            row.analysis.movement.scale().mm(estimate(row)?.distance_mm)
        });
        add.number(&format!("{name}_rotation_deg"), rotation, |row| {
            estimate(row).map(|found| found.rotation.deg())
        });
    }
}

fn own_line(add: &mut Columns<'_, PostureRow<'_>>) {
    add.number(
        "best_fit_line_lateral_tilt_deg",
        "lateral tilt of the line of best fit to the rotations; positive to the patient's right",
        |row| row.best_fit_line.as_ref().map(|own| own.line.lateral_tilt().deg()),
    );
    add.number(
        "better_than_inflection_line_deg",
        "angle between this line and the inflection line",
        |row| row.line_comparison(LineKind::Inflection).map(|found| found.angle.deg()),
    );
    add.number(
        "better_than_inflection_line_mm",
        "distance of this line from the midpoint of the inflections",
        |row| row.line_comparison(LineKind::Inflection).map(|found| found.distance_mm),
    );
    add.number(
        "p_through_inflections",
        "p value of the hypothesis that this line runs through both inflections",
        |row| row.line_comparison(LineKind::Inflection).map(|found| found.test.p_value),
    );
    add.number(
        "p_parallel_to_iliac_line",
        "p value of the hypothesis that this line is parallel to the iliac line",
        |row| row.line_comparison(LineKind::Iliac).map(|found| found.test.p_value),
    );
    add.number(
        "p_given_line",
        "p value of the hypothesis that this line is the given line",
        |row| row.line_comparison(LineKind::Given).map(|found| found.test.p_value),
    );
}
