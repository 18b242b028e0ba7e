//! Every number of a reproduction as text.

use super::{Films, Part, Reproduction};
use crate::document::{Column, Table};
use crate::phrases::none;
use crate::terminal::{self, Parts};

/// Columns of the text.
const WIDTH: usize = 120;

/// All parts, each with its table and note. A verdict stands below its row.
#[must_use]
pub fn full(reproduction: &Reproduction<'_>, parts: &[Part]) -> String {
    let names = reproduction.names();
    let (what, numbers) = match reproduction.films {
        Films::Phantoms { subjects, seed } => (
            format!(
                "synthetic patients: {subjects} subjects of its Table 1, in {} loading scenarios (seed {seed})",
                names.len()
            ),
            "Every number below the name of a scenario is SYNTHETIC; mean ± SD as the paper prints them.",
        ),
        Films::Given => (
            format!("patients that were given{}", reproduction.synthetic()),
            "Mean ± SD as the paper prints them.",
        ),
    };
    let mut text = format!("Jalalian et al. 2016 on {what}\n");
    for group in &reproduction.groups {
        text.push_str(&format!("  {:5} {}\n", group.name, group.meaning));
    }
    for sentence in [numbers, reproduction.method_sentence()] {
        text.push_str(sentence);
        text.push('\n');
    }
    for part in parts {
        text.push('\n');
        text.push_str(&part_text(part, &names));
    }
    text
}

/// The column of the paper is left out where it gives no number.
fn part_text(part: &Part, names: &[&str]) -> String {
    let has_paper = part.rows.iter().any(|row| row.paper.is_some());
    let heads =
        has_paper.then_some("paper").into_iter().chain(names.iter().copied()).map(Column::numbers);
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
