//! How a report was made.

use spineline::analysis::{Analysis, AnalysisOptions, Method};
use spineline::anatomy::PublishedNumbers;
use spineline_files::method_text::{OPTIONS, departures, nearest_method};

use super::Patient;
use crate::document::{Column, Section, Table};

/// Version, choices and sources of one patient's analysis.
pub fn how(patient: &Patient<'_>) -> Section {
    let mut section = Section::new("method", "How this report was made");
    let mut table = options(patient.generator, &patient.analysis.options);
    let mut add = |what: &str, words: String| table.row(vec![what.to_owned(), words]);
    let analysis: &Analysis = patient.analysis;
    add("Films", if analysis.synthetic { "synthetic" } else { "real" }.to_owned());
    add("Lengths", analysis.movement.scale().to_string());
    add("Sagittal shape", analysis.profile_words().to_owned());
    section.table(table);
    section.table(published());
    section.paragraph(MEANING);
    section
}

/// The published numbers of a typical spine, and how far they were compared with their sources.
pub(crate) fn published() -> Table {
    let caption = "Published numbers of a typical spine";
    let mut table = Table::of(caption, PublishedNumbers::ALL, |add| {
        add.words("Numbers", |one| one.numbers);
        add.words("Used for", |one| one.used_for);
        add.words("Source", |one| one.source);
        add.words("Compared", |one| one.check.to_string());
    });
    table.note = "Springs have their sources in the table of springs.".to_owned();
    table
}

const MEANING: &str = "Method: Jalalian et al. 2016, Finding line of action of the force exerted on erect spine based on lateral bending test in personalization of scoliotic spine models. Bending films carry no force, so only ratios of stiffness are identified. Sources are named by their keys in the project's list of references.";

/// Version and choices, which all patients of a run share.
pub(crate) fn options(generator: &str, options: &AnalysisOptions) -> Table {
    let mut table =
        Table::new("Version and options", vec![Column::words("What"), Column::words("Choice")]);
    table.row(vec!["Program".to_owned(), generator.to_owned()]);
    for option in &OPTIONS {
        table.row(vec![option.title.to_owned(), option.words(options)]);
    }
    table
}

/// The method and its changed options; `None` for the default method without changes.
pub(crate) fn changed(options: &AnalysisOptions) -> Option<String> {
    let method = nearest_method(options);
    let usual = method.options();
    let words = departures(options, &usual)
        .map(|option| format!("{}: {}", option.title, option.words(options)));
    let words = words.collect::<Vec<_>>().join("; ");
    match (method, words.is_empty()) {
        (Method::Default, true) => None,
        (Method::Default, false) => Some(format!("Model options are not the defaults. {words}.")),
        (Method::Paper, true) => Some("Method: the paper's.".to_owned()),
        (Method::Paper, false) => Some(format!("Method: the paper's, except for: {words}.")),
    }
}
