use crate::anatomy::{Levels, named, trunk_weight_shares};
use crate::fault::{Remedy, faults};
use crate::multibody::{SpineModel, Support};
use crate::number::fixed;
use crate::spatial::{Angle, Mat3, Vec3};

/// A load on one vertebra. Frame `G` unless the name says `in_vertebra`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BodyLoad {
    /// A force along a line fixed in space, whatever the vertebra does.
    ForceOnLine {
        /// Force.
        force_n: Vec3,
        /// Any point of the line.
        point_mm: Vec3,
    },
    /// A force of fixed direction at a point of the vertebra.
    ForceAtPoint {
        /// Force.
        force_n: Vec3,
        /// From the vertebra's midpoint, in its axes.
        point_in_vertebra_mm: Vec3,
    },
    /// A force that turns with the vertebra.
    FollowerForce {
        /// Force in the vertebra's axes.
        force_in_vertebra_n: Vec3,
        /// From the vertebra's midpoint, in its axes.
        point_in_vertebra_mm: Vec3,
    },
    /// A moment of fixed direction.
    Moment {
        /// Moment.
        moment_nmm: Vec3,
    },
    /// A moment that turns with the vertebra.
    FollowerMoment {
        /// Moment in the vertebra's axes.
        moment_in_vertebra_nmm: Vec3,
    },
    /// A frictionless pad that touches the erect spine and then advances: a linear spring along one direction.
    Pad {
        /// Where it touches, from the vertebra's midpoint, in its axes.
        point_in_vertebra_mm: Vec3,
        /// The way it pushes; a unit vector.
        direction: Vec3,
        /// Stiffness.
        n_per_mm: f64,
        /// How far it is pushed in.
        advance_mm: f64,
    },
    /// A strap to a point of the ground, unstretched on the erect spine and then shortened: a linear spring along itself.
    Strap {
        /// Where it holds, from the vertebra's midpoint, in its axes.
        point_in_vertebra_mm: Vec3,
        /// Where it is tied.
        anchor_mm: Vec3,
        /// Stiffness.
        n_per_mm: f64,
        /// How much it is shortened.
        shortening_mm: f64,
    },
}

named! {
    /// Timing of a load. Pads, straps and rods stand from the start; their advance has this timing.
    #[default(Proportional)]
    pub enum Timing {
        /// Constant: applied before the proportional loads, and then constant.
        Constant = "held" as "constant",
        /// Proportional: increases with the load factor, after the constant loads.
        Proportional = "growing" as "proportional",
    }
}

/// One load on one vertebra.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadItem {
    /// Which vertebra, from the fixed one upwards.
    pub vertebra: usize,
    /// What it carries.
    pub load: BodyLoad,
    /// When it comes.
    pub timing: Timing,
}

/// Prescribes the relative pose of two vertebrae, as a rod screwed to both does.
///
/// It prescribes the components that the support leaves free. In a free support that is the whole pose. In a frontal support it is the
/// tilt of the upper vertebra and its lateral place, both seen along the lower one's anterior axis: the support holds
/// flexion, axial rotation and what follows from them, and the distance of the two vertebrae follows from the tilts of the
/// joints, along which the screws slide. [`Loading::check`] refuses a rod that prescribes more.
///
/// Joints turn and do not stretch, so a chain between the two is nearly as long in every shape: in a free support, a pose
/// that asks for much more or less distance is out of reach, and the path ends before it (as unreachable, or as not
/// converged). A rod holds from the start; `timing` says when its pose is brought from the erect to the prescribed one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rod {
    /// Lower vertebra.
    pub inferior: usize,
    /// Upper vertebra; a rod that moves it needs [`Rod::least_joints`] between the two.
    pub superior: usize,
    /// How the upper vertebra moves from its erect pose, in the lower one's axes.
    pub shift_mm: Vec3,
    /// How it turns from its erect pose: a rotation vector in the lower one's axes.
    pub turn_rad: Vec3,
    /// When it is brought in.
    pub timing: Timing,
}

/// All that acts on a spine.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Loading {
    /// Loads on single vertebrae.
    pub items: Vec<LoadItem>,
    /// Rods between two.
    pub rods: Vec<Rod>,
}

/// Tolerance of a unit vector, for numbers written with seven places.
pub const UNIT_TOLERANCE: f64 = 1e-6;

/// Which part of a loading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum LoadPlace {
    /// Place in [`Loading::items`].
    #[error("load {0}")]
    Item(usize),
    /// Place in [`Loading::rods`].
    #[error("rod {0}")]
    Rod(usize),
}

/// A load that cannot be applied.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{place}: {fault}")]
pub struct LoadingError {
    /// Which one, counted from zero.
    pub place: LoadPlace,
    /// Why.
    pub fault: LoadingFault,
}

faults! {
    /// Why a load cannot be applied.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum LoadingFault {
        /// The vertebra does not exist, or is the fixed one.
        #[error("it is on vertebra {vertebra}; loads act on 1 to {last}, and 0 is fixed")]
        #[help("loads act on the vertebrae above the fixed one: L3 to T2 in a complete model")]
        Vertebra {
            vertebra: usize,
            /// The uppermost vertebra.
            last: usize,
        },
        /// A number that is not finite.
        #[error("{what} is not finite")]
        #[help("give finite numbers")]
        NotFinite {
            /// Which value.
            what: &'static str,
        },
        /// A direction of no length, or not of length one.
        #[error("the direction has length {length}, and must be a unit vector")]
        #[help("divide the direction by its length")]
        Direction {
            length: f64,
        },
        /// Stiffness is not positive and finite.
        #[error("its stiffness is {n_per_mm} per mm, and must be positive")]
        #[help("give the stiffness as force per mm, greater than zero")]
        Spring {
            n_per_mm: f64,
        },
        /// A strap without a length.
        #[error("the strap is {} mm long on the erect spine, and the minimum is 1 mm", fixed(*length_mm, 2))]
        #[help("tie the strap to a point away from the vertebra")]
        Strap {
            length_mm: f64,
        },
        /// A rod between vertebrae that are not there, or not in order.
        #[error("it joins vertebrae {inferior} and {superior}, and 0 ≤ lower < upper ≤ {last} must hold")]
        #[help("name the lower vertebra first")]
        RodEnds {
            inferior: usize,
            superior: usize,
            /// The uppermost vertebra.
            last: usize,
        },
        /// Invalid rod pose.
        #[error("its translation or rotation is not finite, or the rotation exceeds 180°")]
        #[help("give finite numbers")]
        RodPose,
        /// A rod that prescribes what the support holds.
        #[error(
            "it prescribes {component} of {}{}, but in the frontal support a rod prescribes only the tilt (rotation about x) and the lateral place (displacement along y) of its upper vertebra",
            fixed(*value, 3),
            component.unit()
        )]
        #[help("set it to 0, or take the free support")]
        RodAgainstSupport {
            component: RodComponent,
            /// How much it prescribes, in the component's unit.
            value: f64,
        },
        /// A rod that moves vertebrae with too few joints between them.
        #[error("it moves vertebra {superior} beside vertebra {inferior}, and between the two there are {joints} of the {least} joints that this takes")]
        #[help("take vertebrae with more joints between them, or a rod that keeps the erect pose")]
        RodJoints {
            inferior: usize,
            superior: usize,
            /// Joints between the two.
            joints: usize,
            /// Least number of joints.
            least: usize,
        },
    }
}

named! {
    /// A component of a rod's pose that a frontal support does not leave to it, in the axes of the lower vertebra.
    pub enum RodComponent {
        /// Displacement along the anterior axis.
        ShiftX = "shift_x" as "a displacement along x (to the front)",
        /// Displacement along the cranial axis.
        ShiftZ = "shift_z" as "a displacement along z (along the spine)",
        /// Rotation about the left axis.
        TurnY = "turn_y" as "a rotation about y (flexion)",
        /// Rotation about the cranial axis.
        TurnZ = "turn_z" as "a rotation about z (axial rotation)",
    }
}

impl RodComponent {
    /// The unit as it follows a number: ` mm` or `°`.
    #[must_use]
    pub const fn unit(self) -> &'static str {
        match self {
            Self::ShiftX | Self::ShiftZ => " mm",
            Self::TurnY | Self::TurnZ => "°",
        }
    }
}

impl LoadingError {
    /// What the user can do about it.
    #[must_use]
    pub fn help(&self) -> &'static str {
        self.fault.help()
    }
}

impl Remedy for LoadingError {
    fn help(&self) -> &'static str {
        LoadingError::help(self)
    }
}

impl Loading {
    /// One load that grows.
    #[must_use]
    pub fn single(vertebra: usize, load: BodyLoad) -> Self {
        Self { items: vec![LoadItem::proportional(vertebra, load)], rods: Vec::new() }
    }

    /// The weight of the trunk, slice by slice, of the head and of the arms, as dead forces at the vertebrae's midpoints.
    ///
    /// The top of `levels` also carries what is above it. A slice's weight is taken at its vertebra's midpoint; in life it lies up to 50 mm before it [pearsall-1996].
    ///
    /// # Units
    /// `body_weight_n` is the whole patient's weight; `down` is a unit vector in `G`.
    ///
    /// # References
    /// [keenan-2014], [winter-2009], [pearsall-1996].
    pub fn gravity(
        levels: Levels,
        body_weight_n: f64,
        down: Vec3,
        timing: Timing,
    ) -> impl Iterator<Item = LoadItem> {
        let shares = (1..).zip(trunk_weight_shares(levels));
        shares.map(move |(vertebra, share)| LoadItem {
            vertebra,
            load: BodyLoad::at_midpoint(down * (body_weight_n * share)),
            timing,
        })
    }

    /// Whether anything comes before the path.
    #[must_use]
    pub fn has_constant_loads(&self) -> bool {
        let constant = |timing| timing == Timing::Constant;
        self.items.iter().any(|item| constant(item.timing))
            || self.rods.iter().any(|rod| constant(rod.timing))
    }

    /// Looks for what cannot be applied to a spine in a support.
    ///
    /// # Errors
    /// [`LoadingError`], the first one found.
    pub fn check(&self, model: &SpineModel, support: Support) -> Result<(), LoadingError> {
        let last = model.midpoints_mm.len() - 1;
        for (place, item) in self.items.iter().enumerate() {
            item.check(model, last)
                .map_err(|fault| LoadingError { place: LoadPlace::Item(place), fault })?;
        }
        for (place, rod) in self.rods.iter().enumerate() {
            rod.check(last, support)
                .map_err(|fault| LoadingError { place: LoadPlace::Rod(place), fault })?;
        }
        Ok(())
    }
}

impl LoadItem {
    /// A load that grows.
    #[must_use]
    pub const fn proportional(vertebra: usize, load: BodyLoad) -> Self {
        Self { vertebra, load, timing: Timing::Proportional }
    }

    fn check(&self, model: &SpineModel, last: usize) -> Result<(), LoadingFault> {
        let vertebra = self.vertebra;
        if vertebra == 0 || vertebra > last {
            return Err(LoadingFault::Vertebra { vertebra, last });
        }
        self.load.check(model, vertebra)
    }
}

impl BodyLoad {
    /// A force of fixed direction at the vertebra's midpoint.
    #[must_use]
    pub fn at_midpoint(force_n: Vec3) -> Self {
        Self::ForceAtPoint { force_n, point_in_vertebra_mm: Vec3::zeros() }
    }

    fn check(&self, model: &SpineModel, vertebra: usize) -> Result<(), LoadingFault> {
        let finite = |what, vector: &Vec3| {
            if is_finite(vector) { Ok(()) } else { Err(LoadingFault::NotFinite { what }) }
        };
        let number = |what, value: f64| finite(what, &Vec3::new(value, 0.0, 0.0));
        let spring = |n_per_mm: f64| {
            let good = n_per_mm > 0.0 && n_per_mm.is_finite();
            if good { Ok(()) } else { Err(LoadingFault::Spring { n_per_mm }) }
        };
        match self {
            Self::ForceOnLine { force_n, point_mm } => {
                finite("the force", force_n)?;
                finite("the line's point", point_mm)
            }
            Self::ForceAtPoint { force_n: force, point_in_vertebra_mm }
            | Self::FollowerForce { force_in_vertebra_n: force, point_in_vertebra_mm } => {
                finite("the force", force)?;
                finite("its point", point_in_vertebra_mm)
            }
            Self::Moment { moment_nmm: moment }
            | Self::FollowerMoment { moment_in_vertebra_nmm: moment } => {
                finite("the moment", moment)
            }
            Self::Pad { point_in_vertebra_mm, direction, n_per_mm, advance_mm } => {
                finite("its point", point_in_vertebra_mm)?;
                number("the advance", *advance_mm)?;
                spring(*n_per_mm)?;
                let length = direction.norm();
                let is_unit = (length - 1.0).abs() < UNIT_TOLERANCE;
                if is_unit { Ok(()) } else { Err(LoadingFault::Direction { length }) }
            }
            Self::Strap { point_in_vertebra_mm, anchor_mm, n_per_mm, shortening_mm } => {
                finite("its point", point_in_vertebra_mm)?;
                finite("the anchor", anchor_mm)?;
                number("the shortening", *shortening_mm)?;
                spring(*n_per_mm)?;
                let length_mm =
                    (anchor_mm - erect_place_mm(model, vertebra, point_in_vertebra_mm)).norm();
                let has_length = length_mm >= 1.0;
                if has_length { Ok(()) } else { Err(LoadingFault::Strap { length_mm }) }
            }
        }
    }
}

fn is_finite(vector: &Vec3) -> bool {
    vector.iter().all(|x| x.is_finite())
}

/// Where a point of a vertebra lies on the erect spine.
pub(super) fn erect_place_mm(model: &SpineModel, vertebra: usize, in_vertebra_mm: &Vec3) -> Vec3 {
    model.midpoints_mm[vertebra] + model.axes[vertebra] * in_vertebra_mm
}

/// A rod's prescribed pose of the upper vertebra in the lower one's axes, and its change with the factor.
pub(super) struct RodPose {
    pub place_mm: Vec3,
    pub axes: Mat3,
}

impl Rod {
    /// A rod that keeps two vertebrae as they stand to one another in the erect spine.
    #[must_use]
    pub fn locking(inferior: usize, superior: usize, timing: Timing) -> Self {
        Self { inferior, superior, shift_mm: Vec3::zeros(), turn_rad: Vec3::zeros(), timing }
    }

    /// The least number of joints between the vertebrae of a rod that moves them: so that their hinges have as many degrees of
    /// freedom as the rod prescribes. Two ball joints do not do in a free support: they keep the distance of their centres.
    #[must_use]
    pub const fn least_joints(support: Support) -> usize {
        match support {
            Support::Free => 3,
            Support::Frontal => 2,
        }
    }

    fn check(&self, last: usize, support: Support) -> Result<(), LoadingFault> {
        let Self { inferior, superior, shift_mm, turn_rad, .. } = *self;
        if inferior >= superior || superior > last {
            return Err(LoadingFault::RodEnds { inferior, superior, last });
        }
        let turns = turn_rad.norm() <= std::f64::consts::PI;
        let is_pose = is_finite(&shift_mm) && is_finite(&turn_rad) && turns;
        if !is_pose {
            return Err(LoadingFault::RodPose);
        }
        if support == Support::Frontal {
            self.check_frontal()?;
        }
        let (joints, least) = (superior - inferior, Self::least_joints(support));
        if joints < least && (shift_mm, turn_rad) != (Vec3::zeros(), Vec3::zeros()) {
            return Err(LoadingFault::RodJoints { inferior, superior, joints, least });
        }
        Ok(())
    }

    /// Looks for components, in the axes of the lower vertebra, that a frontal support does not leave to a rod.
    fn check_frontal(&self) -> Result<(), LoadingFault> {
        let held = [
            (RodComponent::ShiftX, self.shift_mm.x),
            (RodComponent::ShiftZ, self.shift_mm.z),
            (RodComponent::TurnY, Angle::from_rad(self.turn_rad.y).deg()),
            (RodComponent::TurnZ, Angle::from_rad(self.turn_rad.z).deg()),
        ];
        let more = held.into_iter().find(|(_, value)| *value != 0.0);
        more.map_or(Ok(()), |(component, value)| {
            Err(LoadingFault::RodAgainstSupport { component, value })
        })
    }

    /// The pose at a factor: from the erect one (0) to the prescribed one (1).
    pub(super) fn pose_at(&self, model: &SpineModel, factor: f64) -> RodPose {
        let inferior_from_global = model.axes[self.inferior].transpose();
        let erect_mm = inferior_from_global
            * (model.midpoints_mm[self.superior] - model.midpoints_mm[self.inferior]);
        let turn = nalgebra::Rotation3::new(self.turn_rad * factor).into_inner();
        RodPose {
            place_mm: erect_mm + self.shift_mm * factor,
            axes: turn * inferior_from_global * model.axes[self.superior],
        }
    }
}
