//! How sure the numbers are: from the films themselves, and from the noise of landmarks.

use spineline::analysis::Analysis;
use spineline::personalize::{Identifiability, MultiplierInformation, ProfileEnd};
use spineline::uncertainty::{QuantityUnit, Uncertainty};

use super::measured::none;
use crate::document::{Column, Notice, NoticeKind, Section, Table};

/// An interval of a multiplier from its profile.
pub fn interval(one: &MultiplierInformation, scale: f64) -> String {
    let end = |end: ProfileEnd, open: f64| match end {
        ProfileEnd::At(log) => format!("{:.2}", scale * log.exp()),
        ProfileEnd::Open if open < 1.0 => format!("below {:.2}", scale * open),
        ProfileEnd::Open => format!("above {:.1}", scale * open),
        ProfileEnd::Lost(_) => "?".to_owned(),
    };
    format!("{} to {}", end(one.profile.lower, 0.1), end(one.profile.upper, 10.0))
}

/// What the bending films say of every multiplier.
pub fn identifiability(
    section: &mut Section,
    analysis: &Analysis,
    found: &[Option<Identifiability>],
) {
    let columns = vec![
        Column::words("Line of action"),
        Column::words("Joints"),
        Column::numbers("sd of ln (1)"),
        Column::words("What the films identify"),
    ];
    let mut table = Table::new("Profile likelihood of the multipliers", columns);
    for (model, found) in analysis.models.iter().zip(found) {
        let Some(found) = found else {
            let text = format!("{}: its fit did not converge, so nothing is known.", model.kind);
            section.notice(Notice::new(NoticeKind::Warning, text));
            continue;
        };
        for (name, one) in model.groups.names().iter().zip(&found.multipliers) {
            let sd = one.log_sd;
            table.row(vec![
                model.kind.to_string(),
                name.replace('_', " "),
                if sd < 100.0 { format!("{sd:.2}") } else { "unlimited".to_owned() },
                one.profile.verdict().to_string(),
            ]);
        }
        if found.variance_factor > 1.0 {
            let times = found.variance_factor.sqrt();
            let text = format!(
                "{}: the fit leaves {times:.1} times what noise explains; intervals are widened by that.",
                model.kind
            );
            section.notice(Notice::new(NoticeKind::Note, text));
        }
    }
    section.table(table);
}

/// Every number of the report with its interval.
pub fn numbers(analysis: &Analysis, found: &Uncertainty) -> Section {
    let mut section = Section::new("uncertainty", "What landmark noise does to the numbers");
    section.paragraph(format!(
        "{} replicates, seed {}; {} of them failed. The interval holds 95 % of the others.",
        found.done, found.seed, found.failed
    ));
    for words in found.noise_words().into_iter().chain(found.failure_words()) {
        section.paragraph(words);
    }
    section.notice(Notice::new(NoticeKind::Note, Uncertainty::CAVEAT));
    if found.done < found.asked {
        let text = format!("Broken off: {} replicates were asked for.", found.asked);
        section.notice(Notice::new(NoticeKind::Warning, text));
    }
    let columns = vec![
        Column::words("Number"),
        Column::words("Unit"),
        Column::numbers("Value"),
        Column::numbers("Mean"),
        Column::numbers("sd"),
        Column::words("95 % interval"),
        Column::numbers("In (%)"),
    ];
    let mut table = Table::new("Numbers over the replicates", columns);
    for spread in found.quantities.iter().filter(|spread| spread.quantity.is_reported()) {
        let unit = spread.quantity.unit(analysis);
        let number = |value: f64| match unit {
            QuantityUnit::Segments => format!("{value:.0}"),
            QuantityUnit::One | QuantityUnit::Millimetres => format!("{value:.2}"),
            _ => format!("{value:.1}"),
        };
        let of = spread.spread;
        table.row(vec![
            spread.quantity.label(analysis),
            unit.key().to_owned(),
            spread.nominal.ok().map_or_else(none, number),
            of.map_or_else(none, |s| number(s.mean)),
            of.map_or_else(none, |s| format!("{:.2}", s.sd)),
            of.map_or_else(none, |s| {
                let [low, high] = s.interval_95();
                format!("{} to {}", number(low), number(high))
            }),
            format!("{:.1}", 100.0 * spread.count as f64 / found.done.max(1) as f64),
        ]);
    }
    section.table(table);
    section
}
