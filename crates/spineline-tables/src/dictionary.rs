use spineline::anatomy::Named;
use spineline::warning::WarningCode;

use crate::define::table;
use crate::table::Table;
use crate::{OptionalTables, other_files, tables_of};

/// One column of one table.
struct Entry {
    table: &'static str,
    column: String,
    unit: &'static str,
    kind: &'static str,
    meaning: &'static str,
}

/// The meaning of every column of every table, as a table.
#[must_use]
pub fn dictionary(optional: OptionalTables) -> Table {
    let entries: Vec<Entry> = tables_of(&[], optional)
        .into_iter()
        .flat_map(|table| {
            table.columns.into_iter().map(move |column| Entry {
                table: table.name,
                kind: column.values.kind(),
                column: column.name,
                unit: column.unit,
                meaning: column.meaning,
            })
        })
        .collect();
    table("dictionary", "a column of a table", &entries, |add| {
        add.text("table", "name of the table", |entry| entry.table);
        add.text("column", "name of the column", |entry| entry.column.clone());
        add.text("unit", "unit; empty where values are not numbers", |entry| entry.unit);
        add.text("type", "`text`, `number`, `integer` or `boolean`", |entry| entry.kind);
        add.text("meaning", "meaning of the values", |entry| entry.meaning);
    })
}

const DICTIONARY_HEAD: &str = "# Columns of the tables and codes of warnings

`spineline schema dictionary` prints this page. `analyze --tables DIR` writes the same about its own tables as `dictionary.csv`. The last nine
tables belong to other options and commands: `chain` to `analyze --chain`, `errors` to `analyze --csv` and `reproduce`, `cohort_tests` to
`analyze --cohort`, `noise_study` to `noise-study`, `path` to `simulate --csv`, `loaded_measures` to `simulate --measures`, `statistics` to
`reliability --csv`, `summary` to `reproduce`, `verdicts` to `import`.

";

/// The dictionary for people, in Markdown: a section per table, then the tables of other commands, then the codes of warnings.
#[must_use]
pub fn dictionary_markdown() -> String {
    let mut text = DICTIONARY_HEAD.to_owned();
    for table in tables_of(&[], OptionalTables::ALL).into_iter().chain(other_files()) {
        text.push_str(&format!("## {}\n\nOne row per {}.\n\n", table.name, table.row));
        text.push_str("| column | unit | type | meaning |\n|---|---|---|---|\n");
        for column in &table.columns {
            let kind = column.values.kind();
            text.push_str(&format!(
                "| `{}` | {} | {kind} | {} |\n",
                column.name, column.unit, column.meaning
            ));
        }
        text.push('\n');
    }
    text.push_str("## Codes of warnings\n\n| code | step | severity | film doubted | given when |\n|---|---|---|---|---|\n");
    for code in WarningCode::ALL {
        let (step, severity) = (code.step().key(), code.severity().key());
        let doubted = if code.doubts_film() { "yes" } else { "" };
        text.push_str(&format!(
            "| `{}` | {step} | {severity} | {doubted} | {} |\n",
            code.key(),
            code.help()
        ));
    }
    text
}
