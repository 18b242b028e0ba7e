//! The repeatability of readings over a cohort.

use spineline::analysis::Analysis;
use spineline::measure::FilmReadings;
use spineline::reliability::{DesignReliability, QuantityReliability, assess, film_quantities};

use crate::document::{Figure, Section};
use crate::figures::bland_altman;
use crate::reliability::{in_short, note_readings};

/// Plotted quantities: tilts between neighbours, which a turn of the film does not change, and the paper's tilts.
const PLOTTED: [&str; 2] = ["tilt_step", "tilt_as_paper"];
/// More points hide one another.
const MAX_POINTS: usize = 4000;

/// Errors and correlations of the readings, and the differences between readers.
pub fn section(analyses: &[Analysis]) -> Section {
    let mut section = Section::new("reliability", "Reliability of the readings");
    let mut cases: Vec<(&str, &[FilmReadings])> = Vec::new();
    for analysis in analyses {
        if !cases.iter().any(|(id, _)| *id == analysis.case_id) {
            cases.push((&analysis.case_id, &analysis.movement.readings));
        }
    }
    let repeated = |films: &&[FilmReadings]| films.iter().any(|film| film.readings.len() > 1);
    if !cases.iter().any(|(_, films)| repeated(films)) {
        section
            .paragraph("Every film was read once: the repeatability of the readings is not known.");
        return section;
    }
    let synthetic = analyses.iter().any(|analysis| analysis.synthetic);
    let mut plots: Vec<Figure> = Vec::new();
    let found: Vec<QuantityReliability> = film_quantities(&cases).iter().map(assess).collect();
    for quantity in &found {
        for (number, design) in (1..).zip(&quantity.designs) {
            plots.extend(plot(quantity, number, design, synthetic));
        }
    }
    section.table(in_short(&found));
    note_readings(&mut section, &found);
    section.paragraph("`spineline reliability --full` has all statistics and designs. Plots of more than 4,000 points are left out.");
    for plot in plots {
        section.figure(plot);
    }
    section
}

/// Bland and Altman's plot, where it can be read. Its name has the number of the design: every observer has one of the same kind.
fn plot(
    quantity: &QuantityReliability,
    number: usize,
    design: &DesignReliability,
    synthetic: bool,
) -> Option<Figure> {
    let few = design.bland_altman.iter().all(|pair| pair.points.len() <= MAX_POINTS);
    if !few || !PLOTTED.contains(&quantity.key.as_str()) {
        return None;
    }
    let svg = bland_altman(quantity, design, synthetic)?;
    let caption = format!(
        "Agreement of {}, {}: differences over means, with bias and limits of agreement.",
        quantity.words(),
        design.design
    );
    let name = format!("agreement-{}-{number}-{}", quantity.key, design.design.key());
    let figure = Figure::new(name, caption, svg);
    // More than one row of panels.
    Some(if design.bland_altman.len() > 2 { figure.on_whole_page() } else { figure })
}
