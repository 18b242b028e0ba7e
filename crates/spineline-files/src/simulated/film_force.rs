//! The force that an analysis found for a film, as a load.

use spineline::action::Application;
use spineline::analysis::FilmLoad;
use spineline::anatomy::Level;
use spineline::multibody::{PathEnding, Timing};
use spineline::warning::WarningCode;

use crate::{AppliedLoad, SimulationWarning};

impl AppliedLoad {
    /// The load of a film on the uppermost vertebra of its model.
    #[must_use]
    pub fn of_film(film: &FilmLoad, top: Level) -> Self {
        let force_n = film.force_vector_n().into();
        let (level, timing) = (top, Timing::Proportional);
        match film.application {
            Application::Fixed => {
                Self::ForceOnLine { level, force_n, point_mm: film.point_mm, timing }
            }
            Application::AtT2 => {
                Self::ForceAtPoint { level, force_n, point_in_vertebra_mm: [0.0; 3], timing }
            }
        }
    }
}

impl SimulationWarning {
    /// The warning about the load of a film that was not found.
    #[must_use]
    pub fn not_found(film: &FilmLoad) -> Option<Self> {
        let (posture, status) = (film.posture, film.status.key());
        (film.status != PathEnding::Converged).then(|| {
            let text = match film.status {
                PathEnding::FitNotConverged => format!(
                    "the force for the {posture} film is by a fit of the stiffness that did not converge"
                ),
                _ => format!(
                    "the analysis found no force for the {posture} film ({status}); this is the force with the nearest shape"
                ),
            };
            Self::new(WarningCode::LoadNotFound, text)
        })
    }
}
