//! Step 6: vertebrae, joints, springs and a load → the shape in static equilibrium.
//!
//! # Model
//! The base (L4) is fixed. Each joint up to T2, 14 where all levels are modelled, sits at the posterior edge of the inferior vertebra's superior endplate and is
//! three hinges in series, x (lateral), y (flexion), z (axial), in the inferior vertebra's anatomical axes, with a
//! linear torsion spring on each, unstressed in the erect posture or stressed by the weight of the trunk ([`SpineModel::carrying`]);
//! lateral and axial spring may be coupled ([`JointStiffness`]). The force of a line of action is carried by the
//! uppermost vertebra; other loads act anywhere ([`GeneralStatics`]).
//!
//! # Statics
//! A line fixed in space is a constant spatial wrench, so the moment `m` about a joint depends only on the joint's own
//! place, which depends only on the joints below. With hinges in series each angle is explicit:
//! `θx = m·e_x / kx`, `θy = m·(Rx e_y) / ky`, `θz = m·(Rx Ry e_z) / kz`. Equilibrium is one march from the base to the
//! top, and so are its derivatives ([`Statics::march`]). Other loads take Newton iterations along a path from the unloaded spine.
//!
//! # References
//! [petit-2004], [panjabi-1976], [jalalian-loa] section 2.

mod bodies;
mod film_under_load;
mod follow;
mod general;
mod geometry;
mod human_range;
mod load;
mod loaded_film;
mod march;
mod matching;
mod nearest;
mod roots;
mod solution;
mod statics;
mod stiffness;
mod stiffness_tables;
mod target;
mod unit_load;

pub use bodies::BodySize;
pub use film_under_load::FittedSprings;
pub(crate) use film_under_load::{FilmUnderLoad, MarchedFilm, TurnedBase, Wanted};
pub use follow::{BranchEventKind, PathEnding};
pub use general::{
    BodyLoad, BranchEvent, Equilibrium, EquilibriumPath, GeneralStatics, Goal, LoadItem, LoadPlace,
    Loading, LoadingError, LoadingFault, NewtonWork, OnPoint, PathOptions, PathPoint, Rod,
    RodComponent, ShapeParameter, SpringError, Timing, UNIT_TOLERANCE,
};
pub(crate) use geometry::disc_mm;
pub use geometry::{Joint, SpineModel};
pub use human_range::{BeyondHumanRange, MAX_HUMAN_COLUMN, MAX_HUMAN_JOINT};
pub use load::{Load, Wrench};
pub(crate) use loaded_film::LoadedFilm;
pub use matching::{ForceMatch, ForceSign, amplitude_matches, match_amplitude};
pub(crate) use matching::{MAX_FORCE_PER_STIFFNESS, MAX_HINGE_RAD, OneComponent, match_t2_near};
pub use nearest::match_t2;
pub(crate) use nearest::{
    SeveralComponents, nearest_from_starts, nearest_on_path, size_factor, starts_of_sizes,
};
pub use solution::{Deformed, Parameter, Solution};
pub use statics::Statics;
pub(crate) use stiffness::group_title;
pub use stiffness::{
    JointGroups, JointStiffness, StiffnessError, StiffnessLibrary, Support, coupled_matrix,
};
pub use stiffness_tables::StiffnessTable;
pub use target::Residual;
pub(crate) use unit_load::{UnitKind, UnitLoad};
