use spineline::warning::Warning;

use crate::Patient;
use crate::define::{Columns, Row, keyed, rows};
use crate::table::Table;

/// One row per patient and warning.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows = rows(patients, |patient| patient.analysis.all_warnings());
    keyed("warnings", "patient × warning", &rows, columns)
}

fn columns(add: &mut Columns<'_, Row<'_, &Warning>>) {
    add.text("severity", "`note`, `warning` or `contradiction`", |row| row.code.severity().key());
    add.text("code", "stable key of the warning", |row| row.code.key());
    add.text("step", "step of the method that raised it", |row| row.code.step().key());
    add.text("posture", "film concerned", |row| row.posture.map(|posture| posture.key()));
    add.text("level", "vertebra concerned", |row| row.level.map(|level| level.to_string()));
    add.text("line", "line of action concerned", |row| row.line.map(|line| line.key()));
    add.text("message", "what happened and what to do", |row| row.message.clone());
}
