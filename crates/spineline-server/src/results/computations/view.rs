//! Computations as the browser shows them.

use spineline::analysis::Analysis;
use spineline::anatomy::Posture;
use spineline::number::fixed;
use spineline::personalize::MULTIPLIER_COVERAGE;
use spineline::uncertainty::{QuantityKind, QuantitySpread, QuantityUnit, Uncertainty};
use spineline_report::patient::parts;

use crate::api::{Computation, ComputationView, IntervalView, Wire};
use crate::jobs::{ComputationJob, Found, progress};

/// State, progress and results of a computation.
pub fn view(name: Computation, job: Option<&ComputationJob>) -> ComputationView {
    let (progress, found) = progress(job);
    let mut view =
        ComputationView { name: Wire(name), progress, intervals: Vec::new(), sections: Vec::new() };
    // Computations exist only for analysed results.
    if let Some((job, found)) = job.zip(found)
        && let Some(analysis) = job.result.analysis()
    {
        add(&mut view, analysis, found);
    }
    view
}

fn add(view: &mut ComputationView, analysis: &Analysis, found: &Found) {
    view.sections = match found {
        Found::Replicates(found) => {
            view.intervals = intervals(analysis, found);
            view.progress.texts = texts(found);
            Vec::new()
        }
        Found::Identifiability(found) => vec![parts::identifiability(analysis, found)],
        Found::Models(found) => parts::models(found).into_iter().collect(),
    };
}

fn texts(found: &Uncertainty) -> Vec<String> {
    let words = found.few_words().into_iter().chain(found.noise_words());
    let words = words.chain(found.failure_words());
    words.chain([Uncertainty::CAVEAT, MULTIPLIER_COVERAGE].map(str::to_owned)).collect()
}

/// Angles of the erect film, scales of films, multipliers and forces.
fn intervals(analysis: &Analysis, found: &Uncertainty) -> Vec<IntervalView> {
    let is_shown = |one: &&QuantitySpread| match one.quantity.kind {
        QuantityKind::Cobb | QuantityKind::Ferguson => one.quantity.posture == Some(Posture::Erect),
        QuantityKind::FilmScale | QuantityKind::LogMultiplier | QuantityKind::Force => true,
        _ => false,
    };
    let shown = found.quantities.iter().filter(is_shown);
    shown.filter_map(|one| interval(analysis, one)).collect()
}

fn interval(analysis: &Analysis, one: &QuantitySpread) -> Option<IntervalView> {
    let is_multiplier = one.multiplier().is_some();
    let shown = |number: f64| if is_multiplier { number.exp() } else { number };
    let value = shown(one.nominal.ok()?);
    let ends = one.interval_95().map(|ends| ends.map(shown));
    let only_if = one.quantity.interval_caveat().map_or("", |_| " (if the model is exact)");
    let label = one.quantity.label(analysis);
    let label = if is_multiplier { label.replace("ln of the ", "") } else { label };
    let text = |number: f64| match one.quantity.unit(analysis) {
        QuantityUnit::Degrees => format!("{}°", fixed(number, 1)),
        QuantityUnit::Newtons => format!("{} N", fixed(number, 0)),
        QuantityUnit::RelativeForce => format!("{} (relative)", fixed(number, 0)),
        QuantityUnit::Millimetres | QuantityUnit::Pixels | QuantityUnit::Segments => {
            fixed(number, 1)
        }
        QuantityUnit::One => fixed(number, 3),
    };
    Some(IntervalView {
        label,
        value: text(value),
        interval: match ends {
            Some([low, high]) => format!("{} to {}{only_if}", text(low), text(high)),
            None if one.at_bound => "none: at its bound, not identified".to_owned(),
            None => return None,
        },
    })
}
