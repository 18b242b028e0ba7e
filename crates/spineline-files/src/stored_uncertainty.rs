//! The effect of landmark noise as a study store keeps it: what the replicates have added to what the case itself gives.

use serde::{Deserialize, Serialize};
use spineline::action::LineKind;
use spineline::anatomy::Posture;
use spineline::uncertainty::{Absent, FailureCount, QuantitySpread, Spread, Uncertainty};

use crate::keys::Key;

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
    line: Option<Key<LineKind>>,
    posture: Option<Key<Posture>>,
    count: u64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StoredSpread {
    count: u64,
    absent: Vec<(Key<Absent>, u64)>,
    /// Mean, standard deviation, quantiles.
    spread: Option<(f64, f64, [f64; 5])>,
}

/// The replicates of a case as text.
#[must_use]
pub fn uncertainty_text(found: &Uncertainty) -> String {
    let failure = |one: &FailureCount| StoredFailure {
        code: one.code.to_string(),
        line: one.line.map(Key),
        posture: one.posture.map(Key),
        count: one.count,
    };
    let spread = |one: &QuantitySpread| StoredSpread {
        count: one.count,
        absent: one.absent.iter().map(|(why, count)| (Key(*why), *count)).collect(),
        spread: one.spread.map(|s| (s.mean, s.sd, s.quantiles)),
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
        absent: kept.absent.into_iter().map(|(why, count)| (why.0, count)).collect(),
        spread: kept.spread.map(|(mean, sd, quantiles)| Spread { mean, sd, quantiles }),
        ..one.clone()
    };
    let failure = |one: StoredFailure| FailureCount {
        code: one.code.into(),
        line: one.line.map(|key| key.0),
        posture: one.posture.map(|key| key.0),
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
