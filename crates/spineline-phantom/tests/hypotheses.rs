//! Loads and bases on films of known truth: the one that made them wins.

use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::hypothesis::{Hypothesis, Role};
use spineline::multibody::Support;
use spineline_phantom::{Readers, Truth, generate};

fn compared(index: usize, truth: Truth, readers: &Readers) -> Analysis {
    let phantom = generate(index, truth, readers, 1).expect("a phantom");
    let options = AnalysisOptions {
        support: Support::Frontal,
        hypotheses: Hypothesis::compared(),
        ..Default::default()
    };
    analyze(&phantom.case, &options).expect("a sound case")
}

#[test]
fn print_all() {
    for truth in [Truth::Rod, Truth::Pull].into_iter().chain(Truth::OTHERS) {
        println!("{truth:?}");
        let all: Vec<Analysis> = [0, 2, 4, 6, 8, 12]
            .iter()
            .filter_map(|&index| {
                generate(index, truth, &Readers::default(), 1).map_err(|e| println!("{e}")).ok()?;
                Some(compared(index, truth, &Readers::default()))
            })
            .collect();
        if all.is_empty() {
            continue;
        }
        for h in Hypothesis::compared() {
            let fits: Vec<_> = all
                .iter()
                .filter_map(|a| a.hypotheses.iter().find(|f| f.hypothesis == h))
                .collect();
            let mean = |v: &dyn Fn(&spineline::hypothesis::HypothesisFit) -> f64| {
                fits.iter().map(|f| v(f)).sum::<f64>() / fits.len() as f64
            };
            let e = |r| mean(&|f| f.mean_location_error_mm(r).unwrap_or(f64::NAN));
            println!(
                "  {:32} n {} aicc {:7.1} bic {:7.1} fit {:6.2} left {:6.2} load {:6.2} held {:6.2} lost {} unconverged {}",
                h.key(),
                fits.len(),
                mean(&|f| f.criteria.aicc),
                mean(&|f| f.criteria.bic),
                e(Role::Fitted),
                e(Role::LeftOut),
                e(Role::LeftOutLoadFitted),
                e(Role::HeldOut),
                fits.iter().map(|f| f.lost.len()).sum::<usize>(),
                fits.iter()
                    .filter(|f| f.status != spineline::personalize::FitStatus::Converged)
                    .count()
            );
        }
    }
}
