//! Numbers that JSON allows, or nearly, and that no film has: every reader and what is computed after it ends with a result or an
//! error, never with a panic.

use std::panic::{AssertUnwindSafe, catch_unwind};

use spineline::analysis::{AnalysisOptions, analyze};
use spineline_files::{ExportFormat, export, parse_analysis, parse_case, parse_load, parse_model};
use spineline_fuzz_checks::{CHECKS, seeds};

const NUMBERS: [&str; 10] = [
    "1e400",
    "-1e400",
    "NaN",
    "-Infinity",
    "1e308",
    "-1e155",
    "5e-324",
    "-0.0",
    "0",
    "99999999999999999999",
];

/// Where the numbers of a JSON text are.
fn numbers(text: &str) -> Vec<(usize, usize)> {
    let bytes = text.as_bytes();
    let (mut found, mut i, mut is_quoted) = (Vec::new(), 0, false);
    while i < bytes.len() {
        match bytes[i] {
            b'\\' if is_quoted => i += 1,
            b'"' => is_quoted = !is_quoted,
            b'-' | b'0'..=b'9' if !is_quoted => {
                let ends = |&b: &u8| !matches!(b, b'-' | b'+' | b'.' | b'e' | b'E' | b'0'..=b'9');
                let length = bytes[i..].iter().position(ends).unwrap_or(bytes.len() - i);
                found.push((i, i + length));
                i += length - 1;
            }
            _ => {}
        }
        i += 1;
    }
    found
}

/// Copies of a text, each with another number in one of at most so many places.
fn hostile(text: &str, most_places: usize) -> impl Iterator<Item = String> {
    let places = numbers(text);
    let step = places.len().div_ceil(most_places).max(1);
    places.into_iter().step_by(step).flat_map(move |(from, to)| {
        let at = move |number| format!("{}{number}{}", &text[..from], &text[to..]);
        NUMBERS.into_iter().map(at)
    })
}

/// The copies on which a use panics, as the line with the number.
fn panics(text: &str, most_places: usize, run: impl Fn(&str)) -> Vec<String> {
    let mut found = Vec::new();
    for copy in hostile(text, most_places) {
        if catch_unwind(AssertUnwindSafe(|| run(&copy))).is_err() {
            let differ = |(a, b): &(&str, &str)| a != b;
            let line = text.lines().zip(copy.lines()).find(differ);
            found.push(line.map_or_else(String::new, |(was, is)| format!("{was} → {is}")));
        }
    }
    found
}

fn seed(name: &str) -> String {
    let found = seeds().expect("our own formats").into_iter().find(|seed| seed.name == name);
    String::from_utf8(found.expect("a seed").bytes).expect("text")
}

#[test]
fn every_reader_of_json_takes_or_refuses_every_number() {
    for seed in seeds().expect("our own formats") {
        let Ok(text) = std::str::from_utf8(&seed.bytes) else { continue };
        let check = CHECKS.iter().find(|(name, _)| *name == seed.target).expect("a check").1;
        let found = panics(text, 60, |copy| check(copy.as_bytes()));
        assert!(found.is_empty(), "{}: {found:#?}", seed.name);
    }
}

#[test]
fn a_case_of_any_numbers_is_analysed_or_refused() {
    let found = panics(&seed("phantom"), 40, |copy| {
        let Ok(case) = parse_case(copy) else { return };
        let _ = analyze(&case, &AnalysisOptions::default());
    });
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn options_of_any_numbers_are_used_or_refused() {
    let text = seed("analysis");
    let (start, end) = (text.find("\"options\"").expect("options"), text.find("\"chain\""));
    let options = &text[start..end.expect("results")];
    let found = panics(options, 12, |copy| {
        let copy = text.replacen(options, copy, 1);
        let Ok(stored) = parse_analysis(&copy) else { return };
        let _ = analyze(&stored.case, &stored.request.options);
    });
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_model_of_any_numbers_is_exported_or_refused() {
    let found = panics(&seed("model"), 60, |copy| {
        let Ok(model) = parse_model(copy) else { return };
        for format in [ExportFormat::Mjcf, ExportFormat::Osim, ExportFormat::Urdf] {
            let _ = export(&model, format, "test");
        }
    });
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn a_load_of_any_numbers_is_placed_or_refused() {
    let model = parse_model(&seed("model")).expect("our own model");
    let found = panics(&seed("load"), 60, |copy| {
        let Ok(load) = parse_load(copy) else { return };
        let _ = load.place(&model);
    });
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn deep_nesting_is_refused() {
    for (open, close) in [("[", "]"), ("{\"a\":", "}")] {
        let deep = format!("{}0{}", open.repeat(200_000), close.repeat(200_000));
        for inside in
            [deep.clone(), format!("{{\"films\": {deep}}}"), format!("{{\"shapes\": {deep}}}")]
        {
            for (_, check) in CHECKS {
                check(inside.as_bytes());
            }
        }
    }
}
