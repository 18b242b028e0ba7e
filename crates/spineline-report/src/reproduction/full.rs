//! Every number of a reproduction as text.

use super::{Part, Scenarios};
use crate::document::{Column, Table};
use crate::phrases::none;
use crate::terminal::{self, Parts};

/// Columns of the text.
const WIDTH: usize = 120;

/// All parts, each with its table and note. A verdict stands below its row.
#[must_use]
pub fn full(scenarios: &Scenarios<'_>, parts: &[Part], subjects: usize, seed: u64) -> String {
    let names = scenarios.each_ref().map(|one| one.name);
    let mut text = format!(
        "Jalalian et al. 2016 on synthetic patients: {subjects} subjects of its Table 1, in {} loading scenarios (seed {seed})\n",
        names.len()
    );
    for one in scenarios {
        text.push_str(&format!("  {:5} {}\n", one.name, one.meaning));
    }
    text.push_str("Every number below the name of a scenario is SYNTHETIC; mean ± SD as the paper prints them.\n");
    for part in parts {
        text.push('\n');
        text.push_str(&part_text(part, names));
    }
    text
}

/// The column of the paper is left out where it gives no number.
fn part_text(part: &Part, names: [&str; 3]) -> String {
    let has_paper = part.rows.iter().any(|row| row.paper.is_some());
    let heads = has_paper.then_some("paper").into_iter().chain(names).map(Column::numbers);
    let columns = [Column::words(part.title.as_str())].into_iter().chain(heads).collect();
    let mut table = Table::new("", columns);
    for row in &part.rows {
        let paper = has_paper.then(|| row.paper.clone().unwrap_or_else(none));
        let cells = paper.into_iter().chain(row.ours.iter().map(|cell| cell.text.clone()));
        table.row([format!("  {}", row.quantity)].into_iter().chain(cells).collect());
    }
    let Parts { head, rows, .. } = terminal::parts(&table, WIDTH);
    let mut text = head;
    for (lines, row) in rows.iter().zip(&part.rows) {
        text.push_str(lines);
        if !row.verdict.is_empty() {
            let verdict = format!("→ {}", row.verdict);
            text.push_str(&terminal::paragraph(&verdict, WIDTH - 6, "      "));
        }
    }
    text.push_str(&terminal::paragraph(&part.note, WIDTH - 2, "  "));
    text
}
