//! Reliability of readings as text.

use spineline::reliability::{DesignReliability, QuantityReliability, Statistic, shown_measure};
use spineline_tables::limits_of_agreement;

use super::table::{Table, wrap};

/// One table per quantity and design, the errors first.
pub fn text(found: &[QuantityReliability], synthetic: bool) -> String {
    let mut text = String::new();
    if synthetic {
        text.push_str("SYNTHETIC films\n\n");
    }
    for quantity in found {
        text.push_str(&wrap(&format!("{}: {}", quantity.key, quantity.meaning), 110, ""));
        for design in &quantity.designs {
            text.push_str(&design_text(design, &quantity.unit));
        }
        text.push('\n');
    }
    text.push_str(&wrap(
        "SEM, MDC95 and limits of agreement describe the readers alone. Every correlation also grows with the spread of the subjects. Intervals assume independent subjects; vertebrae of one film are not independent, so true intervals are wider.",
        110,
        "",
    ));
    text
}

fn design_text(design: &DesignReliability, unit: &str) -> String {
    let few = |count: usize, word: &str| {
        if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
    };
    let mut text = format!("\n{}: {}\n", design.design, design.raters.join(" | "));
    // All statistics of a table without raters or subjects are undefined for the same reason.
    let mut reasons = design.statistics.iter().map(|statistic| statistic.outcome.err());
    if let Some(Some(reason)) = reasons.next()
        && reasons.all(|other| other == Some(reason))
    {
        text.push_str(&format!("  undefined: {reason}\n"));
        return text;
    }
    let n = format!("{}, {}", few(design.subjects, "subject"), few(design.raters.len(), "rater"));
    let mut table = Table::new(["Statistic", "value", "95 % CI", "unit", "n"]);
    for statistic in &design.statistics {
        table.row(cells(statistic, unit, &n));
    }
    for pair in &design.bland_altman {
        for (name, value, interval) in limits_of_agreement(pair) {
            let [first, second] = &pair.raters;
            let range = interval.map_or_else(|| "-".to_owned(), |i| between(i, shown_measure));
            table.row(vec![
                format!("Bland-Altman {name}, {second} minus {first}"),
                shown_measure(value),
                range,
                unit.to_owned(),
                n.clone(),
            ]);
        }
    }
    text.push_str(&table.text());
    for remark in &design.remarks {
        text.push_str(&wrap(&format!("! {remark}"), 110, "  "));
    }
    text
}

fn cells(statistic: &Statistic, unit: &str, n: &str) -> Vec<String> {
    let (value, range) = statistic.shown();
    let unit = if statistic.kind.has_unit() { unit } else { "" };
    let value = value.unwrap_or_else(|| "-".to_owned());
    vec![statistic.kind.name().to_owned(), value, range, unit.to_owned(), n.to_owned()]
}

fn between([low, high]: [f64; 2], shown: fn(f64) -> String) -> String {
    format!("{} to {}", shown(low), shown(high))
}
