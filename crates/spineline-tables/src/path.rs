//! `simulate`: the shapes on the path of equilibria.

use spineline::anatomy::Region;
use spineline::multibody::{ForceSign, PathPoint};
use spineline::response::{SpineAngles, direction_word};
use spineline::spatial::Angle;

use crate::define::{
    Column, Definition, Unit, count, element, grouped, number, text, truth, written,
};
use crate::table::{NumberFormat, Table};

/// One shape of a spine under loads.
#[derive(Debug, Clone)]
pub struct LoadedShape<'a> {
    /// Patient.
    pub case_id: &'a str,
    /// Whether the patient of the model is synthetic.
    pub synthetic: bool,
    /// Whether forces are in newtons.
    pub absolute: bool,
    /// How the search ended.
    pub status: &'static str,
    /// Whether the loads grow along or against themselves.
    pub sign: ForceSign,
    /// The shape and its place on the path.
    pub point: &'a PathPoint,
    /// The angles on a frontal film of the shape, with a curve per region.
    pub angles: SpineAngles,
}

/// One row per shape. Columns are named after the uppermost vertebra and the regions of the curves.
#[must_use]
pub fn path_table(top: &str, regions: &[Region], shapes: &[LoadedShape<'_>]) -> Table {
    let regions: Vec<&str> = regions.iter().map(|region| region.key()).collect();
    definition(top, &regions).fill(shapes)
}

/// The table for any vertebra and regions, without rows.
pub(crate) fn path_columns() -> Table {
    definition("<top>", &["<region>"]).fill(&[])
}

fn definition<'a>(top: &str, regions: &[&str]) -> Definition<LoadedShape<'a>> {
    let groups = [keys(), location(top), curves(regions), numerics()];
    grouped("path", "shape on the path of equilibria", groups)
}

fn keys<'a>() -> Vec<Column<LoadedShape<'a>>> {
    vec![
        text("case_id", "patient", |row| Some(row.case_id.to_owned())),
        truth("synthetic", "whether the patient of the model is synthetic", |row| {
            Some(row.synthetic)
        }),
        truth("absolute", "whether forces are in newtons; else they are relative", |row| {
            Some(row.absolute)
        }),
        text("status", "how the search ended; the same in every row", |row| {
            Some(row.status.to_owned())
        }),
        text("direction", "whether loads grow `along` or `against` themselves", |row| {
            Some(direction_word(row.sign).to_owned())
        }),
        text("timing", "which loads are varied", |row| Some(row.point.timing.key().to_owned())),
        number("factor", Unit::One, "factor of these loads", |row| Some(row.point.factor)),
        number("arc", Unit::Radians, "length of the path up to this shape", |row| {
            Some(row.point.arc_rad)
        }),
    ]
}

fn location<'a>(top: &str) -> Vec<Column<LoadedShape<'a>>> {
    let coordinate = |way: &str, index, meaning| {
        element(
            &format!("{top}_{way}"),
            Unit::Millimetres,
            meaning,
            index,
            |row: &LoadedShape<'a>, index| {
                row.point.deformed.midpoints_mm.last().map(|midpoint| midpoint[index])
            },
        )
    };
    vec![
        number(
            "lateral_tilt_right",
            Unit::Degrees,
            "lateral tilt of the line from the lowest to the uppermost vertebra; positive to the patient's right",
            |row| Some(row.angles.lateral_tilt.deg()),
        ),
        coordinate("anterior", 0, "place of the uppermost vertebra, positive to the front"),
        coordinate("left", 1, "the same, positive to the patient's left"),
        coordinate("cranial", 2, "the same, positive upwards"),
    ]
}

/// Every angle of all curves, before the next angle.
fn curves<'a>(regions: &[&str]) -> Vec<Column<LoadedShape<'a>>> {
    type Measure<'a> = fn(&LoadedShape<'a>, usize) -> Option<f64>;
    let cobb: Measure<'a> = |row, curve| row.angles.curves[curve].ends.cobb.map(Angle::deg);
    let tilt_range: Measure<'a> = |row, curve| Some(row.angles.curves[curve].ends.tilt_range.deg());
    let ferguson: Measure<'a> = |row, curve| Some(row.angles.curves[curve].ferguson.deg());
    let angles = [
        (
            "cobb",
            "Cobb angle between the end vertebrae of the erect film, positive where convex to the patient's left; empty where endplates are not known",
            cobb,
        ),
        (
            "tilt_range",
            "difference between the tilts of these vertebrae, of the same sign",
            tilt_range,
        ),
        ("ferguson", "Ferguson angle, of the same sign", ferguson),
    ];
    let columns = angles.into_iter().flat_map(|(angle, meaning, cell)| {
        regions.iter().enumerate().map(move |(curve, region)| {
            let name = format!("{angle}_{region}_convex_left");
            element(&name, Unit::Degrees, meaning, curve, cell)
        })
    });
    columns.collect()
}

fn numerics<'a>() -> Vec<Column<LoadedShape<'a>>> {
    vec![
        number("largest_hinge", Unit::Radians, "largest angle of a hinge", |row| {
            Some(row.point.deformed.largest_hinge_rad())
        }),
        written(
            NumberFormat::ShortestScientific,
            number(
                "residual",
                Unit::Radians,
                "largest difference between a hinge angle and the one of its moment",
                |row| Some(row.point.residual_rad),
            ),
        ),
        count("iterations", "Newton iterations", |row| Some(i64::from(row.point.iterations))),
    ]
}
