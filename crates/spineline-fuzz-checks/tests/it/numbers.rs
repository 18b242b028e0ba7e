//! Numbers that JSON allows, or nearly, but films cannot have: every reader and the computation after it ends with a
//! result or an error, never with a panic.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};

use spineline::analysis::{AnalysisOptions, analyze};
use spineline::measure::{FilmLandmarks, Placement, Reading, ReadingId, SpacingPlane};
use spineline::multibody::Goal;
use spineline::response::respond;
use spineline_files::{
    CaseFile, ExportFormat, export, parse_analysis, parse_case, parse_load, parse_model, to_text,
};
use spineline_fuzz_checks::{CHECKS, seeds};
use spineline_phantom::{Readers, Scenario, generate};

const NUMBERS: [&str; 11] = [
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
    "4294967295",
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

/// A text with another number in some places.
fn with(text: &str, places: &[(usize, usize)], number: &str) -> String {
    let (mut copy, mut done) = (String::new(), 0);
    for &(from, to) in places {
        copy.push_str(&text[done..from]);
        copy.push_str(number);
        done = to;
    }
    copy + &text[done..]
}

/// Copies of a text with another number at one place, or at `most_places` places from it on, for at most `most_places`
/// first places.
fn hostile(text: &str, most_places: usize) -> impl Iterator<Item = String> {
    let places = numbers(text);
    let step = places.len().div_ceil(most_places).max(1);
    (0..places.len()).step_by(step).flat_map(move |first| {
        let one = &places[first..=first];
        let several = &places[first..(first + most_places).min(places.len())];
        let copies = NUMBERS.map(|number| [with(text, one, number), with(text, several, number)]);
        copies.into_iter().flatten().collect::<Vec<_>>()
    })
}

/// The lines in which the copies that cause a panic differ.
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

/// The films as locations and tilts, without pictures.
fn placements() -> String {
    let mut case = generate(0, Scenario::Rod, &Readers::exact(), 1).expect("subject 1 exists").case;
    let nominal = analyze(&case, &AnalysisOptions::default()).expect("a phantom");
    for (film, posture) in case.films.iter_mut().zip(&nominal.movement.films) {
        let vertebrae = posture.outline.vertebrae.iter();
        let placed = vertebrae.map(|v| (v.level, Placement::new(v.location, v.tilt)));
        let reading = Reading { id: ReadingId::new("program", 1), vertebrae: placed.collect() };
        film.landmarks = FilmLandmarks::placed(SpacingPlane::Patient, vec![reading]);
    }
    to_text(&CaseFile::from_case(&case))
}

#[test]
fn placements_of_any_numbers_are_analysed_or_refused() {
    let text = placements();
    assert!(parse_case(&text).is_ok_and(|case| analyze(&case, &Default::default()).is_ok()));
    let found = panics(&text, 16, |copy| {
        let Ok(case) = parse_case(copy) else { return };
        let _ = analyze(&case, &AnalysisOptions::default());
    });
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn options_of_any_numbers_are_used_or_refused() {
    let text = seed("analysis");
    assert!(parse_analysis(&text).is_ok());
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
        let Ok(stored) = parse_model(copy) else { return };
        for format in ExportFormat::ALL {
            let _ = export(&stored.model, format, "test");
        }
    });
    assert!(found.is_empty(), "{found:#?}");
}

/// Maximum number of shapes of a search.
const MAX_SHAPES: usize = 10;

#[test]
fn a_load_of_any_numbers_is_simulated_or_refused() {
    let model = parse_model(&seed("model")).expect("our own model").model;
    let statics = model.statics().expect("its springs");
    let text = seed("load");
    assert!(parse_load(&text).is_ok_and(|load| load.place(&model).is_ok()));
    let found = panics(&text, 60, |copy| {
        let Ok(placed) = parse_load(copy).and_then(|load| load.place(&model)) else { return };
        let mut shapes = 0;
        let _ = respond(&statics, &placed.loading, Goal::FullLoad, 1.0, &mut |_, _| {
            shapes += 1;
            if shapes < MAX_SHAPES { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
        });
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
