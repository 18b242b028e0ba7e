//! `import` of an AASCE set: the verdict on every row of its landmarks.

use spineline::spatial::Angle;

use crate::define::{Columns, table};
use crate::table::{NumberFormat::Places, Table};

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
    table("verdicts", "row of the landmarks", verdicts, columns)
}

fn columns(add: &mut Columns<'_, RowVerdict>) {
    add.count("line", "line of `landmarks.csv`", |row| row.line as usize);
    add.text("case_id", "name that a case of this row has", |row| row.case_id.clone());
    add.text("verdict", "`clean`, or `faults`, for which no case is written", |row| {
        if row.found.is_ok() { "clean" } else { "faults" }
    });
    add.number(
        "main_angle_deg",
        "main angle: range of the tilts of the mean endplates from T1 to L5; empty where there are faults",
        |row| row.found.as_ref().ok().map(|angle| angle.deg()),
    )
    .format = Places(4);
    add.text("faults", "faults of the row, with `; ` between them", |row| {
        row.found.as_ref().err().cloned()
    });
}
