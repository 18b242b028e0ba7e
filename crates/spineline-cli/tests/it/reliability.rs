//! `spineline reliability` as its users call it, on phantoms, on tables, and on readings of three clinicians.

#![expect(clippy::disallowed_methods, reason = "the oracle has its own formulas")]

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::program::{assert_says, folder, json, split, with_phantom, with_phantoms};

/// The entry of a list whose key has a value.
fn with<'a>(list: &'a Value, key: &str, value: &str) -> &'a Value {
    let all = list.as_array().expect("a list");
    all.iter().find(|entry| entry[key] == value).unwrap_or_else(|| panic!("no {key} {value}"))
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn the_errors_of_phantom_readings_equal_those_of_their_readers() {
    let here = with_phantoms("rod", &["1", "2"]);
    let text = here
        .done(&split("reliability cases --json out.json --csv out.csv --figures figures --full"));
    assert!(text.contains("SYNTHETIC") && text.contains("two-way random, absolute agreement"));
    let file = here.json("out.json");
    assert_eq!(file["synthetic"], true);
    let tilt = with(&file["quantities"], "quantity", "tilt_as_paper");
    let within = with(&tilt["designs"], "design", "intra_observer");
    let sem = with(&within["statistics"], "statistic", "sem_consistency");
    // Axes scatter by 0.3° from repeat to repeat and are rounded to 0.1°; 300 degrees of freedom leave 4 %.
    let truth = (0.3_f64.powi(2) + 0.1_f64.powi(2) / 12.0).sqrt();
    assert!((number(&sem["value"]) / truth - 1.0).abs() < 0.15, "{sem}");
    assert_eq!((&within["subjects"], &sem["unit"]), (&Value::from(150), &Value::from("deg")));
    let figures = fs::read_dir(here.path("figures")).expect("a folder");
    let figures: Vec<PathBuf> = figures.map(|entry| entry.expect("a file").path()).collect();
    assert_eq!(figures.len(), 6 * 4, "six quantities, two designs between and two within");
    let svg = fs::read_to_string(&figures[0]).expect("a picture");
    assert!(svg.contains("synthetic data") && svg.contains("limits of agreement"));
    let tilts = figures.iter().find(|file| file.to_string_lossy().contains("-tilt_as_paper-2-"));
    let tilts = fs::read_to_string(tilts.expect("tilts")).expect("a picture");
    let tilts = tilts.split_once("</metadata>").expect("a provenance").1;
    // Names in words, sentences with a capital, and a unit after every number.
    assert!(tilts.contains("Agreement of readings: tilt as paper, "), "{tilts}");
    assert!(tilts.contains(">Tilt of a vertebra against the film; "), "{tilts}");
    assert!(tilts.contains("vertebrae on films") && !tilts.contains("rater"), "{tilts}");
    let limits = tilts.split_once(", limits ").expect("limits").1;
    assert!(limits.split('<').next().is_some_and(|text| text.ends_with(" deg")), "{tilts}");
    let rows = here.text("out.csv");
    assert!(rows.lines().all(|row| row.split(',').count() >= 16), "every row is whole");
}

#[test]
fn nonzero_numbers_are_not_printed_as_zero() {
    // F51: errors far below the spread of the subjects, and coefficients near zero and one.
    let here = folder();
    let mut table = "quantity,unit,subject,observer,repeat,value\n".to_owned();
    for i in 0..40_i32 {
        let noise = f64::from(i * 7919 % 41 - 20) * 1e-7;
        let _ = writeln!(table, "close,mm,{i},A,1,{i}\nclose,mm,{i},B,1,{}", f64::from(i) + noise);
        let (a, b) = (i * 17 % 41, i * 29 % 37);
        let _ = writeln!(table, "loose,mm,{i},A,1,{a}\nloose,mm,{i},B,1,{b}");
    }
    here.write("t.csv", table);
    let text = here.done(&["reliability", "t.csv", "--full"]);
    let text = text.replace('−', "-");
    let shown = text.split_whitespace().filter_map(|word| word.parse::<f64>().ok());
    assert!(shown.clone().count() > 50, "{text}");
    let words = text.split_whitespace().filter(|word| word.parse() == Ok(0.0));
    assert_eq!(words.collect::<Vec<_>>(), Vec::<&str>::new(), "{text}");
    assert!(text.contains("0.9999"), "a coefficient near one is not one: {text}");
}

#[test]
fn a_single_reader_gives_reasons_in_text_and_analysis() {
    // F27.
    let here = with_phantom(&["--subject", "1", "--noise", "0"]);
    let text = here.done(&["reliability", "cases", "--full"]);
    assert!(text.contains("undefined: one observer only") && text.contains("one repeat only"));
    let (text, _, _) = here.run(&["analyze", "cases", "--json", "-"]);
    let file = json(&text);
    let file = file.get(0).unwrap_or(&file);
    assert!(file["reliability"].is_null());
    with(&file["warnings"], "code", "reliability_one_reading");
}

#[test]
fn several_readings_reach_the_analysis_file() {
    let here = with_phantom(&[]);
    let (text, _, _) = here.run(&["analyze", "cases", "--json", "-"]);
    let file = json(&text);
    let spacing = with(&file["reliability"], "quantity", "spacing");
    let between = with(&spacing["designs"], "design", "inter_observer_means");
    assert_eq!(between["raters"].as_array().map(Vec::len), Some(2));
    assert_eq!(between["subjects"], 70, "five films of fourteen pairs");
}

#[test]
fn wrong_usage_and_wrong_tables_have_different_exit_codes() {
    let here = folder();
    here.write("bad.csv", "quantity,unit,subject,observer,repeat,value\na,mm,1,A,1,x\n");
    let error = here.refused(&["reliability", "bad.csv"], 3);
    assert!(
        error.contains("bad.csv: line 2: `value` is `x`") && error.contains("help:"),
        "{error}"
    );
    assert_eq!(here.run(&["reliability", "bad.csv", "case.json"]).2, 2);
    assert_eq!(here.run(&["reliability", "bad.csv", "--json", "-", "--csv", "-"]).2, 2);
    assert_eq!(here.run(&["reliability"]).2, 2);
}

/// Lines by clinician, patient and repeat: heights up and places to the patient's left, in mm, from below.
type Lines = BTreeMap<(String, String, u32), Vec<[f64; 2]>>;

/// The frontal lines of the clinicians; pictures have x to the patient's right and y down.
fn clinicians_lines(folder: &Path) -> Lines {
    let mut lines = Lines::new();
    for clinician in ["C1", "C2", "C3"] {
        let entries = fs::read_dir(folder.join(clinician)).expect("a folder per clinician");
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a file").path()).collect();
        // Names hold the time of the reading.
        paths.sort();
        for path in paths {
            let name = path.file_name().expect("a file").to_string_lossy().into_owned();
            let patient = format!("p{}", name.split('_').next().expect("a patient"));
            let file = json(&fs::read_to_string(&path).expect("a text"));
            let Some(points) = file["apLinePts"].as_array() else { continue };
            let mut line: Vec<[f64; 2]> =
                points.iter().map(|p| [-number(&p["World"][1]), -number(&p["World"][0])]).collect();
            line.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
            let of_him = |key: &&(String, String, u32)| key.0 == clinician && key.1 == patient;
            let repeat = lines.keys().filter(of_him).count() as u32 + 1;
            // One clinician read one patient a fourth time, which would leave only that patient complete.
            if repeat > 3 {
                continue;
            }
            lines.insert((clinician.to_owned(), patient, repeat), line);
        }
    }
    lines
}

/// The place of a line at a height, straight between its points.
fn place(line: &[[f64; 2]], height: f64) -> f64 {
    let above = line.partition_point(|point| point[0] < height).clamp(1, line.len() - 1);
    let ([z0, y0], [z1, y1]) = (line[above - 1], line[above]);
    if z1 > z0 { y0 + (y1 - y0) * (height - z0) / (z1 - z0) } else { y0 }
}

/// Location and tilt of every line at 15 heights that all readings of the patient reach; by quantity, subject,
/// clinician and repeat.
fn resampled(lines: &Lines) -> BTreeMap<(&'static str, String, String, u32), f64> {
    let mut values = BTreeMap::new();
    for ((clinician, patient, repeat), line) in lines {
        let own = || lines.iter().filter(|((_, other, _), _)| other == patient).map(|(_, l)| l);
        let bottom = own().map(|line| line[0][0]).fold(f64::MIN, f64::max);
        let top = own().map(|line| line[line.len() - 1][0]).fold(f64::MAX, f64::min);
        let step = (top - bottom) / 16.0;
        for i in 1..16 {
            let height = bottom + f64::from(i) * step;
            let subject = format!("{patient}-{i:02}");
            // A chord as high as a vertebra and its discs; leaning to the patient's right is positive.
            let rise = place(line, height + 0.5 * step) - place(line, height - 0.5 * step);
            let tilt_deg = -rise.atan2(step).to_degrees();
            let key = |quantity| (quantity, subject.clone(), clinician.clone(), *repeat);
            values.insert(key("location"), place(line, height));
            values.insert(key("tilt"), tilt_deg);
        }
    }
    values
}

/// Scatter of the clinicians' means without their offsets, squared: half the variance of differences, over all pairs.
fn half_variance_of_differences(means: &BTreeMap<&str, Vec<f64>>) -> f64 {
    let all: Vec<&Vec<f64>> = means.values().collect();
    let mut halves = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in &all[i + 1..] {
            let n = a.len() as f64;
            let differences: Vec<f64> = a.iter().zip(b.iter()).map(|(a, b)| a - b).collect();
            let mean = differences.iter().sum::<f64>() / n;
            let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
            halves.push(0.5 * squares / (n - 1.0));
        }
    }
    halves.iter().sum::<f64>() / halves.len() as f64
}

#[test]
fn errors_of_three_clinicians_lines_follow_from_their_differences() {
    let Some(data) = std::env::var_os("SPINELINE_DATA") else {
        println!("skipped: SPINELINE_DATA is not set");
        return;
    };
    let lines = clinicians_lines(&PathBuf::from(data).join("pcdare/observers_clinicians"));
    assert_eq!(lines.len(), 63, "three clinicians, seven patients, three repeats");
    let values = resampled(&lines);
    let mut table = "quantity,unit,subject,observer,repeat,value\n".to_owned();
    for ((quantity, subject, observer, repeat), value) in &values {
        let unit = if *quantity == "tilt" { "deg" } else { "mm" };
        let _ = writeln!(table, "{quantity},{unit},{subject},{observer},{repeat},{value}");
    }
    let here = folder();
    here.write("lines.csv", table);
    let text = here.done(&["reliability", "lines.csv", "--json", "-"]);
    let file = json(&text);
    for quantity in ["location", "tilt"] {
        let found = with(&file["quantities"], "quantity", quantity);
        for design in found["designs"].as_array().expect("designs") {
            assert_eq!(design["subjects"], 105, "seven patients at fifteen heights");
            for statistic in ["icc_2_1", "icc_3_1", "icc_2_k", "pearson"] {
                let value = number(&with(&design["statistics"], "statistic", statistic)["value"]);
                assert!(0.0 < value && value < 1.0, "{quantity}, {design}: {statistic} {value}");
            }
        }
        let between = with(&found["designs"], "design", "inter_observer_means");
        let mut sums: BTreeMap<&str, BTreeMap<&str, f64>> = BTreeMap::new();
        for ((_, subject, observer, _), value) in values.iter().filter(|(k, _)| k.0 == quantity) {
            *sums.entry(observer).or_default().entry(subject).or_default() += value / 3.0;
        }
        let means: BTreeMap<&str, Vec<f64>> = sums
            .iter()
            .map(|(observer, all)| (*observer, all.values().copied().collect()))
            .collect();
        let right = half_variance_of_differences(&means).sqrt();
        let sem = with(&between["statistics"], "statistic", "sem_consistency");
        let apart = (number(&sem["value"]) - right).abs();
        assert!(apart < 1e-9 * right, "{quantity}: {sem} should be {right}");
    }
}

#[test]
fn the_answer_is_one_row_per_quantity() {
    let here = with_phantom(&[]);
    let text = here.done(&["reliability", "cases"]);
    assert!(text.lines().count() <= 25, "{text}");
    assert_says(&text, &["tilt step", "lateral bow", "SEM", "ICC", "--full"]);
}
