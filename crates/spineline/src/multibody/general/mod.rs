//! Equilibrium under any loads: Newton, and continuation from the erect spine.
//!
//! # Equations
//! Unknown are the hinge angles `q`. Every load is a wrench `W` on its vertebra, which may depend on the pose; every hinge
//! is a twist `S` of all above it. Balance: `K q = Sᵀ Σ W` with the sum over what lies above the hinge. The tangent
//! `K - ∂(Sᵀ Σ W)/∂q` is unsymmetric, since a moment fixed in space has no potential.
//!
//! # References
//! Twists, wrenches and elimination along a chain: [featherstone-2008]. Pseudo-arclength continuation: [keller-1977].

mod balance;
mod border;
mod elimination;
mod equilibrium;
mod loading;
mod newton;
mod path;
mod rates;
mod rods;
mod singular;
mod solver;
mod stability;
#[cfg(test)]
mod tests;
mod wrench;

pub use equilibrium::{BranchEvent, Equilibrium, EquilibriumPath, PathPoint};
pub use loading::{
    BodyLoad, LoadItem, LoadPlace, Loading, LoadingError, LoadingFault, Rod, RodComponent, Timing,
    UNIT_TOLERANCE,
};
pub use path::{Goal, OnPoint, PathOptions};
pub use rates::ShapeParameter;
pub use solver::{GeneralStatics, NewtonWork, SpringError};
