//! The lines of action that the films themselves prefer, against the proposed ones.

use nalgebra::{Matrix2, Matrix4, Vector2};

use super::models::depth_mm;
use super::{Analysis, PostureAnalysis};
use crate::action::LineOfAction;
use crate::curve::CurveSpread;
use crate::measure::SpacingPlane;
use crate::multibody::JointGroups;
use crate::personalize::evidence::FilmEvidence;
use crate::personalize::{Crossing, LineTest, PreferredLoads, Proposal};
use crate::spatial::{Angle, Frontal};

/// The line of the load that one film's rotations prefer.
#[derive(Debug, Clone, PartialEq)]
pub struct PreferredLine {
    /// The line; its direction is cranial.
    pub line: LineOfAction,
    /// Where it crosses the heights of the inflections (of L4 and T2, where there are none), each with 95 % confidence.
    pub crossings: [LineCrossing; 2],
    /// Against the line through the inflections.
    pub inflection: Option<LineComparison>,
    /// Of "it is parallel to the iliac line"; `None` where no crests are marked.
    pub iliac: Option<LineTest>,
    /// Deviation of `ln` stiffness among the joints of a region, shared by all films.
    pub joint_log_sd: f64,
}

/// A place of a line at a height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineCrossing {
    /// Height.
    pub z_mm: f64,
    /// Place to the patient's left; infinite for a line along the height.
    pub y_mm: f64,
    /// Where it may be.
    pub within: Crossing,
}

/// How far a film's own line lies from the line through the inflections.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineComparison {
    /// Angle between the lines.
    pub angle: Angle,
    /// Distance of the film's own line from the middle of the two inflections.
    pub distance_mm: f64,
    /// Of "it runs through both inflections".
    pub test: LineTest,
}

impl PostureAnalysis {
    /// The film's own line against the line through the inflections.
    #[must_use]
    pub fn line_comparison(&self) -> Option<LineComparison> {
        self.preferred_line.as_ref()?.inflection
    }
}

impl Analysis {
    /// The loads that all films but the erect one prefer, with regional multipliers; films in the order of the postures.
    #[must_use]
    pub fn preferred_loads(&self) -> Option<PreferredLoads> {
        let films: Vec<&FilmEvidence> =
            self.postures.iter().filter_map(|p| p.evidence.as_ref()).collect();
        let groups = JointGroups::regional(&self.regions);
        PreferredLoads::estimate(&films, depth_mm(self), &groups)
    }
}

/// Finds every film's own line.
pub(super) fn prefer_lines(analysis: &mut Analysis) {
    // Without lengths there are no lines.
    if analysis.postures.iter().any(|p| p.outline.scale.plane == SpacingPlane::Pixels) {
        return;
    }
    let Some(loads) = analysis.preferred_loads() else { return };
    let lines: Vec<Option<PreferredLine>> = analysis
        .postures
        .iter()
        .filter(|posture| posture.evidence.is_some())
        .enumerate()
        .map(|(film, posture)| preferred_line(analysis, &loads, film, posture))
        .collect();
    let moved = analysis.postures.iter_mut().filter(|posture| posture.evidence.is_some());
    for (posture, line) in moved.zip(lines) {
        posture.preferred_line = line;
    }
}

fn preferred_line(
    analysis: &Analysis,
    loads: &PreferredLoads,
    film: usize,
    posture: &PostureAnalysis,
) -> Option<PreferredLine> {
    let line = loads.line(film, posture.middle())?.line;
    let vertebrae = &posture.outline.vertebrae;
    let ends = [vertebrae[0].location, vertebrae[vertebrae.len() - 1].location];
    let heights = posture.inflection_points.unwrap_or(ends).map(|point| point.z_mm);
    let [caudal, cranial] = heights.map(|z_mm| {
        let y_mm =
            line.point.y_mm + (z_mm - line.point.z_mm) * line.direction.y_mm / line.direction.z_mm;
        Some(LineCrossing { z_mm, y_mm, within: loads.crossing(film, z_mm)? })
    });
    Some(PreferredLine {
        crossings: [caudal?, cranial?],
        inflection: against_inflections(analysis, loads, film, posture, &line),
        iliac: against_iliac(loads, film, posture),
        joint_log_sd: loads.joint_log_sd,
        line,
    })
}

fn against_inflections(
    analysis: &Analysis,
    loads: &PreferredLoads,
    film: usize,
    posture: &PostureAnalysis,
    line: &LineOfAction,
) -> Option<LineComparison> {
    let points = posture.inflection_points?;
    let proposed = LineOfAction::through(points[0], points[1]).ok()?;
    let covariance = inflection_covariance(analysis, posture, points)?;
    Some(LineComparison {
        angle: line.angle_to(&proposed),
        distance_mm: line.lever_arm_mm((points[0] + points[1]) * 0.5).abs(),
        test: loads.test(film, &Proposal::Through { points, covariance })?,
    })
}

/// Covariance of the inflections as they lie on a film: along its curve by what the erect curve and the length of a segment leave
/// open, and with the curve itself.
fn inflection_covariance(
    analysis: &Analysis,
    posture: &PostureAnalysis,
    points: [Frontal; 2],
) -> Option<Matrix4<f64>> {
    let erect = analysis.erect();
    let pair = analysis.inflections.pair?;
    let segment_mm2 = analysis.chain.segment_mm.powi(2) / 12.0;
    let along = erect.fit.spread(&erect.outline)?.inflections_mm2(pair.map(|i| i.t_mm))
        + Matrix2::identity() * segment_mm2;
    let spread: CurveSpread<'_> = posture.fit.spread(&posture.outline)?;
    let places = points.map(|point| posture.fit.curve.nearest_t_mm(point));
    let tangents = places.map(|t| {
        let tangent = posture.fit.curve.tangent(t);
        let unit = tangent * (1.0 / tangent.norm_mm());
        Vector2::new(unit.y_mm, unit.z_mm)
    });
    let carried = Matrix4::from_fn(|i, j| {
        tangents[i / 2][i % 2] * along[(i / 2, j / 2)] * tangents[j / 2][j % 2]
    });
    Some(carried + spread.points_mm2(places))
}

fn against_iliac(
    loads: &PreferredLoads,
    film: usize,
    posture: &PostureAnalysis,
) -> Option<LineTest> {
    let outline = &posture.outline;
    let normal = outline.iliac_normal?;
    let t2 = outline.vertebrae[outline.vertebrae.len() - 1].location;
    let direction = LineOfAction::along_iliac(t2, Some(normal)).direction;
    /// Between the crests of grown-ups (assumption).
    const CRESTS_MM: f64 = 250.0;
    // Crests are marked once, and like a corner; a location is the mean of four corners and of all readings.
    let crest_mm = 2.0 * outline.noise.location_mm * (outline.readings as f64).sqrt();
    let sd = Angle::from_rad(f64::sqrt(2.0) * crest_mm / CRESTS_MM);
    loads.test(film, &Proposal::Along { direction, sd })
}
