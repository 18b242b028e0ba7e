use spineline::action::LineKind;
use spineline::analysis::FilmMovement;
use spineline::curve::CurveForm;
use spineline::measure::FilmLength;
use spineline::spatial::Angle;

use crate::Patient;
use crate::define::{Column, LENGTHS, Row, Unit, count, keyed, number, text, truth};
use crate::table::Table;

type PostureRow<'a> = Row<'a, &'a FilmMovement>;

/// One row per patient and posture.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows: Vec<PostureRow<'_>> = patients
        .iter()
        .flat_map(|patient| patient.analysis.movement.films.iter().map(|item| patient.row(item)))
        .collect();
    keyed("postures", "patient × posture", [film(), curve(), film_scale(), movement(), own_line()])
        .fill(&rows)
}

fn film<'a>() -> Vec<Column<PostureRow<'a>>> {
    vec![
        text("posture", "film", |row| Some(row.item.outline.posture.key().to_owned())),
        text("lengths", LENGTHS, |row| Some(row.item.outline.scale.plane.key().to_owned())),
        text(
            "doubted",
            "codes of the warnings that doubt this film, with spaces between them; empty without any",
            |row| {
                let posture = Some(row.item.outline.posture);
                let doubts = row.analysis.film_doubts();
                let codes: Vec<&str> =
                    doubts.filter(|one| one.posture == posture).map(|one| one.code.key()).collect();
                (!codes.is_empty()).then(|| codes.join(" "))
            },
        ),
        count("readings", "readings of the film", |row| Some(row.item.outline.readings as i64)),
        number(
            "spine",
            Unit::Millimetres,
            "length of the polygon through the midpoints from the base to the top",
            |row| row.item.outline.scale.mm(row.item.outline.polygon_mm()),
        ),
        number(
            "amplitude",
            Unit::Degrees,
            "lateral tilt of the line from the base to the top; positive to the patient's right",
            |row| Some(row.item.outline.amplitude().deg()),
        ),
        number(
            "noise_location",
            Unit::Millimetres,
            "standard deviation of a coordinate of a location",
            |row| row.item.outline.scale.mm(row.item.outline.noise.location_mm),
        ),
        number("noise_tilt", Unit::Degrees, "standard deviation of a tilt", |row| {
            Some(row.item.outline.noise.tilt.deg())
        }),
        truth(
            "noise_measured",
            "whether these standard deviations come from repeated readings; else they are assumed",
            |row| Some(row.item.outline.noise.is_measured()),
        ),
    ]
}

fn curve<'a>() -> Vec<Column<PostureRow<'a>>> {
    vec![
        count("curve_order", "order of the curve's polynomial", |row| {
            Some(row.item.fit.order as i64)
        }),
        text("curve_form", "`graph` (y of z) or `parametric`", |row| {
            Some(
                match row.item.fit.curve.form() {
                    CurveForm::Graph => "graph",
                    CurveForm::Parametric => "parametric",
                }
                .to_owned(),
            )
        }),
        number(
            "curve_rmse",
            Unit::Millimetres,
            "root mean square distance of the curve from the locations",
            |row| row.item.outline.scale.mm(row.item.fit.rmse_mm),
        ),
        number("curve_rmse", Unit::Pixels, "the same where the film has no spacing", |row| {
            row.item.outline.scale.px(row.item.fit.rmse_mm)
        }),
        number(
            "curve_rmse",
            Unit::Degrees,
            "root mean square difference between the tilt of the curve and the measured tilts",
            |row| Some(row.item.fit.rmse_tilt.deg()),
        ),
        count("segments", "number of segments of the chain on this curve (n_i)", |row| {
            Some(row.item.pose.segments() as i64)
        }),
    ]
}

fn length(row: &PostureRow<'_>) -> Option<FilmLength> {
    row.item.motion.is_some().then_some(row.item.outline.length)
}

fn scale_95(row: &PostureRow<'_>, end: usize) -> Option<f64> {
    length(row).filter(FilmLength::is_free).map(|length| length.scale.interval_95()[end])
}

/// The film's length against the erect one.
fn film_scale<'a>() -> Vec<Column<PostureRow<'a>>> {
    vec![
        number(
            "film_scale_measured",
            Unit::One,
            "length of the spine on this film over its length on the erect film, from the locations alone",
            |row| length(row).map(|length| length.measured.factor),
        ),
        number(
            "film_scale",
            Unit::One,
            "the same with its prior; locations are divided by it. 1 where the scale is fixed",
            |row| length(row).map(|length| length.scale.factor),
        ),
        number("film_scale_95_low", Unit::One, "lower end of its 95 % interval", |row| {
            scale_95(row, 0)
        }),
        number("film_scale_95_high", Unit::One, "upper end of its 95 % interval", |row| {
            scale_95(row, 1)
        }),
    ]
}

fn distance(row: &PostureRow<'_>, end: usize) -> Option<f64> {
    row.item.inflection_estimates.map(|pair| pair[end].distance_segments as f64)
}

fn distance_mm(row: &PostureRow<'_>, end: usize) -> Option<f64> {
    let pair = row.item.inflection_estimates?;
    row.analysis.movement.scale().mm(pair[end].distance_mm)
}

fn rotation(row: &PostureRow<'_>, end: usize) -> Option<f64> {
    row.item.inflection_estimates.map(|pair| pair[end].rotation.deg())
}

fn movement<'a>() -> Vec<Column<PostureRow<'a>>> {
    vec![
        number(
            "mean_rotation",
            Unit::Degrees,
            "mean rotation of the segments from the erect posture",
            |row| row.item.mean_rotation().map(Angle::deg),
        ),
        number(
            "caudal_inflection_to_least",
            Unit::Segments,
            "distance from the segment of the caudal inflection to the least-rotating segment",
            |row| distance(row, 0),
        ),
        number(
            "caudal_inflection_to_least",
            Unit::Millimetres,
            "the same along the erect curve",
            |row| distance_mm(row, 0),
        ),
        number(
            "caudal_inflection_rotation",
            Unit::Degrees,
            "rotation of the segment of the caudal inflection",
            |row| rotation(row, 0),
        ),
        number(
            "cranial_inflection_to_least",
            Unit::Segments,
            "distance from the segment of the cranial inflection to the least-rotating segment",
            |row| distance(row, 1),
        ),
        number(
            "cranial_inflection_to_least",
            Unit::Millimetres,
            "the same along the erect curve",
            |row| distance_mm(row, 1),
        ),
        number(
            "cranial_inflection_rotation",
            Unit::Degrees,
            "rotation of the segment of the cranial inflection",
            |row| rotation(row, 1),
        ),
    ]
}

fn own_line<'a>() -> Vec<Column<PostureRow<'a>>> {
    vec![
        number(
            "preferred_line_lateral_tilt",
            Unit::Degrees,
            "lateral tilt of the line of best fit to the rotations; positive to the patient's right",
            |row| row.item.preferred_line.as_ref().map(|own| own.line.lateral_tilt().deg()),
        ),
        number(
            "preferred_to_inflection_line",
            Unit::Degrees,
            "angle between this line and the inflection line",
            |row| row.item.line_comparison(LineKind::Inflection).map(|found| found.angle.deg()),
        ),
        number(
            "preferred_to_inflection_line",
            Unit::Millimetres,
            "distance of this line from the midpoint of the inflections",
            |row| row.item.line_comparison(LineKind::Inflection).map(|found| found.distance_mm),
        ),
        number(
            "p_through_inflections",
            Unit::One,
            "p value of the hypothesis that this line runs through both inflections",
            |row| row.item.line_comparison(LineKind::Inflection).map(|found| found.test.p_value),
        ),
        number(
            "p_parallel_to_iliac_line",
            Unit::One,
            "p value of the hypothesis that this line is parallel to the iliac line",
            |row| row.item.line_comparison(LineKind::Iliac).map(|found| found.test.p_value),
        ),
        number(
            "p_given_line",
            Unit::One,
            "p value of the hypothesis that this line is the given line",
            |row| row.item.line_comparison(LineKind::Given).map(|found| found.test.p_value),
        ),
    ]
}
