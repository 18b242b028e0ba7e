//! Reports of films without a scale or iliac crests: no length in millimetres, and the reason for what is missing.

use spineline::analysis::Case;
use spineline::anatomy::Posture;
use spineline::measure::FilmLandmarks;
use spineline::number::fixed;
use spineline_phantom::Scenario;
use spineline_report::document::{Block, Section};
use spineline_report::figures::{case_overview, line_identification, spine_in_space};
use spineline_report::html;
use spineline_report::patient::films_table;

use crate::common::{self, analyzed, exact_rod, report, section};

/// A phantom whose films of some postures lack a spacing.
fn case(without: &[Posture]) -> Case {
    let mut case = exact_rod(0);
    for film in case.films.iter_mut().filter(|film| without.contains(&film.posture)) {
        let FilmLandmarks::Corners { image, .. } = &mut film.landmarks else { panic!("corners") };
        image.spacing = None;
    }
    case
}

fn paragraphs(section: &Section) -> String {
    let words = section.blocks.iter().filter_map(|block| match block {
        Block::Paragraph(text) => Some(text.as_str()),
        _ => None,
    });
    words.collect::<Vec<_>>().join(" ")
}

#[test]
fn a_case_without_a_scale_has_no_drawing_in_millimetres() {
    let document = report(&case(&Posture::ALL));
    for figure in document.figures() {
        assert!(!figure.svg.contains("(mm)"), "{}", figure.name);
    }
    let space = section(&document, "space");
    assert!(!space.blocks.iter().any(|block| matches!(block, Block::Figure(_))));
    let words = paragraphs(space);
    assert!(words.contains("not drawn") && words.contains("no scale"), "{words}");
    assert_eq!(spine_in_space(&analyzed(&case(&[Posture::Erect]))), None);
    let page = html(&document);
    assert!(!page.contains("class=\"space\""), "no view to turn either");
    assert!(!page.contains("Left-out bends (mm)"), "no errors of predictions");
}

#[test]
fn sections_without_a_model_name_the_films_without_a_scale() {
    let document = report(&case(&[Posture::LeftBending, Posture::Traction]));
    for id in ["simulated", "stiffness", "errors", "comparison"] {
        let words = paragraphs(section(&document, id));
        assert!(words.contains("without a scale (left bending, traction)"), "{id}: {words}");
        assert!(words.contains("ball or ruler"), "{id}: {words}");
    }
    let words = paragraphs(section(&document, "line"));
    assert!(words.contains("without a scale (left bending, traction)"), "{words}");
}

#[test]
fn only_films_with_a_scale_have_axes_in_millimetres() {
    let analysis = analyzed(&case(&[Posture::LeftBending]));
    let figures = [case_overview(&analysis), line_identification(&analysis).expect("four films")];
    for (svg, films) in figures.iter().zip([5, 4]) {
        assert_eq!(svg.matches("lateral (no scale)").count(), 1);
        assert_eq!(svg.matches("lateral (mm)").count(), films - 1);
        assert!(svg.contains("typical length"), "the note says how it is drawn");
    }
    // Nothing in the legend that is not in a panel.
    assert!(!figures[1].contains("best fit"));
    // At an assumed length, other films have no axes either.
    assert!(!case_overview(&analyzed(&case(&[Posture::Erect]))).contains("lateral (mm)"));
}

#[test]
fn a_model_without_a_scale_needs_none_for_its_angles() {
    let document = report(&case(&Posture::ALL));
    let text = html(&document);
    assert!(text.contains("Cobb angles") && text.contains("Rotation of every segment"));
}

#[test]
fn the_tilt_of_a_film_without_iliac_crests_names_its_other_reference() {
    let mut case = case(&[]);
    for film in &mut case.films {
        let FilmLandmarks::Corners { iliac_crests, .. } = &mut film.landmarks else { continue };
        if film.posture != Posture::Erect {
            *iliac_crests = None;
        }
    }
    let table = films_table(&analyzed(&case));
    assert_eq!(table.columns[3].head, "Lateral tilt against the iliac normal");
    let other: Vec<bool> =
        table.rows.iter().map(|row| row[3].ends_with(" (against L4's axis)")).collect();
    assert_eq!(other, [false, true, true, true, true]);
}

#[test]
fn a_lenke_type_says_that_it_uses_frontal_films_alone() {
    let words = analyzed(&case(&[])).lenke_words();
    assert!(words.starts_with("Lenke type "), "{words}");
    assert!(words.ends_with(" (by frontal films alone, no modifiers)"), "{words}");
}

#[test]
fn an_inflection_is_given_by_its_distance_along_the_curve_from_the_base() {
    let analysis = analyzed(&common::case(0, Scenario::Rod));
    let movement = &analysis.movement;
    let pair = movement.inflections.pair.as_ref().expect("a double curve");
    let intervals = movement.inflection_intervals.expect("a graph");
    let scale = movement.scale();
    let text = analysis.inflection_words();
    for (inflection, interval) in pair.iter().zip(intervals.each) {
        let along_mm = movement.erect().fit.curve.length_mm(inflection.t_mm);
        let place = format!("{}, {} from L4", inflection.place(), scale.text(along_mm, 0));
        let ends = interval.map_or("not limited".to_owned(), |found| {
            let [from, to] = found.along_mm.map(|mm| fixed(scale.units_per_mm * mm, 0));
            let (below, above) = found.between;
            format!("{from} to {to} mm; between {below} and {above}")
        });
        assert!(text.contains(&format!("{place} ({ends})")), "{place} ({ends}): {text}");
    }
}
