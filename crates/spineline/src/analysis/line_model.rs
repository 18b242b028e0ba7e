//! A personalised model of one line of action.

use crate::action::LineKind;
use crate::anatomy::Posture;
use crate::evaluate::Simulation;
use crate::multibody::{JointGroups, StiffnessLibrary, coupled_matrix};
use crate::number::mean;
use crate::personalize::{FitStatus, Gauge, Personalization};
use crate::spatial::Mat3;

/// A personalised model for one choice of line, and what it predicts.
#[derive(Debug, Clone, PartialEq)]
pub struct LineModel {
    /// The choice of line.
    pub kind: LineKind,
    /// Which joints share a multiplier.
    pub groups: JointGroups,
    /// The fit.
    pub fit: Personalization,
    /// Predictions of every posture that has a line, fitted ones and held-out ones.
    pub simulations: Vec<Simulation>,
}

impl LineModel {
    /// The prediction of one posture.
    #[must_use]
    pub fn simulation(&self, posture: Posture) -> Option<&Simulation> {
        self.simulations.iter().find(|simulation| simulation.shape.posture == posture)
    }

    /// Multipliers of the lateral springs, in the order of the groups.
    pub fn multipliers(&self) -> impl Iterator<Item = f64> {
        self.fit.log_multipliers.iter().map(|log| log.exp())
    }

    /// Personalised springs of every joint about x, y and z, caudal first.
    #[must_use]
    pub fn stiffness_nmm_per_rad(&self, library: &StiffnessLibrary) -> Vec<[f64; 3]> {
        let multipliers: Vec<f64> = self.multipliers().collect();
        library
            .rows()
            .iter()
            .zip(self.groups.of_joint())
            .map(|(row, &group)| {
                let [lateral, flexion, axial] =
                    row.nmm_per_rad.map(|k| k * self.fit.absolute_scale);
                [lateral * multipliers[group], flexion, axial]
            })
            .collect()
    }

    /// The same with their coupling, as matrices.
    #[must_use]
    pub fn stiffness_matrices(&self, library: &StiffnessLibrary) -> Vec<Mat3> {
        let springs = self.stiffness_nmm_per_rad(library).into_iter().zip(library.rows());
        springs.map(|(springs, row)| coupled_matrix(springs, row.axial_per_lateral)).collect()
    }

    /// Whether springs and forces are absolute: only where a force is known and was found in the model.
    #[must_use]
    pub fn is_absolute(&self, gauge: Gauge) -> bool {
        let Gauge::KnownForce { posture, .. } = gauge else { return false };
        self.simulation(posture).is_some_and(|s| s.is_usable() && s.force_n != 0.0)
    }

    /// Whether the fit and every simulation has a usable result.
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.fit.status == FitStatus::Converged
            && self.simulations.iter().all(Simulation::is_usable)
    }

    /// Mean location error over fitted or over held-out postures; `None` without these postures.
    #[must_use]
    pub fn mean_location_error_mm(&self, fitted: bool) -> Option<f64> {
        let films = self.simulations.iter().filter(|s| s.fitted == fitted && s.is_usable());
        mean(films.flat_map(|s| s.shape.location_errors_mm.iter().copied()))
    }
}
