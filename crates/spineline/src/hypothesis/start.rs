//! Starts of a fit in closed form: rotation and moment of every joint are both measured on the film.

use super::loads::UnitLoad;
use super::{HypothesisFilm, Spine};
use crate::personalize::estimate::JointResponses;
use crate::personalize::evidence::{FilmEvidence, JointEvidence};

impl HypothesisFilm<'_> {
    /// Rotations and centres of its joints.
    pub(super) fn evidence(&self, spine: &Spine<'_>) -> FilmEvidence {
        FilmEvidence::measure(spine.model, spine.library, spine.erect, self.outline)
    }
}

/// Responses of a film's joints to unit loads.
pub(super) fn responses_to<'a>(
    units: &[Vec<UnitLoad>],
    film: &HypothesisFilm<'_>,
    evidence: &'a FilmEvidence,
    spine: &Spine<'_>,
) -> JointResponses<'a> {
    let (midpoints, _) = spine.model.posed_on_film(film.outline, spine.erect);
    let of_joint = |(j, joint): (usize, &JointEvidence)| {
        let moment =
            |unit: &UnitLoad| unit.moment_about(j, &joint.centre_mm, &midpoints).dot(&joint.hinge);
        let mut turns = [0.0; 3];
        for (turn, units) in turns.iter_mut().zip(units) {
            *turn = joint.compliance_rad_per_nmm * units.iter().map(moment).sum::<f64>();
        }
        turns
    };
    let by_component = evidence.joints.iter().enumerate().map(of_joint).collect();
    JointResponses { evidence, by_component }
}
