//! The force that an analysis found for a film, as a load.

use spineline::action::Application;
use spineline::anatomy::Level;
use spineline::multibody::Timing;
use spineline::spatial::Vec3;

use crate::{AppliedLoad, LevelKey, LoadRecord, SimulationWarning};

impl LoadRecord {
    /// The same with another signed force.
    #[must_use]
    pub fn with_force(&self, force_n: f64) -> Self {
        Self { force_n, ..self.clone() }
    }

    /// It as a load on the uppermost vertebra of its model.
    #[must_use]
    pub fn load(&self, top: Level) -> AppliedLoad {
        let force_n = (Vec3::from(self.direction) * self.force_n).into();
        let (level, timing) = (LevelKey(top), Timing::Proportional);
        match self.application {
            Application::Fixed => {
                AppliedLoad::ForceOnLine { level, force_n, point_mm: self.point_mm, timing }
            }
            Application::AtT2 => {
                AppliedLoad::ForceAtPoint { level, force_n, point_in_vertebra_mm: [0.0; 3], timing }
            }
        }
    }

    /// The warning about a force that was not found.
    #[must_use]
    pub fn doubt(&self) -> Option<SimulationWarning> {
        let (posture, status) = (self.posture, &self.status);
        (status != "converged").then(|| {
            let text = format!(
                "the analysis found no force for the {posture} film ({status}); this is the one whose shape came nearest"
            );
            SimulationWarning::new("load_not_found", text)
        })
    }
}
