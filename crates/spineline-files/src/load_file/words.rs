use spineline::multibody::Timing;
use spineline::spatial::{displacement_words, moment_words, rotation_words, vector_words};

use super::AppliedLoad;

impl AppliedLoad {
    /// As text, with the unit of the model's forces where a force stands alone.
    #[must_use]
    pub fn words(&self, force_unit: &str) -> String {
        let words = match self {
            AppliedLoad::ForceOnLine { level, force_n, .. } => {
                format!(
                    "force on {}, along a line fixed in space: {}",
                    level,
                    vector_words(*force_n)
                )
            }
            AppliedLoad::ForceAtPoint { level, force_n, .. } => {
                format!("force at {}: {}", level, vector_words(*force_n))
            }
            AppliedLoad::FollowerForce { level, force_in_vertebra_n, .. } => format!(
                "force at {} that follows its rotation: {} of the vertebra",
                level,
                vector_words(*force_in_vertebra_n)
            ),
            AppliedLoad::Moment { level, moment_nmm, .. } => {
                format!("moment on {} (force × mm): {}", level, moment_words(*moment_nmm))
            }
            AppliedLoad::FollowerMoment { level, moment_in_vertebra_nmm, .. } => format!(
                "moment on {} that follows its rotation (force × mm): {}",
                level,
                moment_words(*moment_in_vertebra_nmm)
            ),
            AppliedLoad::Gravity { body_weight_n, .. } => {
                format!(
                    "weight of trunk, head and arms of a body with the weight {body_weight_n} {force_unit}"
                )
            }
            AppliedLoad::Pad { level, direction, n_per_mm, advance_mm, .. } => format!(
                "pad on {level}: {}, {}",
                displacement_words(direction.map(|part| part * advance_mm)),
                spring_words(*n_per_mm, force_unit)
            ),
            AppliedLoad::Strap { level, n_per_mm, shortening_mm, .. } => format!(
                "strap on {level}: shortened by {shortening_mm} mm, {}",
                spring_words(*n_per_mm, force_unit)
            ),
            AppliedLoad::Rod { inferior, superior, shift_mm, turn_deg, .. } => {
                let is_moved = |by: &[f64; 3]| by.iter().any(|part| *part != 0.0);
                let turn = is_moved(turn_deg).then(|| rotation_words(*turn_deg));
                let shift = is_moved(shift_mm).then(|| displacement_words(*shift_mm));
                let moves: Vec<String> = turn.into_iter().chain(shift).collect();
                let how = if moves.is_empty() {
                    "keeps their erect pose".to_owned()
                } else {
                    format!("moves {superior} from its erect pose by {}", moves.join(" and "))
                };
                format!("rod from {inferior} to {superior}: {how}")
            }
        };
        match self.timing() {
            Timing::Constant => format!("{words} (constant)"),
            Timing::Proportional => words,
        }
    }
}

/// The stiffness of a spring; relative forces have no unit.
fn spring_words(n_per_mm: f64, force_unit: &str) -> String {
    match force_unit {
        "N" => format!("spring {n_per_mm} N/mm"),
        _ => format!("spring {n_per_mm} relative units per mm"),
    }
}
