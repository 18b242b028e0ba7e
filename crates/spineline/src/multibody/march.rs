//! Equilibrium under a wrench fixed in space: one pass from the fixed vertebra upwards.
//!
//! # Equations
//! From the caudal joint upwards, with the force `F` and the moment `M` of the wrench about the origin, the joint's centre `c` and the
//! axes `e_x`, `e_y`, `e_z` of the inferior vertebra:
//!
//! ```text
//! m       = M - c x F                      moment about the joint
//! theta_x = (m . e_x           - s_x) / k_x        lateral hinge
//! theta_y = (m . (R_x e_y)     - s_y) / k_y        flexion hinge
//! theta_z = (m . (R_x R_y e_z) - s_z) / k_z        axial hinge
//! ```
//!
//! `s` are the moments of the springs in the erect posture ([`Joint::erect_moment_nmm`]). `R_x` and `R_y` turn by `theta_x` and `theta_y`, and all three hinges turn what lies above the joint. Each angle depends on those
//! before it alone, so that one pass gives the equilibrium. In a coupled joint ([`JointStiffness`](super::JointStiffness)) the axial
//! spring is unstressed at `r theta_x`, and `theta_x` is the root of one equation.
//!
//! # Derivatives
//! A parameter moves the inferior midpoint by `v` and turns its vertebra by `w`. From the caudal joint upwards, with the vector `a` from
//! that midpoint to the centre and a hinge's axis `e` as the hinges before it have turned it:
//!
//! ```text
//! c'     = v + w x a
//! m'     = M' - c x F' + F x c'
//! theta' = (m' . e + w . (e x m)) / k,  then w + e theta' for the next hinge
//! ```

#[cfg(doc)]
use super::Joint;
use super::statics::Hinges;
use super::{Parameter, Solution, Statics, Wrench};
use crate::spatial::{Mat3, Vec3, sin_cos};

/// A joint that has turned.
struct Turned {
    /// Angles of the hinges, and their axes in `G`.
    angles: [f64; 3],
    hinges: [Vec3; 3],
    /// The axes of the inferior vertebra, turned by all three hinges.
    axes: Mat3,
}

impl Hinges {
    /// Turns the hinges by a moment about the joint, less the springs' moments in the erect posture; `axes` are the inferior
    /// vertebra's.
    #[inline(always)]
    fn turn(&self, axes: &Mat3, moment_nmm: &Vec3, erect_nmm: &Vec3) -> Turned {
        let [mut x, mut y, mut z] = [0, 1, 2].map(|i| Vec3::from(axes.column(i)));
        // Components along the axes, which turn as the axes do.
        let [mut m_x, mut m_y, mut m_z] = [x, y, z].map(|axis| moment_nmm.dot(&axis));
        let [c_x, c_y, c_z] = self.compliance;
        let ratio = self.axial_per_lateral;
        let hinge_x = x;
        let theta_x = if ratio == 0.0 {
            c_x * (m_x - erect_nmm.x)
        } else {
            coupled_lateral(&[m_x, m_y, m_z], erect_nmm, &self.compliance, ratio)
        };
        turn_pair([&mut y, &mut z], [&mut m_y, &mut m_z], theta_x);
        let (hinge_y, mut hinge_z, mut theta_y, mut theta_z) = (y, z, 0.0, 0.0);
        if !self.is_frontal() {
            theta_y = c_y * (m_y - erect_nmm.y);
            turn_pair([&mut z, &mut x], [&mut m_z, &mut m_x], theta_y);
            hinge_z = z;
            theta_z = ratio * theta_x + c_z * (m_z - erect_nmm.z);
            turn_pair([&mut x, &mut y], [&mut m_x, &mut m_y], theta_z);
        }
        Turned {
            angles: [theta_x, theta_y, theta_z],
            hinges: [hinge_x, hinge_y, hinge_z],
            axes: Mat3::from_columns(&[x, y, z]),
        }
    }

    /// Whether flexion and axial hinge are locked.
    fn is_frontal(&self) -> bool {
        self.compliance[1] == 0.0 && self.compliance[2] == 0.0
    }
}

/// Turns two axes by an angle about the third, the first towards the second, and the components along them.
#[inline(always)]
fn turn_pair([a, b]: [&mut Vec3; 2], [m_a, m_b]: [&mut f64; 2], angle_rad: f64) {
    let (s, c) = sin_cos(angle_rad);
    (*a, *b) = (*a * c + *b * s, *b * c - *a * s);
    (*m_a, *m_b) = (*m_a * c + *m_b * s, *m_b * c - *m_a * s);
}

/// The lateral angle of a coupled joint under a moment in the axes of its inferior vertebra: the root of
///
/// ```text
/// f(θ) = θ - C_x (m_x - s_x + r (m_x sin θ_y + q cos θ_y - s_z))
/// θ_y = C_y (m_y cos θ + m_z sin θ - s_y),  q = m_z cos θ - m_y sin θ
/// ```
///
/// by Newton, kept between bounds of opposite sign.
fn coupled_lateral(
    [mx, my, mz]: &[f64; 3],
    erect: &Vec3,
    compliance: &[f64; 3],
    ratio: f64,
) -> f64 {
    let moments = Vec3::new(*mx, *my, *mz).norm() + erect.norm();
    let size = compliance[0] * moments * (1.0 + ratio.abs());
    let (mut low, mut high) = (-size, size);
    let mut angle = (compliance[0] * (mx - erect.x + ratio * (mz - erect.z))).clamp(low, high);
    for _ in 0..60 {
        let (s, c) = sin_cos(angle);
        let (p, q) = (my * c + mz * s, mz * c - my * s);
        let (sy, cy) = sin_cos(compliance[1] * (p - erect.y));
        let axial = mx * sy + q * cy - erect.z;
        let value = angle - compliance[0] * (mx - erect.x + ratio * axial);
        if value > 0.0 {
            high = angle;
        } else {
            low = angle;
        }
        let flexing = compliance[1] * q;
        let slope = 1.0 - compliance[0] * ratio * (mx * cy * flexing - sy * flexing * q - cy * p);
        let newton = angle - value / slope;
        let next = if newton >= low && newton <= high { newton } else { f64::midpoint(low, high) };
        let step = (next - angle).abs();
        angle = next;
        if step <= 1e-15 {
            break;
        }
    }
    angle
}

impl Statics<'_> {
    /// Equilibrium under a wrench fixed in space, with its derivatives, by the equations of one pass from L4 to T2.
    ///
    /// `units[i]` is the derivative of the wrench by [`Parameter::Load`]`(i)`. Forces are in N, places in mm and moments in
    /// N·mm, all in `G`. The shape and its derivatives by `parameters` are written to `solution`, whose memory is used again.
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
        let force = &wrench.force_n;
        let (mut axes, mut midpoint) = (self.model.axes[0], self.model.midpoints_mm[0]);
        for (j, (joint, hinges)) in self.model.joints.iter().zip(&self.hinges).enumerate() {
            let arm = axes * joint.centre_in_inferior_mm;
            let centre = midpoint + arm;
            let moment = wrench.moment_nmm - centre.cross(force);
            let turned = hinges.turn(&axes, &moment, &joint.erect_moment_nmm);
            let rise = turned.axes * joint.rise_in_inferior_mm;
            axes = turned.axes * joint.inferior_from_superior;
            midpoint = centre + rise;
            let deformed = &mut solution.deformed;
            deformed.axes[j + 1] = axes;
            deformed.midpoints_mm[j + 1] = midpoint;
            deformed.hinges_rad[j] = turned.angles;
            if !parameters.is_empty() {
                let step = Step { joint: j, force, moment, turned, centre, arm, rise };
                self.differentiate(&step, units, parameters, solution);
            }
        }
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
        let Step { joint: j, force, moment, turned: joint, centre, arm, rise } = step;
        let (j, directions) = (*j, &joint.hinges);
        let compliance = &self.hinges[j].compliance;
        // How a hinge's moment changes as its axis turns.
        let levers = directions.map(|axis| axis.cross(moment));
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
                    stretch = -joint.angles[0];
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
            if !self.hinges[j].is_frontal() {
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
    force: &'a Vec3,
    /// Moment of the wrench about the centre.
    moment: Vec3,
    turned: Turned,
    centre: Vec3,
    /// From the inferior midpoint to the centre, and from there to the superior midpoint.
    arm: Vec3,
    rise: Vec3,
}
