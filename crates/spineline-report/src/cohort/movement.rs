//! Rotations of segments over a cohort, with table 2 of the paper.

use spineline::cohort::{Cohort, PairedComparison};
use spineline::number::with_sd;

use crate::document::{Figure, Section, Table};
use crate::figures::{self, EstimateGroup, InflectionSample};
use crate::phrases::mean_words;

const NO_MOVEMENT: &str = "No patient has both a pair of inflections and a film of another posture than erect: inflections and least-rotating segments cannot be compared.";

/// Figures 6 and 10, and the tests between the two estimates.
pub fn section(cohort: &Cohort) -> Section {
    let mut section = Section::new("movement", "Movement of the spine");
    let all = &cohort.inflection[0];
    let sample = InflectionSample {
        name: "all patients".to_owned(),
        distances_segments: all.all_distances_segments.clone(),
        rotations_deg: all.all_rotations_deg.clone(),
    };
    match figures::inflection_distances(&[sample], None, false, cohort.synthetic) {
        Some(svg) => {
            let caption =
                "Inflection segments against the least-rotating segments (figure 6 of the paper).";
            section.figure(Figure::new("inflections", caption, svg));
        }
        None => section.paragraph(NO_MOVEMENT),
    }
    if let Some(svg) =
        figures::least_rotating_estimates(&EstimateGroup::of(cohort), cohort.synthetic)
    {
        let caption = "Inflections and MMS_Mean as estimates of the least-rotating segments (figure 10 of the paper).";
        section.figure(Figure::new("estimates", caption, svg));
    }
    section.table(rotations(cohort));
    section.table(table_2(cohort));
    section
}

fn rotations(cohort: &Cohort) -> Table {
    let inflections = &cohort.inflection[0];
    let rows = [
        ("Residual of the curve's locations (mm)", cohort.rmse_mm, 2),
        ("Residual of the curve's tilts (°)", cohort.rmse_deg, 2),
        ("Rotation of all segments (°)", cohort.rotation_deg, 4),
        ("Rotation of the least-rotating segments (°)", cohort.least_rotation_deg, 5),
        ("Rotation of the inflection segments (°)", inflections.rotation_deg, 4),
        ("Inflections to the least-rotating segments (segments)", inflections.distance_segments, 1),
        ("Inflections to the least-rotating segments (mm)", inflections.distance_mm, 2),
    ];
    let rows = rows.into_iter().filter(|(_, of, _)| of.pooled.n > 0);
    Table::of("Curves and rotations", rows, |add| {
        add.words("Quantity", |(name, ..)| *name);
        add.numbers("Values", |(_, of, _)| of.pooled.n.to_string());
        add.numbers("Mean ± sd, pooled", |(_, of, places)| {
            with_sd(of.pooled.mean, of.pooled.sd, *places)
        });
        add.words("Mean over patients (95 %)", |(_, of, places)| mean_words(of, *places));
    })
}

fn table_2(cohort: &Cohort) -> Table {
    let names = [
        ("distance on bends", "segments"),
        ("distance on neutral and traction films", "segments"),
        ("rotation on bends", "°"),
        ("rotation on neutral and traction films", "°"),
    ];
    let tests = names.into_iter().zip(&cohort.table_2);
    let tests = tests.filter(|(_, test)| test.patients() > 0);
    let rows = tests.map(|((quantity, unit), test)| (quantity, test, unit));
    let caption = "Two estimates of the least-rotating segments (table 2 of the paper)";
    table_of_tests(caption, "Inflections minus MMS_Mean", rows)
}

/// Comparisons as the paper tests them and as patients do. A row has a quantity, its comparison and its unit.
pub fn table_of_tests<'a>(
    caption: &str,
    head: &str,
    rows: impl IntoIterator<Item = (&'static str, &'a PairedComparison, &'static str)>,
) -> Table {
    Table::of(caption, rows, |add| {
        add.words(head, |(quantity, _, unit)| format!("{quantity} ({unit})"));
        add.words("The paper's pooled test", |(_, test, unit)| test.pooled_words(unit));
        add.words("Over patients", |(_, test, unit)| test.patient_words(unit));
    })
}
