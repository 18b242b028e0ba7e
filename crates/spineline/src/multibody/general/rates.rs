use super::balance::Factors;
use super::loading::{LoadItem, Loading, Timing};
use super::solver::{GeneralStatics, NewtonWork};
use super::wrench::{Spatial, first, second};
use crate::multibody::Solution;
use crate::spatial::{Mat3, Vec3};

/// Parameters of the derivatives of a shape in equilibrium.
#[derive(Debug, Clone, Copy)]
pub enum ShapeParameter<'p> {
    /// The natural logarithm of the lateral stiffness of the joints that are marked.
    LogLateral(&'p [bool]),
    /// The amount of some loads, beside the balanced ones.
    Loads(&'p [LoadItem]),
}

impl GeneralStatics<'_> {
    /// The shape that `work` has found under a loading at factor one, with its derivatives: the implicit function theorem on
    /// the tangent of the balance. `solution.converged` is false where the tangent is singular.
    ///
    /// # Frames and units
    /// `G`; midpoints in mm, turns in rad, both per unit of the parameter.
    ///
    /// # Errors
    /// None: `work` must be balanced under this loading, by [`GeneralStatics::solve_near`] with factor one.
    pub fn differentiate(
        &self,
        loading: &Loading,
        work: &mut NewtonWork,
        parameters: &[ShapeParameter<'_>],
        solution: &mut Solution,
    ) {
        let balance = self.balance(loading);
        let NewtonWork(newton) = work;
        let factors = Factors { constant: 1.0, proportional: 1.0, varies: Timing::Proportional };
        balance.evaluate(&factors, &mut newton.state);
        solution.deformed = newton.state.deformed();
        let vertebrae = balance.model.midpoints_mm.len();
        for rates in [&mut solution.midpoint_rates, &mut solution.turn_rates] {
            rates.resize_with(parameters.len(), || vec![Vec3::zeros(); vertebrae]);
        }
        solution.residual_mm = 0.0;
        solution.converged = newton.elimination.factor(&balance, &newton.state);
        if !solution.converged {
            return;
        }
        let mut turns = vec![Vec3::zeros(); vertebrae - 1];
        for (p, parameter) in parameters.iter().enumerate() {
            let state = &newton.state;
            let moments: Vec<Vec3> = match parameter {
                ShapeParameter::LogLateral(marked) => (0..vertebrae - 1)
                    .map(|j| match marked[j] {
                        true => Vec3::x() * (-lateral(&balance.stiffness[j]) * state.hinges[j].x),
                        false => Vec3::zeros(),
                    })
                    .collect(),
                ShapeParameter::Loads(items) => {
                    let mut loads = vec![Spatial::zeros(); vertebrae];
                    for item in *items {
                        let v = item.vertebra;
                        let load = item.load.wrench(&state.pose(v), 1.0, balance.model, v);
                        loads[v] += load.wrench;
                    }
                    let mut above = Spatial::zeros();
                    let mut moments = vec![Vec3::zeros(); vertebrae - 1];
                    for j in (0..vertebrae - 1).rev() {
                        above += loads[j + 1];
                        moments[j] = state.twists[j].tr_mul(&above);
                    }
                    moments
                }
            };
            newton.elimination.solve(|j| moments[j], &mut turns);
            let mut twist = Spatial::zeros();
            for (j, turn) in turns.iter().enumerate() {
                twist += state.twists[j] * turn;
                let turning = first(&twist);
                solution.turn_rates[p][j + 1] = turning;
                solution.midpoint_rates[p][j + 1] =
                    second(&twist) + turning.cross(&state.midpoints[j + 1]);
            }
        }
    }
}

/// Lateral stiffness of a joint whose axial hinge turns freely with it.
fn lateral(stiffness: &Mat3) -> f64 {
    stiffness[(0, 0)] - stiffness[(0, 2)].powi(2) / stiffness[(2, 2)]
}
