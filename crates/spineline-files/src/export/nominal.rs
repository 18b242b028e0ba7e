//! Nominal inertia and damping, with which a simulation reaches its equilibrium within seconds. No equilibrium depends on them.

use super::xml::number;

/// Nominal time of a hinge in s, whatever the level of the stiffness.
pub(super) const TIME_S: f64 = 0.1;
/// Inertia of a vertebra over the inertia of the vertebra below. A smaller share makes the upper joints fast, a larger one the
/// motion of neighbours against each other; an explicit integrator needs more steps for both.
const TAPER: f64 = 0.7;
/// Damping of a joint times [`TIME_S`] over the inertia that the joint carries. It is twice the critical one: a force along a line
/// fixed in space has no potential, and shakes a spine with less.
const DAMPING: f64 = 4.0;
/// Radius of gyration of a vertebra in m. With a large one, the mass has little effect.
const GYRATION_M: f64 = 1.0;

/// A vertebra's moment of inertia about every axis, and its mass.
#[derive(Debug, Clone, Copy)]
pub(super) struct Inertia {
    pub(super) moment_kg_m2: f64,
    pub(super) mass_kg: f64,
}

impl Inertia {
    const fn of(moment_kg_m2: f64) -> Self {
        Self { moment_kg_m2, mass_kg: moment_kg_m2 / (GYRATION_M * GYRATION_M) }
    }

    /// A part of it.
    pub(super) const fn share(self, share: f64) -> Self {
        Self::of(share * self.moment_kg_m2)
    }
}

/// Inertia of the vertebrae and damping of the joints, for formats whose hinges have no inertia.
#[derive(Debug)]
pub(super) struct Nominal {
    /// Of every vertebra.
    pub(super) inertias: Vec<Inertia>,
    /// Of every joint, for each of its hinges.
    pub(super) dampings_nms_per_rad: Vec<f64>,
}

impl Nominal {
    /// The inertia for which the slowest axis has the time [`TIME_S`]; per joint the compliance of its three hinges in rad/(N·m),
    /// zero where locked.
    pub(super) fn of(compliances: &[Vec<f64>]) -> Self {
        let shares = std::iter::successors(Some(1.0), |share| Some(share * TAPER));
        let shares: Vec<f64> = shares.take(compliances.len()).collect();
        let carried: Vec<f64> = (0..shares.len()).map(|j| shares[j..].iter().sum()).collect();
        let slowness = |axis: usize| -> f64 {
            compliances.iter().zip(&carried).map(|(joint, carried)| carried * joint[axis]).sum()
        };
        let slowest = (0..3).map(slowness).fold(0.0, f64::max);
        let unit_kg_m2 = TIME_S * TIME_S / slowest;
        // The lowest vertebra does not move.
        let moments = std::iter::once(1.0).chain(shares.iter().map(|share| share * unit_kg_m2));
        let damping = |carried: &f64| DAMPING / TIME_S * carried * unit_kg_m2;
        Self {
            inertias: moments.map(Inertia::of).collect(),
            dampings_nms_per_rad: carried.iter().map(damping).collect(),
        }
    }

    /// What it is, for the comment of a file.
    pub(super) fn words() -> String {
        format!(
            "inertia of a vertebra {} times the inertia of the vertebra below, at a level that follows the stiffness; mass with a radius of gyration of {} m; damping of a joint {} 1/s times the inertia above it",
            number(TAPER),
            number(GYRATION_M),
            number(DAMPING / TIME_S),
        )
    }
}
