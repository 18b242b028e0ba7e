//! An analysis of one patient → a report: what speaks against it first, and how it was made last.

mod measured;
mod method;
mod model;
mod sureness;

use spineline::analysis::{Analysis, Case, LinesCompared};
use spineline::personalize::Identifiability;
use spineline::uncertainty::Uncertainty;

use crate::document::{Document, Notice, NoticeKind, Section};
use crate::figures::FilmPicture;

pub(crate) use measured::none;
pub(crate) use method::options;
pub(crate) use model::numbers;

/// What a report is made from.
#[derive(Debug, Clone, Copy)]
pub struct Patient<'a> {
    /// The films.
    pub case: &'a Case,
    /// What was found.
    pub analysis: &'a Analysis,
    /// Pictures of the films, as far as there are any.
    pub pictures: &'a [FilmPicture],
    /// What the films say of every model's multipliers, in the order of the models; `None` where nobody asked.
    pub identifiability: Option<&'a [Option<Identifiability>]>,
    /// What the noise of landmarks does to the numbers; `None` where nobody asked.
    pub uncertainty: Option<&'a Uncertainty>,
    /// Program that makes the report.
    pub generator: &'a str,
    /// The analysis as JSON, to be embedded.
    pub json: &'a str,
}

/// The report of one patient.
#[must_use]
pub fn report(patient: &Patient<'_>) -> Document {
    let analysis = patient.analysis;
    let compared = analysis.compare_lines();
    let mut sections = vec![verdict(analysis, &compared)];
    sections.push(measured::films(patient));
    sections.push(measured::movement(analysis));
    sections.push(measured::line(analysis));
    sections.push(model::simulated(analysis));
    sections.push(model::space(analysis));
    sections.push(model::stiffness(patient));
    sections.push(model::errors(analysis));
    sections.push(model::comparison(analysis, &compared));
    sections.extend(patient.uncertainty.map(|found| sureness::numbers(analysis, found)));
    sections.push(method::how(patient));
    Document {
        title: "Patient report".to_owned(),
        subject: analysis.case_id.clone(),
        generator: patient.generator.to_owned(),
        banners: banners(analysis.synthetic),
        sections,
        analysis: patient.json.to_owned(),
    }
}

/// What stands above every report.
pub(crate) fn banners(synthetic: bool) -> Vec<Notice> {
    let made_up = "Synthetic data: made up, not measured on a patient. Every number and picture here is synthetic.";
    let device =
        "Research software, not a medical device: no diagnosis and no treatment may rest on it.";
    let texts = synthetic.then_some(made_up).into_iter().chain([device]);
    texts.map(|text| Notice::new(NoticeKind::Banner, text)).collect()
}

/// The verdict in sentences, then all that speaks against the numbers, the heaviest first.
fn verdict(analysis: &Analysis, compared: &LinesCompared) -> Section {
    let mut section = Section::new("verdict", "Verdict, contradictions and warnings");
    for sentence in analysis.verdict(compared) {
        section.paragraph(sentence);
    }
    let mut notices: Vec<Notice> = analysis.warnings.all().iter().map(Notice::from).collect();
    notices.sort_by_key(|notice| notice.kind);
    if notices.is_empty() {
        section.paragraph("No contradiction and no warning was met.");
    }
    for notice in notices {
        section.notice(notice);
    }
    section
}
