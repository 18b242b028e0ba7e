use spineline::multibody::Timing;
use spineline::spatial::{moment_words, vector_words};

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
                "pad on {}, advanced (mm) {}, with {n_per_mm} per mm",
                level,
                vector_words(direction.map(|part| part * advance_mm))
            ),
            AppliedLoad::Strap { level, n_per_mm, shortening_mm, .. } => {
                format!("strap on {}, shortened by {shortening_mm} mm, {n_per_mm} per mm", level)
            }
            AppliedLoad::Rod { inferior, superior, shift_mm, turn_deg, .. } => {
                let fixed = shift_mm.iter().chain(turn_deg).all(|part| *part == 0.0);
                let how = if fixed {
                    "keeps their erect pose"
                } else {
                    "moves them relative to each other"
                };
                format!("rod from {} to {}: {how}", inferior, superior)
            }
        };
        match self.timing() {
            Timing::Constant => format!("{words} (constant)"),
            Timing::Proportional => words,
        }
    }
}
