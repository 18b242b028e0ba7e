//! `simulate`: the shapes on the path of equilibria.

use spineline::anatomy::Region;
use spineline::multibody::{ForceSign, PathPoint};
use spineline::response::{CurveAngles, SpineAngles};
use spineline::spatial::Angle;

use crate::define::{Columns, table};
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
    of_shapes(top, &regions, shapes)
}

pub(crate) fn of_shapes(top: &str, regions: &[&str], shapes: &[LoadedShape<'_>]) -> Table {
    table("path", "shape on the path of equilibria", shapes, |add| {
        keys(add);
        location(add, top);
        curves(add, regions);
        numerics(add);
    })
}

fn keys(add: &mut Columns<'_, LoadedShape<'_>>) {
    add.text("case_id", "patient", |row| row.case_id);
    add.truth("synthetic", "whether the patient of the model is synthetic", |row| row.synthetic);
    add.truth("absolute", "whether forces are in newtons; else they are relative", |row| {
        row.absolute
    });
    add.text("status", "how the search ended; the same in every row", |row| row.status);
    add.text("direction", "whether loads grow `along` or `against` themselves", |row| {
        row.sign.key()
    });
    add.text("timing", "which loads are varied", |row| row.point.timing.key());
    add.number("factor", "factor of these loads", |row| row.point.factor);
    add.number("arc_rad", "length of the path up to this shape", |row| row.point.arc_rad);
}

fn location(add: &mut Columns<'_, LoadedShape<'_>>, top: &str) {
    add.number(
        "lateral_tilt_right_deg",
        "lateral tilt of the line from the lowest to the uppermost vertebra against the lowest's axis; positive to the patient's right",
        |row| row.angles.lateral_tilt.deg(),
    );
    let ways = [
        ("anterior", "place of the uppermost vertebra, positive to the front"),
        ("left", "the same, positive to the patient's left"),
        ("cranial", "the same, positive upwards"),
    ];
    for (axis, (way, meaning)) in ways.into_iter().enumerate() {
        add.number(&format!("{top}_{way}_mm"), meaning, |row| {
            row.point.deformed.midpoints_mm.last().map(|midpoint| midpoint[axis])
        });
    }
}

/// Every angle of all curves, before the next angle.
fn curves(add: &mut Columns<'_, LoadedShape<'_>>, regions: &[&str]) {
    type Measure = fn(&CurveAngles) -> Option<Angle>;
    let angles: [(&str, &str, Measure); 3] = [
        (
            "cobb",
            "Cobb angle between the end vertebrae of the erect film, positive where convex to the patient's left; empty where endplates are not known",
            |curve| curve.ends.cobb,
        ),
        (
            "tilt_range",
            "difference between the tilts of these vertebrae, of the same sign",
            |curve| Some(curve.ends.tilt_range),
        ),
        ("ferguson", "Ferguson angle, of the same sign", |curve| Some(curve.ferguson)),
    ];
    for (angle, meaning, measure) in angles {
        for (curve, region) in regions.iter().enumerate() {
            let name = format!("{angle}_{region}_convex_left_deg");
            add.number(&name, meaning, |row| measure(&row.angles.curves[curve]).map(Angle::deg));
        }
    }
}

fn numerics(add: &mut Columns<'_, LoadedShape<'_>>) {
    add.number("largest_hinge_rad", "largest angle of a hinge", |row| {
        row.point.deformed.largest_hinge_rad()
    });
    add.number(
        "residual_rad",
        "largest difference between a hinge angle and the one of its moment",
        |row| row.point.residual_rad,
    )
    .format = NumberFormat::ShortestScientific;
    add.count("iterations", "Newton iterations", |row| row.point.iterations as usize);
}
