//! Every number of the paper beside ours, from the summary that `spineline reproduce` writes.

use serde_json::Value;

/// Scenarios of the phantoms, in the order of the summary's rows.
const SCENARIOS: usize = 3;

/// The page, from the text of `summary.json`.
pub fn page(summary: &str) -> Result<String, String> {
    let summary: Value = serde_json::from_str(summary).map_err(|error| error.to_string())?;
    let rows = summary["rows"].as_array().ok_or("summary.json: no rows")?;
    let mut page = format!(
        "# The paper's numbers beside ours\n\n\
         Made by `{}` with seed {}. The paper's films are not public, so ours are **synthetic**: {} subjects of its Table 1, \
         moved in three ways (`rod`: a force through the inflections; `bend`: all joints turn to one side; `pull`: a \
         horizontal force at T2). No number of the paper is a goal. The verdict says in words how the two go together.\n",
        summary["generator"].as_str().unwrap_or("spineline"),
        summary["seed"],
        18
    );
    let mut section = "";
    for triple in rows.chunks(SCENARIOS) {
        let text =
            |row: &Value, key: &str| row[key].as_str().unwrap_or_default().replace('|', "\\|");
        let same = |row: &Value| row["quantity"] == triple[0]["quantity"];
        if triple.len() < SCENARIOS || !triple.iter().all(same) {
            return Err("summary.json: rows do not come in threes".to_owned());
        }
        let own = triple[0]["section"].as_str().unwrap_or_default();
        if own != section {
            section = own;
            page.push_str(&format!(
                "\n## {own}\n\n| | paper | rod | bend | pull | verdict |\n|---|---|---|---|---|---|\n"
            ));
        }
        let ours: Vec<String> = triple.iter().map(|row| text(row, "text")).collect();
        page.push_str(&format!(
            "| {} | {} | {} | {} |\n",
            text(&triple[0], "quantity"),
            text(&triple[0], "paper"),
            ours.join(" | "),
            text(&triple[0], "verdict")
        ));
    }
    Ok(page)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn three_scenarios_make_a_row_and_a_section_a_table() {
        let row = |section: &str, scenario: &str, text: &str| json!({ "section": section, "quantity": "a|b", "paper": "1.0", "scenario": scenario, "text": text, "verdict": "near" });
        let rows: Vec<Value> = ["rod", "bend", "pull"]
            .iter()
            .flat_map(|scenario| [row("Table 1", scenario, scenario)])
            .chain(["rod", "bend", "pull"].iter().map(|scenario| row("Table 2", scenario, "2")))
            .collect();
        let summary = json!({ "generator": "spineline 0", "seed": 1, "rows": rows });
        let page = page(&summary.to_string()).expect("a page");
        assert!(page.contains("| a\\|b | 1.0 | rod | bend | pull | near |"), "{page}");
        assert_eq!(page.matches("\n## ").count(), 2);
        assert!(page.contains("**synthetic**"));
    }

    #[test]
    fn a_summary_that_lost_a_row_is_refused() {
        let summary = json!({ "rows": [{ "quantity": "a" }] });
        assert!(page(&summary.to_string()).is_err());
    }
}
