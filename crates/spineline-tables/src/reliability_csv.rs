//! Reliability of readings as CSV.

use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Statistic,
};

use crate::error::TableError;
use crate::records::rows_to_csv;

const HEADING: [&str; 16] = [
    "synthetic",
    "quantity",
    "design",
    "observer",
    "raters",
    "repeats",
    "subjects",
    "dropped",
    "statistic",
    "name",
    "value",
    "sd",
    "ci95_low",
    "ci95_high",
    "unit",
    "undefined",
];

/// One row per statistic, and per bias and limit of every pair.
///
/// # Errors
/// [`TableError::Csv`], though every row has a cell per column.
pub fn reliability_csv(
    found: &[QuantityReliability],
    synthetic: bool,
) -> Result<String, TableError> {
    let designs = found.iter().flat_map(|of| of.designs.iter().map(move |design| (of, design)));
    rows_to_csv(
        "reliability",
        HEADING,
        designs.flat_map(|(of, design)| rows(of, design, synthetic)),
    )
}

fn rows(
    quantity: &QuantityReliability,
    design: &DesignReliability,
    synthetic: bool,
) -> Vec<Vec<String>> {
    let shared = [
        synthetic.to_string(),
        quantity.key.clone(),
        design.design.key().to_owned(),
        match &design.design {
            Design::IntraObserver { observer } => observer.clone(),
            _ => String::new(),
        },
        design.raters.len().to_string(),
        design.repeats.iter().map(usize::to_string).collect::<Vec<_>>().join(" "),
        design.subjects.to_string(),
        design.dropped.to_string(),
    ];
    let statistics = design.statistics.iter().map(|s| statistic_cells(s, &quantity.unit));
    let pairs = design.bland_altman.iter();
    let pairs =
        pairs.flat_map(|pair| pair.named_limits().map(|l| limit_cells(pair, l, &quantity.unit)));
    let row = |cells: [String; 8]| shared.iter().cloned().chain(cells).collect();
    statistics.chain(pairs).map(row).collect()
}

fn statistic_cells(statistic: &Statistic, unit: &str) -> [String; 8] {
    let kind = statistic.kind;
    let estimate = statistic.outcome.ok();
    let interval = estimate.and_then(|estimate| estimate.interval.ok());
    let number = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    [
        kind.key().to_owned(),
        kind.name().to_owned(),
        number(estimate.map(|estimate| estimate.value)),
        number(estimate.and_then(|estimate| estimate.sd)),
        number(interval.map(|interval| interval[0])),
        number(interval.map(|interval| interval[1])),
        if kind.has_unit() { unit.to_owned() } else { String::new() },
        statistic.outcome.err().map_or_else(String::new, |reason| reason.key().to_owned()),
    ]
}

fn limit_cells(
    pair: &BlandAltman,
    (name, value, interval): (&str, f64, Option<[f64; 2]>),
    unit: &str,
) -> [String; 8] {
    let [first, second] = &pair.raters;
    let bound = |i: usize| interval.map_or_else(String::new, |bounds| bounds[i].to_string());
    [
        format!("bland_altman_{}", name.replace(' ', "_")),
        format!("{second} minus {first}"),
        value.to_string(),
        if name == "bias" { pair.sd.to_string() } else { String::new() },
        bound(0),
        bound(1),
        unit.to_owned(),
        String::new(),
    ]
}
