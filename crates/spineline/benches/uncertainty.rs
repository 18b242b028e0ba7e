//! One replicate of a landmark Monte Carlo: all marks moved, all steps done anew, every number taken.

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline::analysis::analyze;
use spineline::multibody::Support;
use spineline::uncertainty::{LandmarkNoise, MonteCarlo};
use spineline_phantom::{Readers, Scenario};

fn replicate(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("replicate, five films of six readings");
    for (support, name) in [(Support::Free, "free"), (Support::Frontal, "frontal")] {
        for scenario in Scenario::PAPER {
            let case = common::case(0, scenario, &Readers::default());
            let nominal = analyze(&case, &common::options(support)).expect("a sound case");
            let monte_carlo =
                MonteCarlo::new(&case, &nominal, LandmarkNoise::Measured, 1).expect("sound noise");
            let mut index = 0;
            group.bench_function(format!("{}, {name}", scenario.key()), |bencher| {
                bencher.iter(|| {
                    index += 1;
                    black_box(monte_carlo.replicate(black_box(index)))
                });
            });
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = common::criterion(); targets = replicate }
criterion_main!(benches);
