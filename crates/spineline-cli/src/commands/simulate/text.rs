//! One simulation as a report for the terminal.

use spineline::multibody::{Equilibrium, Goal};
use spineline::number::fixed;
use spineline::uncertainty::LoadedUncertainty;
use spineline_files::SimulationWarning;
use spineline_report::document::{Document, Notice, NoticeKind, Section};

use super::outcome::Outcome;
use crate::run::provenance::generator;

pub fn report(outcome: &Outcome) -> Document {
    let mut sections = vec![target(outcome), ending(outcome)];
    sections.extend(outcome.response.result().map(|result| shape(outcome, result)));
    sections.extend([replicates(outcome), path(outcome)]);
    sections.retain(|section| !section.blocks.is_empty());
    Document::new("Simulation", subject(outcome), generator(), sections)
}

pub fn notices(outcome: &Outcome) -> Vec<Notice> {
    let notice = |warning: &SimulationWarning| Notice {
        code: warning.code.key().to_owned(),
        ..Notice::new(NoticeKind::Warning, warning.message.clone())
    };
    outcome.warnings.iter().map(notice).collect()
}

fn subject(outcome: &Outcome) -> String {
    let model = &outcome.model;
    let synthetic = if model.synthetic { " · SYNTHETIC" } else { "" };
    let support = model.support.key();
    format!(
        "{}{synthetic} · model with the {} · {support} support · forces in {}",
        model.case_id,
        model.line,
        model.force_unit()
    )
}

/// The loads, and what is searched for.
fn target(outcome: &Outcome) -> Section {
    let mut section = Section::new("target", "");
    let times = match outcome.response.goal {
        Goal::FullLoad => "",
        Goal::LateralTilt(_) => ", times the factor below",
    };
    for (number, load) in outcome.loads.loads.iter().enumerate() {
        let words = load.words(outcome.model.force_unit());
        section.paragraph(format!("Load {}{times}: {words}", number + 1));
    }
    if !outcome.model.absolute {
        let text = "Forces are relative to the nominal stiffness, not newtons: no force was measured for this model";
        section.paragraph(text.to_owned());
    }
    section.paragraph(match outcome.response.goal {
        Goal::FullLoad => "Target: the shape under these loads".to_owned(),
        Goal::LateralTilt(tilt) => format!(
            "Target: the factor of the loads for a {} of {}; factors up to {} in either direction are tried",
            outcome.tables().lateral_tilt(),
            tilt.leaning(),
            fixed(outcome.response.largest_factor, 1)
        ),
    });
    section
}

/// The status first, then what it means and what to do.
fn ending(outcome: &Outcome) -> Section {
    let mut section = Section::new("ending", "");
    outcome.tables().ending().into_iter().for_each(|text| section.paragraph(text));
    section
}

fn shape(outcome: &Outcome, result: &Equilibrium) -> Section {
    let (mut section, tables) = (Section::new("shape", ""), outcome.tables());
    section.table(tables.forces(result));
    section.table(tables.angles());
    section.table(tables.numbers(result));
    section
}

/// How many replicates have a result, the noise, and what the intervals cover.
fn replicates(outcome: &Outcome) -> Section {
    let mut section = Section::new("replicates", "");
    let words = outcome.uncertainty.iter().flat_map(LoadedUncertainty::words);
    words.for_each(|text| section.paragraph(text));
    section
}

/// The shapes that meet the target and the events on the way, then the warnings.
fn path(outcome: &Outcome) -> Section {
    let (mut section, tables) = (Section::new("path", ""), outcome.tables());
    section.table(tables.solutions());
    tables.events().into_iter().for_each(|text| section.paragraph(text));
    notices(outcome).into_iter().for_each(|notice| section.notice(notice));
    section
}
