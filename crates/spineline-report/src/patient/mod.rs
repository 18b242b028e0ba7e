//! An analysis of one patient → a report: contradictions and warnings first, the method last.

mod check;
mod grouped;
mod measured;
mod method;
mod model;
pub mod parts;
mod short;
mod space;
mod summary;
mod uncertainty;

use spineline::analysis::{Analysis, AnalysisOptions, Case};
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;

use crate::document::{Document, Figure, Notice, NoticeKind, Section};
use crate::figures::{self, FilmPicture};
use crate::hypotheses;

pub use check::{check, film_warnings, films_table};
pub(crate) use method::{options, published};
use short::Intervals;
pub(crate) use short::outcome;
pub use summary::{full, summary};

/// Data for a report.
#[derive(Debug, Clone, Copy)]
pub struct Patient<'a> {
    /// The films.
    pub case: &'a Case,
    /// The results.
    pub analysis: &'a Analysis,
    /// Images of the films, where available; [`summary`] shows none.
    pub pictures: &'a [FilmPicture],
    /// Identifiability of every model's multipliers, in the order of the models; `None` where it was not requested.
    pub identifiability: Option<&'a [Option<Identifiability>]>,
    /// The effect of landmark noise on the numbers; `None` where it was not requested.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Program that makes the report.
    pub generator: &'a str,
    /// The analysis as JSON, to be embedded; [`summary`] does not show it.
    pub json: &'a str,
}

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
    Document {
        title: "Patient report".to_owned(),
        subject: analysis.case_id.clone(),
        generator: patient.generator.to_owned(),
        banners: banners(analysis.synthetic)
            .into_iter()
            .chain(of_options(&analysis.options))
            .collect(),
        sections,
        analysis: patient.json.to_owned(),
    }
}

/// Notices above every report.
pub(crate) fn banners(synthetic: bool) -> Vec<Notice> {
    let generated = "Synthetic data: generated, not measured on a patient. Every number and picture here is synthetic.";
    let device =
        "Research software, not a medical device: not to be used for diagnosis or treatment.";
    let texts = synthetic.then_some(generated).into_iter().chain([device]);
    texts.map(|text| Notice::new(NoticeKind::Banner, text)).collect()
}

/// A notice of the method and its changed options; `None` for the default method without changes.
pub(crate) fn of_options(options: &AnalysisOptions) -> Option<Notice> {
    method::changed(options).map(|text| Notice::new(NoticeKind::Banner, text))
}

/// The verdict in sentences.
fn sentences(section: &mut Section, analysis: &Analysis) {
    for sentence in analysis.verdict() {
        section.paragraph(sentence);
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
        title: "analysis".to_owned(),
        subject: analysis.case_id.clone(),
        generator: generator.to_owned(),
        banners: banners(analysis.synthetic),
        sections: vec![verdict],
        analysis: String::new(),
    }
}

/// The verdict in sentences, then contradictions and warnings, the most severe first.
fn verdict(analysis: &Analysis) -> Section {
    let mut section = Section::new("verdict", "Evidence, contradictions and warnings");
    sentences(&mut section, analysis);
    let mut notices = grouped::notices(analysis.warnings.all());
    notices.sort_by_key(|notice| notice.kind);
    if notices.is_empty() {
        section.paragraph("No contradictions and no warnings.");
    }
    for notice in notices {
        section.notice(notice);
    }
    section
}

/// The doubted films, each once.
pub(crate) fn doubted_films(analysis: &Analysis) -> Vec<String> {
    let mut films: Vec<String> = Vec::new();
    for warning in analysis.film_doubts() {
        let film = warning.posture.map_or_else(|| "lateral".to_owned(), |p| p.to_string());
        if !films.contains(&film) {
            films.push(film);
        }
    }
    films
}
