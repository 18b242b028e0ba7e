//! The effect of landmark noise as a study store keeps it: the results that the replicates add to the case's own.

use serde::{Deserialize, Serialize};
use spineline::action::LineKind;
use spineline::anatomy::Posture;
use spineline::uncertainty::{
    Absent, FailureCount, LoadedSpread, LoadedUncertainty, QuantitySpread, Spread, Uncertainty,
};

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    done: u64,
    failed: u64,
    failures: Vec<StoredFailure>,
    /// In the order of the analysis.
    quantities: Vec<StoredSpread>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredFailure {
    code: String,
    line: Option<LineKind>,
    posture: Option<Posture>,
    count: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSpread {
    count: u64,
    absent: Vec<(Absent, u64)>,
    spread: Option<StoredValues>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredLoaded {
    done: u64,
    usable: u64,
    endings: Vec<(String, u64)>,
    /// Count and values, in the order of the measures.
    numbers: Vec<(u64, Option<StoredValues>)>,
}

/// Mean, standard deviation, quantiles.
type StoredValues = (f64, f64, [f64; 5]);

fn stored_values(spread: Spread) -> StoredValues {
    (spread.mean, spread.sd, spread.quantiles)
}

fn spread_of((mean, sd, quantiles): StoredValues) -> Spread {
    Spread { mean, sd, quantiles }
}

/// The replicates of a case as text.
#[must_use]
pub fn uncertainty_text(found: &Uncertainty) -> String {
    let failure = |one: &FailureCount| StoredFailure {
        code: one.code.to_string(),
        line: one.line,
        posture: one.posture,
        count: one.count,
    };
    let spread = |one: &QuantitySpread| StoredSpread {
        count: one.count,
        absent: one.absent.clone(),
        spread: one.spread.map(stored_values),
    };
    crate::to_line(&Stored {
        done: found.done,
        failed: found.failed,
        failures: found.failures.iter().map(failure).collect(),
        quantities: found.quantities.iter().map(spread).collect(),
    })
}

/// Reads what [`uncertainty_text`] wrote. `empty` is the same case without a replicate, such as an empty
/// [`Tally`](spineline::uncertainty::Tally) gives; `None` where the text does not belong to it.
#[must_use]
pub fn parse_uncertainty(text: &str, empty: Uncertainty) -> Option<Uncertainty> {
    let stored: Stored = serde_json::from_str(text).ok()?;
    if stored.quantities.len() != empty.quantities.len() {
        return None;
    }
    let spreads = empty.quantities.iter().zip(stored.quantities);
    let spread = |(one, kept): (&QuantitySpread, StoredSpread)| QuantitySpread {
        count: kept.count,
        absent: kept.absent,
        spread: kept.spread.map(spread_of),
        ..one.clone()
    };
    let failure = |one: StoredFailure| FailureCount {
        code: one.code.into(),
        line: one.line,
        posture: one.posture,
        count: one.count,
    };
    Some(Uncertainty {
        done: stored.done,
        failed: stored.failed,
        failures: stored.failures.into_iter().map(failure).collect(),
        quantities: spreads.map(spread).collect(),
        ..empty
    })
}

/// The replicates of a model under loads as text.
#[must_use]
pub fn loaded_uncertainty_text(found: &LoadedUncertainty) -> String {
    let endings = found.endings.iter();
    let number = |one: &LoadedSpread| (one.count, one.spread.map(stored_values));
    crate::to_line(&StoredLoaded {
        done: found.done,
        usable: found.usable,
        endings: endings.map(|(code, count)| (code.to_string(), *count)).collect(),
        numbers: found.numbers.iter().map(number).collect(),
    })
}

/// Reads what [`loaded_uncertainty_text`] wrote. `empty` is the same model and loads without a replicate, such as an empty
/// [`LoadedTally`](spineline::uncertainty::LoadedTally) gives; `None` where the text does not belong to it.
#[must_use]
pub fn parse_loaded_uncertainty(text: &str, empty: LoadedUncertainty) -> Option<LoadedUncertainty> {
    let stored: StoredLoaded = serde_json::from_str(text).ok()?;
    if stored.numbers.len() != empty.numbers.len() {
        return None;
    }
    let numbers = empty.numbers.iter().zip(stored.numbers);
    let number = |(one, (count, values)): (&LoadedSpread, (u64, Option<StoredValues>))| {
        LoadedSpread { count, spread: values.map(spread_of), ..one.clone() }
    };
    let endings = stored.endings.into_iter();
    Some(LoadedUncertainty {
        done: stored.done,
        usable: stored.usable,
        endings: endings.map(|(code, count)| (code.into(), count)).collect(),
        numbers: numbers.map(number).collect(),
        ..empty
    })
}
