//! Marks of cells and legends of figures.

use spineline::analysis::{AnalysisOptions, analyze};
use spineline::anatomy::{Level, Posture};
use spineline::clinical::{CobbEnds, EndChoice};
use spineline::measure::{FilmLandmarks, SpacingPlane, TiltRule, measure_readings};
use spineline_report::patient;

use crate::common::{self, section, shown};
use crate::reports::{JSON, document, named, tables};

#[test]
fn a_curve_that_ends_at_an_interpolated_vertebra_beyond_the_model_is_marked() {
    let mut case = common::exact_rod(0);
    for film in &mut case.films {
        let mut readings = measure_readings(film, TiltRule::default()).expect("a sound film");
        // The right bend ends the model at T4; the erect film shows T2, and T3 is interpolated on it.
        for reading in &mut readings {
            reading.vertebrae.retain(|&level, _| match film.posture {
                Posture::RightBending => level <= Level::T4,
                Posture::Erect => level != Level::T3,
                _ => true,
            });
        }
        film.landmarks = FilmLandmarks::placed(SpacingPlane::Patient, readings);
    }
    let given = Some(CobbEnds { inferior: Level::T6, superior: Level::T3 });
    let ends = EndChoice { given: [None, given, None], ..EndChoice::default() };
    let options = AnalysisOptions { ends, ..AnalysisOptions::default() };
    let analysis = analyze(&case, &options).expect("a phantom is sound");
    assert_eq!(analysis.movement.levels().top(), Level::T4);
    let document = patient::report(&shown(&case, &analysis, JSON));
    let mut rows = tables(section(&document, "films")).into_iter().flat_map(|table| &table.rows);
    let row = rows.find(|row| row.iter().any(|cell| cell == "T3–T6")).expect("the curve");
    let [erect, left] = [&row[4], &row[5]];
    assert!(erect.ends_with(" ~") && !left.ends_with(" ~"), "{row:?}");
}

#[test]
fn the_figure_of_inflections_names_its_case_and_counts_films() {
    let document = document(&named("P07"));
    let figure = document.figures().find(|figure| figure.name == "inflections");
    let svg = &figure.expect("a figure").svg;
    // Five films: both inflections move from the erect film to four others.
    assert!(svg.contains("least-rotating segments, case P07"), "{svg}");
    assert!(svg.contains("both inflections on 4 films (n = 8)"), "{svg}");
    assert!(svg.contains("share (%)") && !svg.contains("share of cases"), "{svg}");
}
