use nalgebra::{Matrix2, Matrix2x3, Matrix3x2};

use super::transfer::WrenchTransfer;
use super::{JointGroups, Load, SpineModel, StiffnessLibrary, Support, Wrench};
use crate::action::{Application, LineOfAction};
use crate::spatial::{Angle, Frontal, Mat3, Vec3, is_small};

/// Parameters of the derivatives of a solution.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// The magnitude of the load: force along a line; or component 0, 1 or 2 of `(fy, fz, mx)`.
    Load(usize),
    /// The natural logarithm of a group's lateral stiffness.
    LogStiffness(usize),
}

/// The vertebrae under load.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Deformed {
    /// Midpoints in `G`.
    pub midpoints_mm: Vec<Vec3>,
    /// Axes in `G`.
    pub axes: Vec<Mat3>,
    /// Hinge angles of every joint about x, y and z, in rad.
    pub hinges_rad: Vec<[f64; 3]>,
}

impl Deformed {
    /// Midpoints as a frontal film would show them.
    #[must_use]
    pub fn location(&self, vertebra: usize) -> Frontal {
        let midpoint = self.midpoints_mm[vertebra];
        Frontal::new(midpoint.y, midpoint.z)
    }

    /// Tilt of a vertebra as a frontal film would show it.
    #[must_use]
    pub fn tilt(&self, vertebra: usize) -> Angle {
        let cranial = self.axes[vertebra].column(2);
        Angle::from_sin_cos(-cranial[1], cranial[2])
    }

    /// Lateral tilt of the line L4→T2.
    #[must_use]
    pub fn lateral_tilt(&self) -> Angle {
        self.location(self.midpoints_mm.len() - 1).lateral_tilt()
    }

    /// The largest hinge angle.
    #[must_use]
    pub fn largest_hinge_rad(&self) -> f64 {
        self.hinges_rad.iter().flatten().fold(0.0, |most: f64, angle| most.max(angle.abs()))
    }
}

/// An equilibrium and its derivatives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Solution {
    /// The vertebrae.
    pub deformed: Deformed,
    /// Per parameter and vertebra: derivative of the midpoint (mm per unit of the parameter).
    pub midpoint_rates: Vec<Vec<Vec3>>,
    /// Per parameter and vertebra: rotation vector per unit of the parameter.
    pub turn_rates: Vec<Vec<Vec3>>,
    /// Whether the place of a load that moves with T2 was found.
    pub converged: bool,
    /// Distance of T2's midpoint from the line on which a load at T2 was put.
    pub residual_mm: f64,
    /// Room for derivatives by the place of a load at T2, which only its search needs.
    pub(super) spare_rates: Vec<Vec<Vec3>>,
}

impl Solution {
    /// Derivative of a vertebra's tilt.
    #[must_use]
    pub fn tilt_rate(&self, parameter: usize, vertebra: usize) -> f64 {
        let cranial: Vec3 = self.deformed.axes[vertebra].column(2).into();
        let change = self.turn_rates[parameter][vertebra].cross(&cranial);
        // tilt = atan2(-cy, cz)
        (cranial.y * change.z - cranial.z * change.y)
            / (cranial.y * cranial.y + cranial.z * cranial.z)
    }

    /// Derivative of a vertebra's location on a frontal film.
    #[must_use]
    pub fn location_rate(&self, parameter: usize, vertebra: usize) -> Frontal {
        let rate = self.midpoint_rates[parameter][vertebra];
        Frontal::new(rate.y, rate.z)
    }

    /// Derivative of the lateral tilt of the line L4→T2.
    #[must_use]
    pub fn lateral_tilt_rate(&self, parameter: usize) -> f64 {
        let top = self.deformed.midpoints_mm.len() - 1;
        let place = self.deformed.location(top);
        place.cross(self.location_rate(parameter, top)) / place.dot(place)
    }

    /// The fastest hinge, in rad per unit of the parameter.
    #[must_use]
    pub fn fastest_turn(&self, parameter: usize) -> f64 {
        let turns = &self.turn_rates[parameter];
        turns.windows(2).map(|pair| (pair[1] - pair[0]).norm()).fold(0.0, f64::max)
    }
}

/// A spine with springs: everything that does not change while a load is sought.
#[derive(Debug, Clone)]
pub struct Statics<'a> {
    model: &'a SpineModel,
    group_of_joint: &'a [usize],
    hinges: Vec<Hinges>,
}

/// The hinges of one joint.
#[derive(Debug, Clone, Copy)]
struct Hinges {
    /// Radians per N·mm; zero where a hinge is locked.
    compliance: [f64; 3],
    /// Axial rotation per lateral rotation at which the axial spring is unstressed.
    axial_per_lateral: f64,
    /// From this joint's centre to the next one's, in the axes that the hinges have turned; unused above the last joint.
    to_next_mm: Vec3,
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
        let next_centres = model.joints.iter().skip(1).map(|joint| joint.centre_in_inferior_mm);
        let hinges = nmm_per_rad
            .into_iter()
            .zip(&model.joints)
            .zip(next_centres.chain([Vec3::zeros()]))
            .map(|(([x, y, z], joint), next_mm)| Hinges {
                compliance: match support {
                    Support::Free => [1.0 / x, 1.0 / y, 1.0 / z],
                    Support::Frontal => [1.0 / x, 0.0, 0.0],
                },
                axial_per_lateral: 0.0,
                to_next_mm: joint.rise_in_inferior_mm + joint.inferior_from_superior * next_mm,
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

    /// Equilibrium under a wrench fixed in space: one pass from L4 to T2, with its derivatives.
    ///
    /// `units[i]` is the derivative of the wrench by [`Parameter::Load`]`(i)`. Forces are in N, places in mm and moments in
    /// N·mm, all in `G`. The shape and its derivatives by `parameters` are written to `solution`, whose memory is used again.
    ///
    /// # Equations
    /// From the caudal joint upwards, with the moment `m = M - c x F` of the wrench `(F, M)` about the joint's centre `c` and
    /// the hinge axes `e_x`, `e_y`, `e_z` of the inferior vertebra:
    ///
    /// ```text
    /// theta_x = m . e_x           / k_x
    /// theta_y = m . (R_x e_y)     / k_y
    /// theta_z = m . (R_x R_y e_z) / k_z
    /// ```
    ///
    /// where `R_x` and `R_y` turn by `theta_x` and `theta_y` (coupled joints: [`JointStiffness`](super::JointStiffness)). Each angle depends on those before it alone, so that one pass
    /// gives the equilibrium, and its derivatives by the chain rule.
    ///
    /// ```
    /// use spineline::anatomy::{Levels, SagittalProfile};
    /// use spineline::measure::{TiltRule, measure_film};
    /// use spineline::multibody::{
    ///     JointGroups, Solution, SpineModel, Statics, StiffnessLibrary, Support, Wrench,
    /// };
    /// use spineline::spatial::Vec3;
    /// use spineline::warning::Warnings;
    /// use spineline_phantom::{Readers, Scenario, generate};
    ///
    /// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
    /// let erect = measure_film(&case.films[0], TiltRule::default(), &mut Warnings::default())?;
    /// let spine = SpineModel::from_outline(&erect, &SagittalProfile::default());
    /// let groups = JointGroups::per_joint(Levels::COMPLETE);
    /// let library = StiffnessLibrary::default();
    /// let statics = Statics::new(&spine, &library, &groups, &[0.0; 14], Support::Free);
    /// // 10 N on T2, to the patient's left.
    /// let wrench = Wrench::at(spine.midpoints_mm[14], Vec3::new(0.0, 10.0, 0.0));
    /// let mut solution = Solution::default();
    /// statics.march(&wrench, &[], &[], &mut solution);
    /// assert!(solution.deformed.location(14).y_mm > spine.midpoints_mm[14].y);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn march(
        &self,
        wrench: &Wrench,
        units: &[Wrench],
        parameters: &[Parameter],
        solution: &mut Solution,
    ) {
        self.reset(parameters.len(), solution);
        // Small angles are the rule; a pass that meets a large one is done again.
        let whole = if parameters.is_empty() {
            self.pass::<false, true>(wrench, units, parameters, solution)
                || self.pass::<false, false>(wrench, units, parameters, solution)
        } else {
            self.pass::<true, true>(wrench, units, parameters, solution)
                || self.pass::<true, false>(wrench, units, parameters, solution)
        };
        debug_assert!(whole, "only a pass for small angles ends early");
    }

    /// The march itself. Returns `false` if it ended before T2: with `SMALL` it ends at the first large angle.
    ///
    /// Compiled separately without derivatives and for small angles, which is faster.
    fn pass<const DERIVATIVES: bool, const SMALL: bool>(
        &self,
        wrench: &Wrench,
        units: &[Wrench],
        parameters: &[Parameter],
        solution: &mut Solution,
    ) -> bool {
        let mut transfer = WrenchTransfer::new(self.model, wrench);
        let mut midpoint = self.model.midpoints_mm[0];
        for (j, (joint, hinges)) in self.model.joints.iter().zip(&self.hinges).enumerate() {
            let arm = transfer.in_g(&joint.centre_in_inferior_mm);
            let centre = midpoint + arm;
            let (turns, directions) = if hinges.axial_per_lateral == 0.0 {
                transfer.turn::<SMALL>(&hinges.compliance)
            } else {
                transfer.turn_coupled(&hinges.compliance, hinges.axial_per_lateral)
            };
            if SMALL && !turns.iter().all(|turn| is_small(*turn)) {
                return false;
            }
            let rise = transfer.in_g(&joint.rise_in_inferior_mm);
            transfer.pass_on(&hinges.to_next_mm, &joint.inferior_from_superior);
            midpoint = centre + rise;
            let deformed = &mut solution.deformed;
            deformed.axes[j + 1] = transfer.axes();
            deformed.midpoints_mm[j + 1] = midpoint;
            deformed.hinges_rad[j] = turns;
            if DERIVATIVES {
                let step = Step { joint: j, wrench, turns, directions, centre, arm, rise };
                self.differentiate(&step, units, parameters, solution);
            }
        }
        true
    }

    /// The derivatives of one joint's superior vertebra from the inferior one's.
    #[inline(always)]
    fn differentiate(
        &self,
        step: &Step<'_>,
        units: &[Wrench],
        parameters: &[Parameter],
        solution: &mut Solution,
    ) {
        let Step { joint: j, wrench, turns, directions, centre, arm, rise } = step;
        let (j, force) = (*j, &wrench.force_n);
        let compliance = &self.hinges[j].compliance;
        let moment = wrench.moment_nmm - centre.cross(force);
        // How a hinge's moment changes as its axis turns.
        let levers = directions.map(|axis| axis.cross(&moment));
        let rates = solution.midpoint_rates.iter_mut().zip(&mut solution.turn_rates);
        for (parameter, (midpoints, turned)) in parameters.iter().zip(rates) {
            let ([midpoint, next_midpoint], [turned, next_turned]) =
                (neighbours(midpoints, j), neighbours(turned, j));
            let mut turn = *turned;
            let centre_rate = *midpoint + turn.cross(arm);
            let mut moment_rate = force.cross(&centre_rate);
            let mut stretch = 0.0;
            match *parameter {
                Parameter::Load(i) => {
                    moment_rate += units[i].moment_nmm - centre.cross(&units[i].force_n);
                }
                Parameter::LogStiffness(group) if self.group_of_joint[j] == group => {
                    stretch = -turns[0];
                }
                // A softer joint above does not move a vertebra below.
                Parameter::LogStiffness(_)
                    if turn == Vec3::zeros() && *midpoint == Vec3::zeros() =>
                {
                    (*next_turned, *next_midpoint) = (turn, *midpoint);
                    continue;
                }
                Parameter::LogStiffness(_) => {}
            }
            // Each hinge: its moment changes with the load, with the place, and with its own axis.
            let rate = |i: usize, turn: &Vec3| {
                compliance[i] * (moment_rate.dot(&directions[i]) + turn.dot(&levers[i]))
            };
            let ratio = self.hinges[j].axial_per_lateral;
            let lateral = if ratio == 0.0 {
                rate(0, &turn) + stretch
            } else {
                // The axial moment counts too, and its axis turns with the lateral and the flexion hinge.
                let flexion = |turn: &Vec3| turn + directions[1] * rate(1, turn);
                let fixed = rate(0, &turn) + stretch;
                let share = compliance[0] * ratio;
                let axial_moment =
                    |turn: &Vec3| moment_rate.dot(&directions[2]) + flexion(turn).dot(&levers[2]);
                let by_itself = axial_moment(&(turn + directions[0])) - axial_moment(&turn);
                (fixed + share * axial_moment(&turn)) / (1.0 - share * by_itself)
            };
            turn += directions[0] * lateral;
            if compliance[1] != 0.0 || compliance[2] != 0.0 {
                turn += directions[1] * rate(1, &turn);
                turn += directions[2] * (rate(2, &turn) + ratio * lateral);
            }
            *next_turned = turn;
            *next_midpoint = centre_rate + turn.cross(rise);
        }
    }

    fn reset(&self, parameters: usize, solution: &mut Solution) {
        let vertebrae = self.model.midpoints_mm.len();
        let deformed = &mut solution.deformed;
        if deformed.midpoints_mm.len() != vertebrae {
            deformed.midpoints_mm = self.model.midpoints_mm.clone();
            deformed.axes = self.model.axes.clone();
            deformed.hinges_rad = vec![[0.0; 3]; vertebrae - 1];
        }
        for rates in [&mut solution.midpoint_rates, &mut solution.turn_rates] {
            let spare = &mut solution.spare_rates;
            rates.resize_with(parameters, || {
                spare.pop().unwrap_or_else(|| vec![Vec3::zeros(); vertebrae])
            });
        }
    }
}

/// The rates of the inferior and of the superior vertebra of a joint.
#[inline(always)]
fn neighbours(rates: &mut [Vec3], joint: usize) -> &mut [Vec3; 2] {
    rates[joint..].first_chunk_mut().expect("a joint stands between two vertebrae")
}

/// One joint of a march, as its derivatives need it.
struct Step<'a> {
    joint: usize,
    wrench: &'a Wrench,
    /// Angles of the hinges, and their axes in `G`.
    turns: [f64; 3],
    directions: [Vec3; 3],
    centre: Vec3,
    /// From the inferior midpoint to the centre, and from there to the superior midpoint.
    arm: Vec3,
    rise: Vec3,
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
