//! Inputs that the benches of this crate share.
#![allow(dead_code, reason = "every bench uses a part of them")]

use std::time::Duration;

use criterion::Criterion;
use spineline::action::LineKind;
use spineline::analysis::{Analysis, AnalysisOptions, Case, analyze};
use spineline::multibody::{Load, Support};
use spineline_phantom::{Readers, Scenario, generate};

/// Short runs: a second of warming up would outweigh two of measuring.
pub fn criterion() -> Criterion {
    Criterion::default()
        .measurement_time(Duration::from_secs(2))
        .warm_up_time(Duration::from_millis(500))
        .without_plots()
}

pub fn case(subject: usize, scenario: Scenario, readers: &Readers) -> Case {
    generate(subject, scenario, readers, 1).expect("all 18 subjects have phantoms").case
}

pub fn options(support: Support) -> AnalysisOptions {
    AnalysisOptions { support, ..Default::default() }
}

pub fn analyzed(subject: usize, scenario: Scenario, support: Support) -> Analysis {
    let case = case(subject, scenario, &Readers::exact());
    analyze(&case, &options(support)).expect("phantoms are sound cases")
}

/// Loads along one kind of line on both bends, as the analysis found them.
pub fn bending_loads(analysis: &Analysis, kind: LineKind) -> Vec<Load> {
    let model = analysis.model(kind).expect("every line");
    let fitted = model.simulations.iter().filter(|simulation| simulation.fitted);
    fitted.map(|simulation| Load::along(simulation.line, simulation.depth_mm)).collect()
}
