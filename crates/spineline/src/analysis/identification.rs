//! Whether the films identify every stiffness multiplier.

use super::models::{bending_loads, fit_films, settings_of};
use super::{Analysis, LineModel};
use crate::number::mean;
use crate::personalize::{FitStatus, GroupStiffness, Identifiability, StiffnessBound, identify};
use crate::warning::Warnings;

/// How the fit of a multiplier ended. [`Analysis::identifiability`] tests whether the films identify a fitted value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MultiplierEnding {
    /// A value: a force is known.
    Absolute,
    /// A ratio to the other multipliers.
    Ratio,
    /// The fit ended at a bound, which is not a value.
    AtBound(StiffnessBound),
    /// All others ended at a bound, and these bounds fix it, also where a force is known.
    OthersAtBounds,
    /// Most joints that share it turn against the force on the fitted films: no positive stiffness explains them.
    Contradicted,
    /// The fit did not converge.
    NotConverged,
}

/// A multiplier's verdict and the joints behind it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MultiplierVerdict {
    /// How its fit ended.
    pub ending: MultiplierEnding,
    /// Joints of the fitted films that turn against the force, a joint once per film.
    pub against: usize,
    /// All joints that share it, a joint once per film.
    pub joints: usize,
}

impl MultiplierVerdict {
    /// Whether its fit ended at a value.
    #[must_use]
    pub const fn has_value(&self) -> bool {
        self.ending.refusal().is_none()
    }
}

impl LineModel {
    /// The verdict on every multiplier, in the order of the groups.
    ///
    /// # Definition
    /// A multiplier is contradicted when more than half of its joints, counted once per fitted film with a usable
    /// simulation, turn against the moment of that film's force ([`crate::evaluate::Simulation::contradicted`]). The worst
    /// finding counts: not converged, then contradicted, then at a bound, then all others at bounds.
    #[must_use]
    pub fn verdicts(&self, analysis: &Analysis) -> Vec<MultiplierVerdict> {
        let films: Vec<_> = self.simulations.iter().filter(|s| s.fitted && s.is_usable()).collect();
        let group_of = self.groups.of_joint();
        let gauge = analysis.options.gauge;
        let verdict = |group: usize| {
            let in_group = |joint: usize| group_of[joint] == group;
            let against = films
                .iter()
                .flat_map(|film| &film.contradicted)
                .filter_map(|joint| analysis.movement.levels().index_of(joint.inferior))
                .filter(|&joint| in_group(joint))
                .count();
            let joints = films.len() * (0..group_of.len()).filter(|&joint| in_group(joint)).count();
            let bound = self.fit.bounds[group];
            let ending = if self.fit.status != FitStatus::Converged || films.is_empty() {
                MultiplierEnding::NotConverged
            } else if 2 * against > joints {
                MultiplierEnding::Contradicted
            } else if bound != StiffnessBound::Inside {
                MultiplierEnding::AtBound(bound)
            } else if self.fit.has_one_inside(gauge) {
                MultiplierEnding::OthersAtBounds
            } else if self.is_absolute(gauge) {
                MultiplierEnding::Absolute
            } else {
                MultiplierEnding::Ratio
            };
            MultiplierVerdict { ending, against, joints }
        };
        (0..self.groups.len()).map(verdict).collect()
    }
}

impl Analysis {
    /// Identifiability of a model's multipliers: intervals by the mixed model from the joint rotations of all films; profile likelihood,
    /// information, and what a prior adds, from the bends. `None` where its fit did not converge.
    ///
    /// Computed on request, because no other result depends on it: it takes tens of fits.
    #[must_use]
    pub fn identifiability(&self, model: &LineModel) -> Option<Identifiability> {
        let movement = &self.movement;
        // The analysis holds the warnings about these lines already.
        let mut repeated = Warnings::default();
        let bends = bending_loads(movement, &self.options, model.kind, &mut repeated);
        let films = fit_films(&bends);
        let springs = movement.springs(&model.groups);
        let mut found =
            identify(&springs, &films, &settings_of(movement, &self.options, &[]), &model.fit)?;
        // Predictions are about their mean, the multipliers of a fit about theirs.
        let level = mean(model.fit.log_multipliers.iter().copied())?;
        for (one, group) in
            found.multipliers.iter_mut().zip(self.group_stiffness(model).into_iter().flatten())
        {
            one.stiffness = Some(GroupStiffness { log_mean: group.log_mean + level, ..group });
        }
        Some(found)
    }

    /// Lateral springs of every model's joints on one logarithmic scale: 0 for the softest of all models, 1 for the
    /// stiffest; a half where all are alike. By model and joint, caudal first.
    #[must_use]
    pub fn relative_stiffness(&self) -> Vec<Vec<f64>> {
        let logs: Vec<Vec<f64>> = self
            .models
            .iter()
            .map(|model| model.stiffness_nmm_per_rad(&self.movement.library))
            .map(|joints| joints.iter().map(|[lateral, ..]| lateral.ln()).collect())
            .collect();
        let all = || logs.iter().flatten().copied();
        let (low, high) =
            (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        let place = |log: &f64| if high > low { (log - low) / (high - low) } else { 0.5 };
        logs.iter().map(|joints| joints.iter().map(place).collect()).collect()
    }
}
