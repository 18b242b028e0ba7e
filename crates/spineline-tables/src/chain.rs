//! `analyze --chain`: the Denavit-Hartenberg table of every chain.

use spineline::analysis::{Analysis, FilmMovement};
use spineline::chain::DenavitHartenberg;
use spineline::spatial::Frontal;

use crate::define::{Column, LENGTHS, Row, Unit, count, keyed, number, places, refused, text};
use crate::table::Table;

/// A segment of a chain.
struct Segment<'a> {
    posture: &'a FilmMovement,
    index: usize,
    row: DenavitHartenberg,
    joint: Frontal,
}

impl Segment<'_> {
    fn mm(&self, length_mm: f64) -> Option<f64> {
        self.posture.outline.scale.mm(length_mm)
    }
}

type SegmentRow<'a> = Row<'a, Segment<'a>>;

/// One row per patient, posture and segment: the Denavit-Hartenberg table of the chain, and where its joints lie.
#[must_use]
pub fn chain_table(analyses: &[Analysis]) -> Table {
    let mut rows: Vec<SegmentRow<'_>> = Vec::new();
    for analysis in analyses {
        for posture in &analysis.movement.films {
            let table = posture.pose.to_denavit_hartenberg(&analysis.movement.chain);
            let segments = table.into_iter().zip(&posture.pose.joints).enumerate();
            rows.extend(segments.map(|(index, (row, &joint))| Row {
                analysis,
                item: Segment { posture, index, row, joint },
            }));
        }
    }
    keyed("chain", "patient × posture × segment", [columns_of_segments(), vec![refused()]])
        .fill(&rows)
}

fn columns_of_segments<'a>() -> Vec<Column<SegmentRow<'a>>> {
    let mm = Unit::Millimetres;
    vec![
        text("posture", "film", |row| Some(row.item.posture.outline.posture.key().to_owned())),
        count("segment", "number of the segment; 0 is the most caudal one", |row| {
            Some(row.item.index as i64)
        }),
        places("a", mm, "link length", 9, |row| row.item.mm(row.item.row.a_mm)),
        number("alpha", Unit::Degrees, "link twist", |row| Some(row.item.row.alpha.deg())),
        places("d", mm, "link offset", 0, |row| row.item.mm(row.item.row.d_mm)),
        places("theta", Unit::Degrees, "joint variable", 9, |row| Some(row.item.row.theta.deg())),
        places(
            "joint_y",
            mm,
            "joint at the caudal end of the segment, relative to the midpoint of the base; positive to the patient's left",
            6,
            |row| row.item.mm(row.item.joint.y_mm),
        ),
        places("joint_z", mm, "the same, positive upwards", 6, |row| {
            row.item.mm(row.item.joint.z_mm)
        }),
        text("lengths", LENGTHS, |row| Some(row.item.posture.outline.scale.plane.key().to_owned())),
    ]
}
