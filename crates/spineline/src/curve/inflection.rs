use super::{Curve, CurveFit};
use crate::anatomy::Level;
use crate::spatial::{Angle, Frontal};

/// Minimum angle of a curve between inflections.
pub(crate) const MIN_TURN: Angle = Angle::from_deg(5.0);

/// A curve between inflections: the part of the spine curve that turns to one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveBetween {
    /// Parameter at its caudal end.
    pub from_mm: f64,
    /// Parameter at its cranial end.
    pub to_mm: f64,
    /// Change of the tilt from end to end; the sum over all curves between inflections is T2's tilt.
    pub turn: Angle,
}

/// A point where the erect curve changes its direction of bending.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inflection {
    /// Parameter on the erect curve.
    pub t_mm: f64,
    /// Place on the erect film.
    pub erect: Frontal,
    /// The vertebrae between which it lies, caudal first.
    pub between: (Level, Level),
    /// The vertebra at whose midpoint a user put it.
    pub vertebra: Option<Level>,
}

impl Inflection {
    /// The vertebra at whose midpoint it was put, or the two between which it lies.
    #[must_use]
    pub fn place(&self) -> String {
        let (below, above) = self.between;
        self.vertebra.map_or_else(|| format!("{below}/{above}"), |level| level.to_string())
    }
}

/// The inflections of one spine curve, and the curves between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Inflections {
    /// All that were seen, caudal first.
    pub all: Vec<Inflection>,
    /// The curves between them; one more than inflections.
    pub curves: Vec<CurveBetween>,
    /// The pair that carries the line of action, caudal first; `None` with fewer than two.
    pub pair: Option<[Inflection; 2]>,
}

/// A place that a user points at: a vertebra, or the disc between two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Site {
    /// The vertebra, or the lower one.
    pub inferior: Level,
    /// The same vertebra, or the upper one.
    pub superior: Level,
}

/// Where the inflections come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum InflectionChoice {
    /// From the erect curve.
    #[default]
    Automatic,
    /// Picked by the user, caudal first.
    ByHand([Site; 2]),
}

/// Finds where a curve inflects.
///
/// # Definition
/// A sign change of the curvature between L4 and T2 whose curves on both sides turn by at least `min_turn`. Curves that
/// turn less are joined to their neighbours, the smallest first. With more than two inflections, the pair is the one
/// around the curve between two inflections that turns most.
#[must_use]
pub fn find_inflections(fit: &CurveFit, min_turn: Angle) -> Inflections {
    let curve = &fit.curve;
    let mut curves = curves_between(curve, &sign_changes(curve));
    // Join the smallest curve to its neighbours until every curve reaches the minimum angle.
    while curves.len() > 1 {
        let smallest = (0..curves.len())
            .min_by(|&a, &b| curves[a].turn.abs().rad().total_cmp(&curves[b].turn.abs().rad()))
            .unwrap_or(0);
        if curves[smallest].turn.abs() >= min_turn {
            break;
        }
        let first = smallest.saturating_sub(1);
        let last = (smallest + 1).min(curves.len() - 1);
        let joined = CurveBetween {
            from_mm: curves[first].from_mm,
            to_mm: curves[last].to_mm,
            turn: curves[first..=last].iter().fold(Angle::ZERO, |sum, part| sum + part.turn),
        };
        curves.splice(first..=last, [joined]);
    }
    let all: Vec<Inflection> =
        curves[1..].iter().map(|part| inflection_at(fit, part.from_mm)).collect();
    // The largest curve that has an inflection at either end.
    let pair = (1..curves.len().saturating_sub(1))
        .max_by(|&a, &b| curves[a].turn.abs().rad().total_cmp(&curves[b].turn.abs().rad()))
        .map(|part| [all[part - 1], all[part]]);
    Inflections { all, curves, pair }
}

impl Inflections {
    /// Puts the pair where the user has pointed.
    #[must_use]
    pub fn picked(mut self, fit: &CurveFit, sites: [Site; 2]) -> Self {
        let mut pair = sites.map(|site| {
            let is_vertebra =
                site.inferior == site.superior && fit.levels.index_of(site.inferior).is_some();
            let vertebra = is_vertebra.then_some(site.inferior);
            Inflection { vertebra, ..inflection_at(fit, fit.site_mm(site)) }
        });
        pair.sort_by(|a, b| a.t_mm.total_cmp(&b.t_mm));
        self.pair = Some(pair);
        self
    }
}

impl CurveFit {
    /// All places that a user can point at on the curve, caudal first: its vertebrae, and the discs between them.
    pub fn sites(&self) -> impl Iterator<Item = Site> {
        let levels = self.levels.as_slice();
        levels.iter().enumerate().flat_map(|(place, &level)| {
            let disc =
                levels.get(place + 1).map(|&above| Site { inferior: level, superior: above });
            std::iter::once(Site { inferior: level, superior: level }).chain(disc)
        })
    }

    /// Parameter of a place on the curve: at the vertebra, or halfway between two.
    #[must_use]
    pub fn site_mm(&self, site: Site) -> f64 {
        let t = |level: Level| self.vertebra_t_mm[self.levels.nearest_index(level)];
        0.5 * (t(site.inferior) + t(site.superior))
    }
}

fn inflection_at(fit: &CurveFit, t_mm: f64) -> Inflection {
    let levels = fit.levels.as_slice();
    let above = fit.vertebra_t_mm.iter().position(|&t| t > t_mm).unwrap_or(levels.len() - 1).max(1);
    let between = (levels[above - 1], levels[above]);
    Inflection { t_mm, erect: fit.curve.point(t_mm), between, vertebra: None }
}

/// Parameters at which the curvature changes its sign, to 1e-10 of the curve's length.
fn sign_changes(curve: &Curve) -> Vec<f64> {
    // Two changes within one step bound a curve far below the minimum angle.
    const STEPS: u32 = 400;
    let at = |step: u32| curve.end_mm() * f64::from(step) / f64::from(STEPS);
    let mut found = Vec::new();
    let (mut from, mut sign) = (0.0, 0.0_f64);
    for step in 0..=STEPS {
        let to = at(step);
        let turning = curve.turning(to);
        if turning == 0.0 {
            continue;
        }
        if sign * turning < 0.0 {
            found.push(bisect(curve, from, to));
        }
        (from, sign) = (to, turning.signum());
    }
    found
}

fn bisect(curve: &Curve, mut from: f64, mut to: f64) -> f64 {
    let sign = curve.turning(from).signum();
    while to - from > 1e-10 * curve.end_mm() {
        let middle = 0.5 * (from + to);
        if curve.turning(middle) * sign > 0.0 {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

fn curves_between(curve: &Curve, changes: &[f64]) -> Vec<CurveBetween> {
    let mut ends = vec![0.0];
    ends.extend_from_slice(changes);
    ends.push(curve.end_mm());
    ends.windows(2)
        .map(|pair| CurveBetween {
            from_mm: pair[0],
            to_mm: pair[1],
            turn: (curve.tilt(pair[1]) - curve.tilt(pair[0])).wrapped(),
        })
        .collect()
}
