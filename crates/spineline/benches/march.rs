//! One equilibrium of 14 joints under a line fixed in space, with and without derivatives.
//!
//! The force and the multipliers differ from call to call, and neither they nor the shape can be computed ahead.

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline::action::LineKind;
use spineline::multibody::{JointGroups, Parameter, Solution, Statics, StiffnessLibrary, Support};
use spineline_phantom::Scenario;

/// Forces that follow one another without a pattern, between -60 and 60 N.
fn next_force(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    120.0 * ((*state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
}

fn march(criterion: &mut Criterion) {
    let parameters = [
        Parameter::Load(0),
        Parameter::LogStiffness(0),
        Parameter::LogStiffness(1),
        Parameter::LogStiffness(2),
    ];
    let mut group = criterion.benchmark_group("march");
    for support in [Support::Free, Support::Frontal] {
        let analysis = common::analyzed(0, Scenario::Rod, support);
        let load = common::bending_loads(&analysis, LineKind::Inflection)[0];
        let (library, groups) =
            (StiffnessLibrary::default(), JointGroups::regional(&analysis.movement.regions));
        let statics =
            Statics::new(&analysis.movement.spine, &library, &groups, &[0.1, 0.3, -0.4], support);
        for count in [0, 1, 4] {
            let name = format!("{support:?}, {count} derivatives").to_lowercase();
            let mut state = 7;
            let mut solution = Solution::default();
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let force_n = black_box(next_force(&mut state));
                    let by = black_box(&parameters[..count]);
                    statics.solve(&load, &[force_n], by, &mut solution);
                    black_box(&mut solution);
                });
            });
        }
    }
    group.finish();
}

criterion_group! { name = benches; config = common::criterion(); targets = march }
criterion_main!(benches);
