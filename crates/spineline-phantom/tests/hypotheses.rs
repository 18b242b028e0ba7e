//! Loads and bases on films of known truth: the one that made them wins.

use spineline::analysis::{Analysis, AnalysisOptions, analyze};
use spineline::hypothesis::{Base, Hypothesis, HypothesisFit, LoadShape, Role};
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
        for index in [0, 8] {
            let a = compared(index, truth, &Readers::default());
            println!("{truth:?} {index}");
            for f in &a.hypotheses {
                let e = |r| f.mean_location_error_mm(r).unwrap_or(f64::NAN);
                println!(
                    "  {:32} {:?} K {:2} rms {:7.2} aicc {:8.1} bic {:8.1} fit {:6.2} left {:6.2} load {:6.2} held {:6.2} lost {:?} base {:?}",
                    f.hypothesis.key(), f.status, f.criteria.fitted, f.criteria.residual_rms(), f.criteria.aicc, f.criteria.bic,
                    e(Role::Fitted), e(Role::LeftOut), e(Role::LeftOutLoadFitted), e(Role::HeldOut), f.lost.len(),
                    f.of_role(Role::Fitted).map(|p| p.base.deg()).collect::<Vec<_>>()
                );
            }
        }
    }
}
