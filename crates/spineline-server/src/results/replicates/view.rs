//! Replicates as the browser shows them.

use std::sync::atomic::Ordering;

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline::uncertainty::{AnalysisQuantity, QuantitySpread, QuantityUnit, Uncertainty};

use crate::api::{IntervalView, ReplicatesState, ReplicatesView};
use crate::replicate_jobs::{Ending, Job};

/// State, progress and intervals of a computation.
pub fn view(job: Option<&Job>) -> ReplicatesView {
    let Some(job) = job else {
        let state = ReplicatesState::None;
        return ReplicatesView { state, done: 0, asked: 0, intervals: vec![], texts: vec![] };
    };
    let (state, intervals, texts) = match job.ending.get() {
        None => (ReplicatesState::Running, Vec::new(), Vec::new()),
        Some(Ending::Cancelled) => (ReplicatesState::Cancelled, Vec::new(), Vec::new()),
        Some(Ending::Failed(why)) => (ReplicatesState::Failed, Vec::new(), vec![why.clone()]),
        Some(Ending::Done(found)) => {
            let rows = job.result.analysis().map(|analysis| intervals(analysis, found));
            (ReplicatesState::Done, rows.unwrap_or_default(), texts(found))
        }
    };
    let done = job.done.load(Ordering::Relaxed);
    ReplicatesView { state, done, asked: job.asked, intervals, texts }
}

fn texts(found: &Uncertainty) -> Vec<String> {
    let words = found.noise_words().into_iter().chain(found.failure_words());
    words.chain([Uncertainty::CAVEAT.to_owned()]).collect()
}

/// Angles of the erect film, scales of films, multipliers and forces.
fn intervals(analysis: &Analysis, found: &Uncertainty) -> Vec<IntervalView> {
    let is_shown = |one: &&QuantitySpread| {
        matches!(
            one.quantity,
            AnalysisQuantity::Cobb(Posture::Erect, _)
                | AnalysisQuantity::Ferguson(Posture::Erect, _)
                | AnalysisQuantity::FilmScale(_)
                | AnalysisQuantity::LogMultiplier(..)
                | AnalysisQuantity::Force(..)
        )
    };
    let shown = found.quantities.iter().filter(is_shown);
    shown.filter_map(|one| interval(analysis, one)).collect()
}

fn interval(analysis: &Analysis, one: &QuantitySpread) -> Option<IntervalView> {
    let [low, high] = one.interval_95()?;
    let multiplier = one.multiplier();
    let (value, low, high) =
        match multiplier.and_then(|found| Some((found.value?, found.quantiles?))) {
            Some((value, quantiles)) => (value, quantiles[0], quantiles[4]),
            None => (one.nominal.ok()?, low, high),
        };
    let label = one.quantity.label(analysis);
    let label = if multiplier.is_some() { label.replace("ln of the ", "") } else { label };
    let text = |number: f64| match one.quantity.unit(analysis) {
        QuantityUnit::Degrees => format!("{number:.1}°"),
        QuantityUnit::Force => format!("{number:.0}"),
        QuantityUnit::Millimetres | QuantityUnit::Pixels | QuantityUnit::Segments => {
            format!("{number:.1}")
        }
        QuantityUnit::One => format!("{number:.3}"),
    };
    Some(IntervalView {
        label,
        value: text(value),
        interval: format!("{} to {}", text(low), text(high)),
    })
}
