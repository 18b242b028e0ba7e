//! Shapes of a simulated posture under parts of its force.

use super::{Analysis, LineModel};
use crate::action::LineOfAction;
use crate::anatomy::Posture;
use crate::evaluate::Simulation;
use crate::multibody::{Deformed, Load, Solution, Statics};
use crate::spatial::Frontal;

impl Analysis {
    /// The spine of a simulated posture under parts of its force, such as 0, 0.5 and 1, on the outline of the film: the
    /// paper's figure 11.
    ///
    /// `None` if the model lacks the posture.
    #[must_use]
    pub fn force_path(
        &self,
        model: &LineModel,
        posture: Posture,
        parts: &[f64],
    ) -> Option<Vec<(f64, Vec<Frontal>)>> {
        let shapes = self.force_shapes(model, posture, parts)?;
        let factor = self.on_outline(model.simulation(posture)?);
        let locations = |shape: &Deformed| {
            let all = (0..shape.midpoints_mm.len()).map(|i| shape.location(i) * factor);
            all.collect::<Vec<Frontal>>()
        };
        Some(parts.iter().copied().zip(shapes.iter().map(locations)).collect())
    }

    /// The line of a simulation at the length of the erect film, which is the model's.
    #[must_use]
    pub fn line_in_model(&self, simulation: &Simulation) -> LineOfAction {
        let point = simulation.line.point * (1.0 / self.on_outline(simulation));
        LineOfAction { point, ..simulation.line }
    }

    /// A length on the outline of a simulated film over the same length in the model.
    fn on_outline(&self, simulation: &Simulation) -> f64 {
        let outline = self.movement.film(simulation.shape.posture).map(|posture| &posture.outline);
        outline.map_or(1.0, |outline| simulation.shape.scale.factor / outline.length.scale.factor)
    }

    /// As [`Analysis::force_path`], with the whole shape of the spine under each part, at the length of the erect film.
    #[must_use]
    pub fn force_shapes(
        &self,
        model: &LineModel,
        posture: Posture,
        parts: &[f64],
    ) -> Option<Vec<Deformed>> {
        let simulation = model.simulation(posture)?;
        let options = &self.options;
        let logs = &model.fit.log_multipliers;
        let statics = Statics::new(
            self.movement.spine_of_films(),
            &self.movement.library,
            &model.groups,
            logs,
            options.support,
        );
        let load = Load::along(self.line_in_model(simulation), simulation.depth_mm);
        // Springs and forces are scaled alike, so the unscaled ones give the same shapes.
        let force_n = simulation.force_n / model.fit.absolute_scale;
        let mut solution = Solution::default();
        let shapes = parts.iter().map(|&part| {
            statics.solve(&load, &[part * force_n], &[], &mut solution);
            solution.deformed.clone()
        });
        Some(shapes.collect())
    }
}
