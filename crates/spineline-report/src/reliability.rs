//! The reliability of readings as a document: all statistics of every quantity and design.

use spineline::reliability::{
    BlandAltman, DesignReliability, QuantityReliability, Statistic, shown_measure,
};

use crate::document::{Column, Document, Notice, NoticeKind, Section, Table};
use crate::phrases::none;

/// Note on the statistics.
pub(crate) const NOTE: &str = "SEM, MDC95 and limits of agreement describe the readers alone. Every correlation also increases with the standard deviation between the subjects. Intervals treat the subjects as independent; vertebrae of one film are not, so true intervals are wider.";

/// One table per quantity and design, the errors first, without figures; a terminal shows it.
#[must_use]
pub fn summary(found: &[QuantityReliability], synthetic: bool, generator: &str) -> Document {
    let mut section = Section::new("reliability", "Reliability of the readings");
    for quantity in found {
        section.heading(format!("{}: {}", quantity.key, quantity.meaning));
        for design in &quantity.designs {
            add_design(&mut section, design, &quantity.unit);
        }
    }
    section.notice(Notice::new(NoticeKind::Note, NOTE));
    let synthetic = if synthetic { " · SYNTHETIC films" } else { "" };
    let quantities = if found.len() == 1 { "quantity" } else { "quantities" };
    Document {
        title: "Readings".to_owned(),
        subject: format!("{} {quantities}{synthetic}", found.len()),
        generator: generator.to_owned(),
        banners: Vec::new(),
        sections: vec![section],
        analysis: String::new(),
    }
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
    let counted = |count: usize, word: &str| match count {
        1 => format!("1 {word}"),
        _ => format!("{count} {word}s"),
    };
    let n = [counted(design.subjects, "subject"), counted(design.raters.len(), "rater")];
    let columns = vec![
        Column::words("Statistic"),
        Column::numbers("Value"),
        Column::words("95 % interval"),
        Column::words("Unit"),
    ];
    let mut table = Table::new(format!("{caption} ({})", n.join(", ")), columns);
    for statistic in &design.statistics {
        table.row(statistic_row(statistic, unit));
    }
    for pair in &design.bland_altman {
        table.rows.extend(agreement_rows(pair, unit));
    }
    section.table(table);
    for remark in &design.remarks {
        section.notice(Notice::new(NoticeKind::Note, format!("{remark}.")));
    }
}

fn statistic_row(statistic: &Statistic, unit: &str) -> Vec<String> {
    let (value, interval) = statistic.shown();
    let unit = if statistic.kind.has_unit() { unit } else { "1" };
    vec![statistic.kind.name().to_owned(), value.unwrap_or_else(none), interval, unit.to_owned()]
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
