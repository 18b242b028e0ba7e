//! A spine with springs under the load of one film.

use nalgebra::{Matrix2, Matrix2x3, Matrix3x2};

use super::{
    JointGroups, Load, Parameter, Solution, SpineModel, StiffnessLibrary, Support, Wrench,
};
use crate::action::{Application, LineOfAction};
use crate::spatial::Vec3;

/// A spine with springs: everything that does not change while a load is sought.
#[derive(Debug, Clone)]
pub struct Statics<'a> {
    pub(super) model: &'a SpineModel,
    pub(super) group_of_joint: &'a [usize],
    pub(super) hinges: Vec<Hinges>,
}

#[derive(Debug, Clone, Copy)]
pub(super) struct Hinges {
    /// Radians per N·mm; zero where a hinge is locked.
    pub compliance: [f64; 3],
    /// Axial rotation per lateral rotation at which the axial spring is unstressed.
    pub axial_per_lateral: f64,
}

impl<'a> Statics<'a> {
    /// Springs of a library, the lateral ones multiplied per group, and their coupling where the support lets joints turn axially.
    #[must_use]
    pub fn new(
        model: &'a SpineModel,
        library: &StiffnessLibrary,
        groups: &'a JointGroups,
        log_multipliers: &[f64],
        support: Support,
    ) -> Self {
        let stiffness = library.rows().iter().map(|row| row.nmm_per_rad);
        let mut statics = Self::from_stiffness(model, stiffness, groups.of_joint(), support);
        let joints = statics.hinges.iter_mut().zip(groups.of_joint()).zip(library.rows());
        for ((hinges, &group), row) in joints {
            hinges.compliance[0] *= (-log_multipliers[group]).exp();
            if support == Support::Free {
                hinges.axial_per_lateral = row.axial_per_lateral;
            }
        }
        statics
    }

    /// Springs given directly, in N·mm/rad about x, y and z of every joint.
    #[must_use]
    pub fn from_stiffness(
        model: &'a SpineModel,
        nmm_per_rad: impl IntoIterator<Item = [f64; 3]>,
        group_of_joint: &'a [usize],
        support: Support,
    ) -> Self {
        let hinges = nmm_per_rad
            .into_iter()
            .map(|[x, y, z]| Hinges {
                compliance: match support {
                    Support::Free => [1.0 / x, 1.0 / y, 1.0 / z],
                    Support::Frontal => [1.0 / x, 0.0, 0.0],
                },
                axial_per_lateral: 0.0,
            })
            .collect();
        Self { model, group_of_joint, hinges }
    }

    /// The unloaded model.
    #[must_use]
    pub const fn model(&self) -> &SpineModel {
        self.model
    }

    /// Mean lateral stiffness, by which forces scale.
    #[must_use]
    pub fn mean_lateral_nmm_per_rad(&self) -> f64 {
        let sum: f64 = self.hinges.iter().map(|hinges| 1.0 / hinges.compliance[0]).sum();
        sum / self.hinges.len() as f64
    }

    /// Equilibrium under a load of given magnitude, with derivatives by the parameters.
    ///
    /// `magnitude` holds the force along the line, or `(fy, fz, mx)` of a frontal load. `solution` is overwritten; its
    /// T2 is the start of the search where the load moves with T2.
    ///
    /// # Frames and units
    /// `G`; N, N·mm, mm, rad.
    ///
    /// # Accuracy
    /// Explicit: rounding only. T2 lies on the line of a load at T2 to 1e-9 mm, or `converged` is false and `residual_mm` says by how much.
    pub fn solve(
        &self,
        load: &Load,
        magnitude: &[f64],
        parameters: &[Parameter],
        solution: &mut Solution,
    ) {
        match load {
            Load::Line { line, .. } => match line.application {
                Application::Fixed => {
                    let [unit, ..] = load.units_on_film();
                    self.march(&scaled(&unit, magnitude[0]), &[unit], parameters, solution);
                    solution.converged = true;
                    solution.residual_mm = 0.0;
                }
                Application::AtT2 => self.solve_at_t2(line, magnitude[0], parameters, solution),
            },
            Load::Frontal { .. } => {
                let units = load.units_on_film();
                let total = Wrench {
                    force_n: (0..3).map(|i| units[i].force_n * magnitude[i]).sum(),
                    moment_nmm: (0..3).map(|i| units[i].moment_nmm * magnitude[i]).sum(),
                };
                self.march(&total, &units, parameters, solution);
                solution.converged = true;
                solution.residual_mm = 0.0;
            }
        }
    }

    /// A force at T2's midpoint: Newton on the line through where T2 ends up, at first where the film shows it.
    fn solve_at_t2(
        &self,
        line: &LineOfAction,
        force_n: f64,
        parameters: &[Parameter],
        solution: &mut Solution,
    ) {
        /// Longer than any spine: a force this far away does not come back.
        const ASTRAY_MM: f64 = 1e3;
        const MOVES: [Parameter; 2] = [Parameter::Load(1), Parameter::Load(2)];
        let top = self.model.midpoints_mm.len() - 1;
        let direction = Vec3::new(0.0, line.direction.y_mm, line.direction.z_mm);
        let force = direction * force_n;
        let on_film = Vec3::new(self.model.midpoints_mm[top].x, line.point.y_mm, line.point.z_mm);
        let mut place = solution.deformed.midpoints_mm.get(top).copied().unwrap_or(on_film);
        // Sliding the force along its line changes nothing: its place moves across it only.
        let across = Matrix3x2::from_columns(&[Vec3::x(), Vec3::x().cross(&direction)]);
        // First direction: more force. The others: the place of the force moves.
        let all: Vec<Parameter> = parameters.iter().copied().chain(MOVES).collect();
        let n = parameters.len();
        solution.converged = false;
        for _ in 0..25 {
            let moved = |way: usize| Wrench {
                force_n: Vec3::zeros(),
                moment_nmm: across.column(way).cross(&force),
            };
            let units = [Wrench::at(place, direction), moved(0), moved(1)];
            self.march(&Wrench::at(place, force), &units, &all, solution);
            let follow = across.tr_mul(&Matrix3x2::from_columns(&[
                solution.midpoint_rates[n][top],
                solution.midpoint_rates[n + 1][top],
            ]));
            let gap = across.tr_mul(&(solution.deformed.midpoints_mm[top] - place));
            solution.residual_mm = gap.norm();
            let inverse = (Matrix2::identity() - follow).try_inverse();
            let Some(inverse) = inverse.filter(|_| solution.residual_mm <= ASTRAY_MM) else {
                break;
            };
            if solution.residual_mm < 1e-9 {
                close_derivatives(solution, n, &(inverse * across.transpose()), top);
                solution.converged = true;
                break;
            }
            place += across * (inverse * gap);
        }
        for rates in [&mut solution.midpoint_rates, &mut solution.turn_rates] {
            solution.spare_rates.extend(rates.drain(n..));
        }
    }
}

fn scaled(wrench: &Wrench, factor: f64) -> Wrench {
    Wrench { force_n: wrench.force_n * factor, moment_nmm: wrench.moment_nmm * factor }
}

/// Adds to every derivative the effect of the force's movement with T2 (implicit function theorem).
fn close_derivatives(
    solution: &mut Solution,
    parameters: usize,
    shifts: &Matrix2x3<f64>,
    top: usize,
) {
    for p in 0..parameters {
        let shift = shifts * solution.midpoint_rates[p][top];
        for rates in [&mut solution.midpoint_rates, &mut solution.turn_rates] {
            let (own, moves) = rates.split_at_mut(parameters);
            for (vertebra, rate) in own[p].iter_mut().enumerate() {
                *rate += moves[0][vertebra] * shift[0] + moves[1][vertebra] * shift[1];
            }
        }
    }
}
