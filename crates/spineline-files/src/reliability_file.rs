//! Reliability of readings, as a file and as a part of an analysis file.

use schemars::JsonSchema;
use serde::Serialize;
use spineline::reliability::{
    BlandAltman, Design, DesignReliability, QuantityReliability, Statistic,
};

use crate::Provenance;

/// Reliability and error of readings. Lengths in the unit of their quantity, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[schemars(title = "Spineline reliability, version 1")]
pub struct ReliabilityFile {
    format: String,
    version: u32,
    /// Program that wrote it.
    generator: String,
    /// Provenance.
    provenance: Provenance,
    /// Whether any reading is of synthetic films.
    synthetic: bool,
    quantities: Vec<QuantityRecord>,
}

/// One quantity in all designs.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
pub(crate) struct QuantityRecord {
    quantity: String,
    unit: String,
    /// Description of the quantity and of its subjects.
    meaning: String,
    designs: Vec<DesignRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct DesignRecord {
    /// `inter_observer_means`, `inter_observer_single` or `intra_observer`.
    design: String,
    /// Of `intra_observer`: whose repeats are compared.
    observer: Option<String>,
    /// Of `inter_observer_single`: which repeat is compared.
    repeat: Option<u32>,
    raters: Vec<String>,
    /// Readings in one rater's value, by rater.
    repeats: Vec<usize>,
    /// Subjects that all raters rated.
    subjects: usize,
    /// Subjects that are left out because not all raters read them.
    dropped: usize,
    statistics: Vec<StatisticRecord>,
    bland_altman: Vec<BlandAltmanRecord>,
    remarks: Vec<ReasonRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct StatisticRecord {
    statistic: String,
    /// Symbol, model, definition and unit in words.
    name: String,
    /// Formula.
    definition: String,
    /// Unit of its value; `null` for a coefficient.
    unit: Option<String>,
    value: Option<f64>,
    /// Over the pairs of raters, where it is a mean over several.
    sd: Option<f64>,
    interval_95: Option<[f64; 2]>,
    /// Reason for a missing value.
    undefined: Option<ReasonRecord>,
    /// Reason for a missing interval.
    interval_undefined: Option<ReasonRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct BlandAltmanRecord {
    /// Differences are the second minus the first.
    raters: [String; 2],
    bias: f64,
    sd: f64,
    /// Bias -1.96 and +1.96 standard deviations.
    limits: [f64; 2],
    bias_interval_95: Option<[f64; 2]>,
    limit_intervals_95: Option<[[f64; 2]; 2]>,
    interval_undefined: Option<ReasonRecord>,
}

#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
struct ReasonRecord {
    code: String,
    message: String,
}

impl ReliabilityFile {
    /// The file of the results, with its provenance.
    #[must_use]
    pub fn new(
        quantities: &[QuantityReliability],
        synthetic: bool,
        generator: &str,
        provenance: Provenance,
    ) -> Self {
        Self {
            format: "spineline-reliability".to_owned(),
            version: 1,
            generator: generator.to_owned(),
            provenance,
            synthetic,
            quantities: quantities.iter().map(QuantityRecord::new).collect(),
        }
    }
}

impl QuantityRecord {
    pub(crate) fn new(quantity: &QuantityReliability) -> Self {
        Self {
            quantity: quantity.key.clone(),
            unit: quantity.unit.clone(),
            meaning: quantity.meaning.clone(),
            designs: quantity.designs.iter().map(|d| design(d, &quantity.unit)).collect(),
        }
    }
}

fn design(found: &DesignReliability, unit: &str) -> DesignRecord {
    let (observer, repeat) = match &found.design {
        Design::InterObserverMeans => (None, None),
        Design::InterObserverSingle { repeat } => (None, Some(*repeat)),
        Design::IntraObserver { observer } => (Some(observer.clone()), None),
    };
    let remarks = found.remarks.iter();
    let remarks =
        remarks.map(|r| ReasonRecord { code: r.key().to_owned(), message: r.to_string() });
    DesignRecord {
        design: found.design.key().to_owned(),
        observer,
        repeat,
        raters: found.raters.clone(),
        repeats: found.repeats.clone(),
        subjects: found.subjects,
        dropped: found.dropped,
        statistics: found.statistics.iter().map(|s| statistic(s, unit)).collect(),
        bland_altman: found.bland_altman.iter().map(bland_altman).collect(),
        remarks: remarks.collect(),
    }
}

fn statistic(found: &Statistic, unit: &str) -> StatisticRecord {
    let kind = found.kind;
    let interval = found.outcome.map(|estimate| estimate.interval);
    StatisticRecord {
        statistic: kind.key().to_owned(),
        name: kind.to_string(),
        definition: kind.definition().to_owned(),
        unit: kind.has_unit().then(|| unit.to_owned()),
        value: found.outcome.ok().map(|estimate| estimate.value),
        sd: found.outcome.ok().and_then(|estimate| estimate.sd),
        interval_95: interval.ok().and_then(Result::ok),
        undefined: found.outcome.err().map(reason),
        interval_undefined: interval.ok().and_then(Result::err).map(reason),
    }
}

fn bland_altman(found: &BlandAltman) -> BlandAltmanRecord {
    BlandAltmanRecord {
        raters: found.raters.clone(),
        bias: found.bias,
        sd: found.sd,
        limits: found.limits,
        bias_interval_95: found.bias_interval.ok(),
        limit_intervals_95: found.limit_intervals.ok(),
        interval_undefined: found.bias_interval.err().map(reason),
    }
}

fn reason(why: spineline::reliability::Undefined) -> ReasonRecord {
    ReasonRecord { code: why.key().to_owned(), message: why.to_string() }
}
