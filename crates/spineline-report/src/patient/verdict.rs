//! Notices above a report, the verdict and the warnings.

use spineline::analysis::{Analysis, AnalysisOptions};

use super::{grouped, method};
use crate::document::{Notice, NoticeKind, Section};

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

pub(super) fn sentences(section: &mut Section, analysis: &Analysis) {
    for sentence in analysis.verdict() {
        section.paragraph(sentence);
    }
}

/// The verdict in sentences, then contradictions and warnings, the most severe first.
pub(super) fn verdict(analysis: &Analysis) -> Section {
    let mut section = Section::new("verdict", "Evidence, contradictions and warnings");
    sentences(&mut section, analysis);
    let mut notices = grouped::notices(analysis.all_warnings());
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
