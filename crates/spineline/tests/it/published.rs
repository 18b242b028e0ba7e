//! Published numbers and their sources: every key is in the list of references, and numbers not compared are marked in use.

use spineline::anatomy::{Level, Morphometry, PublishedNumbers, SourceCheck};
use spineline::multibody::StiffnessTable;
use spineline::personalize::{MULTIPLIER_COVERAGE, STIFFNESS_COVERAGE};

use crate::common::assert_near;

const REFERENCES: &str = include_str!("../../../../docs/references.bib");

fn is_listed(key: &str) -> bool {
    REFERENCES.lines().any(|line| line.starts_with('@') && line.ends_with(&format!("{{{key},")))
}

/// Note of a reference.
fn note(key: &str) -> &'static str {
    let entry = REFERENCES.split("\n@").find(|entry| entry.contains(&format!("{{{key},")));
    entry.expect("a reference").split("note").last().expect("a note")
}

#[test]
fn no_citation_is_from_memory() {
    let text = REFERENCES.to_lowercase();
    assert!(!text.contains("memory") && !text.contains("not seen"));
}

#[test]
fn every_published_number_names_references_that_are_listed() {
    for one in PublishedNumbers::ALL {
        for key in one.source.split(", ") {
            assert!(is_listed(key), "{key} of {}", one.numbers);
        }
    }
    let missing = |table: StiffnessTable| {
        let rows = table.library().rows().to_vec();
        let sources: Vec<String> = rows.iter().map(|row| row.source.clone()).collect();
        let words = sources.iter().flat_map(|source| source.split([' ', ',', ';', '(', ')']));
        // A key ends in its year.
        let keys = words.filter(|word| {
            word.rsplit_once('-')
                .is_some_and(|(_, year)| year.len() == 4 && year.parse::<u16>().is_ok())
        });
        keys.filter(|key| !is_listed(key)).map(str::to_owned).collect::<Vec<_>>()
    };
    for table in StiffnessTable::ALL {
        assert_eq!(missing(table), [""; 0], "{}", table.key());
    }
}

#[test]
fn springs_whose_source_was_not_read_say_so() {
    let marked = |table: StiffnessTable, mark: &str| {
        table.library().rows().iter().filter(|row| row.source.contains(mark)).count()
    };
    assert_eq!(marked(StiffnessTable::Coupled, "fujimori-2014 (UNVERIFIED)"), 10);
    assert!(note("fujimori-2014").contains("UNVERIFIED"));
    // All but T12/L1, which is the mean of its neighbours.
    assert_eq!(marked(StiffnessTable::MotionSegments, "(second-hand)"), 13);
    assert_eq!(marked(StiffnessTable::InVitro, "UNVERIFIED"), 0);
}

#[test]
fn ranges_of_motion_that_were_not_read_are_unverified() {
    let ranges = PublishedNumbers::ALL.into_iter().find(|one| one.source == "white-panjabi-1990");
    assert_eq!(ranges.expect("ranges").check, SourceCheck::Unverified);
    assert!(note("white-panjabi-1990").contains("UNVERIFIED"));
}

/// Lengths of vertebrae with their discs in the adult model that stood for typical distances before, L4 to T2, and the distances of CT over
/// theirs (decision record 0047).
const UNITS_MM: [f64; 15] =
    [32.5, 32.5, 30.1, 31.3, 33.2, 29.0, 28.5, 24.7, 24.2, 25.5, 24.2, 24.8, 23.1, 20.9, 19.1];
const CT_OVER_TABLE: [[f64; 2]; 14] = [
    [1.12, 1.12],
    [1.14, 1.14],
    [1.13, 1.13],
    [1.00, 1.00],
    [0.95, 0.95],
    [0.95, 0.95],
    [0.95, 0.95],
    [0.98, 0.98],
    // Between T8 and T4 only the two ends were given.
    [0.89, 0.94],
    [0.89, 0.94],
    [0.89, 0.94],
    [0.89, 0.94],
    [0.95, 0.95],
    [1.03, 1.03],
];

#[test]
fn distances_of_typical_midpoints_equal_the_cts() {
    let pairs = Level::MODEL.windows(2).zip(UNITS_MM.windows(2)).zip(CT_OVER_TABLE);
    for ((levels, units_mm), [low, high]) in pairs {
        let before_mm = 0.5 * (units_mm[0] + units_mm[1]);
        let now_mm = Morphometry::spacing_mm(levels[0], levels[1]);
        // One digit is written.
        let range = (low * before_mm - 0.051)..=(high * before_mm + 0.051);
        assert!(range.contains(&now_mm), "{}/{}: {now_mm} mm", levels[1], levels[0]);
    }
    let sum: f64 = Level::MODEL.windows(2).map(|p| Morphometry::spacing_mm(p[0], p[1])).sum();
    assert_near(Morphometry::spacing_mm(Level::L4, Level::T2), sum, 1e-9, "along the spine");
    assert_eq!(Morphometry::spacing_mm(Level::T2, Level::T2), 0.0);
}

#[test]
fn corrected_cells_have_their_published_values() {
    assert_eq!(Morphometry::of(Level::T1).body_height_mm, 14.3);
}

#[test]
fn documents_say_how_often_intervals_and_regions_hold_what_they_should() {
    let documents = [
        include_str!("../../../../validation/claims.md"),
        include_str!("../../../../docs/guide/src/numbers.md"),
        include_str!("../../../../docs/guide/src/sure.md"),
        include_str!("../../../../docs/paper/paper.md"),
    ];
    for figure in ["34 to 85 %", "30 to 44 %"] {
        assert!(MULTIPLIER_COVERAGE.contains(figure), "{figure}");
    }
    for figure in ["88 to 99 %", "68 to 89 %"] {
        assert!(STIFFNESS_COVERAGE.contains(figure), "{figure}");
        assert!(documents[0].contains(figure) && documents[2].contains(figure), "{figure}");
    }
    for document in documents {
        for figure in ["34 to 85 %", "30 to 44 %", "9 to 24 %", "80 to 86 %"] {
            assert!(document.contains(figure), "{figure} is missing in\n{document}");
        }
    }
    assert!(include_str!("../../../../docs/guide/src/compare.md").contains("9 to 24 %"));
}
