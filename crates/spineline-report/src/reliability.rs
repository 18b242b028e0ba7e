//! The reliability of readings as a document: one row per quantity, or all statistics of every quantity and design.

use spineline::measure::alike_remark;
use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Remark, StatisticKind, Undefined,
    shown_measure,
};
use spineline::warning::{counted, first_named};

use crate::document::{Column, Document, Notice, NoticeKind, Section, Table};
use crate::phrases::none;

/// Note on the statistics.
pub(crate) const NOTE: &str = "SEM, MDC95 and limits of agreement describe the readers alone. Every correlation also increases with the standard deviation between the subjects. Intervals treat the subjects as independent; vertebrae of one film are not, so true intervals are wider.";

/// Note on quantities of films.
const FILM_NOTE: &str = "A subject is one vertebra, or one with its neighbours, on one film. As paper: all vertebrae together as in the paper, so correlations include the place of a vertebra along the spine and the posture.";

/// One row per quantity: the error of a reading, and how well observers agree.
#[must_use]
pub fn summary(found: &[QuantityReliability], synthetic: bool, generator: &str) -> Document {
    let mut section = Section::new("reliability", "");
    section.table(in_short(found));
    if section.blocks.is_empty() && found.iter().all(|quantity| why_unknown(quantity).is_none()) {
        section.paragraph("No quantity was read twice: its reliability is not known.");
    }
    note_readings(&mut section, found);
    section.paragraph("All statistics and designs: --full.");
    document(section, found.len(), synthetic, generator)
}

/// One table per quantity and design, the errors first, without figures.
#[must_use]
pub fn full(found: &[QuantityReliability], synthetic: bool, generator: &str) -> Document {
    let mut section = Section::new("reliability", "Reliability of the readings");
    for quantity in found {
        section.heading(format!("{}: {}", quantity.key, quantity.meaning));
        for design in &quantity.designs {
            add_design(&mut section, design, &quantity.unit);
        }
    }
    for note in common_notes(found) {
        section.notice(warning("", note));
    }
    section.notice(Notice::new(NoticeKind::Note, NOTE));
    document(section, found.len(), synthetic, generator)
}

fn document(section: Section, quantities: usize, synthetic: bool, generator: &str) -> Document {
    let synthetic = if synthetic { " · SYNTHETIC films" } else { "" };
    let words = if quantities == 1 { "quantity" } else { "quantities" };
    let subject = format!("{quantities} {words}{synthetic}");
    Document::new("Readings", subject, generator, vec![section])
}

/// One row per quantity, by single readings of the observers, or else by the repeats of one.
pub(crate) fn in_short(found: &[QuantityReliability]) -> Table {
    let with_interval = |design: &DesignReliability, kind| match shown_value(design, kind) {
        Some((value, interval)) => format!("{value} ({interval})"),
        None => none(),
    };
    let value = |design: &DesignReliability, kind| {
        shown_value(design, kind).map_or_else(none, |(value, _)| value)
    };
    let rows = found.iter().filter_map(|quantity| Some((quantity, short_design(quantity)?)));
    let mut table = Table::of("Reliability of one reading", rows, |add| {
        add.words("Quantity", |(quantity, _)| format!("{}, {}", quantity.words(), quantity.unit));
        add.words("Compared", |(_, design)| match &design.design {
            Design::InterObserverSingle { .. } => "observers".to_owned(),
            Design::InterObserverMeans => "means of observers".to_owned(),
            Design::IntraObserver { observer } => format!("repeats of {observer}"),
        });
        add.numbers("Subjects", |(_, design)| design.subjects.to_string());
        add.words("SEM (95 %)", |(_, design)| with_interval(design, StatisticKind::SemAgreement));
        add.numbers("MDC95", |(_, design)| value(design, StatisticKind::Mdc95Agreement));
        add.words("ICC(A,1) (95 %)", |(_, design)| {
            with_interval(design, StatisticKind::IccAgreement)
        });
        add.numbers("r", |(_, design)| value(design, StatisticKind::Pearson));
    });
    table.note = format!("MDC95: smallest real change of one reading. r: Pearson. {NOTE}");
    if found.iter().any(|quantity| quantity.key.ends_with("_as_paper")) {
        table.note.push_str(&format!(" {FILM_NOTE}"));
    }
    let mut remarks = remarks_of(found);
    if let Some(left_out) = remarks.find(|remark| matches!(remark, Remark::InPixels { .. })) {
        table.note.push_str(&format!(" {left_out}."));
    }
    table
}

/// A statistic with its interval, where it is known.
fn shown_value(design: &DesignReliability, kind: StatisticKind) -> Option<(String, String)> {
    let (value, interval) = design.statistics.iter().find(|one| one.kind == kind)?.shown();
    value.map(|value| (value, interval))
}

/// The design of a quantity in the summary, if its error is known: single readings of the observers, or else their means or the repeats of one.
fn short_design(quantity: &QuantityReliability) -> Option<&DesignReliability> {
    let is_known =
        |design: &&DesignReliability| shown_value(design, StatisticKind::SemAgreement).is_some();
    quantity.designs.iter().filter(is_known).min_by_key(|design| match design.design {
        Design::InterObserverSingle { .. } => 0,
        Design::InterObserverMeans => 1,
        Design::IntraObserver { .. } => 2,
    })
}

/// Why the error of a quantity is not known although it was read more than once.
fn why_unknown(quantity: &QuantityReliability) -> Option<Undefined> {
    let mut compared = quantity.designs.iter().filter(|design| design.raters.len() > 1);
    compared.find_map(|design| design.statistics.first()?.outcome.err())
}

fn remarks_of(found: &[QuantityReliability]) -> impl Iterator<Item = &Remark> {
    found.iter().flat_map(|one| &one.designs).flat_map(|one| &one.remarks)
}

/// Notes on all quantities: readings that are copies of others, which the numbers lack, and names of quantities that may be one.
fn common_notes(found: &[QuantityReliability]) -> Vec<String> {
    let copied = remarks_of(found).find(|remark| matches!(remark, Remark::Copied { .. }));
    let alike = alike_remark("quantities", found.iter().map(|quantity| quantity.key.as_str()));
    copied.map(Remark::to_string).into_iter().chain(alike).collect()
}

/// Notes on the readings behind a summary: also names of observers and subjects that may be one, subjects that are left out, and
/// quantities without a result. Quantities with the same note share it.
pub(crate) fn note_readings(section: &mut Section, found: &[QuantityReliability]) {
    let mut notes: Vec<(String, Vec<&str>)> =
        common_notes(found).into_iter().map(|note| (note, Vec::new())).collect();
    let is_alike = |remark: &&Remark| {
        matches!(remark, Remark::AlikeNames { .. } | Remark::AlikeSubjects { .. })
    };
    let all = remarks_of(found).filter(is_alike).map(|remark| (remark.to_string(), None));
    let own = found.iter().flat_map(|quantity| {
        let design = short_design(quantity);
        let remarks = design.into_iter().flat_map(|design| &design.remarks);
        let dropped = remarks.filter(|remark| matches!(remark, Remark::Dropped { .. }));
        let unknown = why_unknown(quantity).filter(|_| design.is_none());
        let unknown = unknown.map(|reason| format!("the reliability is not known: {reason}"));
        let texts = dropped.map(Remark::to_string).chain(unknown);
        texts.map(move |text| (text, Some(quantity.key.as_str())))
    });
    for (text, quantity) in all.chain(own) {
        match notes.iter_mut().find(|(own, _)| *own == text) {
            Some((_, quantities)) => quantities.extend(quantity),
            None => notes.push((text, quantity.into_iter().collect())),
        }
    }
    for (text, of) in notes {
        let place = first_named(of.iter().map(|&key| key.to_owned()), of.len());
        section.notice(warning(place, text));
    }
}

fn warning(place: impl Into<String>, text: String) -> Notice {
    Notice { place: place.into(), ..Notice::new(NoticeKind::Warning, text + ".") }
}

fn add_design(section: &mut Section, design: &DesignReliability, unit: &str) {
    let caption = format!("{}: {}", design.design, design.raters.join(" | "));
    // All statistics of a table without raters or subjects lack for the same reason.
    let mut reasons = design.statistics.iter().map(|statistic| statistic.outcome.err());
    if let Some(Some(reason)) = reasons.next()
        && reasons.all(|other| other == Some(reason))
    {
        section.paragraph(format!("{caption}: undefined: {reason}"));
        return;
    }
    let compared = match design.design {
        Design::IntraObserver { .. } => "repeat",
        Design::InterObserverMeans | Design::InterObserverSingle { .. } => "observer",
    };
    let n = [counted(design.subjects, "subject"), counted(design.raters.len(), compared)];
    let columns = vec![
        Column::words("Statistic"),
        Column::numbers("Value"),
        Column::words("95 % interval"),
        Column::words("Unit"),
    ];
    let mut table = Table::new(format!("{caption} ({})", n.join(", ")), columns);
    for statistic in &design.statistics {
        let (value, interval) = statistic.shown();
        let unit = if statistic.kind.has_unit() { unit } else { "1" }.to_owned();
        table.row(vec![statistic.kind.to_string(), value.unwrap_or_else(none), interval, unit]);
    }
    for pair in &design.bland_altman {
        table.rows.extend(agreement_rows(pair, unit));
    }
    section.table(table);
    // Copies are named once for all designs.
    for remark in design.remarks.iter().filter(|one| !matches!(one, Remark::Copied { .. })) {
        section.notice(Notice::new(NoticeKind::Note, format!("{remark}.")));
    }
}

/// The rows of a table for bias and limits of agreement.
fn agreement_rows(pair: &BlandAltman, unit: &str) -> [Vec<String>; 3] {
    let [first, second] = &pair.raters;
    pair.named_limits().map(|(name, value, interval)| {
        let interval = interval.map(|ends| ends.map(shown_measure));
        vec![
            format!("Bland-Altman {name}, {second} minus {first}"),
            shown_measure(value),
            interval.map_or_else(none, |[low, high]| format!("{low} to {high}")),
            unit.to_owned(),
        ]
    })
}
