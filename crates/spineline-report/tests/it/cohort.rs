//! A report of a cohort names what it leaves out, and shows errors on left-out bends.

use std::collections::BTreeSet;

use spineline::action::LineKind;
use spineline::analysis::{Analysis, FilmRole, Subject};
use spineline::anatomy::{Level, Posture};
use spineline::cohort::{Cohort, CohortPatient};
use spineline::multibody::PathEnding;
use spineline::number::fixed;
use spineline::reliability::{RatedQuantity, assess};
use spineline::spatial::Pixel;
use spineline_phantom::Scenario;
use spineline_report::cohort::{self, PatientRow};
use spineline_report::document::{Block, Table};
use spineline_report::{Document, figures, html, reliability, terminal};

use crate::common::{
    GENERATOR, analyzed, case, cohort_of, cohort_report, exact_rod, figure_names, rod_with_films,
    rows, section,
};
use crate::terminal::tables;

fn analysis(subject: usize, films: &[Posture]) -> Analysis {
    analyzed(&rod_with_films(subject, films))
}

fn document(analyses: &[Analysis]) -> Document {
    let subjects = vec![Subject::default(); analyses.len()];
    cohort_report(analyses, &subjects, &[])
}

fn table<'a>(document: &'a Document, id: &str, caption: &str) -> Option<&'a Table> {
    section(document, id).blocks.iter().find_map(|block| match block {
        Block::Table(table) if table.caption.starts_with(caption) => Some(table),
        _ => None,
    })
}

#[test]
fn every_patient_and_line_has_its_error_on_left_out_bends() {
    let analyses: Vec<Analysis> = (0..3).map(|i| analysis(i, &Posture::ALL)).collect();
    let document = document(&analyses);
    let rows = &table(&document, "by-patient", "Mean location errors").expect("a table").rows;
    assert_eq!(rows.len(), 9, "three lines of three patients");
    for analysis in &analyses {
        // The oracle is the comparison of each patient alone.
        let compared = analysis.comparison();
        for (place, model) in analysis.models.iter().enumerate() {
            let name = model.kind.to_string();
            let row = rows.iter().find(|row| row[0] == analysis.case_id && row[1] == name);
            let left_out = compared.errors(place, FilmRole::LeftOutBend).expect("two bends");
            let expected = fixed(left_out.location_mm, 1);
            assert_eq!(row.expect("a row of this line")[3], expected, "{name}");
        }
    }
    let names = figure_names(&document);
    assert!(names.contains(&"errors-left-out"), "{names:?}");
    assert!(table(&document, "errors", "Errors on bending films, left out").is_some());
    assert_eq!(table(&document, "tests", "Films on which"), None, "all lines have results");
}

#[test]
fn a_film_that_is_left_out_is_named_with_line_and_reason() {
    let mut analyses: Vec<Analysis> = (0..2).map(|i| analysis(i, &Posture::ALL)).collect();
    let iliac = analyses[1].models.iter_mut().find(|model| model.kind == LineKind::Iliac);
    let postures = &mut iliac.expect("a model of every line").simulations;
    for simulation in postures.iter_mut().filter(|simulation| !simulation.fitted) {
        simulation.status = PathEnding::Unreachable;
    }
    let cohort = cohort_of(&analyses);
    assert_eq!(cohort.compared.missing.len(), 2, "one line on two films");
    let document = document(&analyses);
    let found = table(&document, "tests", "Films on which a line has no result").expect("a table");
    let expected = [
        analyses[1].case_id.as_str(),
        "neutral, traction",
        "neutral, traction",
        "iliac line",
        "no force up to the limit gives the shape",
    ];
    assert_eq!(found.rows, [expected.map(str::to_owned)]);
}

#[test]
fn a_doubted_film_and_a_shorter_chain_are_named() {
    let mut case = exact_rod(1);
    let landmarks = case.films[0].landmarks.clone();
    assert_eq!(case.films[0].posture, Posture::Erect);
    case.film_mut(Posture::LeftBending).expect("a bend").landmarks = landmarks;
    for film in &mut case.films {
        let is_left = film.posture == Posture::LeftBending;
        let readings = film.landmarks.corner_readings_mut();
        assert!(!readings.is_empty(), "phantoms have corners");
        for reading in readings {
            reading.vertebrae.retain(|level, _| *level <= Level::T4);
            // Equal landmarks would be refused, so the film lies a little lower on its picture.
            for body in reading.vertebrae.values_mut().filter(|_| is_left) {
                body.corners = body.corners.map(|p| Pixel::new(p.column_px, p.row_px + 5.0));
            }
        }
    }
    let doubted = analyzed(&case);
    let analyses = [analysis(0, &Posture::ALL), doubted];
    let document = document(&analyses);
    let films = &table(&document, "flow", "Films that may be wrong").expect("a table").rows;
    // Exact readings have so little noise that other films may be doubted too.
    let all: usize = analyses.iter().map(|analysis| analysis.film_doubts().count()).sum();
    assert_eq!(films.len(), all);
    let copied = [analyses[1].case_id.as_str(), "left bending"];
    let row = films.iter().find(|row| row[..2] == copied).expect("the copied film");
    assert!(row[2].contains("erect shape"), "{row:?}");
    let notices = table(&document, "by-patient", "Contradictions").expect("a table");
    let column: Vec<&str> = notices.rows.iter().map(|row| row[4].as_str()).collect();
    assert!(!column[0].contains("bending") && column[1].contains("left bending"), "{column:?}");
    let patients = table(&document, "patients", "Descriptive data").expect("a table");
    let chains: Vec<&str> = patients.rows.iter().map(|row| row[8].as_str()).collect();
    assert_eq!(chains, ["L4-T2", "L4-T4"]);
    let verdict = format!("{:?}", section(&document, "verdict").blocks);
    for part in ["left bending", "1 patient from L4 to T2 and 1 patient from L4 to T4"] {
        assert!(verdict.contains(part), "{part}: {verdict}");
    }
}

#[test]
fn cases_without_a_model_or_a_film_are_named_with_the_reason() {
    let one_bend = [Posture::Erect, Posture::LeftBending, Posture::Traction];
    let analyses =
        [analysis(0, &Posture::ALL), analysis(1, &[Posture::Erect]), analysis(2, &one_bend)];
    let document = document(&analyses);
    let found = table(&document, "flow", "Cases without a model").expect("a table");
    let expected = [
        [&analyses[1].case_id, "left bending, right bending, neutral, traction", "no bending film"],
        [&analyses[2].case_id, "right bending, neutral", "–"],
    ];
    assert_eq!(found.rows, expected.map(|row| row.map(str::to_owned)));
}

#[test]
fn a_cohort_of_erect_films_has_no_empty_panels() {
    let analyses = [0, 1].map(|subject| analysis(subject, &[Posture::Erect]));
    let document = document(&analyses);
    let names = figure_names(&document);
    assert_eq!(names, ["flow", "lenke"]);
    assert!(document.sections.iter().all(|section| !section.blocks.is_empty()));
    let text = html(&document);
    assert!(text.contains("inflections and least-rotating segments cannot be compared"));
}

#[test]
fn a_kind_of_film_without_results_says_so_in_place_of_an_empty_panel() {
    let films = [Posture::Erect, Posture::LeftBending];
    let document = document(&[analysis(0, &films), analysis(1, &films)]);
    let names = figure_names(&document);
    assert!(names.contains(&"errors-fitted"), "{names:?}");
    assert!(!names.contains(&"errors-left-out") && !names.contains(&"errors-held-out"));
    let without = Block::Paragraph("These films have no result.".to_owned());
    let count = section(&document, "errors").blocks.iter().filter(|b| **b == without).count();
    assert_eq!(count, 2);
    assert!(document.figures().all(|figure| !figure.svg.contains("n = 0")));
}

#[test]
fn figures_of_a_shorter_chain_name_its_own_base() {
    let mut case = exact_rod(0);
    for film in &mut case.films {
        let readings = film.landmarks.corner_readings_mut();
        assert!(!readings.is_empty(), "phantoms have corners");
        for reading in readings {
            reading.vertebrae.retain(|level, _| (Level::L3..=Level::T4).contains(level));
        }
    }
    let analysis = analyzed(&case);
    let line = &analysis.models[0];
    let drawn = [
        Some(figures::films(&case, &analysis, &[])),
        Some(figures::case_overview(&analysis)),
        figures::line_identification(&analysis),
        figures::measured_and_simulated(&analysis, Posture::LeftBending),
        Some(figures::force_path(&analysis, Posture::LeftBending, line.kind, &[], "N")),
        figures::rotations(&analysis),
        Some(figures::chain(&analysis)),
        figures::spine_in_space(&analysis).map(|(svg, _)| svg),
    ];
    for (place, svg) in drawn.into_iter().enumerate() {
        let svg = svg.expect("the films give every figure");
        let texts = svg.split('>').filter_map(|part| part.split('<').next());
        let is_end = |c: char| !c.is_alphanumeric();
        let words: BTreeSet<&str> = texts.flat_map(|text| text.split(is_end)).collect();
        assert!(words.contains("L3"), "figure {place}: {words:?}");
        assert!(!words.contains("L4") && !words.contains("T2"), "figure {place}: {words:?}");
    }
}

#[test]
fn a_large_cohort_shows_its_first_patients_and_counts_all() {
    let analysis = analyzed(&case(0, Scenario::Pull));
    let patient = CohortPatient::of(&analysis);
    let all = PatientRow::MAX_SHOWN + 1;
    for (patients, is_cut) in [(all - 1, false), (all, true)] {
        let together = Cohort::of(&vec![patient.clone(); patients], 1);
        let shown = vec![PatientRow::of(&analysis); patients];
        let document = cohort::full(&rows(&shown, &together));
        let table = tables(&document)
            .into_iter()
            .find(|t| t.caption.contains("Mean location"))
            .expect("rows");
        assert_eq!(table.rows.len(), PatientRow::MAX_SHOWN);
        assert_eq!(table.caption.contains("the first 200 of 201 patients"), is_cut);
        assert_eq!(table.note.contains("--tables and --json write all"), is_cut, "{}", table.note);
        assert!(document.subject.starts_with(&format!("{patients} patients")));
    }
}

#[test]
fn films_without_a_result_are_shown_of_the_first_patients() {
    let whole = analyzed(&case(0, Scenario::Pull));
    // Changed before any result is computed: an analysis keeps its comparison.
    let mut without = whole.clone();
    without.models.retain(|model| model.kind != LineKind::Inflection);
    let mut patients = vec![CohortPatient::of(&whole)];
    for (lacking, is_cut) in [(PatientRow::MAX_SHOWN, false), (PatientRow::MAX_SHOWN + 1, true)] {
        patients.resize_with(lacking + 1, || {
            without.case_id.push('x');
            CohortPatient::of(&without)
        });
        let together = Cohort::of(&patients, 1);
        let document = cohort::full(&rows(&[PatientRow::of(&whole)], &together));
        let table =
            tables(&document).into_iter().find(|t| t.caption.contains("no result")).expect("films");
        assert_eq!(table.note.contains("The first 200 of 201 patients"), is_cut, "{}", table.note);
        let mut named: Vec<&String> = table.rows.iter().map(|row| &row[0]).collect();
        named.dedup();
        assert_eq!(named.len(), PatientRow::MAX_SHOWN);
    }
}

#[test]
fn readings_that_cannot_be_compared_say_why() {
    let text = |subjects: u32, observers: &[&str]| {
        let mut quantity = RatedQuantity::new("score", "points", "");
        for subject in 0..subjects {
            for observer in observers {
                assert!(quantity.insert(&subject.to_string(), observer, 1, f64::from(subject)));
            }
        }
        terminal(&reliability::summary(&[assess(&quantity)], false, GENERATOR), 110)
    };
    let one_subject = text(1, &["A", "B"]);
    assert!(one_subject.contains("not known: 1 subject, and at least 2"), "{one_subject}");
    let one_observer = text(2, &["A"]);
    assert!(one_observer.contains("No quantity was read twice"), "{one_observer}");
}

#[test]
fn subjects_and_units_of_readings_of_films_are_explained() {
    let text = |key: &str| {
        let mut quantity = RatedQuantity::new(key, "mm (patient)", "");
        for subject in 0..4 {
            for (observer, value) in [("A", subject * subject), ("B", 3 * subject)] {
                assert!(quantity.insert(&subject.to_string(), observer, 1, f64::from(value)));
            }
        }
        terminal(&reliability::summary(&[assess(&quantity)], false, GENERATOR), 400)
    };
    let of_films = text("location_y_as_paper");
    assert!(of_films.contains("location y as paper, mm (patient)"), "{of_films}");
    let note = "A subject is one vertebra, or one with its neighbours, on one film. As paper: ";
    assert_eq!(of_films.matches(note).count(), 1, "{of_films}");
    assert!(!text("score").contains(note));
}

#[test]
fn a_summary_of_readings_names_what_was_counted_apart_or_left_out() {
    let mut found = Vec::new();
    for (key, subjects) in [("q", 4), ("Q", 4), ("r", 1)] {
        let mut quantity = RatedQuantity::new(key, "points", "");
        for subject in 0..subjects {
            for observer in ["A", "B", "b"] {
                let (subject, value) = (format!("s{subject}"), f64::from(subject));
                assert!(quantity.insert(&subject, observer, 1, value + f64::from(observer < "b")));
            }
        }
        assert!(quantity.insert("S0", "A", 1, 1.0));
        found.push(assess(&quantity));
    }
    let text = terminal(&reliability::summary(&found, false, GENERATOR), 400);
    for part in [
        "these quantities have names that differ by capitals and marks alone: Q and q",
        "`B` and `b` count as 2 observers",
        "these subjects have names that differ by capitals and marks alone: S0 and s0",
        "q, Q: 1 of 5 subjects were not read equally often by all observers and are left out: S0.",
        "r: the reliability is not known: only 1 of 2 subjects were read by all",
    ] {
        assert_eq!(text.matches(part).count(), 1, "{part}: {text}");
    }
}
