//! `analyze --chain`: the Denavit-Hartenberg table of every chain.

use spineline::analysis::{Analysis, FilmMovement};
use spineline::chain::DenavitHartenberg;
use spineline::spatial::Frontal;

use crate::define::{Columns, LENGTHS, Row, keyed};
use crate::table::{NumberFormat::Places, Table};

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
    keyed("chain", "patient × posture × segment", &rows, |add| {
        columns_of_segments(add);
        add.refused();
    })
}

fn columns_of_segments(add: &mut Columns<'_, SegmentRow<'_>>) {
    add.text("posture", "film", |row| row.posture.outline.posture.key());
    add.count("segment", "number of the segment; 0 is the most caudal one", |row| row.index);
    add.number("a_mm", "link length", |row| row.mm(row.row.a_mm)).format = Places(9);
    add.number("alpha_deg", "link twist", |row| row.row.alpha.deg());
    add.number("d_mm", "link offset", |row| row.mm(row.row.d_mm)).format = Places(0);
    add.number("theta_deg", "joint variable", |row| row.row.theta.deg()).format = Places(9);
    add.number(
        "joint_y_mm",
        "joint at the caudal end of the segment, relative to the midpoint of the base; positive to the patient's left",
        |row| row.mm(row.joint.y_mm),
    )
    .format = Places(6);
    add.number("joint_z_mm", "the same, positive upwards", |row| row.mm(row.joint.z_mm)).format =
        Places(6);
    add.text("lengths", LENGTHS, |row| row.posture.outline.scale.plane.key());
}
