//! Chains of vertebrae under any loads, for tests of the general solver.

use spineline::multibody::{
    BodyLoad, BranchEventKind, Equilibrium, EquilibriumPath, GeneralStatics, Goal, LoadItem,
    Loading, PathOptions, Rod, SpineModel, Support, Timing,
};
use spineline::spatial::{Mat3, Vec3};

/// A plane in which a chain bends: by its x hinges towards -y, or by its y hinges towards +x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Plane {
    Lateral,
    Flexion,
}

impl Plane {
    pub const BOTH: [Self; 2] = [Self::Lateral, Self::Flexion];

    /// Which hinge of a joint turns.
    pub const fn hinge(self) -> usize {
        match self {
            Self::Lateral => 0,
            Self::Flexion => 1,
        }
    }

    /// The axis about which the chain bends.
    pub fn axis(self) -> Vec3 {
        match self {
            Self::Lateral => Vec3::x(),
            Self::Flexion => Vec3::y(),
        }
    }

    /// Where a positive turn tips what stands upright.
    pub fn side(self) -> Vec3 {
        match self {
            Self::Lateral => -Vec3::y(),
            Self::Flexion => Vec3::x(),
        }
    }

    /// The point so far to the side and so far up.
    pub fn point(self, side_mm: f64, up_mm: f64) -> Vec3 {
        self.side() * side_mm + Vec3::z() * up_mm
    }
}

/// A straight upright chain: vertebrae at heights, and joints at heights between them.
pub fn straight(midpoints_z_mm: &[f64], centres_z_mm: &[f64]) -> SpineModel {
    let midpoints = midpoints_z_mm.iter().map(|&z| Vec3::new(0.0, 0.0, z)).collect();
    let centres: Vec<Vec3> = centres_z_mm
        .iter()
        .zip(midpoints_z_mm)
        .map(|(centre, midpoint)| Vec3::new(0.0, 0.0, centre - midpoint))
        .collect();
    SpineModel::from_poses(midpoints, vec![Mat3::identity(); midpoints_z_mm.len()], &centres)
}

/// One joint at the origin, and the top so far above it.
pub fn pendulum(length_mm: f64) -> SpineModel {
    straight(&[0.0, length_mm], &[0.0])
}

/// Springs about x, y and z, the same at every joint.
pub fn springs(model: &SpineModel, nmm_per_rad: [f64; 3]) -> Vec<Mat3> {
    vec![Mat3::from_diagonal(&Vec3::from(nmm_per_rad)); model.joints.len()]
}

pub fn proportional(vertebra: usize, load: BodyLoad) -> LoadItem {
    LoadItem::proportional(vertebra, load)
}

pub fn constant(vertebra: usize, load: BodyLoad) -> LoadItem {
    LoadItem { vertebra, load, timing: Timing::Constant }
}

/// A dead force at a vertebra's midpoint.
pub fn dead(force_n: Vec3) -> BodyLoad {
    BodyLoad::at_midpoint(force_n)
}

pub fn loads(items: impl IntoIterator<Item = LoadItem>) -> Loading {
    Loading { items: items.into_iter().collect(), rods: Vec::new() }
}

pub fn with_rods(items: Vec<LoadItem>, rods: Vec<Rod>) -> Loading {
    Loading { items, rods }
}

/// The path to the full load.
#[track_caller]
pub fn follow(
    model: &SpineModel,
    stiffness: &[Mat3],
    support: Support,
    loading: &Loading,
    options: &PathOptions,
) -> EquilibriumPath {
    let solver = GeneralStatics::new(model, stiffness.to_vec(), support).expect("sound springs");
    solver.follow(loading, Goal::FullLoad, options).expect("sound loads")
}

/// Hinges may turn as far as they like.
pub fn far() -> PathOptions {
    PathOptions { largest_hinge_rad: 3.0, ..PathOptions::default() }
}

/// The shape under the full load, on a branch where nothing happened up to it.
#[track_caller]
pub fn equilibrium(
    model: &SpineModel,
    stiffness: &[Mat3],
    support: Support,
    loading: &Loading,
) -> Equilibrium {
    let options = PathOptions { look_beyond: false, ..far() };
    let path = follow(model, stiffness, support, loading, &options);
    path.result().unwrap_or_else(|| panic!("no result: {:?}", path.ending)).clone()
}

/// Factors of the events of a kind.
pub fn events(path: &EquilibriumPath, kind: BranchEventKind) -> Vec<f64> {
    path.events.iter().filter(|event| event.kind == kind).map(|event| event.factor).collect()
}

/// Where a continuous function that changes its sign between two places is zero, by bisection to the last bit.
pub fn root(mut low: f64, mut high: f64, function: impl Fn(f64) -> f64) -> f64 {
    let rises = function(high) > 0.0;
    assert!((function(low) > 0.0) != rises, "no change of sign between {low} and {high}");
    for _ in 0..200 {
        let middle = f64::midpoint(low, high);
        if (function(middle) > 0.0) == rises {
            high = middle;
        } else {
            low = middle;
        }
    }
    f64::midpoint(low, high)
}

/// How fast errors fall when the number of elements is doubled: the exponent between each two.
pub fn orders(errors: &[f64]) -> Vec<f64> {
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}
