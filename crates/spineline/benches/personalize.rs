//! The search for a force, and the fit of one line to two bends.

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline::action::LineKind;
use spineline::anatomy::Posture;
use spineline::measure::Outline;
use spineline::multibody::{
    FittedSprings, ForceSign, JointGroups, Statics, StiffnessLibrary, Support, match_amplitude,
};
use spineline::personalize::evidence::FilmEvidence;
use spineline::personalize::{FitFilm, FitSettings, FitTarget, personalize};
use spineline::spatial::Angle;
use spineline_phantom::Scenario;

const BENDS: [Posture; 2] = [Posture::LeftBending, Posture::RightBending];

fn search(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("match_amplitude");
    let library = StiffnessLibrary::default();
    for (scenario, kind) in
        [(Scenario::Pull, LineKind::Iliac), (Scenario::Rod, LineKind::Inflection)]
    {
        let analysis = common::analyzed(0, scenario, Support::Frontal);
        let model = analysis.model(kind).expect("every line");
        let groups = JointGroups::regional(&analysis.movement.regions);
        let statics = Statics::new(
            &analysis.movement.spine,
            &library,
            &groups,
            &model.fit.log_multipliers,
            Support::Frontal,
        );
        let load = common::bending_loads(&analysis, kind)[0];
        let fitted = model.simulation(BENDS[0]).expect("a left bend");
        let sign = ForceSign::of(fitted.force_n);
        let tilt = fitted.shape.locations[14].lateral_tilt();
        let mut step = 0_u32;
        group.bench_function(format!("{} phantom, {kind}", scenario.key()), |bencher| {
            bencher.iter(|| {
                // Another target each time, within half a degree.
                step = (step + 1) % 64;
                let target = tilt * (1.0 - 1e-3 * f64::from(step) / 64.0);
                black_box(match_amplitude(&statics, black_box(&load), sign, black_box(target)))
            });
        });
    }
    group.finish();
}

fn fit(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("personalize");
    let library = StiffnessLibrary::default();
    for support in [Support::Free, Support::Frontal] {
        for target in [FitTarget::Shape, FitTarget::Ferguson] {
            let analysis = common::analyzed(0, Scenario::Rod, support);
            let groups = JointGroups::regional(&analysis.movement.regions);
            let loads = common::bending_loads(&analysis, LineKind::Inflection);
            let (model, erect) = (&analysis.movement.spine, &analysis.movement.erect().outline);
            let variants: Vec<Vec<Outline>> = (0..16).map(|i| bends(&analysis, i)).collect();
            let shapes = FitSettings::of_shapes(&analysis.movement.regions, support);
            let settings = FitSettings { target, ..shapes };
            let mut next = 0;
            let name = format!("{support:?}, {target:?}").to_lowercase();
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    next = (next + 1) % variants.len();
                    let outlines = &variants[next];
                    let measure = |outline| FilmEvidence::measure(model, &library, erect, outline);
                    let evidence: Vec<FilmEvidence> = outlines.iter().map(measure).collect();
                    let films: Vec<FitFilm<'_>> = outlines
                        .iter()
                        .zip(&evidence)
                        .zip(&loads)
                        .map(|((outline, evidence), &load)| FitFilm { outline, evidence, load })
                        .collect();
                    let springs =
                        FittedSprings { model, erect, library: &library, groups: &groups };
                    black_box(personalize(springs, black_box(&films), &settings, None))
                });
            });
        }
    }
    group.finish();
}

/// The two bends, each vertebra moved a little, differently in every variant.
fn bends(analysis: &spineline::analysis::Analysis, variant: u32) -> Vec<Outline> {
    BENDS
        .map(|posture| {
            let mut outline = analysis.movement.film(posture).expect("both bends").outline.clone();
            for (i, vertebra) in outline.vertebrae.iter_mut().enumerate().skip(1) {
                let wobble = (f64::from(variant) + 1.7 * i as f64).sin();
                vertebra.location.y_mm += 0.2 * wobble;
                vertebra.tilt = vertebra.tilt + Angle::from_deg(0.3 * wobble);
            }
            outline
        })
        .into()
}

criterion_group! { name = benches; config = common::criterion(); targets = search, fit }
criterion_main!(benches);
