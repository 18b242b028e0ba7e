//! The general solver: one equilibrium by Newton from a nearby start, and whole paths by continuation.

mod common;

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use spineline::anatomy::Levels;
use spineline::multibody::{
    BodyLoad, GeneralStatics, Goal, Loading, NewtonWork, PathOptions, Rod, Support, Timing,
};
use spineline::spatial::{Angle, Mat3, Vec3};
use spineline_phantom::Scenario;

/// Loadings of 14 joints, 42 hinges: what changes with the pose grows from one to the next.
fn loadings() -> Vec<(&'static str, Loading)> {
    let push = Vec3::new(0.0, 40.0, -10.0);
    let line = BodyLoad::ForceOnLine { force_n: push, point_mm: Vec3::new(0.0, 0.0, 350.0) };
    let at_t2 = BodyLoad::at_midpoint(push);
    let follower =
        BodyLoad::FollowerForce { force_in_vertebra_n: push, point_in_vertebra_mm: Vec3::zeros() };
    let pad = BodyLoad::Pad {
        point_in_vertebra_mm: Vec3::new(0.0, -40.0, 0.0),
        direction: Vec3::y(),
        n_per_mm: 5.0,
        advance_mm: 20.0,
    };
    let mut standing = Loading::single(7, pad);
    standing.items.extend(Loading::gravity(Levels::COMPLETE, 400.0, -Vec3::z(), Timing::Constant));
    let rod = Rod::locking(4, 10, Timing::Constant);
    let rod = Loading { items: standing.items.clone(), rods: vec![rod] };
    vec![
        ("line fixed in space", Loading::single(14, line)),
        ("force at T2", Loading::single(14, at_t2)),
        ("follower force", Loading::single(14, follower)),
        ("gravity and pad", standing),
        ("gravity, pad and rod", rod),
    ]
}

fn started(work: &mut NewtonWork, hinges: &[Vec3]) {
    work.hinges_mut().copy_from_slice(hinges);
}

fn general(criterion: &mut Criterion) {
    let analysis = common::analyzed(0, Scenario::Rod, Support::Free);
    let springs = |_| Mat3::from_diagonal(&Vec3::new(140e3, 140e3, 250e3));
    let statics =
        GeneralStatics::new(&analysis.movement.spine, (0..14).map(springs), Support::Free)
            .expect("sound springs");
    let loadings = loadings();
    let mut group = criterion.benchmark_group("general");
    for (name, loading) in &loadings {
        let mut work = statics.work(loading).expect("sound loads");
        for factor in [0.25, 0.5, 0.75, 0.95] {
            assert!(statics.solve_near(loading, factor, &mut work), "{name}");
        }
        let hinges = work.hinges_mut().to_vec();
        // From the equilibrium at 95 % of the load.
        started(&mut work, &hinges);
        assert!(statics.solve_near(loading, 1.0, &mut work), "{name}");
        let label = format!("nearby start, {name}");
        group.bench_function(label, |bencher| {
            bencher.iter(|| {
                started(&mut work, black_box(&hinges));
                black_box(statics.solve_near(loading, black_box(1.0), &mut work))
            });
        });
        let label = format!("path to full load, {name}");
        let options = PathOptions { look_beyond: false, ..Default::default() };
        group.bench_function(label, |bencher| {
            bencher.iter(|| black_box(statics.follow(loading, Goal::FullLoad, &options)));
        });
    }
    let options = PathOptions { look_beyond: false, ..Default::default() };
    let target = Goal::LateralTilt(Angle::from_deg(-15.0));
    group.bench_function("path to an amplitude, force at T2", |bencher| {
        bencher.iter(|| black_box(statics.follow(&loadings[1].1, target, &options)));
    });
    group.finish();
}

criterion_group! { name = benches; config = common::criterion(); targets = general }
criterion_main!(benches);
