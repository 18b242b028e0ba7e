//! `spineline noise-study` as its users call it, on a few phantoms.

use std::collections::BTreeMap;

use crate::program::folder;
use crate::results::results;

type Row = BTreeMap<String, String>;

fn rows(text: &str) -> Vec<Row> {
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_owned));
    let heading: Vec<String> = lines.next().expect("a heading").collect();
    lines
        .map(|cells| {
            let cells: Vec<String> = cells.collect();
            assert_eq!(cells.len(), heading.len(), "every row is whole");
            heading.iter().cloned().zip(cells).collect()
        })
        .collect()
}

fn number(row: &Row, column: &str) -> f64 {
    row[column].parse().unwrap_or_else(|_| panic!("{column} is `{}`", row[column]))
}

/// The row of exact marks read with curves of an order.
fn exact<'a>(rows: &'a [Row], scenario: &str, order: &str) -> &'a Row {
    let wanted = [("scenario", scenario), ("order_rule", order), ("noise_sd_mm", "0")];
    rows.iter().find(|row| wanted.iter().all(|(key, value)| row[*key] == *value)).expect("a row")
}

#[test]
fn a_small_study_is_complete_and_does_not_depend_on_threads() {
    let here = folder();
    let study = |out: &str, threads: &str| {
        let few = ["--phantoms", "2", "--scenarios", "rod,flatten,pull", "--seed", "4"];
        let mut arguments = vec!["noise-study", "--out", out, "--threads", threads];
        arguments.extend(few);
        here.done(&arguments)
    };
    let text = study("one", "1");
    study("two", "2");
    for file in ["noise-study.csv", "noise-study.svg"] {
        let bytes = |out: &str| results(&here.text(format!("{out}/{file}")));
        assert_eq!(bytes("one"), bytes("two"));
    }
    assert!(
        text.contains("SYNTHETIC") && text.contains("Claim 3") && text.contains("leave-one-out")
    );
    let svg = here.text("one/noise-study.svg");
    assert!(svg.contains("synthetic data") && svg.contains("noise (mm)"));
    let rows = rows(&here.text("one/noise-study.csv"));
    // Scenarios × rules and supports × deviations.
    assert_eq!(rows.len(), 3 * 7 * 7);
    for row in &rows {
        assert_eq!((&row["synthetic"][..], &row["phantoms"][..]), ("true", "2"));
        for share in ["near_share", "better_share", "rod_exceeds_below_mean_share"] {
            // A cell is empty where nothing could be compared.
            if !row[share].is_empty() {
                let [low, value, high] =
                    [format!("{share}_low"), share.to_owned(), format!("{share}_high")]
                        .map(|column| number(row, &column));
                assert!(0.0 <= low && low <= value && value <= high && high <= 1.0, "{share}");
            }
        }
    }
    // Known scenario: nothing turns at the inflections of rod and flatten, and a side pull at T2 turns them as much as others.
    for scenario in ["rod", "flatten"] {
        assert!(number(exact(&rows, scenario, "order 12"), "below_mean_share") > 0.8, "{scenario}");
    }
    assert!(number(exact(&rows, "pull", "order 12"), "below_mean_share") < 0.8);
    // The marks are exact there, and the erect curve is a polynomial of order 6.
    assert!(number(exact(&rows, "rod", "order 12"), "curve_residual_mm") < 0.1);
}

#[test]
fn a_study_without_rods_has_no_comparison_with_them() {
    let here = folder();
    here.done(&["noise-study", "--phantoms", "2", "--scenarios", "random", "--out", "."]);
    let rows = rows(&here.text("noise-study.csv"));
    assert_eq!(rows.len(), 7 * 7);
    assert!(rows.iter().all(|row| row["rod_exceeds_near_share"].is_empty()));
}
