use spineline::warning::Warning;

use crate::Patient;
use crate::define::{Row, keyed, text};
use crate::table::Table;

type WarningRow<'a> = Row<'a, &'a Warning>;

/// One row per patient and warning.
pub(crate) fn table(patients: &[Patient<'_>]) -> Table {
    let rows: Vec<WarningRow<'_>> = patients
        .iter()
        .flat_map(|patient| patient.analysis.warnings.all().iter().map(|item| patient.row(item)))
        .collect();
    let columns = vec![
        text("severity", "`note`, `warning` or `contradiction`", |row: &WarningRow<'_>| {
            Some(row.item.code.severity().key().to_owned())
        }),
        text("code", "stable key of the warning", |row| Some(row.item.code.key().to_owned())),
        text("step", "step of the method that raised it", |row| {
            Some(row.item.code.step().key().to_owned())
        }),
        text("posture", "film concerned", |row| {
            row.item.posture.map(|posture| posture.key().to_owned())
        }),
        text("level", "vertebra concerned", |row| row.item.level.map(|level| level.to_string())),
        text("line", "line of action concerned", |row| {
            row.item.line.map(|line| line.key().to_owned())
        }),
        text("message", "what happened and what to do", |row| Some(row.item.message.clone())),
    ];
    keyed("warnings", "patient × warning", [columns]).fill(&rows)
}
