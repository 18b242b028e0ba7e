//! Planar statics of the fine chain, independent of the library's march, which is tested against it.

use nalgebra::{DMatrix, DVector};
use spineline::action::{Application, LineOfAction};
use spineline::spatial::{Angle, Frontal};

use crate::build::SEGMENTS;
use crate::erect::ErectSpine;

#[derive(Debug, Clone)]
pub(crate) struct ChainShape {
    /// Nodes from L4 upwards, one more than segments.
    nodes: Vec<Frontal>,
    tilts: Vec<f64>,
    segment_mm: f64,
}

impl ChainShape {
    /// The shape with given rotations.
    pub fn with_turns(spine: &ErectSpine, turn_rad: impl Fn(usize) -> f64) -> Self {
        Self::grow(spine.segment_mm(), |k, _| turn_rad(k))
    }

    /// Builds the chain from L4, segment by segment; `turn` may depend on the node below a segment.
    fn grow(segment_mm: f64, mut turn: impl FnMut(usize, Frontal) -> f64) -> Self {
        let mut nodes = vec![Frontal::default()];
        let mut tilts: Vec<f64> = Vec::with_capacity(SEGMENTS);
        for k in 0..SEGMENTS {
            let tilt = tilts.last().copied().unwrap_or(0.0) + turn(k, nodes[k]);
            tilts.push(tilt);
            nodes.push(nodes[k] + Frontal::leaning(Angle::from_rad(tilt)) * segment_mm);
        }
        Self { nodes, tilts, segment_mm }
    }

    /// Point at an arc length.
    pub fn point(&self, s_mm: f64) -> Frontal {
        let place = (s_mm / self.segment_mm).min(SEGMENTS as f64);
        let k = (place.floor() as usize).min(SEGMENTS - 1);
        self.nodes[k] + (self.nodes[k + 1] - self.nodes[k]) * (place - k as f64)
    }

    /// Tilt at an arc length, between the middles of the segments; zero at the clamped base.
    pub fn tilt(&self, s_mm: f64) -> Angle {
        let place = s_mm / self.segment_mm - 0.5;
        if place < 0.0 {
            return Angle::from_rad(self.tilts[0] * (s_mm / (0.5 * self.segment_mm)));
        }
        let k = (place.floor() as usize).min(SEGMENTS - 2);
        Angle::from_rad(self.tilts[k] + (self.tilts[k + 1] - self.tilts[k]) * (place - k as f64))
    }

    /// Sum of the rotations of all segments from another shape.
    pub fn rotation_from(&self, other: &Self) -> Angle {
        let turn =
            |shape: &Self, k: usize| shape.tilts[k] - if k == 0 { 0.0 } else { shape.tilts[k - 1] };
        let sum = (0..SEGMENTS).map(|k| (turn(self, k) - turn(other, k)).abs()).sum();
        Angle::from_rad(sum)
    }

    pub fn top(&self) -> Frontal {
        self.nodes[SEGMENTS]
    }
}

/// The chain with springs.
#[derive(Debug)]
pub(crate) struct Rod<'a> {
    spine: &'a ErectSpine,
    stiffness_nmm_per_rad: &'a [f64],
}

impl<'a> Rod<'a> {
    pub fn new(spine: &'a ErectSpine) -> Self {
        Self { spine, stiffness_nmm_per_rad: &spine.springs.nmm_per_rad }
    }

    /// Equilibrium under a force along a line fixed in space.
    pub fn bend(&self, line: &LineOfAction, force_n: f64) -> ChainShape {
        ChainShape::grow(self.spine.segment_mm(), |k, node| {
            self.spine.turns_rad[k]
                + force_n * line.lever_arm_mm(node) / self.stiffness_nmm_per_rad[k]
        })
    }

    /// Equilibrium under a force along the line through the chain at two arc lengths, such as its inflections.
    ///
    /// The line crosses the heights of the erect points at two unknown places; Newton's method moves them until the
    /// bent points lie on the line. `places_mm` is the start and receives the solution.
    pub fn bend_through(
        &self,
        s: [f64; 2],
        force_n: f64,
        erect: &ChainShape,
        places_mm: &mut [f64; 2],
    ) -> Option<(ChainShape, LineOfAction)> {
        let heights = s.map(|s| erect.point(s).z_mm);
        let line_at = |places: [f64; 2]| {
            let [low, high] = [0, 1].map(|i| Frontal::new(places[i], heights[i]));
            LineOfAction::through(low, high).ok()
        };
        let miss = |places: [f64; 2]| {
            let line = line_at(places)?;
            let shape = self.bend(&line, force_n);
            let off = s.map(|s| line.lever_arm_mm(shape.point(s)));
            Some((shape, line, off))
        };
        for _ in 0..30 {
            let (shape, line, off) = miss(*places_mm)?;
            if off[0].abs().max(off[1].abs()) < 1e-9 {
                return Some((shape, line));
            }
            const H: f64 = 1e-5;
            let [a, b] = *places_mm;
            let (_, _, by_a) = miss([a + H, b])?;
            let (_, _, by_b) = miss([a, b + H])?;
            let (j00, j10) = ((by_a[0] - off[0]) / H, (by_a[1] - off[1]) / H);
            let (j01, j11) = ((by_b[0] - off[0]) / H, (by_b[1] - off[1]) / H);
            let determinant = j00 * j11 - j01 * j10;
            places_mm[0] -= (j11 * off[0] - j01 * off[1]) / determinant;
            places_mm[1] -= (j00 * off[1] - j10 * off[0]) / determinant;
            if !places_mm.iter().all(|p| p.is_finite()) {
                return None;
            }
        }
        None
    }

    /// Equilibrium under a load of the same size and direction, fixed in space, on the upper node of every segment.
    ///
    /// `base_nmm`, the moment about L4, is the start of a secant iteration and receives the solution, for which the
    /// moment is zero at T2.
    pub fn spread(
        &self,
        direction: Frontal,
        force_n: f64,
        base_nmm: &mut f64,
    ) -> Option<ChainShape> {
        let each = direction * (force_n / SEGMENTS as f64);
        let march = |base: f64| {
            let (mut moment, mut below) = (base, Frontal::default());
            // The difference of the moments about two neighbouring nodes is due to all loads above both.
            let mut step = |k: usize, node: Frontal| {
                moment -= (node - below).cross(each) * (SEGMENTS + 1 - k) as f64;
                below = node;
                moment
            };
            let shape = ChainShape::grow(self.spine.segment_mm(), |k, node| {
                self.spine.turns_rad[k] + step(k, node) / self.stiffness_nmm_per_rad[k]
            });
            let left = step(SEGMENTS, shape.top());
            (left, shape)
        };
        let (found_nmm, shape) = secant([*base_nmm, *base_nmm + 1.0], 1e-6, march)?;
        *base_nmm = found_nmm;
        Some(shape)
    }

    /// Equilibrium under a force at T2 in a direction fixed in space.
    pub fn pull_at_top(
        &self,
        direction: Frontal,
        force_n: f64,
        start: Frontal,
    ) -> Option<(ChainShape, LineOfAction)> {
        let line_at = |point| LineOfAction { point, direction, application: Application::Fixed };
        // Only the line's position across its direction matters: a secant iteration on one number.
        let across = Frontal::new(direction.z_mm, -direction.y_mm);
        let miss = |offset: f64| {
            let line = line_at(start + across * offset);
            let shape = self.bend(&line, force_n);
            (line.lever_arm_mm(shape.top()), (shape, line))
        };
        secant([0.0, 1e-3], 1e-9, miss).map(|(_, found)| found)
    }

    /// Equilibrium under forces at material points that move with the chain, and a moment on its top; `forces` gives
    /// them in a shape. Fixed-point iteration: moments in one shape give the next shape, extrapolated from earlier
    /// rounds, because near buckling a single round makes little progress.
    pub fn bend_by(
        &self,
        start: &ChainShape,
        couple_nmm: f64,
        forces: impl Fn(&ChainShape) -> Vec<PointForce>,
    ) -> Option<ChainShape> {
        let mut shape = start.clone();
        let mut rounds: Vec<Round> = Vec::new();
        for _ in 0..100 {
            let moments = self.moments(&shape, couple_nmm, forces(&shape));
            let next = ChainShape::with_turns(self.spine, |k| {
                self.spine.turns_rad[k] + moments[k] / self.stiffness_nmm_per_rad[k]
            });
            let moves = next.nodes.iter().zip(&shape.nodes);
            let most = moves.map(|(a, b)| a.distance_mm(*b)).fold(0.0, f64::max);
            if most < 1e-9 {
                return Some(next);
            }
            if !most.is_finite() {
                return None;
            }
            let from = DVector::from_column_slice(&shape.tilts);
            let step = DVector::from_column_slice(&next.tilts) - &from;
            rounds.insert(0, Round { from, step });
            rounds.truncate(5);
            let tilts = extrapolated(&rounds)?;
            let turn = |k: usize| tilts[k] - if k == 0 { 0.0 } else { tilts[k - 1] };
            shape = ChainShape::with_turns(self.spine, turn);
        }
        None
    }

    /// Moment about the lower node of every segment, of all forces above it and a moment on the top.
    fn moments(
        &self,
        shape: &ChainShape,
        couple_nmm: f64,
        mut acting: Vec<PointForce>,
    ) -> Vec<f64> {
        let segment_mm = self.spine.segment_mm();
        acting.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
        let (mut about_origin, mut sum) = (couple_nmm, Frontal::default());
        let mut moments = vec![0.0; SEGMENTS];
        for (k, moment) in moments.iter_mut().enumerate().rev() {
            while let Some(one) = acting.pop_if(|one| one.s_mm > k as f64 * segment_mm) {
                about_origin += one.point.cross(one.force);
                sum = sum + one.force;
            }
            *moment = about_origin - shape.nodes[k].cross(sum);
        }
        moments
    }
}

/// The number for which a miss vanishes, with its result, by secants from two starts; `None` if they do not converge.
fn secant<T>(starts: [f64; 2], tolerance: f64, miss: impl Fn(f64) -> (f64, T)) -> Option<(f64, T)> {
    let [mut before, mut now] = starts;
    let mut miss_before = miss(before).0;
    for _ in 0..60 {
        let (off, found) = miss(now);
        if off.abs() < tolerance {
            return Some((now, found));
        }
        let slope = (off - miss_before) / (now - before);
        (before, miss_before) = (now, off);
        now -= off / slope;
        if !now.is_finite() {
            return None;
        }
    }
    None
}

/// Tilts of all segments, and the tilts that follow from their moments.
struct Round {
    from: DVector<f64>,
    step: DVector<f64>,
}

/// Result of the combination of the last rounds with the smallest step (Anderson's method); the last round comes first.
fn extrapolated(rounds: &[Round]) -> Option<DVector<f64>> {
    let (last, others) = rounds.split_first()?;
    let to = &last.from + &last.step;
    if others.is_empty() {
        return Some(to);
    }
    let columns = |change: fn(&Round, &Round) -> DVector<f64>| {
        let all: Vec<_> = others.iter().map(|one| change(last, one)).collect();
        DMatrix::from_columns(&all)
    };
    let steps = columns(|a, b| &a.step - &b.step);
    let ends = columns(|a, b| &a.from - &b.from) + &steps;
    let parts = steps.svd(true, true).solve(&last.step, 1e-12).ok()?;
    Some(to - ends * parts)
}

/// A force on all of the chain below its material point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PointForce {
    pub s_mm: f64,
    /// Any point of its line.
    pub point: Frontal,
    pub force: Frontal,
}
