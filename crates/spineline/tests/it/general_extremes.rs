//! Bad and extreme loads: every one ends in a named status or a named error.

use crate::common::{Draw, spine};
use spineline::multibody::{
    BodyLoad, EquilibriumPath, ForceSign, GeneralStatics, Goal, LoadItem, Loading, PathEnding,
    PathOptions, Rod, SpineModel, Support, Timing,
};
use spineline::spatial::{Angle, Mat3, Vec3};

/// A number of any size, and now and then none.
fn wild(draw: &mut Draw) -> f64 {
    match draw.below(40) {
        0 => f64::NAN,
        1 => f64::INFINITY,
        2 => 0.0,
        3 => f64::MIN_POSITIVE,
        4 => 1e300,
        _ => draw.between(-1.0, 1.0) * 10_f64.powf(draw.between(-6.0, 7.0)),
    }
}

fn wild_vector(draw: &mut Draw) -> Vec3 {
    Vec3::new(wild(draw), wild(draw), wild(draw))
}

/// A vector of a size that spines meet.
fn tame(draw: &mut Draw, size: f64) -> Vec3 {
    Vec3::from_fn(|_, _| draw.between(-size, size))
}

/// Mostly sensible in one place and wild in another.
fn vector(draw: &mut Draw, size: f64) -> Vec3 {
    if draw.below(6) == 0 { wild_vector(draw) } else { tame(draw, size) }
}

fn any_load(draw: &mut Draw) -> BodyLoad {
    let point_in_vertebra_mm = vector(draw, 40.0);
    match draw.below(7) {
        0 => BodyLoad::ForceOnLine { force_n: vector(draw, 300.0), point_mm: vector(draw, 300.0) },
        1 => BodyLoad::ForceAtPoint { force_n: vector(draw, 300.0), point_in_vertebra_mm },
        2 => BodyLoad::FollowerForce {
            force_in_vertebra_n: vector(draw, 300.0),
            point_in_vertebra_mm,
        },
        3 => BodyLoad::Moment { moment_nmm: vector(draw, 4e4) },
        4 => BodyLoad::FollowerMoment { moment_in_vertebra_nmm: vector(draw, 4e4) },
        5 => BodyLoad::Pad {
            point_in_vertebra_mm,
            direction: if draw.below(9) == 0 {
                wild_vector(draw)
            } else {
                tame(draw, 1.0).normalize()
            },
            n_per_mm: if draw.below(4) == 0 { wild(draw) } else { draw.between(0.1, 50.0) },
            advance_mm: if draw.below(4) == 0 { wild(draw) } else { draw.between(-50.0, 50.0) },
        },
        _ => BodyLoad::Strap {
            point_in_vertebra_mm,
            anchor_mm: vector(draw, 500.0),
            n_per_mm: if draw.below(4) == 0 { wild(draw) } else { draw.between(0.1, 50.0) },
            shortening_mm: if draw.below(4) == 0 { wild(draw) } else { draw.between(-50.0, 50.0) },
        },
    }
}

fn any_timing(draw: &mut Draw) -> Timing {
    if draw.below(3) == 0 { Timing::Constant } else { Timing::Proportional }
}

fn any_loading(draw: &mut Draw) -> Loading {
    let items = (0..draw.below(4)).map(|_| LoadItem {
        vertebra: if draw.below(30) == 0 { draw.below(40) } else { 1 + draw.below(14) },
        load: any_load(draw),
        timing: any_timing(draw),
    });
    let items = items.collect();
    let rods = if draw.below(6) == 0 { 1 } else { 0 };
    let rods = (0..rods).map(|_| Rod {
        inferior: draw.below(14),
        superior: draw.below(16),
        shift_mm: vector(draw, 5.0),
        turn_rad: vector(draw, 0.2),
        timing: any_timing(draw),
    });
    Loading { rods: rods.collect(), items }
}

/// Nothing that is shown may be no number, and only what balances is shown as a result.
fn assert_sound(path: &EquilibriumPath, trial: usize) {
    let numbers = |place: &Vec3| place.iter().all(|x| x.is_finite());
    for point in &path.points {
        assert!(point.deformed.midpoints_mm.iter().all(numbers), "trial {trial}");
        let (factor, residual) = (point.factor, point.residual_rad);
        assert!(factor.is_finite() && residual < 1e-8, "trial {trial}: {factor:e}, {residual:e}");
    }
    for found in &path.equilibria {
        assert!(found.residual_rad < 1e-8 && found.smallest_singular_value.is_finite());
    }
    assert_eq!(path.result().is_some(), path.ending.is_usable(), "trial {trial}");
    assert!(path.points.len() <= 2100, "trial {trial}: {} points", path.points.len());
    assert!(path.ending != PathEnding::Interrupted);
}

#[test]
fn ten_thousand_bad_or_extreme_loads_end_in_a_named_status() {
    let mut draw = Draw::new(29);
    let models: Vec<SpineModel> = (0..18).map(|subject| spine(subject).1).collect();
    let mut endings = std::collections::BTreeMap::<&str, usize>::new();
    for trial in 0..10_000 {
        let model = &models[draw.below(18)];
        let springs: Vec<Mat3> = model
            .joints
            .iter()
            .map(|_| Mat3::from_diagonal(&Vec3::from_fn(|_, _| draw.between(3e4, 6e5))))
            .collect();
        let support = if draw.below(4) == 0 { Support::Frontal } else { Support::Free };
        let statics = GeneralStatics::new(model, springs, support).expect("sound springs");
        let loading = any_loading(&mut draw);
        let goal = match draw.below(3) {
            0 => Goal::LateralTilt(Angle::from_deg(draw.between(-40.0, 40.0))),
            _ => Goal::FullLoad,
        };
        let sign = if draw.below(4) == 0 { ForceSign::Negative } else { ForceSign::Positive };
        let options = PathOptions { sign, ..Default::default() };
        let ending = match statics.follow(&loading, goal, &options) {
            Ok(path) => {
                assert_sound(&path, trial);
                path.ending.key()
            }
            Err(error) => {
                assert!(!error.help().is_empty() && !error.to_string().is_empty());
                "refused"
            }
        };
        *endings.entry(ending).or_default() += 1;
    }
    // All of them: a status that never comes would not be tested.
    let named = [
        "converged",
        "several_equilibria",
        "limit_point",
        "unreachable",
        "not_converged",
        "refused",
    ];
    for ending in named {
        assert!(endings.contains_key(ending), "no {ending} in {endings:?}");
    }
}
