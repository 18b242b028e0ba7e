//! Warnings about how fits and simulations of a line ended.

use super::compatibility::against_by_chance;
use super::{Analysis, LeftOutBend, LineModel};
use crate::action::LineKind;
use crate::evaluate::Simulation;
use crate::multibody::{MAX_HUMAN_COLUMN, MAX_HUMAN_JOINT, PathEnding};
use crate::number::fixed;
use crate::personalize::{FitStatus, SIGNIFICANCE, StiffnessBound};
use crate::warning::{WarningCode, Warnings, counted};

/// Why a shape beyond the human range is shown nowhere, after the name of the shape.
pub(super) fn human_range_words() -> String {
    format!(
        "is beyond the human range of motion (limits: {} at a joint, {} over the spine), so it is not a result",
        MAX_HUMAN_JOINT.text(0),
        MAX_HUMAN_COLUMN.text(0)
    )
}

/// Warns of fits and simulations without result.
pub(super) fn warn_of_endings(model: &LineModel, warnings: &mut Warnings) {
    let mut warn = |code, posture, text| warnings.line(code, model.kind, posture, text);
    if model.fit.status != FitStatus::Converged {
        let text = format!(
            "the fit did not converge (`{}`), so its shapes are not results",
            model.fit.status.key()
        );
        warn(WarningCode::FitNotConverged, None, text);
    }
    for simulation in &model.simulations {
        let posture = Some(simulation.shape.posture);
        if simulation.status == PathEnding::BeyondHumanRange {
            let text = format!(
                "the simulated shape {}: check the landmarks and the amplitude of this film",
                human_range_words()
            );
            warn(WarningCode::BeyondHumanRange, posture, text);
        } else if !simulation.has_force() {
            let text = format!(
                "the force was not found (`{}`): the nearest shape is shown, which is not a result",
                simulation.status.key()
            );
            warn(WarningCode::ForceNotFound, posture, text);
        }
        if simulation.lost_forces > 0 {
            let text = format!(
                "the search for forces that reach the amplitude did not converge {}: there may be more such forces",
                counted(simulation.lost_forces, "time")
            );
            warn(WarningCode::ForcesLost, posture, text);
        }
    }
}

/// Warns of the fits without a bend that did not converge.
pub(super) fn left_out_warnings(left_out: &[LeftOutBend]) -> Warnings {
    let mut warnings = Warnings::default();
    for LeftOutBend { posture, models } in left_out {
        for model in models.iter().filter(|model| model.fit.status != FitStatus::Converged) {
            let text = format!(
                "the fit without this bend did not converge (`{}`), so it does not predict the bend",
                model.fit.status.key()
            );
            warnings.line(WarningCode::FitNotConverged, model.kind, Some(*posture), text);
        }
    }
    warnings
}

impl Analysis {
    /// What contradicts the lines that the bends keep, and the multipliers of their models that reached a limit.
    ///
    /// A line that the bends reject has both in nearly every patient. Its result says so itself: the test of the line, the
    /// counter-rotating joints of every film and the verdict on every multiplier. A line that no bend tests is kept.
    pub(super) fn kept_line_warnings(&self) -> Warnings {
        let mut warnings = Warnings::default();
        for model in self.models.iter().filter(|model| !self.compatibility(model).rejects()) {
            warn_of_bounds(model, &mut warnings);
            for simulation in model.simulations.iter().filter(|s| s.has_force()) {
                warn_of_contradiction(model.kind, simulation, &mut warnings);
            }
        }
        warnings
    }
}

fn warn_of_bounds(model: &LineModel, warnings: &mut Warnings) {
    // Where the search of a fit stopped is not a limit that the films have.
    if model.fit.status != FitStatus::Converged {
        return;
    }
    for (name, bound) in model.groups.titles().zip(&model.fit.bounds) {
        if *bound != StiffnessBound::Inside {
            let text = format!(
                "the multiplier of {name} reached its limit: the films do not determine it"
            );
            warnings.line(WarningCode::MultiplierAtBound, model.kind, None, text);
        }
    }
}

/// Warns if joints of one film turn against the force by more than noise explains, given the number of joints.
fn warn_of_contradiction(line: LineKind, simulation: &Simulation, warnings: &mut Warnings) {
    let against = &simulation.contradicted;
    if against_by_chance(against, simulation.joints()) >= SIGNIFICANCE {
        return;
    }
    let posture = simulation.shape.posture;
    let beside = if posture.bend().is_some() {
        ""
    } else {
        "; this film takes no part in the test of the line"
    };
    let text = format!(
        "{} of {} joints turn against the force, {} of them beyond noise ({} % of the work): no positive stiffness explains them{beside}",
        against.len(),
        simulation.joints(),
        against.iter().filter(|joint| joint.beyond_noise).count(),
        fixed(100.0 * simulation.contradicted_weight(), 0)
    );
    warnings.line(WarningCode::JointsContradictLine, line, Some(posture), text);
}
