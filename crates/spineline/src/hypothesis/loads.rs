//! Wrench of one unit of every component of a load on each vertebra.

use super::{HypothesisFilm, LoadShape, Spine};
use crate::action::LineOfAction;
use crate::anatomy::trunk_weight_shares;
use crate::multibody::{FilmUnderLoad, GeneralStatics, LoadedFilm, UnitKind, UnitLoad};
use crate::personalize::estimate::JointResponses;
use crate::personalize::evidence::JointEvidence;
use crate::spatial::{Frontal, Vec3};

fn in_space(v: Frontal) -> Vec3 {
    Vec3::new(0.0, v.y_mm, v.z_mm)
}

/// Unit loads of every component on one film; `None` if the film lacks the line.
///
/// They take from the film: the two inflections for a line through them; L4's tilt for the vertical; the iliac crests, or else L4's
/// axis, for what is parallel to the iliac line; for the iliac line T2, which moves with it.
pub(super) fn unit_loads(
    shape: LoadShape,
    film: &HypothesisFilm<'_>,
    spine: &Spine<'_>,
) -> Option<Vec<Vec<UnitLoad>>> {
    let top = spine.springs.model.midpoints_mm.len() - 1;
    let sideways = in_space(
        LineOfAction::along_iliac(Frontal::default(), film.outline.iliac_normal).direction,
    );
    let on_line = |line: &LineOfAction| UnitLoad {
        vertebra: top,
        kind: UnitKind::OnLine {
            point_mm: in_space(line.point) + Vec3::x() * spine.depth_mm,
            force: in_space(line.direction),
        },
    };
    let at = |vertebra, force| UnitLoad { vertebra, kind: UnitKind::AtMidpoint { force } };
    let couple = |vertebra, moment| UnitLoad { vertebra, kind: UnitKind::Couple { moment } };
    let inflections = || {
        let [caudal, cranial] = film.inflections?;
        LineOfAction::through(caudal, cranial).ok()
    };
    let shares = || length_shares(spine);
    Some(match shape {
        LoadShape::InflectionLine => vec![vec![on_line(&inflections()?)]],
        LoadShape::IliacLine => vec![vec![at(top, sideways)]],
        LoadShape::FreeLine => {
            let along = |direction| UnitLoad {
                vertebra: top,
                kind: UnitKind::OnLine { point_mm: Vec3::x() * spine.depth_mm, force: direction },
            };
            vec![vec![along(Vec3::y())], vec![along(Vec3::z())], vec![couple(top, 1.0)]]
        }
        LoadShape::TwoForces => {
            vec![vec![on_line(&inflections()?)], vec![at(spine.apex, sideways)]]
        }
        LoadShape::Weight => {
            let down = in_space(Frontal::new(0.0, -1.0).rotated(-film.outline.l4_on_film));
            let shares = trunk_weight_shares(spine.springs.erect.levels());
            vec![shares.into_iter().zip(1..).map(|(share, v)| at(v, down * share)).collect()]
        }
        LoadShape::Lateral => {
            vec![shares().iter().map(|&(v, share, _)| at(v, sideways * share)).collect()]
        }
        LoadShape::GradedLateral => vec![
            shares().iter().map(|&(v, share, _)| at(v, sideways * share)).collect(),
            shares().iter().map(|&(v, share, height)| at(v, sideways * share * height)).collect(),
        ],
        LoadShape::Couple => vec![vec![couple(top, 1.0)]],
        LoadShape::GradedCouple => vec![
            vec![couple(top, 1.0)],
            shares().iter().map(|&(v, share, _)| couple(v, share)).collect(),
        ],
    })
}

/// Per vertebra above L4: its part of the length of the erect spine, and how high it lies on it (T2: 1).
fn length_shares(spine: &Spine<'_>) -> Vec<(usize, f64, f64)> {
    let midpoints = &spine.springs.model.midpoints_mm;
    let mut heights = vec![0.0];
    for pair in midpoints.windows(2) {
        heights.push(heights[heights.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let top = heights.len() - 1;
    let length = heights[top];
    (1..=top)
        .map(|v| {
            let above = if v == top { heights[v] } else { 0.5 * (heights[v] + heights[v + 1]) };
            let below = if v == 1 { 0.0 } else { 0.5 * (heights[v - 1] + heights[v]) };
            (v, (above - below) / length, heights[v] / length)
        })
        .collect()
}

impl HypothesisFilm<'_> {
    /// The film under the loads of a hypothesis; `None` if it lacks the line.
    pub(super) fn under(&self, shape: LoadShape, spine: &Spine<'_>) -> Option<LoadedFilm> {
        let units = unit_loads(shape, self, spine)?;
        let groups = spine.springs.groups;
        Some(LoadedFilm::new(units, &spine.with_multipliers(&vec![0.0; groups.len()]), groups))
    }

    pub(super) fn responses_to(&self, units: &[Vec<UnitLoad>]) -> JointResponses<'_> {
        let midpoints_mm = &self.evidence.midpoints_mm;
        let of_joint = |(j, joint): (usize, &JointEvidence)| {
            let moment = |unit: &UnitLoad| {
                unit.moment_about(j, &joint.centre_mm, midpoints_mm).dot(&joint.hinge)
            };
            let mut turns = [0.0; 3];
            for (turn, units) in turns.iter_mut().zip(units) {
                *turn = joint.compliance_rad_per_nmm * units.iter().map(moment).sum::<f64>();
            }
            turns
        };
        let by_component = self.evidence.joints.iter().enumerate().map(of_joint).collect();
        JointResponses { evidence: &self.evidence, by_component }
    }
}

impl<'a> Spine<'a> {
    /// Its springs with given multipliers.
    pub(super) fn with_multipliers(&self, log_multipliers: &[f64]) -> GeneralStatics<'a> {
        LoadedFilm::springs(self.springs, log_multipliers, self.settings.support)
    }
}
