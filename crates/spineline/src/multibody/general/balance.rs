use super::loading::{Loading, Timing};
use super::rods::{RodEquations, RodState};
use super::wrench::{Pose, Spatial, SpatialMatrix, first, second, spatial};
use crate::multibody::{Deformed, SpineModel, Support};
use crate::spatial::{Mat3, Vec3, sin_cos};

/// How much of the constant and of the proportional loads is applied, and which of them the derivative is for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Factors {
    pub constant: f64,
    pub proportional: f64,
    pub varies: Timing,
}

impl Factors {
    pub(super) fn of(&self, timing: Timing) -> f64 {
        match timing {
            Timing::Constant => self.constant,
            Timing::Proportional => self.proportional,
        }
    }

    /// The one that varies.
    pub(super) fn varied(&self) -> f64 {
        self.of(self.varies)
    }

    pub(super) fn set_varied(&mut self, factor: f64) {
        match self.varies {
            Timing::Constant => self.constant = factor,
            Timing::Proportional => self.proportional = factor,
        }
    }
}

/// Columns: the twist that one radian of each hinge of a joint gives to all above it.
pub(super) type HingeTwists = nalgebra::Matrix6x3<f64>;

pub(super) type RowsOf6 = nalgebra::Matrix3x6<f64>;

/// The change of a hinge's moment when the body that carries it twists.
pub(super) fn moment_by_twist(twists: &HingeTwists, wrench: &Spatial) -> RowsOf6 {
    let (moment, force) = (first(wrench), second(wrench));
    let mut rows = RowsOf6::zeros();
    for i in 0..3 {
        let twist: Spatial = twists.column(i).into();
        let (turn, velocity) = (first(&twist), second(&twist));
        let row = spatial(&(turn.cross(&moment) + velocity.cross(&force)), &turn.cross(&force));
        rows.set_row(i, &row.transpose());
    }
    rows
}

/// A spine with springs and loads: what must balance.
#[derive(Debug, Clone, Copy)]
pub(super) struct Balance<'a> {
    pub model: &'a SpineModel,
    pub stiffness: &'a [Mat3],
    pub support: Support,
    pub loading: &'a Loading,
}

/// A pose, its loads and its residual. All buffers are made once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct State {
    /// Hinge angles, which give the pose.
    pub hinges: Vec<Vec3>,
    /// Wrench that each rod puts on its upper vertebra, and minus it on its lower one.
    pub reactions: Vec<Spatial>,
    pub midpoints: Vec<Vec3>,
    pub axes: Vec<Mat3>,
    pub twists: Vec<HingeTwists>,
    /// Wrench of everything above each joint.
    pub above: Vec<Spatial>,
    /// Per vertebra: change of its loads with its own twist, where they have any.
    pub load_tangents: Vec<Option<SpatialMatrix>>,
    /// Spring moments minus load moments about the hinges.
    pub residual: Vec<Vec3>,
    /// Change of the load moments with the factor that varies.
    pub growth: Vec<Vec3>,
    /// Equations of each rod.
    pub rods: Vec<RodEquations>,
    /// Per vertebra, then summed from above: wrench and its change with the factor.
    loads: Vec<(Spatial, Spatial)>,
}

impl State {
    pub(super) fn new(balance: &Balance<'_>) -> Self {
        let joints = balance.model.joints.len();
        let rods = balance.loading.rods.len();
        Self {
            hinges: vec![Vec3::zeros(); joints],
            reactions: vec![Spatial::zeros(); rods],
            midpoints: balance.model.midpoints_mm.clone(),
            axes: balance.model.axes.clone(),
            twists: vec![HingeTwists::zeros(); joints],
            above: vec![Spatial::zeros(); joints],
            load_tangents: vec![None; joints + 1],
            residual: vec![Vec3::zeros(); joints],
            growth: vec![Vec3::zeros(); joints],
            rods: vec![RodEquations::zeros(); rods],
            loads: vec![(Spatial::zeros(), Spatial::zeros()); joints + 1],
        }
    }

    pub(super) fn pose(&self, vertebra: usize) -> Pose<'_> {
        Pose { midpoint_mm: &self.midpoints[vertebra], axes: &self.axes[vertebra] }
    }

    /// The vertebrae as they are.
    pub(super) fn deformed(&self) -> Deformed {
        Deformed {
            midpoints_mm: self.midpoints.clone(),
            axes: self.axes.clone(),
            hinges_rad: self.hinges.iter().map(|angles| (*angles).into()).collect(),
        }
    }

    pub(super) fn largest_hinge_rad(&self) -> f64 {
        self.hinges.iter().map(|angles| angles.amax()).fold(0.0, f64::max)
    }
}

impl Balance<'_> {
    /// Largest difference between a hinge angle and the one of its moment.
    pub(super) fn residual_rad(&self, state: &State) -> f64 {
        let largest = |(residual, stiffness): (&Vec3, &Mat3)| {
            (0..3).map(|i| residual[i].abs() / stiffness[(i, i)]).fold(0.0, nan_max)
        };
        state.residual.iter().zip(self.stiffness).map(largest).fold(0.0, nan_max)
    }

    /// Largest distance (mm) and angle (rad) of a rod from its pose.
    pub(super) fn rod_gap(&self, state: &State) -> (f64, f64) {
        let gaps = state.rods.iter().map(|rod| rod.gap);
        gaps.fold((0.0, 0.0), |(mm, rad), gap| (nan_max(mm, gap.0), nan_max(rad, gap.1)))
    }

    /// Puts the vertebrae where the hinges say, and sums up what acts on them.
    pub(super) fn evaluate(&self, factors: &Factors, state: &mut State) {
        self.pose(state);
        self.apply_loads(factors, state);
        self.apply_rods(factors, state);
        let (mut wrench, mut rate) = (Spatial::zeros(), Spatial::zeros());
        for j in (0..state.hinges.len()).rev() {
            wrench += state.loads[j + 1].0;
            rate += state.loads[j + 1].1;
            state.above[j] = wrench;
            let erect = self.erect_moment_nmm(j);
            let moment = state.twists[j].tr_mul(&wrench) - erect * factors.constant;
            state.residual[j] = self.stiffness[j] * state.hinges[j] - moment;
            state.growth[j] = state.twists[j].tr_mul(&rate);
            if factors.varies == Timing::Constant {
                state.growth[j] -= erect;
            }
        }
    }

    /// Moments of the springs of a joint in the erect posture, which act as constant loads; locked hinges take no part.
    fn erect_moment_nmm(&self, joint: usize) -> Vec3 {
        let moment = self.model.joints[joint].erect_moment_nmm;
        match self.support {
            Support::Free => moment,
            Support::Frontal => Vec3::x() * moment.x,
        }
    }

    fn pose(&self, state: &mut State) {
        let mut axes = self.model.axes[0];
        let mut midpoint = self.model.midpoints_mm[0];
        for (j, joint) in self.model.joints.iter().enumerate() {
            let centre = midpoint + axes * joint.centre_in_inferior_mm;
            let (mut x, mut y, mut z): (Vec3, Vec3, Vec3) =
                (axes.column(0).into(), axes.column(1).into(), axes.column(2).into());
            let angles = state.hinges[j];
            // Each hinge turns the axes that come after it.
            let hinge_x = x;
            turn_pair(&mut y, &mut z, angles.x);
            let hinge_y = y;
            turn_pair(&mut z, &mut x, angles.y);
            let hinge_z = z;
            turn_pair(&mut x, &mut y, angles.z);
            let twist = |axis: &Vec3| spatial(axis, &centre.cross(axis));
            let twists = &mut state.twists[j];
            twists.set_column(0, &twist(&hinge_x));
            if self.support == Support::Free {
                twists.set_column(1, &twist(&hinge_y));
                twists.set_column(2, &twist(&hinge_z));
            }
            let turned = Mat3::from_columns(&[x, y, z]);
            axes = turned * joint.inferior_from_superior;
            midpoint = centre + turned * joint.rise_in_inferior_mm;
            state.axes[j + 1] = axes;
            state.midpoints[j + 1] = midpoint;
        }
    }

    fn apply_loads(&self, factors: &Factors, state: &mut State) {
        state.loads.fill((Spatial::zeros(), Spatial::zeros()));
        state.load_tangents.fill(None);
        for item in &self.loading.items {
            let v = item.vertebra;
            let factor = factors.of(item.timing);
            let load = item.load.wrench(&state.pose(v), factor, self.model, v);
            state.loads[v].0 += load.wrench;
            if item.timing == factors.varies {
                state.loads[v].1 += load.rate;
            }
            if let Some(tangent) = load.tangent {
                *state.load_tangents[v].get_or_insert_with(SpatialMatrix::zeros) += tangent;
            }
        }
    }

    /// Rods act on both vertebrae with opposite wrenches and prescribe their relative pose.
    fn apply_rods(&self, factors: &Factors, state: &mut State) {
        for (number, rod) in self.loading.rods.iter().enumerate() {
            let reaction = state.reactions[number];
            state.loads[rod.superior].0 += reaction;
            state.loads[rod.inferior].0 -= reaction;
            let ends = [rod.inferior, rod.superior];
            let of_rod = RodState {
                midpoints: ends.map(|v| &state.midpoints[v]),
                axes: ends.map(|v| &state.axes[v]),
                reaction: &reaction,
                wanted: rod.pose_at(self.model, factors.of(rod.timing)),
                lateral_nmm_per_rad: self.stiffness[rod.inferior][(0, 0)],
                varies: rod.timing == factors.varies,
            };
            state.rods[number] = RodEquations::of(self.support, rod, &of_rod);
        }
    }
}

/// The greater of two, or NaN where one is.
pub(super) fn nan_max(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// Turns two axes by an angle about the third: `a` towards `b`.
#[inline]
fn turn_pair(a: &mut Vec3, b: &mut Vec3, angle_rad: f64) {
    if angle_rad == 0.0 {
        return;
    }
    let (s, c) = sin_cos(angle_rad);
    (*a, *b) = (*a * c + *b * s, *b * c - *a * s);
}
