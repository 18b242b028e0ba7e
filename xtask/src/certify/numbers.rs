//! The numbers of the program on known films, and those that moved since another certificate.

use std::collections::BTreeMap;
use std::path::Path;

use serde_json::Value;

use crate::command::run_with_codes;
use crate::files::read;
use crate::python;

/// Files with numbers in the folder of a certificate: the paper's study on synthetic films, and real patients where their data are.
const FILES: [&str; 2] = ["reproduce/summary.json", "patients.json"];

/// Exit code of the program where a result is incomplete: a line does not converge on some real films.
const INCOMPLETE: i32 = 4;

/// Numbers by file and place.
type Numbers = BTreeMap<String, f64>;

/// Runs the program on known films, with its files in the folder.
pub fn measured(program: &Path, folder: &Path) -> Result<Numbers, String> {
    spineline(program, folder, &["reproduce", "--out", "reproduce"])?;
    if let Some(data) = std::env::var_os("SPINELINE_DATA") {
        let cases = Path::new(&data).join("pcdare/cases");
        if cases.is_dir() {
            spineline(
                program,
                folder,
                &["analyze", "--cohort", "patients.json", &python::text(&cases)?],
            )?;
        }
    }
    read_all(folder)
}

/// The numbers in the folder of a certificate.
pub fn read_all(folder: &Path) -> Result<Numbers, String> {
    let mut numbers = Numbers::new();
    for file in FILES.iter().filter(|file| folder.join(file).exists()) {
        let text = read(&folder.join(file))?;
        let json = serde_json::from_str(&text).map_err(|error| format!("{file}: {error}"))?;
        collect(file, &json, &mut numbers);
    }
    match numbers.is_empty() {
        true => Err(format!("{}: no certificate with numbers", folder.display())),
        false => Ok(numbers),
    }
}

fn spineline(program: &Path, folder: &Path, arguments: &[&str]) -> Result<(), String> {
    let program = python::text(program)?;
    run_with_codes(folder, &program, arguments, &[("SOURCE_DATE_EPOCH", "0")], &[0, INCOMPLETE])
}

fn collect(place: &str, json: &Value, numbers: &mut Numbers) {
    match json {
        Value::Number(number) => {
            numbers.extend(number.as_f64().map(|number| (place.to_owned(), number)));
        }
        Value::Array(all) => {
            for (index, one) in all.iter().enumerate() {
                collect(&format!("{place}/{index}"), one, numbers);
            }
        }
        Value::Object(all) => {
            for (key, one) in all.iter().filter(|(key, _)| *key != "provenance") {
                collect(&format!("{place}/{key}"), one, numbers);
            }
        }
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// The numbers that moved, the largest change relative to its number first.
pub fn page(before: Option<&Numbers>, now: &Numbers) -> String {
    /// Smaller changes are rounding.
    const MOVED: f64 = 1e-9;
    const LISTED: usize = 200;
    let count = format!("## Numbers\n\n{} numbers on known films", now.len());
    let Some(before) = before else {
        return format!("{count}; `--since FOLDER` compares them with another certificate.\n");
    };
    let relative = |a: f64, b: f64| (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
    let both = now.iter().filter_map(|(place, &now)| Some((place, *before.get(place)?, now)));
    let mut moved: Vec<(&String, f64, f64)> =
        both.clone().filter(|(_, before, now)| relative(*before, *now) > MOVED).collect();
    moved.sort_by(|a, b| relative(b.1, b.2).total_cmp(&relative(a.1, a.2)));
    let same = both.count();
    let (new, gone) = (now.len() - same, before.len() - same);
    let mut page = format!(
        "{count}: {} moved since the other certificate, {new} are new, {gone} are gone.\n",
        moved.len()
    );
    if !moved.is_empty() {
        page.push_str("\n| number | before | now |\n|---|---|---|\n");
    }
    for (place, before, now) in moved.iter().take(LISTED) {
        page.push_str(&format!("| `{place}` | {before} | {now} |\n"));
    }
    if moved.len() > LISTED {
        page.push_str(&format!("\n{} more moved by less.\n", moved.len() - LISTED));
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_moved_are_listed_the_largest_change_first() {
        let of = |text: &str| {
            let mut numbers = Numbers::new();
            collect("a", &serde_json::from_str(text).expect("JSON"), &mut numbers);
            numbers
        };
        let before = of(r#"{"provenance": {"x": 1}, "mm": [1.0, 2.0], "gone": 3, "deg": 4.0}"#);
        let now = of(r#"{"mm": [1.5, 2.0000000000001], "deg": 4.1, "new": "text"}"#);
        let page = page(Some(&before), &now);
        assert!(page.contains("3 numbers on known films: 2 moved"), "{page}");
        assert!(page.contains("0 are new, 1 are gone"), "{page}");
        let places: Vec<usize> = ["| `a/mm/0` | 1 | 1.5 |", "| `a/deg` | 4 | 4.1 |"]
            .map(|row| page.find(row).expect(row))
            .to_vec();
        assert!(places[0] < places[1], "{page}");
    }
}
