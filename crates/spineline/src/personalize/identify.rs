//! Identifiability of every multiplier from the data of a fit: information, profile likelihood, and what a prior adds.
//!
//! # Equations
//! Let `J_a` and `J_f` be the derivatives of the data's residuals, in standard deviations (Ferguson angles: in units of 1°), by
//! `ln alpha` and by the free loads, `Q` an orthonormal basis of the columns of `J_f`, and `phi` the variance factor. The information
//! of the films on stiffness, with the loads free, is
//!
//! ```text
//! A = (I - Q Q') J_a,    information = A' A / phi
//! ```
//!
//! The right singular vectors of `A` are the directions, each with the deviation `sqrt(phi) / singular value`. Under the gauge
//! only changes `W` count that keep the mean of `ln alpha`, so that the covariance is
//!
//! ```text
//! C = W (W' (A' A / phi + P) W)^-1 W',    P = (I - 1 1' / g) / sd^2 with a prior, else 0
//! ```
//!
//! The profile likelihood of multiplier `i` is the rise of the least sum of squares, with the prior where there is one, when
//! `ln alpha_i` is held:
//!
//! ```text
//! rise_i(v) = (min over x with ln alpha_i = v of chi^2(x) - min over x of chi^2(x)) / phi
//! ```
//!
//! Its 95 % interval if the model is exact ([`MULTIPLIER_COVERAGE`]) is where `rise_i(v) < 3.84`, the quantile of chi-squared on one degree of
//! freedom.
//!
//! # References
//! [raue-2009], [gutenkunst-2007].

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::fit::problem_of;
use super::mixed::CHI_SQUARED_95;
use super::problem::Problem;
use super::{FitFilm, FitSettings, Gauge, GroupStiffness, MULTIPLIER_BOUNDS, Personalization};
use crate::anatomy::named;
use crate::least_squares::{FitStatus, Minimum};
use crate::multibody::{FittedSprings, MarchedFilm};
use crate::number::or_infinite;

/// How often a 95 % interval of the mean stiffness of a group ([`GroupStiffness`]) holds the true one, in words: wherever it is shown.
pub const STIFFNESS_COVERAGE: &str = "The 95 % interval is of the mean stiffness of the joints, by a mixed model: joints of a group may differ, and landmarks have noise. On synthetic spines it held the true value in 88 to 99 % of tries where springs are linear, and in 68 to 89 % where they stiffen.";

/// How often a 95 % interval of a multiplier holds the true one, in words: wherever such an interval is shown, by profile or over replicates.
pub const MULTIPLIER_COVERAGE: &str = "A 95 % interval of a multiplier holds the true one in 95 % only if the model is exact. On synthetic spines that are built differently from the model, it held the true one in 34 to 85 % (of this project) and in 30 to 44 % (of others).";

/// Identifiability of the multipliers from the data of a fit.
///
/// # Definition
/// Residuals of shapes count in standard deviations of their measurement, and Ferguson angles in units of 1°, an assumption.
/// Where they exceed this, every deviation and limit below is widened by [`Identifiability::variance_factor`]. A prior is not
/// widened. The scales of the films ([`crate::measure::FilmLength`]) are held at the values found before the fit: everything here is
/// conditional on them.
///
/// # References
/// [raue-2009] for the profile likelihood; [gutenkunst-2007] for the directions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    /// [`Personalization::variance_factor`].
    pub variance_factor: f64,
    /// Measured numbers minus fitted ones.
    pub freedom: usize,
    /// Directions among the `ln α`, the least identified first, from the films alone: without gauge and prior.
    pub directions: Vec<StiffnessDirection>,
    /// Per group.
    pub multipliers: Vec<MultiplierInformation>,
}

/// A direction in which all `ln α` may change together, and how well the films fix it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StiffnessDirection {
    /// Its part in every group's `ln α`; of length 1.
    pub log_multipliers: Vec<f64>,
    /// Standard deviation along it, with the loads free; infinite where the films say nothing.
    #[serde(deserialize_with = "or_infinite")]
    pub log_sd: f64,
    /// How much of it is the direction that changes no ratio, 0 to 1: the one that the gauge fixes.
    pub gauge_share: f64,
}

/// Identifiability of one multiplier under the gauge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MultiplierInformation {
    /// The fitted `ln α`.
    pub log_multiplier: f64,
    /// Standard deviation of `ln α` from the films alone, by curvature; infinite where they do not fix it.
    #[serde(deserialize_with = "or_infinite")]
    pub log_sd: f64,
    /// The same with the prior, where there is one.
    pub log_sd_with_prior: Option<f64>,
    /// Profile likelihood, with the prior where there is one.
    pub profile: Profile,
    /// Mean `ln` stiffness of its joints by the mixed model, from the joint rotations of all films; `None` where these do not determine
    /// it.
    pub stiffness: Option<GroupStiffness>,
}

impl MultiplierInformation {
    /// Part of the information that comes from the films and not from a prior of this deviation, 0 to 1; `None` without a prior, or where
    /// the gauge determines the only group.
    #[must_use]
    pub fn film_share(&self, prior_log_sd: f64, groups: usize, gauge: Gauge) -> Option<f64> {
        // Where the mean is held, a prior alone gives independent values minus their mean.
        let held = if gauge == Gauge::FrozenForce { 0.0 } else { 1.0 / groups as f64 };
        let variance_of_prior = prior_log_sd.powi(2) * (1.0 - held);
        let share = 1.0 - self.log_sd_with_prior?.powi(2) / variance_of_prior;
        (variance_of_prior > 0.0).then(|| share.clamp(0.0, 1.0))
    }

    /// Ends of the 95 % interval of `ln` stiffness over its joints: the lower one is open below the bounds of multipliers, and the upper one
    /// above them.
    #[must_use]
    pub fn interval_95(&self) -> Option<[ProfileEnd; 2]> {
        let [least, most] = MULTIPLIER_BOUNDS.map(f64::ln);
        let [lower, upper] = self.stiffness?.log_interval_95();
        let end = |end: f64, is_open| if is_open { ProfileEnd::Open } else { ProfileEnd::At(end) };
        Some([end(lower, lower < least), end(upper, upper > most)])
    }

    /// Whether the fitted multiplier lies outside of this interval: the fit gives all joints of a group one multiplier, the mixed model
    /// does not. A multiplier at its bound agrees with an interval beyond it.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        let [least, most] = MULTIPLIER_BOUNDS.map(f64::ln);
        self.stiffness.is_some_and(|stiffness| {
            let [lower, upper] = stiffness.log_interval_95();
            self.log_multiplier < lower.min(most) || self.log_multiplier > upper.max(least)
        })
    }

    /// Whether it differs from the mean by more than a factor of 1.5 too.
    #[must_use]
    pub fn is_disputed(&self) -> bool {
        /// Estimators that differ by less tell the same (assumption): multipliers of true lines differ by up to 1.2.
        const SAME: f64 = 1.5;
        let differs =
            |mean: GroupStiffness| (self.log_multiplier - mean.log_mean).abs() > SAME.ln();
        self.is_outside() && self.stiffness.is_some_and(differs)
    }

    /// What the films identify, by this interval.
    #[must_use]
    pub fn verdict(&self) -> IntervalVerdict {
        if self.is_disputed() {
            return IntervalVerdict::Disputed;
        }
        match self.interval_95() {
            None | Some([ProfileEnd::Lost(_), _] | [_, ProfileEnd::Lost(_)]) => {
                IntervalVerdict::Unknown
            }
            Some([ProfileEnd::At(_), ProfileEnd::At(_)]) => IntervalVerdict::Interval,
            Some([ProfileEnd::At(_), ProfileEnd::Open]) => IntervalVerdict::OnlyLower,
            Some([ProfileEnd::Open, ProfileEnd::At(_)]) => IntervalVerdict::OnlyUpper,
            Some([ProfileEnd::Open, ProfileEnd::Open]) => IntervalVerdict::NotIdentified,
        }
    }
}

/// The best fit for every held value of one `ln α`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Points in the order of `ln α`.
    pub points: Vec<ProfilePoint>,
    /// Where the 95 % interval begins, if the model is exact ([`MULTIPLIER_COVERAGE`]).
    pub lower: ProfileEnd,
    /// Where it ends.
    pub upper: ProfileEnd,
}

/// One value of `ln α`, with everything else fitted anew.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ProfilePoint {
    /// The value held.
    pub log_multiplier: f64,
    /// Rise of the sum of squares over the fit's, widened by the variance factor.
    pub rise: f64,
}

/// Where a profile leaves the 95 % region, if the model is exact.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum ProfileEnd {
    /// At this `ln α`.
    At(f64),
    /// Not before the bound of a multiplier: the films allow every value on this side.
    Open,
    /// A fit on the way did not converge, last at this `ln α`.
    Lost(f64),
}

impl ProfileEnd {
    /// The multiplier `α` at this end, where the films set it.
    #[must_use]
    pub fn multiplier(self) -> Option<f64> {
        match self {
            Self::At(log) => Some(log.exp()),
            Self::Open | Self::Lost(_) => None,
        }
    }
}

named! {
    /// What the films identify of a multiplier.
    pub enum IntervalVerdict {
        /// An interval with two ends.
        Interval = "interval" as "identified",
        /// The stiffness has a lower limit.
        OnlyLower = "only_lower" as "only a lower limit",
        /// The stiffness has an upper limit.
        OnlyUpper = "only_upper" as "only an upper limit",
        /// Every stiffness within the bounds explains the films about as well.
        NotIdentified = "not_identified" as "not identified",
        /// The fitted multiplier lies far outside of the interval of its joints.
        Disputed = "disputed" as "not identified: multiplier and joints differ",
        /// The fit of the joint rotations did not converge, or they do not determine the loads.
        Unknown = "unknown" as "unknown: no fit of the joint rotations",
    }
}

impl Profile {
    /// Rise of the sum of squares at the ends of the 95 % interval if the model is exact: 95 % of chi-squared on one degree of freedom.
    pub const LIMIT: f64 = CHI_SQUARED_95;

    /// Whether a point does better than the fit: then the fit was not a minimum.
    #[must_use]
    pub fn improves(&self) -> bool {
        self.points.iter().any(|point| point.rise < -IMPROVEMENT)
    }
}

/// A rise that is lower than this is a better fit, not rounding.
const IMPROVEMENT: f64 = 1e-3;
/// Most points on one side, before and while its end is narrowed down.
const MAX_STEPS: usize = 24;
const MAX_BISECTIONS: usize = 12;
/// A singular value below this part of the largest one is rounding: the films do not see its direction.
const ROUNDING: f64 = 1e-10;

/// Determines which multipliers the films of a fit identify; `None` where the fit did not converge.
#[must_use]
pub fn identify(
    springs: &FittedSprings<'_>,
    films: &[FitFilm<'_>],
    settings: &FitSettings<'_>,
    fit: &Personalization,
) -> Option<Identifiability> {
    if fit.status != FitStatus::Converged {
        return None;
    }
    let weighed = settings.weighed(fit.variance_factor);
    let mut problem = problem_of(*springs, films, &weighed);
    let mut converged = ConvergedFit::begin(&mut problem, fit)?;
    let g = springs.groups.len();
    let across = converged.information();
    let (alone, with_prior) = converged.deviations(&across, settings);
    let multipliers = (0..g)
        .map(|group| MultiplierInformation {
            log_multiplier: fit.log_multipliers[group],
            log_sd: alone[group],
            log_sd_with_prior: with_prior.as_ref().map(|sds| sds[group]),
            profile: converged.profile(group, with_prior.as_ref().unwrap_or(&alone)[group]),
            stiffness: None,
        })
        .collect();
    Some(Identifiability {
        variance_factor: converged.factor,
        freedom: converged.freedom,
        directions: directions(&across, converged.factor),
        multipliers,
    })
}

/// A fit that converged, and the problem that it solves.
struct ConvergedFit<'p, 'a> {
    problem: &'p mut Problem<'a, MarchedFilm>,
    minimum: Minimum,
    bounds: [DVector<f64>; 2],
    groups: usize,
    factor: f64,
    freedom: usize,
}

impl<'p, 'a> ConvergedFit<'p, 'a> {
    fn begin(problem: &'p mut Problem<'a, MarchedFilm>, fit: &Personalization) -> Option<Self> {
        let x = problem.begin(&fit.as_start());
        let bounds = problem.bounds(&x);
        let minimum = problem.minimize(x, bounds.each_ref());
        if minimum.status != FitStatus::Converged {
            return None;
        }
        let (groups, freedom) = (fit.log_multipliers.len(), problem.freedom(&minimum.x));
        Some(Self { problem, minimum, bounds, groups, factor: fit.variance_factor, freedom })
    }

    /// Derivatives of what was measured by every `ln α`, less the part that free loads can compensate.
    fn information(&self) -> DMatrix<f64> {
        let data = self.minimum.system.jacobian.rows(0, self.problem.data_rows());
        let stiffness = data.columns(0, self.groups).into_owned();
        let [lower, upper] = &self.bounds;
        let free: Vec<DVector<f64>> = (self.groups..self.minimum.x.len())
            .filter(|&i| lower[i] < upper[i])
            // Newtons and newton millimetres differ by hundreds.
            .map(|i| data.column(i).into_owned())
            .filter_map(|column| column.try_normalize(0.0))
            .collect();
        if free.is_empty() {
            return stiffness;
        }
        let made_up = DMatrix::from_columns(&free).svd(true, false);
        let basis = made_up.u.expect("it is requested above");
        let strong: Vec<_> = (0..free.len())
            .filter(|&i| made_up.singular_values[i] > 1e-10)
            .map(|i| basis.column(i).into_owned())
            .collect();
        let basis = DMatrix::from_columns(&strong);
        &stiffness - &basis * basis.tr_mul(&stiffness)
    }

    /// Standard deviations of every `ln α` under the gauge: from the films alone, and with the prior.
    fn deviations(
        &self,
        across: &DMatrix<f64>,
        settings: &FitSettings<'_>,
    ) -> (Vec<f64>, Option<Vec<f64>>) {
        let g = self.groups;
        let information = across.tr_mul(across) / self.factor;
        // Ways to change that keep the mean, or all ways where forces fix the level.
        let ways = match settings.gauge {
            Gauge::FrozenForce => DMatrix::identity(g, g),
            Gauge::GeometricMean | Gauge::KnownForce { .. } => {
                let own = |i, j| if i == j { 1.0 } else { 0.0 };
                DMatrix::from_fn(g, g - 1, |i, j| own(i, j) - 1.0 / g as f64)
            }
        };
        let deviations = |information: &DMatrix<f64>| -> Vec<f64> {
            match (ways.tr_mul(information) * &ways).cholesky() {
                Some(factor) => {
                    let covariance = &ways * factor.inverse() * ways.transpose();
                    (0..g).map(|i| covariance[(i, i)].max(0.0).sqrt()).collect()
                }
                None => vec![f64::INFINITY; g],
            }
        };
        let with_prior = settings.prior.map(|prior| {
            let mean = DMatrix::from_element(g, g, 1.0 / g as f64);
            let spread = (DMatrix::identity(g, g) - mean) / (prior.log_sd * prior.log_sd);
            deviations(&(&information + spread))
        });
        (deviations(&information), with_prior)
    }

    /// Follows the best fit with one `ln α` held, to both sides.
    fn profile(&mut self, group: usize, log_sd: f64) -> Profile {
        let best = self.minimum.x[group];
        let mut points = vec![ProfilePoint { log_multiplier: best, rise: 0.0 }];
        let step = if log_sd.is_finite() { log_sd.clamp(0.02, 0.5) } else { 0.5 };
        let lower = self.follow(group, -step, &mut points);
        points.reverse();
        let upper = self.follow(group, step, &mut points);
        points.sort_by(|a, b| a.log_multiplier.total_cmp(&b.log_multiplier));
        Profile { points, lower, upper }
    }

    #[expect(clippy::float_cmp, reason = "a step that `clamp` took away leaves the same bits")]
    fn follow(&mut self, group: usize, step: f64, points: &mut Vec<ProfilePoint>) -> ProfileEnd {
        let bounds = MULTIPLIER_BOUNDS.map(f64::ln);
        let mut known = self.minimum.x.clone();
        let mut inside = ProfilePoint { log_multiplier: known[group], rise: 0.0 };
        let mut step = step;
        for _ in 0..MAX_STEPS {
            let log_multiplier = (inside.log_multiplier + step).clamp(bounds[0], bounds[1]);
            if log_multiplier == inside.log_multiplier {
                return ProfileEnd::Open;
            }
            let Some((rise, x)) = self.held(group, log_multiplier, &known) else {
                return ProfileEnd::Lost(inside.log_multiplier);
            };
            let next = ProfilePoint { log_multiplier, rise };
            points.push(next);
            if rise >= Profile::LIMIT {
                return self.narrow(group, inside, next, &x, points);
            }
            known = x;
            inside = next;
            // Longer steps far from the end.
            if rise < 0.25 * Profile::LIMIT {
                step *= 1.5;
            }
        }
        ProfileEnd::Lost(inside.log_multiplier)
    }

    /// Narrows the place where the rise meets its limit: secants on its root, which is nearly straight.
    fn narrow(
        &mut self,
        group: usize,
        mut inside: ProfilePoint,
        mut outside: ProfilePoint,
        known: &DVector<f64>,
        points: &mut Vec<ProfilePoint>,
    ) -> ProfileEnd {
        const NARROW: f64 = 1e-3;
        let root = |rise: f64| rise.max(0.0).sqrt();
        for _ in 0..MAX_BISECTIONS {
            let width = outside.log_multiplier - inside.log_multiplier;
            if width.abs() < NARROW || (outside.rise - Profile::LIMIT).abs() < 0.01 {
                break;
            }
            let [from, to] = [inside.rise, outside.rise].map(root);
            let part = (Profile::LIMIT.sqrt() - from) / (to - from);
            let log_multiplier = inside.log_multiplier + width * part.clamp(0.1, 0.9);
            let Some((rise, _)) = self.held(group, log_multiplier, known) else {
                return ProfileEnd::Lost(inside.log_multiplier);
            };
            let next = ProfilePoint { log_multiplier, rise };
            points.push(next);
            *(if rise >= Profile::LIMIT { &mut outside } else { &mut inside }) = next;
        }
        ProfileEnd::At(outside.log_multiplier)
    }

    /// The rise with one `ln α` held and everything else fitted anew; `None` where that does not converge.
    fn held(
        &mut self,
        group: usize,
        value: f64,
        near: &DVector<f64>,
    ) -> Option<(f64, DVector<f64>)> {
        // No other multiplier takes the change that the gauge needs.
        if self.groups == 1 && self.problem.holds_mean() {
            return Some((f64::INFINITY, near.clone()));
        }
        let [mut lower, mut upper] = self.bounds.clone();
        let mut x = near.clone();
        // The others take the change that the gauge needs.
        let shift = (x[group] - value) / (self.groups - 1).max(1) as f64;
        for i in (0..self.groups).filter(|&i| i != group && self.problem.holds_mean()) {
            x[i] += shift;
        }
        (x[group], lower[group], upper[group]) = (value, value, value);
        let end = self.problem.minimize(x, [&lower, &upper]);
        let rise = (end.system.cost() - self.minimum.system.cost()) / self.factor;
        (end.status == FitStatus::Converged).then_some((rise, end.x))
    }
}

fn directions(across: &DMatrix<f64>, factor: f64) -> Vec<StiffnessDirection> {
    let g = across.ncols();
    let found = across.clone().svd(false, true);
    let ways = found.v_t.expect("it is requested above");
    let least = ROUNDING * found.singular_values.max();
    let mut directions: Vec<StiffnessDirection> = (0..found.singular_values.len())
        .map(|i| {
            let way: Vec<f64> = ways.row(i).iter().copied().collect();
            let sum: f64 = way.iter().sum();
            // A direction and its opposite are one result: the sum is positive.
            let sign = if sum < 0.0 { -1.0 } else { 1.0 };
            let value = found.singular_values[i];
            StiffnessDirection {
                log_multipliers: way.into_iter().map(|part| sign * part).collect(),
                log_sd: if value > least { factor.sqrt() / value } else { f64::INFINITY },
                gauge_share: sum * sum / g as f64,
            }
        })
        .collect();
    directions.sort_by(|a, b| b.log_sd.total_cmp(&a.log_sd));
    directions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_interval_beyond_the_bounds_is_limited_on_the_side_that_it_has() {
        let of = |ends: [f64; 2], multiplier: f64| {
            let [low, high] = ends.map(f64::ln);
            let (log_mean, log_reach) = (f64::midpoint(low, high), 0.5 * (high - low));
            let profile =
                Profile { points: Vec::new(), lower: ProfileEnd::Open, upper: ProfileEnd::Open };
            let stiffness = Some(GroupStiffness { log_mean, log_sd: 0.5 * log_reach, log_reach });
            let (log_multiplier, log_sd, log_sd_with_prior) = (multiplier.ln(), 1.0, None);
            MultiplierInformation { log_multiplier, log_sd, log_sd_with_prior, profile, stiffness }
                .verdict()
        };
        assert_eq!(of([0.5, 2.0], 1.0), IntervalVerdict::Interval);
        assert_eq!(of([12.0, 40.0], 10.0), IntervalVerdict::OnlyLower);
        assert_eq!(of([0.01, 0.05], 0.1), IntervalVerdict::OnlyUpper);
        assert_eq!(of([0.05, 40.0], 3.0), IntervalVerdict::NotIdentified);
        assert_eq!(of([1.26, 1.91], 3.76), IntervalVerdict::Disputed);
        assert_eq!(of([0.52, 2.66], 10.0), IntervalVerdict::Disputed);
        assert_eq!(of([12.0, 40.0], 3.0), IntervalVerdict::Disputed);
        assert_eq!(of([1.66, 1.84], 1.62), IntervalVerdict::Interval);
    }
}
