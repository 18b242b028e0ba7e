//! `import` of an AASCE set: the verdict on every row of its landmarks.

use spineline::spatial::Angle;

use crate::define::{Column, Definition, Unit, count, places, text};
use crate::table::Table;

/// The verdict on one row of landmarks.
#[derive(Debug, Clone, PartialEq)]
pub struct RowVerdict {
    /// Line of the file.
    pub line: u64,
    /// Name that a case of this row has.
    pub case_id: String,
    /// The main angle of a row without faults, or the faults as one text.
    pub found: Result<Angle, String>,
}

/// One row per row of landmarks.
#[must_use]
pub fn verdicts_table(verdicts: &[RowVerdict]) -> Table {
    Definition { name: "verdicts", row: "row of the landmarks", columns: columns() }.fill(verdicts)
}

fn columns() -> Vec<Column<RowVerdict>> {
    vec![
        count("line", "line of `landmarks.csv`", |row| Some(row.line as i64)),
        text("case_id", "name that a case of this row has", |row| Some(row.case_id.clone())),
        text("verdict", "`clean`, or `faults`, for which no case is written", |row| {
            Some(if row.found.is_ok() { "clean" } else { "faults" }.to_owned())
        }),
        places(
            "main_angle",
            Unit::Degrees,
            "main angle: range of the tilts of the mean endplates from T1 to L5; empty where there are faults",
            4,
            |row| row.found.as_ref().ok().map(|angle| angle.deg()),
        ),
        text("faults", "faults of the row, with `; ` between them", |row| {
            row.found.as_ref().err().cloned()
        }),
    ]
}
