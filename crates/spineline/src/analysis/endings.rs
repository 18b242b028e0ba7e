use super::LineModel;
use crate::multibody::{MAX_HUMAN_COLUMN, MAX_HUMAN_JOINT, MatchStatus};
use crate::personalize::{FitStatus, StiffnessBound};
use crate::warning::{Step, Warnings, counted};

/// Warns of fits and simulations without result, and of joints that contradict the line.
pub(super) fn warn_of_endings(model: &LineModel, warnings: &mut Warnings) {
    let mut warn = |step, code, posture, text| warnings.line(step, code, model.kind, posture, text);
    if model.fit.status != FitStatus::Converged {
        let text = format!("the fit did not converge (`{}`)", model.fit.status.key());
        warn(Step::Personalize, "fit_not_converged", None, text);
    }
    for (name, bound) in model.groups.names().iter().zip(&model.fit.bounds) {
        if *bound != StiffnessBound::Inside {
            let text = format!(
                "the multiplier of {} reached its limit, so its value is not identified",
                name.replace('_', " ")
            );
            warn(Step::Personalize, "multiplier_at_bound", None, text);
        }
    }
    for simulation in &model.postures {
        let posture = Some(simulation.posture);
        if simulation.status == MatchStatus::BeyondHumanRange {
            let text = format!(
                "the simulated shape is beyond the human range of motion (limits: {MAX_HUMAN_JOINT:.0} at a joint, {MAX_HUMAN_COLUMN:.0} over the spine), \
                 so it is not a result: check the landmarks and the amplitude of this film"
            );
            warn(Step::Evaluate, "beyond_human_range", posture, text);
        } else if !simulation.is_usable() {
            let text = format!(
                "the force was not found (`{}`): the nearest shape is shown, which is not a result",
                simulation.status.key()
            );
            warn(Step::Evaluate, "force_not_found", posture, text);
        }
        if simulation.lost_forces > 0 {
            let text = format!(
                "the search for forces that reach the amplitude did not converge {}: there may be more such forces",
                counted(simulation.lost_forces, "time")
            );
            warn(Step::Evaluate, "forces_lost", posture, text);
        }
        let beyond = simulation.contradicted.iter().filter(|joint| joint.beyond_noise).count();
        if beyond > 0 {
            let text = format!(
                "{} of {} joints turn against the force, {beyond} of them beyond noise ({:.0} % of the work): no positive stiffness explains them",
                simulation.contradicted.len(),
                simulation.joints(),
                100.0 * simulation.contradicted_weight()
            );
            warn(Step::Personalize, "joints_contradict_line", posture, text);
        }
    }
}
