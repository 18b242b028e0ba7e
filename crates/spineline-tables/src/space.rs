//! The erect spine in space, from the erect and the lateral film.

use spineline::clinical::SpatialNumber;
use spineline::measure::{AxialRotation, SpatialOutline, SpatialVertebra};
use spineline::spatial::{Angle, Vec3};

use crate::Patient;
use crate::define::{Columns, ENDS_95, Row, STATED, keyed, rows};
use crate::table::Table;

/// A vertebra on both films.
#[derive(Clone, Copy)]
pub(crate) struct InSpace<'a> {
    space: &'a SpatialOutline,
    vertebra: &'a SpatialVertebra,
    /// Its pitch in a model without the lateral film.
    template: Option<Angle>,
}

type VertebraRow<'a> = Row<'a, InSpace<'a>>;

/// One row per patient and vertebra on both films; empty without a lateral film.
pub(crate) fn vertebrae(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let Some(space) = &patient.analysis.movement.space else { return Vec::new() };
        let error = patient.analysis.template_error();
        let vertebrae = space.vertebrae.iter().map(|vertebra| {
            let mut known = error.iter().flat_map(|error| &error.vertebrae);
            let template = known.find(|v| v.level == vertebra.level).map(|v| v.template);
            InSpace { space, vertebra, template }
        });
        vertebrae.collect()
    });
    let row = "patient × vertebra on the erect and the lateral film";
    keyed("space_vertebrae", row, &rows, |add| {
        places(add);
        angles(add);
    })
}

/// One row per patient and number of the spine in space.
pub(crate) fn measures(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| {
        let movement = &patient.analysis.movement;
        let found = movement.spatial_measures();
        found.map(|found| found.numbers(movement.scale())).into_iter().flatten()
    });
    keyed("space_measures", "patient × number of the spine in space", &rows, numbers)
}

fn numbers(add: &mut Columns<'_, Row<'_, SpatialNumber>>) {
    add.unit = STATED;
    add.text(
        "quantity",
        "kyphosis or lordosis by `endplates` or `axes`; `curve_frontal`, `curve_lateral`, `curve_largest` (in the plane of maximum curvature) and `curve_convexity` (0 front, 90 left, 180 back) by axes; `spinal_length`",
        |row| row.key,
    );
    add.text("between", "vertebrae between which it is measured, the upper one first", |row| {
        row.between.clone()
    });
    add.text("region", "region of a curve", |row| row.region.map(|region| region.key()));
    add.text("dimension", "`2-D` on one film, `3-D` in space", |row| row.dimension.key());
    add.text("unit", "`deg`, `mm`, or `px` where the erect film has no spacing", |row| row.unit);
    add.number("value", "its value", |row| row.value);
    add.number(
        "sd",
        "its standard deviation by the landmarks and the alignment of the lateral film",
        |row| row.sd,
    );
    add.interval(["interval_95_low", "interval_95_high"], ENDS_95, |row| Some(row.interval_95()));
}

fn place_mm(row: &VertebraRow<'_>, part: fn(&Vec3) -> f64) -> Option<f64> {
    row.analysis.movement.scale().mm(part(&row.vertebra.place_mm))
}

fn places(add: &mut Columns<'_, VertebraRow<'_>>) {
    add.text("level", "vertebra", |row| row.vertebra.level.to_string());
    add.number(
        "x_3d_mm",
        "place from the lowest vertebra on both films, to the front, by the vertical of the films; empty where the erect film has no spacing",
        |row| place_mm(row, |place| place.x),
    );
    add.number("y_3d_mm", "the same to the patient's left", |row| place_mm(row, |place| place.y));
    add.number("z_3d_mm", "the same upwards", |row| place_mm(row, |place| place.z));
}

fn angles(add: &mut Columns<'_, VertebraRow<'_>>) {
    add.number(
        "tilt_2d_deg",
        "tilt of the axis on the erect film, against its vertical; positive to the patient's right",
        |row| row.vertebra.orientation.tilt.deg(),
    );
    add.number("tilt_2d_sd_deg", "its standard deviation by the landmarks", |row| {
        row.vertebra.tilt_sd.deg()
    });
    add.number(
        "pitch_2d_deg",
        "angle of the axis from the vertical on the lateral film, corrected for the turn of that film; flexion positive",
        |row| row.vertebra.lateral_pitch.deg(),
    );
    add.number("pitch_3d_deg", "pitch of the axis in space; flexion positive", |row| {
        row.vertebra.orientation.pitch.deg()
    });
    add.number(
        "pitch_3d_sd_deg",
        "its standard deviation by the landmarks and the turn of the lateral film",
        |row| row.space.pitch_sd(row.vertebra).deg(),
    );
    add.number(
        "pitch_template_deg",
        "pitch by the profile of a population, as in a model without the lateral film; empty for vertebrae outside of the model",
        |row| row.template.map(Angle::deg),
    );
}

/// One row per patient and vertebra whose pedicles are marked.
pub(crate) fn axial(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| &patient.analysis.movement.axial);
    let row = "patient × vertebra whose pedicles are marked on the erect film";
    keyed("axial_rotation", row, &rows, rotations)
}

fn rotations(add: &mut Columns<'_, Row<'_, &AxialRotation>>) {
    add.text("level", "vertebra", |row| row.level.to_string());
    add.number(
        "axial_3d_deg",
        "axial rotation by the distance between the pedicles (Stokes); positive where the front of the vertebra turns to the patient's left",
        |row| row.stokes.deg(),
    );
    add.number(
        "axial_3d_sd_deg",
        "its standard deviation by the landmarks and by how vertebrae differ between people",
        |row| row.sd.deg(),
    );
    add.number(
        "drerup_deg",
        "the same by the width of the body (Drerup); empty where the pedicles lie too far out for it",
        |row| row.drerup.map(Angle::deg),
    );
    add.text("nash_moe", "grade of Nash and Moe, `0` to `IV`", |row| row.grade.key());
    add.count("readings", "number of readings that marked both pedicles", |row| row.readings);
}
