use crate::action::{LineKind, LineOfAction};
use crate::analysis::{Analysis, FilmMovement};
use crate::anatomy::named;
use crate::evaluate::Simulation;
use crate::evaluate::statistics::{Resampling, Share, Summary, paired_t, quantile};
use crate::measure::Outline;
use crate::motion::least_windows;
use crate::number::mean;
use crate::spatial::Frontal;

use super::RESAMPLES;

/// The paper's inflections lie at most this number of segments from the least-rotating ones.
pub const NEAR_SEGMENTS: usize = 2;

/// The evidence of one patient on the paper's three main claims.
///
/// Without curves and chains, so that many patients fit into memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PatientClaims {
    /// Distance of every inflection to the least-rotating segment of its window, over all moved films: two per film.
    pub distances_segments: Vec<f64>,
    /// The share of them within [`NEAR_SEGMENTS`] that segments at random places of the windows would have.
    pub near_by_chance: Option<f64>,
    /// Mean rotation of the inflections over all moved films, in degrees.
    pub inflection_rotation_deg: Option<f64>,
    /// Mean rotation of all segments over the same films.
    pub mean_rotation_deg: Option<f64>,
    /// Mean location error of the inflection line and of the iliac line, on the fitted films that both could simulate.
    pub fitted_mm: Option<[f64; 2]>,
    /// The same on held-out films.
    pub held_out_mm: Option<[f64; 2]>,
    /// Rotation of the segment where the inflection line meets the spine a third time, below both inflections; one per moved film
    /// with such a segment, in degrees.
    pub third_points_deg: Vec<f64>,
    /// Moved films with an inflection line.
    pub films_with_line: usize,
    /// Vertebrae whose midpoint moves against the force along the iliac line, one number per bend.
    pub against_force: Vec<f64>,
    /// Mean over films of the curves' residuals: locations in mm, NaN without a scale, and tilts in degrees.
    pub residuals: [f64; 2],
    /// Mean order of the curves.
    pub order: f64,
}

impl PatientClaims {
    /// Reads the numbers off an analysis.
    #[must_use]
    pub fn of(analysis: &Analysis) -> Self {
        let moved = analysis.movement.films.iter().filter_map(|posture| {
            Some((posture.motion.as_ref()?, posture.inflection_estimates.as_ref()?))
        });
        let (mut distances, mut inflections, mut all) = (Vec::new(), Vec::new(), Vec::new());
        for (motion, estimates) in moved {
            distances.extend(estimates.iter().map(|e| e.distance_segments as f64));
            inflections.extend(estimates.iter().map(|e| e.rotation.deg()));
            all.push(motion.mean_rotation().deg());
        }
        let erect = analysis.movement.erect();
        let has_line = |film: &&FilmMovement| film.inflection_estimates.is_some();
        let with_line: Vec<_> = analysis.movement.films.iter().filter(has_line).collect();
        let bends = analysis.movement.bends();
        let windows = least_windows(&erect.fit, &erect.pose);
        let chance = windows.map(|(from, to)| {
            ((2 * NEAR_SEGMENTS + 1) as f64 / (to.saturating_sub(from) + 1) as f64).min(1.0)
        });
        let of_films = |value: &dyn Fn(&FilmMovement) -> Option<f64>| {
            mean(analysis.movement.films.iter().filter_map(value)).unwrap_or(f64::NAN)
        };
        Self {
            third_points_deg: with_line.iter().filter_map(|film| third_point_deg(film)).collect(),
            films_with_line: with_line.len(),
            against_force: bends.map(|film| against_force(&erect.outline, film) as f64).collect(),
            near_by_chance: (!distances.is_empty()).then_some(0.5 * (chance[0] + chance[1])),
            distances_segments: distances,
            inflection_rotation_deg: mean(inflections),
            mean_rotation_deg: mean(all),
            fitted_mm: both_lines(analysis, true),
            held_out_mm: both_lines(analysis, false),
            residuals: [
                of_films(&|film| film.outline.scale.mm(film.fit.rmse_mm)),
                of_films(&|film| Some(film.fit.rmse_tilt.deg())),
            ],
            order: of_films(&|film| Some(film.fit.order as f64)),
        }
    }

    /// Share of the inflections within [`NEAR_SEGMENTS`] of the least-rotating segment.
    #[must_use]
    pub fn near(&self) -> Option<f64> {
        let near = |distance: &f64| f64::from(u8::from(*distance <= NEAR_SEGMENTS as f64));
        mean(self.distances_segments.iter().map(near))
    }

    /// How far the rotation of the inflections lies below the mean rotation, as a part of it.
    #[must_use]
    pub fn below_mean(&self) -> Option<f64> {
        Some(1.0 - self.inflection_rotation_deg? / self.mean_rotation_deg?)
    }

    /// Location error of the iliac line minus the error of the inflection line, on fitted or on held-out films.
    #[must_use]
    pub fn advantage_mm(&self, fitted: bool) -> Option<f64> {
        let errors = if fitted { self.fitted_mm } else { self.held_out_mm };
        errors.map(|[inflection, iliac]| iliac - inflection)
    }
}

/// Rotation of the segment below both inflections where the line through them meets the spine again.
fn third_point_deg(film: &FilmMovement) -> Option<f64> {
    let [caudal, cranial] = film.inflection_points?;
    let line = LineOfAction::through(caudal, cranial).ok()?;
    let inflection = film.inflection_estimates?[0].segment;
    // The first joint is L4's midpoint. Segments next to the inflection are the inflection.
    let below = film.pose.joints.get(1..inflection.saturating_sub(NEAR_SEGMENTS))?;
    let crossing = *line.crossings(below).first()?;
    Some(film.motion.as_ref()?.rotations.get(crossing + 1)?.deg())
}

/// Vertebrae above the base whose midpoint moves against the force along the iliac line, which pulls T2 to where it moves.
fn against_force(erect: &Outline, film: &FilmMovement) -> usize {
    let moves = erect.locations().zip(film.outline.locations()).map(|(from, to)| to - from);
    let moves: Vec<Frontal> = moves.skip(1).collect();
    let Some(&of_t2) = moves.last() else { return 0 };
    let line = LineOfAction::along_iliac(of_t2, film.outline.iliac_normal);
    let along = |one: &Frontal| one.dot(line.direction) * of_t2.dot(line.direction);
    moves.iter().filter(|one| along(one) < 0.0).count()
}

fn simulations(
    analysis: &Analysis,
    kind: LineKind,
    fitted: bool,
) -> impl Iterator<Item = &Simulation> {
    let models = analysis.models.iter().filter(move |m| m.kind == kind);
    models.flat_map(|m| &m.simulations).filter(move |s| s.fitted == fitted)
}

/// Mean location errors of the inflection and the iliac line, on the films that both could simulate.
fn both_lines(analysis: &Analysis, fitted: bool) -> Option<[f64; 2]> {
    let usable = |kind| simulations(analysis, kind, fitted).filter(|s| s.is_usable());
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for a in usable(LineKind::Inflection) {
        let same = |b: &&Simulation| b.shape.posture == a.shape.posture;
        if let Some(b) = usable(LineKind::Iliac).find(same) {
            first.extend_from_slice(&a.shape.location_errors_mm);
            second.extend_from_slice(&b.shape.location_errors_mm);
        }
    }
    Some([mean(first)?, mean(second)?])
}

named! {
    /// The verdict of the numbers on a claim.
    pub enum ClaimVerdict {
        /// The whole interval is on the claim's side.
        Holds = "holds",
        /// The interval has both sides in it.
        Open = "open",
        /// The whole interval is on the other side.
        Fails = "fails" as "does not hold",
    }
}

impl ClaimVerdict {
    /// Whether a value lies above a limit, judged by its interval.
    #[must_use]
    pub fn above(limit: f64, interval: [f64; 2]) -> Self {
        if interval[0] > limit {
            Self::Holds
        } else if interval[1] < limit {
            Self::Fails
        } else {
            Self::Open
        }
    }
}

/// The paper's three main claims over many patients, each with an interval over patients and a verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Claims {
    /// Patients.
    pub patients: usize,
    /// Claim 1: share of inflections within [`NEAR_SEGMENTS`] of the least-rotating segment, mean over patients.
    pub near: Share,
    /// The share at random places.
    pub near_by_chance: f64,
    /// Median of all distances, in segments; NaN without a distance.
    pub median_distance_segments: f64,
    /// Mean rotation of all segments and of the inflections, in degrees.
    pub rotations_deg: [f64; 2],
    /// Claim 2: by which part of it the rotation of the inflections lies below the mean rotation, with a bootstrap interval.
    pub below_mean: f64,
    /// Interval of [`Claims::below_mean`]; `None` for fewer than six patients.
    pub below_mean_interval: Option<[f64; 2]>,
    /// Claim 3: share of patients whose fitted films have a smaller mean location error with the inflection line than with
    /// the iliac line; patients with equal errors count half.
    pub better: Share,
    /// The same on held-out films.
    pub better_held_out: Share,
    /// Mean error of the inflection and of the iliac line over the patients of [`Claims::better`], in mm.
    pub errors_mm: [f64; 2],
    /// The same on held-out films.
    pub held_out_errors_mm: [f64; 2],
    /// Mean advantage of the inflection line over these patients, in mm, and its bootstrap interval.
    pub advantage_mm: (f64, Option<[f64; 2]>),
    /// One-sided probability of the paper's paired t-test with one mean per patient.
    pub advantage_p: Option<f64>,
    /// Moved films on which the inflection line meets the spine a third time, and moved films with that line.
    pub third_points: [usize; 2],
    /// Rotation of the segments at these points, in degrees.
    pub third_points_deg: Summary,
    /// Vertebrae per bend whose midpoint moves against the force along the iliac line.
    pub against_force: Summary,
    /// Mean residuals of the curves: mm and degrees.
    pub residuals: [f64; 2],
    /// Mean order of the curves.
    pub order: f64,
}

impl Claims {
    /// Nine of ten inflections lie near the least-rotating segment; the paper has all of 144.
    pub const NEAR_LIMIT: f64 = 0.9;
    /// The inflections rotate at most a tenth of the mean; the paper has 7 %.
    pub const BELOW_LIMIT: f64 = 0.9;
    /// The inflection line is better in more patients than not.
    pub const BETTER_LIMIT: f64 = 0.5;

    /// Statistics of some patients; the seed is for the bootstrap.
    #[must_use]
    pub fn of(patients: &[PatientClaims], seed: u64) -> Self {
        let all = |value: &dyn Fn(&PatientClaims) -> Option<f64>| -> Vec<f64> {
            patients.iter().filter_map(value).collect()
        };
        let pooled = |values: &dyn Fn(&PatientClaims) -> &[f64]| {
            Summary::of(&patients.iter().flat_map(values).copied().collect::<Vec<_>>())
        };
        let mut distances: Vec<f64> =
            patients.iter().flat_map(|p| p.distances_segments.iter().copied()).collect();
        distances.sort_by(f64::total_cmp);
        // Patients without an inflection line have a mean rotation alone.
        let both =
            patients.iter().filter_map(|p| p.inflection_rotation_deg.zip(p.mean_rotation_deg));
        let (inflections, means): (Vec<f64>, Vec<f64>) = both.unzip();
        let rotations_deg = [&means, &inflections].map(|values| Summary::of(values).mean);
        let wins = |fitted: bool| {
            let win = |p: &PatientClaims| {
                let mm = p.advantage_mm(fitted)?;
                Some(if mm > 0.0 {
                    1.0
                } else if mm < 0.0 {
                    0.0
                } else {
                    0.5
                })
            };
            Share::of_units(&all(&win))
        };
        let errors = [0, 1].map(|line| all(&|p| p.fitted_mm.map(|errors| errors[line])));
        let held_out = [0, 1].map(|line| all(&|p| p.held_out_mm.map(|errors| errors[line])));
        let advantages = all(&|p| p.advantage_mm(true));
        let resampling = Resampling::new(RESAMPLES, seed);
        let median = if distances.is_empty() { f64::NAN } else { quantile(&distances, 0.5) };
        Self {
            patients: patients.len(),
            near: Share::of_units(&all(&PatientClaims::near)),
            near_by_chance: Summary::of(&all(&|p| p.near_by_chance)).mean,
            median_distance_segments: median,
            rotations_deg,
            below_mean: 1.0 - rotations_deg[1] / rotations_deg[0],
            below_mean_interval: resampling
                .ratio_interval(&inflections, &means)
                .map(|[low, high]| [1.0 - high, 1.0 - low]),
            better: wins(true),
            better_held_out: wins(false),
            errors_mm: [0, 1].map(|line: usize| Summary::of(&errors[line]).mean),
            held_out_errors_mm: [0, 1].map(|line: usize| Summary::of(&held_out[line]).mean),
            advantage_mm: (Summary::of(&advantages).mean, resampling.interval(&advantages)),
            advantage_p: paired_t(&errors[0], &errors[1]).map(|t| t.p_less),
            third_points: [
                patients.iter().map(|p| p.third_points_deg.len()).sum(),
                patients.iter().map(|p| p.films_with_line).sum(),
            ],
            third_points_deg: pooled(&|p| &p.third_points_deg),
            against_force: pooled(&|p| &p.against_force),
            residuals: [0, 1].map(|i: usize| {
                Summary::of(&all(&|p| Some(p.residuals[i]).filter(|one| one.is_finite()))).mean
            }),
            order: Summary::of(&all(&|p| Some(p.order))).mean,
        }
    }

    /// The three verdicts; `None` for fewer than two patients, since one patient says nothing about others, and for claim 2 of
    /// fewer than six ([`Resampling::FEWEST`]).
    #[must_use]
    pub fn verdicts(&self) -> [Option<ClaimVerdict>; 3] {
        let share = |share: &Share, limit: f64| {
            (share.n > 1).then(|| ClaimVerdict::above(limit, share.interval))
        };
        [
            share(&self.near, Self::NEAR_LIMIT),
            self.below_mean_interval.map(|i| ClaimVerdict::above(Self::BELOW_LIMIT, i)),
            share(&self.better, Self::BETTER_LIMIT),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patient(distances: &[f64], rotations: [f64; 2], errors: [f64; 2]) -> PatientClaims {
        PatientClaims {
            distances_segments: distances.to_vec(),
            near_by_chance: Some(0.02),
            mean_rotation_deg: Some(rotations[0]),
            inflection_rotation_deg: Some(rotations[1]),
            fitted_mm: Some(errors),
            held_out_mm: Some([errors[1], errors[0]]).filter(|_| errors[0] < 2.0),
            residuals: [0.1, 0.2],
            order: 6.0,
            ..PatientClaims::default()
        }
    }

    #[test]
    fn claims_are_counted_by_patient() {
        // By hand: shares near are 1/2 and 1; rotations 0.01 and 0.03 of 0.1 and 0.3; one win each way.
        let patients = [
            patient(&[0.0, 3.0], [0.1, 0.01], [1.0, 2.0]),
            patient(&[1.0, 2.0], [0.3, 0.03], [4.0, 1.0]),
            // Without an inflection line, whose mean rotation has no part in the ratio.
            PatientClaims { order: 8.0, mean_rotation_deg: Some(9.0), ..PatientClaims::default() },
        ];
        let claims = Claims::of(&patients, 1);
        assert_eq!((claims.patients, claims.near.n, claims.better.n), (3, 2, 2));
        assert_eq!((claims.near.share, claims.better.share), (0.75, 0.5));
        assert_eq!(claims.median_distance_segments, 1.5);
        assert!((claims.below_mean - 0.9).abs() < 1e-12);
        assert_eq!((claims.errors_mm, claims.advantage_mm.0), ([2.5, 1.5], -1.0));
        // The first patient alone has held-out films.
        assert_eq!((claims.better_held_out.n, claims.held_out_errors_mm), (1, [2.0, 1.0]));
        assert!((claims.order - 20.0 / 3.0).abs() < 1e-12);
        let verdicts = claims.verdicts();
        assert_eq!(verdicts[0], Some(ClaimVerdict::Open));
        assert_eq!(verdicts[2], Some(ClaimVerdict::Open));
    }

    #[test]
    fn a_verdict_needs_the_whole_interval() {
        assert_eq!(ClaimVerdict::above(0.5, [0.6, 0.9]), ClaimVerdict::Holds);
        assert_eq!(ClaimVerdict::above(0.5, [0.4, 0.9]), ClaimVerdict::Open);
        assert_eq!(ClaimVerdict::above(0.5, [0.1, 0.4]), ClaimVerdict::Fails);
        let tie = patient(&[0.0; 8], [0.1, 0.09], [1.0, 1.0]);
        let claims = Claims::of(&vec![tie; 20], 1);
        assert_eq!((claims.better.share, claims.better_held_out.share), (0.5, 0.5));
        assert_eq!(claims.verdicts()[2], Some(ClaimVerdict::Open), "equal errors favour no line");
        let one = patient(&[40.0; 8], [0.1, 0.09], [2.0, 1.0]);
        for few in [vec![], vec![one.clone()]] {
            assert!(Claims::of(&few, 1).verdicts().iter().all(Option::is_none));
        }
        let verdicts = Claims::of(&[one.clone(), one], 1).verdicts();
        assert_eq!(verdicts[0], Some(ClaimVerdict::Fails));
    }
}
