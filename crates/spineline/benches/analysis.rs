//! Whole cases, and the two steps that handle the finest chain.

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline::analysis::{Case, analyze};
use spineline::anatomy::Posture;
use spineline::curve::{CurveFit, OrderRule, fit_curve};
use spineline::measure::{Outline, TiltRule, measure_film};
use spineline::multibody::Support;
use spineline::warning::Warnings;
use spineline_phantom::{Readers, Scenario};

/// Films of six readings; every iteration takes another subject.
fn cases() -> Vec<Case> {
    (0..6).map(|subject| common::case(subject, Scenario::Bend, &Readers::default())).collect()
}

fn erect_only(mut case: Case) -> Case {
    case.films.retain(|film| film.posture == Posture::Erect);
    case
}

fn whole(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("analyze");
    let options = common::options(Support::Frontal);
    let alone: Vec<Case> = cases().into_iter().map(erect_only).collect();
    for (name, cases) in [("five films of six readings", cases()), ("erect film alone", alone)] {
        let mut next = 0;
        group.bench_function(name, |bencher| {
            bencher.iter(|| {
                next = (next + 1) % cases.len();
                black_box(analyze(black_box(&cases[next]), &options))
            });
        });
    }
    // Patients bent by a force through their inflections, where that line fits well.
    let rods: Vec<Case> =
        (0..6).map(|subject| common::case(subject, Scenario::Rod, &Readers::default())).collect();
    let mut next = 0;
    group.bench_function("five films of six readings, rod phantoms", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % rods.len();
            black_box(analyze(black_box(&rods[next]), &options))
        });
    });
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let mut warnings = Warnings::default();
    let outlines: Vec<Outline> = cases()
        .iter()
        .flat_map(|case| &case.films)
        .map(|film| measure_film(film, TiltRule::default(), &mut warnings).expect("a sound film"))
        .collect();
    let fit = |outline: &Outline, rule| -> CurveFit {
        fit_curve(outline, rule, &mut Warnings::default()).expect("a plain spine")
    };
    let mut next = 0;
    criterion.bench_function("fit_curve, orders 4 to 12", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % outlines.len();
            black_box(fit(black_box(&outlines[next]), OrderRule::LeaveOneOut))
        });
    });
    let fits: Vec<CurveFit> =
        outlines.iter().map(|outline| fit(outline, OrderRule::LeaveOneOut)).collect();
    let analysis = analyze(&cases()[0], &common::options(Support::Frontal)).expect("a sound case");
    criterion.bench_function("chain.lay, about 1000 segments", |bencher| {
        bencher.iter(|| {
            next = (next + 1) % fits.len();
            black_box(analysis.movement.chain.lay(black_box(&fits[next].curve)))
        });
    });
}

criterion_group! { name = benches; config = common::criterion(); targets = whole, steps }
criterion_main!(benches);
