//! Uncertainty by landmark noise as text.

use std::fmt::Write;

use spineline::analysis::Analysis;
use spineline::anatomy::Level;
use spineline::uncertainty::{AnalysisQuantity, QuantitySpread, QuantityUnit, Uncertainty};

use super::table::{Table, wrap};

/// The part of a report about the uncertainty of its numbers.
pub fn text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut text = format!(
        "Landmark noise: {} replicates, seed {}; mean of the replicates, interval with 95 % of them\n",
        found.done, found.seed
    );
    if found.done < found.asked {
        let _ = writeln!(text, "  interrupted: {} were requested", found.asked);
    }
    for words in found.noise_words() {
        text.push_str(&wrap(&words, 106, "  "));
    }
    let _ = writeln!(text, "  failed: {} of {} analyses", found.failed, found.done);
    for words in found.failure_words() {
        text.push_str(&wrap(&words, 106, "    "));
    }
    text.push_str(&wrap(Uncertainty::CAVEAT, 106, "  "));
    let _ = write!(text, "\n{}\n{}", places_text(analysis, found), spreads_text(analysis, found));
    text
}

/// Deviations of the measured vertebrae, film by film.
fn places_text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut table = Table::new([
        "Standard deviation of vertebrae",
        "lateral",
        "largest",
        "height",
        "largest",
        "tilt (°)",
        "largest",
    ]);
    for posture in analysis.postures.iter().map(|p| p.outline.posture) {
        let mut row = vec![posture.to_string()];
        for quantity in
            [AnalysisQuantity::LocationY, AnalysisQuantity::LocationZ, AnalysisQuantity::Tilt]
        {
            row.extend(mean_and_largest(found, |level| quantity(posture, level), analysis));
        }
        table.row(row);
    }
    table.text()
}

fn mean_and_largest(
    found: &Uncertainty,
    quantity: impl Fn(Level) -> AnalysisQuantity,
    analysis: &Analysis,
) -> [String; 2] {
    let sds: Vec<(f64, Level)> = Level::MODEL[1..]
        .iter()
        .filter_map(|&level| Some((found.spread(quantity(level))?.sd, level)))
        .collect();
    let Some(&(largest, level)) = sds.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
        return ["-".to_owned(), "-".to_owned()];
    };
    let unit = match quantity(level).unit(analysis) {
        QuantityUnit::Degrees => String::new(),
        unit => format!(" {}", unit.key()),
    };
    let mean = sds.iter().map(|(sd, _)| sd).sum::<f64>() / sds.len() as f64;
    [format!("{mean:.2}{unit}"), format!("{largest:.2} ({level})")]
}

/// Every other number that the report shows.
fn spreads_text(analysis: &Analysis, found: &Uncertainty) -> String {
    let mut table = Table::new(["Number", "unit", "value", "mean", "sd", "95 % interval", "in"]);
    for spread in found.quantities.iter().filter(|spread| spread.quantity.is_reported()) {
        table.row(row(analysis, spread, found.done));
    }
    table.text()
}

fn row(analysis: &Analysis, spread: &QuantitySpread, done: u64) -> Vec<String> {
    let quantity = spread.quantity;
    let number = |value: f64| match quantity.unit(analysis) {
        QuantityUnit::Segments => format!("{value:.0}"),
        QuantityUnit::One | QuantityUnit::Millimetres => format!("{value:.2}"),
        _ => format!("{value:.1}"),
    };
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    let found = spread.spread;
    vec![
        quantity.label(analysis),
        quantity.unit(analysis).key().to_owned(),
        or_dash(spread.nominal.ok().map(number)),
        or_dash(found.map(|s| number(s.mean))),
        or_dash(found.map(|s| format!("{:.2}", s.sd))),
        or_dash(found.map(|s| {
            let [low, high] = s.interval_95();
            format!("{} to {}", number(low), number(high))
        })),
        format!("{:.1} %", 100.0 * spread.count as f64 / done.max(1) as f64),
    ]
}
