//! Lines of best fit to the rotations of the films, compared with the candidates.

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::{
    Analysis, AnalysisOptions, BestFitLine, FilmMovement, LineComparison, LineCrossing, LineModel,
    Movement,
};
use crate::action::{LineKind, LineOfAction};
use crate::clinical::JointShares;
use crate::curve::CurveSpread;
use crate::personalize::evidence::FilmEvidence;
use crate::personalize::{BestFitLoads, GroupStiffness, NoLoads, ProposedLine, predict_stiffness};
use crate::spatial::{Angle, Frontal};
use crate::warning::{WarningCode, Warnings};

impl FilmMovement {
    /// The line of best fit to the film's rotations against a line of this kind; `None` without such a line, and for the estimated
    /// line, which comes from the same rotations.
    #[must_use]
    pub fn line_comparison(&self, kind: LineKind) -> Option<LineComparison> {
        let best_fit = self.best_fit_line.as_ref()?;
        match kind {
            LineKind::Inflection => best_fit.inflection,
            LineKind::Iliac => best_fit.iliac,
            LineKind::Given => best_fit.given,
            LineKind::Estimated => None,
        }
    }
}

impl Analysis {
    /// The loads of best fit on all films but the erect one, with regional multipliers; films in the order of the postures.
    ///
    /// # Errors
    /// [`NoLoads`].
    pub fn best_fit_loads(&self) -> Result<BestFitLoads, NoLoads> {
        best_fit_loads_near(&self.movement, None)
    }

    /// The mean `ln` stiffness of every group of a model's joints, predicted from the rotations of all films with the bends' forces along the
    /// model's line.
    ///
    /// # Errors
    /// [`NoLoads`].
    pub fn group_stiffness(&self, model: &LineModel) -> Result<Vec<GroupStiffness>, NoLoads> {
        let movement = &self.movement;
        let segments = movement.inflection_segments.zip(inflections_along_mm2(movement));
        let line_of = |film: &FilmMovement| {
            film.outline.posture.bend()?;
            match model.kind {
                LineKind::Inflection => {
                    let (segments, along_mm2) = segments?;
                    through_inflections(film, segments, along_mm2)
                }
                LineKind::Iliac => through_t2(film),
                LineKind::Given => Some(exactly(film, &self.options.given_line(&film.outline)?).1),
                LineKind::Estimated => None,
            }
        };
        let films: Vec<_> = movement
            .films
            .iter()
            .filter_map(|film| Some((film.evidence.as_ref()?, line_of(film))))
            .collect();
        predict_stiffness(&films, movement.depth_mm(), &joint_shares(movement), &model.groups)
    }
}

/// Petit's line by a point on each side of T2, so that mirrored films have mirrored equations: the error of T2 moves both points alike, and
/// the error of the crests' direction moves them across the line in opposite directions.
fn through_t2(film: &FilmMovement) -> Option<ProposedLine> {
    let outline = &film.outline;
    let t2 = outline.top();
    let line = LineOfAction::along_iliac(t2, Some(outline.iliac_normal?));
    let place_mm2 = outline.noise.location_mm.powi(2);
    let mut covariance = Matrix4::from_fn(|i, j| if i % 2 == j % 2 { place_mm2 } else { 0.0 });
    let reach = line.direction * (0.5 * LineOfAction::MIN_GAP_MM);
    let across_mm2 = (reach.norm_mm() * crests_sd(film).rad()).powi(2);
    for (i, j, sign) in [(1, 1, 1.0), (3, 3, 1.0), (1, 3, -1.0), (3, 1, -1.0)] {
        covariance[(i, j)] += sign * across_mm2;
    }
    Some(ProposedLine::Through { points: [t2 - reach, t2 + reach], covariance })
}

fn through_inflections(
    film: &FilmMovement,
    segments: [usize; 2],
    along_mm2: Matrix2<f64>,
) -> Option<ProposedLine> {
    let points = film.inflection_points?;
    let covariance = inflection_covariance(film, segments, along_mm2)?;
    Some(ProposedLine::Through { points, covariance })
}

/// Standard deviation of the direction of the iliac crests.
fn crests_sd(film: &FilmMovement) -> Angle {
    /// Between the crests of grown-ups (assumption).
    const CRESTS_MM: f64 = 250.0;
    let outline = &film.outline;
    // Crests are marked once, and like a corner; a location is the mean of four corners and of all readings.
    let crest_mm = 2.0 * outline.noise.location_mm * (outline.readings as f64).sqrt();
    Angle::from_rad(f64::sqrt(2.0) * crest_mm / CRESTS_MM)
}

fn best_fit_loads_near(
    movement: &Movement,
    near: Option<&BestFitLoads>,
) -> Result<BestFitLoads, NoLoads> {
    if movement.film_without_scale().is_some() {
        return Err(NoLoads::NoFilms);
    }
    let films: Vec<&FilmEvidence> =
        movement.films.iter().filter_map(|posture| posture.evidence.as_ref()).collect();
    BestFitLoads::estimate(&films, movement.depth_mm(), &joint_shares(movement), near)
}

/// Which part of every joint lies in which region: regions end at the inflections, unless these give no three regions.
fn joint_shares(movement: &Movement) -> JointShares {
    let vertebrae_mm = &movement.erect().fit.vertebra_t_mm;
    let ends = [0, 1].map(|i| movement.regions.bounds[i].superior);
    let lie_near = |ends_mm: &[f64; 2]| {
        ends.iter()
            .zip(ends_mm)
            .all(|(&end, mm)| (vertebrae_mm[end - 1]..vertebrae_mm[end + 1]).contains(mm))
    };
    let ends_mm = movement.inflections.pair.map(|pair| pair.map(|inflection| inflection.t_mm));
    match ends_mm.filter(lie_near) {
        Some(ends_mm) => JointShares::between(vertebrae_mm, ends_mm),
        None => JointShares::whole(&movement.regions),
    }
}

/// Finds the line of best fit to the rotations of every film, from a warm start of the loads.
pub(super) fn find_best_fit_lines(
    movement: &mut Movement,
    options: &AnalysisOptions,
    near: Option<&BestFitLoads>,
    warnings: &mut Warnings,
) {
    // Lines need lengths.
    if movement.film_without_scale().is_some() || movement.films.len() < 2 {
        return;
    }
    let loads = match best_fit_loads_near(movement, near) {
        Ok(loads) => loads,
        Err(reason) => {
            let text = format!(
                "{reason}, so no film has a line of best fit to the rotations and no line of action is tested"
            );
            warnings.push(WarningCode::BestFitLinesNotFound, text);
            return;
        }
    };
    let found = BestFit {
        inflections_mm2: inflections_along_mm2(movement),
        movement,
        options,
        loads: &loads,
    };
    // Loads are counted over the films that have evidence.
    let mut films = 0..;
    let line_of = |posture: &FilmMovement| {
        posture.evidence.as_ref()?;
        found.line(films.next()?, posture)
    };
    let lines: Vec<Option<BestFitLine>> = movement.films.iter().map(line_of).collect();
    for (film, line) in movement.films.iter_mut().zip(lines) {
        film.best_fit_line = line;
    }
}

/// The loads of best fit, and what their lines are compared with.
struct BestFit<'a> {
    movement: &'a Movement,
    options: &'a AnalysisOptions,
    loads: &'a BestFitLoads,
    inflections_mm2: Option<Matrix2<f64>>,
}

impl BestFit<'_> {
    /// The line of a film, by its place among the films with evidence.
    fn line(&self, film: usize, posture: &FilmMovement) -> Option<BestFitLine> {
        let line = self.loads.line(film, posture.middle())?.line;
        let compare = |other: &LineOfAction, at: Frontal, proposal: &ProposedLine| {
            Some(LineComparison {
                angle: line.angle_to(other),
                distance_mm: line.lever_arm_mm(at).abs(),
                test: self.loads.test(film, proposal)?,
            })
        };
        let places = self.movement.inflection_segments.zip(self.inflections_mm2);
        let inflection = places.and_then(|(segments, along_mm2)| {
            let [a, b] = posture.inflection_points?;
            let through = LineOfAction::through(a, b).ok()?;
            compare(&through, (a + b) * 0.5, &through_inflections(posture, segments, along_mm2)?)
        });
        let iliac = posture.outline.iliac_normal.and_then(|normal| {
            let t2 = posture.outline.top();
            let iliac = LineOfAction::along_iliac(t2, Some(normal));
            let (direction, sd) = (iliac.direction, crests_sd(posture));
            compare(&iliac, t2, &ProposedLine::Along { direction, sd })
        });
        let given = self.options.given_line(&posture.outline).and_then(|given| {
            let (nearest, proposal) = exactly(posture, &given);
            compare(&given, nearest, &proposal)
        });
        let ends = [posture.outline.vertebrae[0].location, posture.outline.top()];
        let heights = posture.inflection_points.unwrap_or(ends);
        let [caudal, cranial] = heights.map(|point| {
            let z_mm = point.z_mm;
            let within = self.loads.crossing(film, z_mm)?;
            Some(LineCrossing { z_mm, y_mm: line.y_mm_at(z_mm), within })
        });
        Some(BestFitLine {
            crossings: [caudal?, cranial?],
            inflection,
            iliac,
            given,
            joint_log_sd: self.loads.joint_log_sd,
            line,
        })
    }
}

/// Covariance of the two inflections along the spine, by the uncertainty of the erect curve and the length of a segment; by the
/// noise if the uncertainty is not known.
fn inflections_along_mm2(movement: &Movement) -> Option<Matrix2<f64>> {
    let erect = movement.erect();
    let pair = movement.inflections.pair?;
    let segment_mm2 = movement.chain.segment_mm.powi(2) / 12.0;
    let on_curve = match movement.inflection_intervals {
        Some(free) => free.about_polynomial_mm2,
        None => erect.fit.spread(&erect.outline)?.inflections_mm2(pair.map(|i| i.t_mm)),
    };
    Some(on_curve + Matrix2::identity() * segment_mm2)
}

/// Covariance of the inflections as they lie on a film: along its curve, and with the curve itself.
fn inflection_covariance(
    posture: &FilmMovement,
    segments: [usize; 2],
    along_mm2: Matrix2<f64>,
) -> Option<Matrix4<f64>> {
    let spread: CurveSpread<'_> = posture.fit.spread(&posture.outline)?;
    let places = segments.map(|segment| posture.pose.t_mm[segment]);
    let tangents = places.map(|t| {
        let tangent = posture.fit.curve.tangent(t);
        let unit = tangent * (1.0 / tangent.norm_mm());
        Vector2::new(unit.y_mm, unit.z_mm)
    });
    let carried = Matrix4::from_fn(|i, j| {
        tangents[i / 2][i % 2] * along_mm2[(i / 2, j / 2)] * tangents[j / 2][j % 2]
    });
    Some(carried + spread.points_mm2(places))
}

/// A given line, which is known exactly: through any two of its points there is the same statistic. The first one is its point nearest to
/// the middle of the spine.
fn exactly(film: &FilmMovement, given: &LineOfAction) -> (Frontal, ProposedLine) {
    let middle = film.middle();
    // The lever arm of a unit force is the distance across its direction.
    let across = Frontal::new(given.direction.z_mm, -given.direction.y_mm);
    let nearest = middle + across * across.dot(given.point - middle);
    let points = [nearest, nearest + given.direction * LineOfAction::MIN_GAP_MM];
    (nearest, ProposedLine::Through { points, covariance: Matrix4::zeros() })
}
