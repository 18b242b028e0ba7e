//! A report of a cohort names what it leaves out, and shows errors on left-out bends.

use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, FilmRole, Subject, analyze};
use spineline::anatomy::Posture;
use spineline::cohort::Cohort;
use spineline::multibody::MatchStatus;
use spineline_phantom::{Readers, Truth, generate};
use spineline_report::cohort::{self, Patients};
use spineline_report::document::{Block, Section, Table};
use spineline_report::{Document, html};

/// A phantom of which some films are kept.
fn analysis(subject: usize, films: &[Posture]) -> Analysis {
    let readers = Readers::exact();
    let mut case = generate(subject, Truth::Rod, &readers, 1).expect("a subject").case;
    case.films.retain(|film| films.contains(&film.posture));
    analyze(&case, &AnalysisOptions::default()).expect("a phantom is sound")
}

fn document(analyses: &[Analysis]) -> Document {
    let subjects = vec![Subject::default(); analyses.len()];
    cohort::report(&Patients {
        analyses,
        subjects: &subjects,
        together: &Cohort::of(&analyses.iter().collect::<Vec<_>>(), 1),
        refused: &[],
        generator: "spineline test",
        json: "[]",
    })
}

fn section<'a>(document: &'a Document, id: &str) -> &'a Section {
    document.sections.iter().find(|section| section.id == id).expect("the section is there")
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
        let compared = analysis.compare_lines();
        for (place, model) in analysis.models.iter().enumerate() {
            let name = model.kind.to_string();
            let row = rows.iter().find(|row| row[0] == analysis.case_id && row[1] == name);
            let left_out = compared.errors(place, FilmRole::LeftOutBend).expect("two bends");
            let expected = format!("{:.1}", left_out.location_mm);
            assert_eq!(row.expect("a row of this line")[3], expected, "{name}");
        }
    }
    let names: Vec<&str> = document.figures().map(|figure| figure.name.as_str()).collect();
    assert!(names.contains(&"errors-left-out"), "{names:?}");
    assert!(table(&document, "errors", "Errors on bending films, left out").is_some());
    assert_eq!(table(&document, "tests", "Films left out"), None, "no film is left out");
}

#[test]
fn a_film_that_is_left_out_is_named_with_line_and_reason() {
    let mut analyses: Vec<Analysis> = (0..2).map(|i| analysis(i, &Posture::ALL)).collect();
    let iliac = analyses[1].models.iter_mut().find(|model| model.kind == LineKind::Iliac);
    let postures = &mut iliac.expect("a model of every line").postures;
    for simulation in postures.iter_mut().filter(|simulation| !simulation.fitted) {
        simulation.status = MatchStatus::Unreachable;
    }
    let cohort = Cohort::of(&analyses.iter().collect::<Vec<_>>(), 1);
    assert_eq!(cohort.compared.missing.len(), 2, "one line on two films");
    let document = document(&analyses);
    let found = table(&document, "tests", "Films left out of the comparison").expect("a table");
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
    let names: Vec<&str> = document.figures().map(|figure| figure.name.as_str()).collect();
    assert_eq!(names, ["flow", "lenke"]);
    assert!(document.sections.iter().all(|section| !section.blocks.is_empty()));
    let text = html(&document);
    assert!(text.contains("inflections and least-rotating segments cannot be compared"));
}

#[test]
fn a_kind_of_film_without_results_says_so_in_place_of_an_empty_panel() {
    let films = [Posture::Erect, Posture::LeftBending];
    let document = document(&[analysis(0, &films), analysis(1, &films)]);
    let names: Vec<&str> = document.figures().map(|figure| figure.name.as_str()).collect();
    assert!(names.contains(&"errors-fitted"), "{names:?}");
    assert!(!names.contains(&"errors-left-out") && !names.contains(&"errors-held-out"));
    let without = Block::Paragraph("No such film has a result.".to_owned());
    let count = section(&document, "errors").blocks.iter().filter(|b| **b == without).count();
    assert_eq!(count, 2);
    assert!(document.figures().all(|figure| !figure.svg.contains("n = 0")));
}
