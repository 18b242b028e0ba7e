//! A bend that was left out, under the most probable load for T2 on its film and the prior of joint rotations.

use super::near_t2::largest;
use super::prediction::{FoundLoad, Predicted, Predictor, Role};
use super::{Hypothesis, HypothesisFilm};
use crate::evaluate::{BeforeTheFilm, MostProbable, UnknownLoad};

impl Predictor<'_, '_> {
    /// The film under the most probable load; T2's tilt is known in [`Role::LeftOutWithTilt`].
    pub(super) fn by_prior(self, film: &HypothesisFilm<'_>) -> Predicted {
        let Self { hypothesis: Hypothesis { load, base }, spine, log_multipliers, role } = self;
        let before = BeforeTheFilm {
            springs: spine.springs,
            log_multipliers,
            support: spine.settings.support,
            rotations: spine.rotations,
            base,
            knows_tilt: role == Role::LeftOutWithTilt,
        };
        let found = before.most_probable(film.outline, &[], |outline, _| {
            let loaded = film.at_scale_of(outline, spine).under(load, spine)?;
            let largest = largest(&loaded, log_multipliers, spine);
            Some(UnknownLoad { film: loaded, largest })
        })?;
        let MostProbable { film: loaded, outline, components, base, scale } = found;
        let at_its_scale = film.at_scale_of(&outline, spine);
        let found = FoundLoad { components, base }.shape(&loaded, &at_its_scale, role, spine)?;
        Ok(found.in_lengths_of(film, scale))
    }
}
