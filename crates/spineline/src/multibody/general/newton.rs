use super::balance::{Balance, Factors, State, nan_max};
use super::border::Border;
use super::elimination::Elimination;
use super::stability::Signs;
use super::wrench::{Spatial, first, second};
use crate::multibody::Support;
use crate::spatial::Vec3;

/// A step of Newton that is smaller leaves an error of its square.
const SMALL_STEP_RAD: f64 = 1e-9;
/// A step that is larger has left the branch.
const MAX_STEP_RAD: f64 = 1.5;
const MAX_ITERATIONS: u32 = 25;
/// Limits of balance: hinges (rad), and rods (mm and rad).
pub(super) const BALANCED_RAD: f64 = 1e-9;
const ROD_FITS: (f64, f64) = (1e-6, 1e-8);

/// A direction in the space of hinges, reactions and factor; reactions do not count in its length.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Direction {
    pub turns: Vec<Vec3>,
    pub reactions: Vec<Spatial>,
    pub factor: f64,
    /// Hinge angle that counts as a factor of one in a length.
    pub factor_rad: f64,
}

impl Direction {
    /// The factor alone.
    pub(super) fn of_factor(balance: &Balance<'_>, factor: f64, factor_rad: f64) -> Self {
        Self {
            turns: vec![Vec3::zeros(); balance.model.joints.len()],
            reactions: vec![Spatial::zeros(); balance.loading.rods.len()],
            factor,
            factor_rad,
        }
    }

    pub(super) fn dot(&self, turns: &[Vec3], factor: f64) -> f64 {
        let hinges: f64 = self.turns.iter().zip(turns).map(|(a, b)| a.dot(b)).sum();
        hinges + self.factor_rad * self.factor_rad * self.factor * factor
    }
}

/// The last equation.
pub(super) enum Closing<'c> {
    /// The factors stay.
    Factor,
    /// At a distance along a direction from a point: hinges and factor.
    Arc { from: (&'c [Vec3], f64), along: &'c Direction, length: f64 },
}

/// How an iteration ended.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct NewtonReport {
    pub ending: NewtonEnding,
    pub iterations: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NewtonEnding {
    Balanced,
    /// Hinges balance, and a rod still does not have its pose.
    RodOutOfReach,
    Failed,
}

/// Newton on hinges, reactions of rods, and the factor. All buffers are made once.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Newton {
    pub state: State,
    /// The tangent that was eliminated last.
    pub elimination: Elimination,
    border: Border,
    /// Answers of the hinges: to the residual, to the factor, to each component of each rod's reaction.
    answers: Vec<Vec<Vec3>>,
    turns: Vec<Vec3>,
}

const TO_RESIDUAL: usize = 0;
const TO_FACTOR: usize = 1;
const TO_RODS: usize = 2;

impl Newton {
    pub(super) fn new(balance: &Balance<'_>) -> Self {
        let joints = balance.model.joints.len();
        let rods = balance.loading.rods.len();
        Self {
            state: State::new(balance),
            elimination: Elimination::new(joints),
            border: Border::new(6 * rods + 1),
            answers: vec![vec![Vec3::zeros(); joints]; TO_RODS + 6 * rods],
            turns: vec![Vec3::zeros(); joints],
        }
    }

    /// Iterates from the hinges and reactions as they are; no allocation.
    pub(super) fn correct(
        &mut self,
        balance: &Balance<'_>,
        factors: &mut Factors,
        closing: &Closing<'_>,
    ) -> NewtonReport {
        let failed = |iterations| NewtonReport { ending: NewtonEnding::Failed, iterations };
        for iterations in 1..=MAX_ITERATIONS {
            balance.evaluate(factors, &mut self.state);
            let is_finite = balance.residual_rad(&self.state).is_finite();
            if !is_finite || !self.elimination.factor(balance, &self.state) {
                return failed(iterations);
            }
            let step = self.step(balance, factors, closing);
            if step.is_nan() || step > MAX_STEP_RAD {
                return failed(iterations);
            }
            if step <= SMALL_STEP_RAD {
                balance.evaluate(factors, &mut self.state);
                let residual_rad = balance.residual_rad(&self.state);
                let (mm, rad) = balance.rod_gap(&self.state);
                let ending = if residual_rad.is_nan() || residual_rad > BALANCED_RAD {
                    NewtonEnding::Failed
                } else if mm > ROD_FITS.0 || rad > ROD_FITS.1 {
                    NewtonEnding::RodOutOfReach
                } else {
                    NewtonEnding::Balanced
                };
                return NewtonReport { ending, iterations };
            }
        }
        failed(MAX_ITERATIONS)
    }

    /// One step; its largest turn, or NaN.
    fn step(&mut self, balance: &Balance<'_>, factors: &mut Factors, closing: &Closing<'_>) -> f64 {
        let Self { state, elimination, answers, .. } = self;
        elimination.solve(|j| -state.residual[j], &mut answers[TO_RESIDUAL]);
        self.turns.clone_from(&self.answers[TO_RESIDUAL]);
        let rods = balance.loading.rods.len();
        let arc = matches!(closing, Closing::Arc { .. });
        let order = 6 * rods + usize::from(arc);
        let mut factor_step = 0.0;
        if order > 0 {
            self.answer_border(balance, arc);
            self.border.reset(order);
            for rod in 0..rods {
                let right_hand =
                    -self.state.rods[rod].errors - self.rod_change(balance, rod, TO_RESIDUAL);
                self.fill_rod_rows(balance, rod, arc, &right_hand);
            }
            if let Closing::Arc { from, along, length } = closing {
                let gone: f64 = (self.state.hinges.iter().zip(from.0).zip(&along.turns))
                    .map(|((now, before), turn)| turn.dot(&(now - before)))
                    .sum();
                let gone = gone + along.dot(&[], factors.varied() - from.1);
                let right_hand = length - gone - along.dot(&self.answers[TO_RESIDUAL], 0.0);
                self.fill_arc_row(balance, along, right_hand);
            }
            self.border.solve();
            factor_step = self.add_border(rods, arc);
        }
        let mut largest = match closing {
            Closing::Arc { along, .. } => factor_step.abs() * along.factor_rad,
            Closing::Factor => 0.0,
        };
        for (hinge, turn) in self.state.hinges.iter_mut().zip(&self.turns) {
            *hinge += turn;
            largest = nan_max(largest, turn.amax());
        }
        for (rod, reaction) in self.state.reactions.iter_mut().enumerate() {
            *reaction += reaction_of(self.border.solution(), rod);
        }
        factors.set_varied(factors.varied() + factor_step);
        largest
    }

    /// The direction of the branch at a balanced state, on the side of the direction so far; `None` without one.
    pub(super) fn tangent(
        &mut self,
        balance: &Balance<'_>,
        so_far: &Direction,
        tangent: &mut Direction,
    ) -> Option<()> {
        if !self.elimination.factor(balance, &self.state) {
            return None;
        }
        self.answer_border(balance, true);
        let rods = balance.loading.rods.len();
        self.border.reset(6 * rods + 1);
        for rod in 0..rods {
            self.fill_rod_rows(balance, rod, true, &Spatial::zeros());
        }
        self.fill_arc_row(balance, so_far, 1.0);
        self.border.solve();
        self.turns.fill(Vec3::zeros());
        tangent.factor_rad = so_far.factor_rad;
        tangent.factor = self.add_border(rods, true);
        tangent.turns.clone_from(&self.turns);
        let length = tangent.dot(&self.turns, tangent.factor).sqrt();
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        tangent.turns.iter_mut().for_each(|turn| *turn /= length);
        tangent.factor /= length;
        for (rod, reaction) in tangent.reactions.iter_mut().enumerate() {
            *reaction = reaction_of(self.border.solution(), rod) / length;
        }
        Some(())
    }

    /// The signs of the tangent that was eliminated last.
    pub(super) fn signs(&self, balance: &Balance<'_>) -> Signs {
        if balance.loading.rods.is_empty() {
            self.elimination.signs
        } else {
            Signs::within_rods(balance, &self.state)
        }
    }

    /// The twist of a vertebra when the hinges turn.
    pub(super) fn twist_of(&self, vertebra: usize, turns: &[Vec3]) -> Spatial {
        self.state.twists.iter().zip(turns).take(vertebra).map(|(twists, turn)| twists * turn).sum()
    }

    /// Answers of the hinges to the factor and to the reactions of rods.
    fn answer_border(&mut self, balance: &Balance<'_>, arc: bool) {
        let Self { state, elimination, answers, .. } = self;
        if arc {
            elimination.solve(|j| state.growth[j], &mut answers[TO_FACTOR]);
        }
        for (number, rod) in balance.loading.rods.iter().enumerate() {
            for component in 0..6 {
                let between = rod.inferior..rod.superior;
                let moments = |j: usize| {
                    if between.contains(&j) {
                        state.twists[j].row(component).transpose()
                    } else {
                        Vec3::zeros()
                    }
                };
                elimination.solve(moments, &mut answers[TO_RODS + 6 * number + component]);
            }
        }
    }

    /// How a rod's equations change with one of the answers.
    fn rod_change(&self, balance: &Balance<'_>, rod: usize, answer: usize) -> Spatial {
        let (equations, rod) = (&self.state.rods[rod], &balance.loading.rods[rod]);
        let twist = |joints: std::ops::Range<usize>| -> Spatial {
            joints.map(|j| self.state.twists[j] * self.answers[answer][j]).sum()
        };
        let change = equations.by_relative * twist(rod.inferior..rod.superior);
        match balance.support {
            Support::Free => change,
            Support::Frontal => change + equations.by_both * twist(0..rod.inferior),
        }
    }

    fn fill_rod_rows(
        &mut self,
        balance: &Balance<'_>,
        rod: usize,
        arc: bool,
        right_hand: &Spatial,
    ) {
        let columns = 6 * balance.loading.rods.len();
        for column in 0..columns {
            let mut change = self.rod_change(balance, rod, TO_RODS + column);
            if column / 6 == rod {
                change += self.state.rods[rod].by_reaction.column(column % 6);
            }
            (0..6).for_each(|i| self.border.set(6 * rod + i, column, change[i]));
        }
        if arc {
            let change = self.rod_change(balance, rod, TO_FACTOR) + self.state.rods[rod].rates;
            (0..6).for_each(|i| self.border.set(6 * rod + i, columns, change[i]));
        }
        (0..6).for_each(|i| self.border.set_right_hand(6 * rod + i, right_hand[i]));
    }

    /// The last equation: progress along a direction.
    fn fill_arc_row(&mut self, balance: &Balance<'_>, along: &Direction, right_hand: f64) {
        let columns = 6 * balance.loading.rods.len();
        for column in 0..columns {
            self.border.set(columns, column, along.dot(&self.answers[TO_RODS + column], 0.0));
        }
        self.border.set(columns, columns, along.dot(&self.answers[TO_FACTOR], 1.0));
        self.border.set_right_hand(columns, right_hand);
    }

    /// Adds the border's part of the turns; returns the change of the factor.
    fn add_border(&mut self, rods: usize, arc: bool) -> f64 {
        let (reactions, factor) = self.border.solution().split_at(6 * rods);
        let factor = if arc { factor[0] } else { 0.0 };
        for (j, turn) in self.turns.iter_mut().enumerate() {
            for (answer, reaction) in self.answers[TO_RODS..].iter().zip(reactions) {
                *turn += answer[j] * *reaction;
            }
            if arc {
                *turn += self.answers[TO_FACTOR][j] * factor;
            }
        }
        factor
    }
}

fn reaction_of(solution: &[f64], rod: usize) -> Spatial {
    Spatial::from_column_slice(&solution[6 * rod..6 * rod + 6])
}

pub(super) fn velocity_at(twist: &Spatial, point: &Vec3) -> Vec3 {
    second(twist) + first(twist).cross(point)
}

/// A wrench about a point, as force and moment.
pub(super) fn force_and_moment_at(wrench: &Spatial, point: &Vec3) -> (Vec3, Vec3) {
    let force = second(wrench);
    (force, first(wrench) - point.cross(&force))
}
