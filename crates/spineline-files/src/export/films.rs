//! The films of a model: the force of each on the uppermost vertebra, and the pose that the model takes under it.

use spineline::action::Application;
use spineline::analysis::{FilmLoad, PersonalisedModel};
use spineline::multibody::Goal;
use spineline::spatial::Vec3;

use super::format::ExportError;
use crate::{AppliedLoad, LoadFile};

/// A film, as an engine shows it.
#[derive(Debug)]
pub(super) struct Film {
    pub(super) load: FilmLoad,
    /// The pose, or the reason why the film has no equilibrium.
    pub(super) pose: Result<Pose, String>,
}

/// An equilibrium.
#[derive(Debug)]
pub(super) struct Pose {
    /// Hinge angles of every joint: lateral, flexion, axial.
    pub(super) angles_rad: Vec<[f64; 3]>,
    /// A point on the line of the force, in `G`.
    pub(super) point_mm: Vec3,
}

impl Film {
    /// Name of its pose: its posture.
    pub(super) const fn name(&self) -> &'static str {
        self.load.posture.key()
    }

    /// Name of its load.
    pub(super) fn load_name(&self) -> String {
        format!("{}_load", self.name())
    }
}

/// Every film of a model, in the order of the model.
pub(super) fn films(model: &PersonalisedModel) -> Result<Vec<Film>, ExportError> {
    let mut films: Vec<Film> = Vec::new();
    for &load in &model.loads {
        if films.iter().any(|film| film.load.posture == load.posture) {
            return Err(ExportError::FilmTwice { posture: load.posture });
        }
        films.push(Film { load, pose: pose(model, &load) });
    }
    Ok(films)
}

fn pose(model: &PersonalisedModel, load: &FilmLoad) -> Result<Pose, String> {
    if !load.status.is_usable() {
        return Err(load.status.key().to_owned());
    }
    let file = LoadFile::new(vec![AppliedLoad::of_film(load, model.top())]);
    let placed = file.place(model).map_err(|error| error.to_string())?;
    let response = model.simulate(&placed.loading, Goal::FullLoad).map_err(|e| e.to_string())?;
    let equilibrium = response.result().ok_or_else(|| response.ending.key().to_owned())?;
    let deformed = &equilibrium.deformed;
    let point_mm = match load.application {
        Application::Fixed => load.point_mm.into(),
        Application::AtT2 => deformed.midpoints_mm[model.levels.len() - 1],
    };
    Ok(Pose { angles_rad: deformed.hinges_rad.clone(), point_mm })
}
