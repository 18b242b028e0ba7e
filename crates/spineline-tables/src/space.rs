//! The erect spine in space, from the erect and the lateral film.

use spineline::measure::{SpatialOutline, SpatialVertebra};
use spineline::spatial::Vec3;

use crate::Patient;
use crate::define::{Column, Row, Unit, keyed, number, text};
use crate::table::Table;

/// A vertebra on both films.
#[derive(Clone, Copy)]
pub(crate) struct InSpace<'a> {
    space: &'a SpatialOutline,
    vertebra: &'a SpatialVertebra,
}

type VertebraRow<'a> = Row<'a, InSpace<'a>>;

/// One row per patient and vertebra on both films; none without a lateral film.
pub(crate) fn vertebrae(patients: &[Patient<'_>]) -> Table {
    let mut rows: Vec<VertebraRow<'_>> = Vec::new();
    for patient in patients {
        let Some(space) = &patient.analysis.space else { continue };
        let vertebrae = space.vertebrae.iter();
        rows.extend(vertebrae.map(|vertebra| patient.row(InSpace { space, vertebra })));
    }
    let row = "patient × vertebra on the erect and the lateral film";
    keyed("space_vertebrae", row, [places(), angles()]).fill(&rows)
}

fn place_mm(row: &VertebraRow<'_>, part: fn(&Vec3) -> f64) -> Option<f64> {
    row.analysis.scale().mm(part(&row.item.vertebra.place_mm))
}

fn places<'a>() -> Vec<Column<VertebraRow<'a>>> {
    vec![
        text("level", "vertebra", |row| Some(row.item.vertebra.level.to_string())),
        number(
            "x_3d",
            Unit::Millimetres,
            "place from the lowest vertebra on both films, to the front, by the vertical of the films; empty where the erect film has no spacing",
            |row| place_mm(row, |place| place.x),
        ),
        number("y_3d", Unit::Millimetres, "the same to the patient's left", |row| {
            place_mm(row, |place| place.y)
        }),
        number("z_3d", Unit::Millimetres, "the same upwards", |row| place_mm(row, |place| place.z)),
    ]
}

fn angles<'a>() -> Vec<Column<VertebraRow<'a>>> {
    vec![
        number(
            "tilt_2d",
            Unit::Degrees,
            "tilt of the axis on the erect film, against its vertical; positive to the patient's right",
            |row| Some(row.item.vertebra.orientation.tilt.deg()),
        ),
        number("tilt_2d_sd", Unit::Degrees, "its standard deviation by the landmarks", |row| {
            Some(row.item.vertebra.tilt_sd.deg())
        }),
        number(
            "pitch_2d",
            Unit::Degrees,
            "angle of the axis from the vertical on the lateral film, with the turn of that film taken out; flexion positive",
            |row| Some(row.item.vertebra.lateral_pitch.deg()),
        ),
        number("pitch_3d", Unit::Degrees, "pitch of the axis in space; flexion positive", |row| {
            Some(row.item.vertebra.orientation.pitch.deg())
        }),
        number(
            "pitch_3d_sd",
            Unit::Degrees,
            "its standard deviation by the landmarks and the turn of the lateral film",
            |row| Some(row.item.space.pitch_sd(row.item.vertebra).deg()),
        ),
    ]
}
