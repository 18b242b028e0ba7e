//! An analysis of one patient → a report: contradictions and warnings first, the method last.

mod check;
mod data;
mod grouped;
mod measured;
mod method;
mod model;
pub mod parts;
mod short;
mod space;
mod summary;
mod uncertainty;
mod verdict;

use spineline::analysis::Analysis;

use crate::document::{Document, Figure};
use crate::figures;
use crate::hypotheses;

pub use check::{check, film_warnings, films_table};
pub use data::Patient;
pub(crate) use method::{options, published};
use short::Intervals;
pub(crate) use short::outcome;
pub use summary::{full, summary};
use verdict::verdict;
pub(crate) use verdict::{banners, doubted_films, of_options};

/// The report of one patient.
#[must_use]
pub fn report(patient: &Patient<'_>) -> Document {
    let analysis = patient.analysis;
    let mut sections = vec![short::short(analysis, Intervals::of(patient)), verdict(analysis)];
    sections.push(measured::films(patient));
    sections.extend(space::both_films(analysis));
    sections.extend(space::axial(analysis));
    sections.push(measured::movement(analysis));
    sections.push(measured::line(analysis));
    sections.push(model::simulated(analysis));
    sections.push(model::space(analysis));
    sections.push(model::stiffness(patient));
    sections.push(model::errors(analysis));
    sections.push(model::comparison(analysis));
    sections.extend(hypotheses::of_patient(analysis));
    sections.extend(patient.uncertainty.map(|found| uncertainty::numbers(analysis, found)));
    sections.push(method::how(patient));
    let banners = banners(analysis.synthetic).into_iter().chain(of_options(&analysis.options));
    Document {
        banners: banners.collect(),
        analysis: patient.json.to_owned(),
        ..Document::new("Patient report", &analysis.case_id, patient.generator, sections)
    }
}

/// An analysis for a notebook: banners, verdict, contradictions and warnings, and all films side by side.
#[must_use]
pub fn overview(analysis: &Analysis, generator: &str) -> Document {
    let mut verdict = verdict(analysis);
    verdict.title = String::new();
    let caption = "Measured spine, fitted curve, inflections and candidate lines of action";
    verdict.figure(Figure::new("overview", caption, figures::case_overview(analysis)));
    Document {
        banners: banners(analysis.synthetic),
        ..Document::new("analysis", &analysis.case_id, generator, vec![verdict])
    }
}
