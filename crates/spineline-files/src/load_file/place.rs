use spineline::analysis::PersonalisedModel;
use spineline::anatomy::{Level, Levels};
use spineline::multibody::{
    BodyLoad, LoadItem, LoadPlace, Loading, LoadingFault, Rod, UNIT_TOLERANCE,
};
use spineline::spatial::{Angle, Vec3};

use super::{AppliedLoad, LoadFile};
use crate::FileError;

/// The loads of a file on the vertebrae of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedLoads {
    /// Input of the solver.
    pub loading: Loading,
    /// For every item of the loading, the place of its load in the file, from 0; gravity makes many items.
    pub load_of_item: Vec<usize>,
    /// The same for every rod.
    pub load_of_rod: Vec<usize>,
}

impl AppliedLoad {
    /// The load on one vertebra; `None` for gravity and rods.
    fn on_vertebra(&self) -> Option<(Level, BodyLoad)> {
        let vec = |part: &[f64; 3]| Vec3::from(*part);
        Some(match self {
            Self::ForceOnLine { level, force_n, point_mm, .. } => {
                (*level, BodyLoad::ForceOnLine { force_n: vec(force_n), point_mm: vec(point_mm) })
            }
            Self::ForceAtPoint { level, force_n, point_in_vertebra_mm, .. } => {
                let point_in_vertebra_mm = vec(point_in_vertebra_mm);
                (*level, BodyLoad::ForceAtPoint { force_n: vec(force_n), point_in_vertebra_mm })
            }
            Self::FollowerForce { level, force_in_vertebra_n, point_in_vertebra_mm, .. } => {
                let force_in_vertebra_n = vec(force_in_vertebra_n);
                let point_in_vertebra_mm = vec(point_in_vertebra_mm);
                (*level, BodyLoad::FollowerForce { force_in_vertebra_n, point_in_vertebra_mm })
            }
            Self::Moment { level, moment_nmm, .. } => {
                (*level, BodyLoad::Moment { moment_nmm: vec(moment_nmm) })
            }
            Self::FollowerMoment { level, moment_in_vertebra_nmm, .. } => {
                let moment_in_vertebra_nmm = vec(moment_in_vertebra_nmm);
                (*level, BodyLoad::FollowerMoment { moment_in_vertebra_nmm })
            }
            Self::Pad { level, point_in_vertebra_mm, direction, n_per_mm, advance_mm, .. } => {
                let [point_in_vertebra_mm, direction] = [point_in_vertebra_mm, direction].map(vec);
                let (n_per_mm, advance_mm) = (*n_per_mm, *advance_mm);
                let pad = BodyLoad::Pad { point_in_vertebra_mm, direction, n_per_mm, advance_mm };
                (*level, pad)
            }
            Self::Strap {
                level, point_in_vertebra_mm, anchor_mm, n_per_mm, shortening_mm, ..
            } => {
                let [point_in_vertebra_mm, anchor_mm] = [point_in_vertebra_mm, anchor_mm].map(vec);
                let (n_per_mm, shortening_mm) = (*n_per_mm, *shortening_mm);
                let strap =
                    BodyLoad::Strap { point_in_vertebra_mm, anchor_mm, n_per_mm, shortening_mm };
                (*level, strap)
            }
            Self::Gravity { .. } | Self::Rod { .. } => return None,
        })
    }
}

/// Why one load of a file cannot be applied.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LoadFault {
    /// Which load of the file, from 0.
    pub load: usize,
    /// Why.
    pub reason: String,
    /// Remedy.
    pub help: &'static str,
}

impl LoadFile {
    /// Why loads cannot be applied to a model: for every load that is invalid by itself, else for the first one that is invalid with
    /// the others. Empty where [`LoadFile::place`] succeeds.
    #[must_use]
    pub fn faults(&self, model: &PersonalisedModel) -> Vec<LoadFault> {
        let alone = self.loads.iter().enumerate().filter_map(|(load, one)| {
            let fault = Self::new(vec![one.clone()]).placed(model).err()?;
            Some(LoadFault { load, ..fault })
        });
        let alone: Vec<LoadFault> = alone.collect();
        if alone.is_empty() { self.placed(model).err().into_iter().collect() } else { alone }
    }

    /// Puts the loads on the vertebrae of a model.
    ///
    /// # Errors
    /// [`FileError::Load`] where a load cannot be applied to this model.
    pub fn place(&self, model: &PersonalisedModel) -> Result<PlacedLoads, FileError> {
        self.placed(model).map_err(|LoadFault { load, reason, help }| {
            let (kind, place) = (self.loads[load].kind(), self.loads[load].place());
            FileError::Load { number: load + 1, kind, place, reason, help }
        })
    }

    fn placed(&self, model: &PersonalisedModel) -> Result<PlacedLoads, LoadFault> {
        let mut placed =
            PlacedLoads { loading: Loading::default(), load_of_item: vec![], load_of_rod: vec![] };
        for (number, load) in self.loads.iter().enumerate() {
            self.place_one(number, load, model, &mut placed)?;
            let fresh = placed.loading.items.len();
            placed.load_of_item.resize(fresh, number);
            placed.load_of_rod.resize(placed.loading.rods.len(), number);
        }
        placed.loading.check(&model.spine, model.support).map_err(|error| {
            let load = match error.place {
                LoadPlace::Item(place) => placed.load_of_item[place],
                LoadPlace::Rod(place) => placed.load_of_rod[place],
            };
            LoadFault { load, reason: reason(&error.fault, model), help: error.help() }
        })?;
        Ok(placed)
    }

    fn place_one(
        &self,
        number: usize,
        load: &AppliedLoad,
        model: &PersonalisedModel,
        placed: &mut PlacedLoads,
    ) -> Result<(), LoadFault> {
        let find = |level: Level| {
            let found = model.levels.iter().position(|other| *other == level);
            found.ok_or_else(|| {
                let reason =
                    format!("{level} is not in the model, which extends {}", extent(model));
                LoadFault { load: number, reason, help: "name a vertebra of the model" }
            })
        };
        let timing = load.timing();
        match load {
            AppliedLoad::Gravity { body_weight_n, down, .. } => {
                let levels = self.check_gravity(number, *body_weight_n, down, model)?;
                let slices = Loading::gravity(levels, *body_weight_n, Vec3::from(*down), timing);
                placed.loading.items.extend(slices);
            }
            AppliedLoad::Rod { inferior, superior, shift_mm, turn_deg, .. } => {
                placed.loading.rods.push(Rod {
                    inferior: find(*inferior)?,
                    superior: find(*superior)?,
                    shift_mm: Vec3::from(*shift_mm),
                    turn_rad: Vec3::from(turn_deg.map(|deg| Angle::from_deg(deg).rad())),
                    timing,
                });
            }
            single => {
                let (level, load) = single.on_vertebra().expect("neither gravity nor a rod");
                placed.loading.items.push(LoadItem { vertebra: find(level)?, load, timing });
            }
        }
        Ok(())
    }

    fn check_gravity(
        &self,
        number: usize,
        body_weight_n: f64,
        down: &[f64; 3],
        model: &PersonalisedModel,
    ) -> Result<Levels, LoadFault> {
        let refused = |reason: String, help| Err(LoadFault { load: number, reason, help });
        let Some(levels) = model.known_levels() else {
            let reason = format!(
                "the weight is known for neighbouring vertebrae among L4 to T2, but the model extends {}",
                extent(model)
            );
            return refused(reason, "give the weights as `force_at_point` loads");
        };
        if !(body_weight_n > 0.0 && body_weight_n.is_finite()) {
            let reason = format!("the body weight is {body_weight_n}; it must be positive");
            return refused(
                reason,
                "give the body weight in the unit of the model's forces: where that is newtons, 9.81 times the mass in kg",
            );
        }
        let length = Vec3::from(*down).norm();
        if (length - 1.0).abs() > UNIT_TOLERANCE || !length.is_finite() {
            let reason = format!("`down` has length {length}; it must be a unit vector");
            return refused(reason, "divide `down` by its length");
        }
        let timing = self.loads[number].timing();
        let is_twin = |load: &AppliedLoad| {
            matches!(load, AppliedLoad::Gravity { .. }) && load.timing() == timing
        };
        if let Some(first) = self.loads[..number].iter().position(is_twin) {
            let reason = format!(
                "load {} is gravity with the same timing: both weights would act",
                first + 1
            );
            return refused(reason, "give one `gravity` load with the whole body weight");
        }
        Ok(levels)
    }
}

fn extent(model: &PersonalisedModel) -> String {
    match &model.levels[..] {
        [first, .., last] => format!("from {first} to {last}"),
        _ => "nowhere".to_owned(),
    }
}

/// Text of a load's error, with names instead of indices.
fn reason(fault: &LoadingFault, model: &PersonalisedModel) -> String {
    let name = |vertebra: &usize| model.levels.get(*vertebra).map_or("?", |level| level.name());
    match fault {
        LoadingFault::Vertebra { vertebra, .. } => {
            format!("{} is the fixed vertebra; a load on it has no effect", name(vertebra))
        }
        LoadingFault::RodEnds { inferior, superior, .. } => format!(
            "a rod needs a lower and an upper vertebra, but {} is not below {}",
            name(inferior),
            name(superior)
        ),
        LoadingFault::RodJoints { inferior, superior, joints, least } => format!(
            "it moves {} beside {}, and between the two there are {joints} of the {least} joints that this takes with {} support",
            name(superior),
            name(inferior),
            model.support.key()
        ),
        other => other.to_string(),
    }
}
