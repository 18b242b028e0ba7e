//! Wrench of one unit of every component of a load on each vertebra.

use super::{HypothesisFilm, LoadShape, Spine};
use crate::action::LineOfAction;
use crate::anatomy::trunk_weight_shares;
use crate::multibody::{BodyLoad, LoadItem, Timing};
use crate::spatial::{Angle, Frontal, Vec3, rotation_x};

/// A load of unit size on one vertebra, in `G`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct UnitLoad {
    vertebra: usize,
    kind: UnitKind,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum UnitKind {
    /// A force along a line fixed in space.
    OnLine { point_mm: Vec3, force: Vec3 },
    /// A force of fixed direction at the vertebra's midpoint.
    AtMidpoint { force: Vec3 },
    /// A moment about +X, which no turn of the base changes.
    Couple { moment: f64 },
}

fn item(vertebra: usize, load: BodyLoad) -> LoadItem {
    LoadItem { vertebra, load, timing: Timing::Proportional }
}

impl UnitLoad {
    /// The load times a factor, seen from a base that is turned by an angle about +X.
    pub fn item(&self, times: f64, base: Angle) -> LoadItem {
        let seen = rotation_x(-base);
        let load = match self.kind {
            UnitKind::OnLine { point_mm, force } => {
                BodyLoad::ForceOnLine { force_n: seen * force * times, point_mm: seen * point_mm }
            }
            UnitKind::AtMidpoint { force } => BodyLoad::ForceAtPoint {
                force_n: seen * force * times,
                point_in_vertebra_mm: Vec3::zeros(),
            },
            UnitKind::Couple { moment } => {
                BodyLoad::Moment { moment_nmm: Vec3::x() * moment * times }
            }
        };
        item(self.vertebra, load)
    }

    /// Its size as a force: a moment counts as a pair of forces at the distance `apart_mm`.
    pub fn force_n(&self, apart_mm: f64) -> f64 {
        match self.kind {
            UnitKind::OnLine { force, .. } | UnitKind::AtMidpoint { force } => force.norm(),
            UnitKind::Couple { moment } => moment.abs() / apart_mm,
        }
    }

    /// Derivative of [`UnitLoad::item`] by the base's angle.
    pub fn turned_items(&self, times: f64, base: Angle) -> Vec<LoadItem> {
        let seen = rotation_x(-base);
        let back = |v: &Vec3| -Vec3::x().cross(v);
        match self.kind {
            UnitKind::OnLine { point_mm, force } => {
                let (point, force) = (seen * point_mm, seen * force * times);
                let turned = BodyLoad::ForceOnLine { force_n: back(&force), point_mm: point };
                let moved = BodyLoad::Moment { moment_nmm: back(&point).cross(&force) };
                vec![item(self.vertebra, turned), item(self.vertebra, moved)]
            }
            UnitKind::AtMidpoint { force } => {
                let force_n = back(&(seen * force * times));
                let load = BodyLoad::ForceAtPoint { force_n, point_in_vertebra_mm: Vec3::zeros() };
                vec![item(self.vertebra, load)]
            }
            UnitKind::Couple { .. } => Vec::new(),
        }
    }

    /// Moment about a joint, where a film shows the vertebrae; zero for a joint above.
    pub fn moment_about(&self, joint: usize, centre_mm: &Vec3, midpoints_mm: &[Vec3]) -> Vec3 {
        if self.vertebra <= joint {
            return Vec3::zeros();
        }
        match self.kind {
            UnitKind::OnLine { point_mm, force } => (point_mm - centre_mm).cross(&force),
            UnitKind::AtMidpoint { force } => {
                (midpoints_mm[self.vertebra] - centre_mm).cross(&force)
            }
            UnitKind::Couple { moment } => Vec3::x() * moment,
        }
    }
}

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
    let top = spine.model.midpoints_mm.len() - 1;
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
            let shares = trunk_weight_shares(spine.erect.levels());
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
    let midpoints = &spine.model.midpoints_mm;
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
