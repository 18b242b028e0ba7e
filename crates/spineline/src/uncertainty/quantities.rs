//! The quantities of an analysis whose distribution is computed.

use serde::{Deserialize, Serialize};

use crate::action::LineKind;
use crate::analysis::{Analysis, FilmMovement, LineModel};
use crate::anatomy::{Level, Posture, Region, named};
use crate::clinical::{SagittalPart, SpatialMeasures};
use crate::evaluate::Simulation;
use crate::personalize::{FitStatus, StiffnessBound};
use crate::spatial::Angle;

/// One number of an analysis.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum AnalysisQuantity {
    /// Length of the erect chain.
    ChainLength,
    /// Length of a segment.
    SegmentLength,
    /// Lateral place of a vertebra in `G`, to the patient's left.
    LocationY(Posture, Level),
    /// Height of a vertebra in `G`.
    LocationZ(Posture, Level),
    /// Tilt of a vertebra against L4.
    Tilt(Posture, Level),
    /// Pitch of a vertebra in space, from the erect and the lateral film.
    Pitch(Level),
    /// Kyphosis or lordosis in space, between axes.
    Sagittal(SagittalPart),
    /// Size of a curve in its plane of maximum curvature.
    LargestCurve(Region),
    /// Direction of the convexity in that plane.
    Convexity(Region),
    /// Length of the spine in space.
    SpinalLength,
    /// Cobb angle, between endplates.
    Cobb(Posture, Region),
    /// Difference of the tilts of the end vertebrae.
    TiltRange(Posture, Region),
    /// Ferguson angle.
    Ferguson(Posture, Region),
    /// Scale of a film against the erect one, from all its vertebrae, where it is not fixed.
    FilmScale(Posture),
    /// Number of inflections of the erect curve.
    InflectionCount,
    /// 1 where two inflections carry a line, else 0: the mean is how often they do.
    InflectionPair,
    /// Lateral place of an inflection on the erect film; 0 is the caudal one.
    InflectionY(usize),
    /// Its height.
    InflectionZ(usize),
    /// Its distance from L4 along the erect curve.
    InflectionArc(usize),
    /// The least-rotating segment of a window; 0 is the caudal one.
    LeastSegment(Posture, usize),
    /// From the inflection's segment to it, in segments.
    LeastDistanceSegments(Posture, usize),
    /// The same along the erect film.
    LeastDistance(Posture, usize),
    /// Angle between the line of best fit to the rotations and the inflection line.
    ComparisonAngle(Posture),
    /// Distance of the former from the middle of the inflections.
    ComparisonDistance(Posture),
    /// Lateral tilt of a line of action.
    LineTilt(LineKind, Posture),
    /// Signed distance of a line of action from where the middle of the inflections was found in the case itself.
    LineOffset(LineKind, Posture),
    /// Force along the line, at the level that the scale constraint fixes; positive in the direction of the unperturbed case's line.
    Force(LineKind, Posture),
    /// `ln α` of a group.
    LogMultiplier(LineKind, usize),
    /// Mean location error of a posture.
    LocationError(LineKind, Posture),
    /// Mean location error over fitted or held-out films.
    MeanLocationError(LineKind, bool),
    /// Absolute Ferguson error.
    FergusonError(LineKind, Posture, Region),
    /// Joints that turn against the force.
    ContradictedJoints(LineKind, Posture),
}

named! {
    /// Why an analysis does not have a number.
    pub enum Absent {
        /// The erect curve has no pair of inflections.
        NoInflections = "no_inflections",
        /// The films lack the line or the window, or a moved curve is too short for the segment.
        NotMeasured = "not_measured",
        /// The fit of this line did not converge.
        FitNotConverged = "fit_not_converged",
        /// No force was found for this posture.
        ForceNotFound = "force_not_found",
    }
}

named! {
    /// Unit of a number, as people see it.
    pub enum QuantityUnit {
        /// Millimetres of the film's plane.
        Millimetres = "mm",
        /// Pixels of a film without a spacing.
        Pixels = "px",
        /// Degrees.
        Degrees = "deg",
        /// Newtons, of a model that is scaled to a measured force.
        Newtons = "N",
        /// A force relative to the nominal stiffness, because no force was measured.
        RelativeForce = "relative",
        /// Segments of the chain.
        Segments = "segments",
        /// A number without a unit.
        One = "1",
    }
}

/// All quantities of an analysis of these films with these lines.
pub(super) fn all_of(nominal: &Analysis, kinds: &[LineKind]) -> Vec<AnalysisQuantity> {
    let movement = &nominal.movement;
    use AnalysisQuantity as Q;
    let postures: Vec<Posture> = movement.films.iter().map(|p| p.outline.posture).collect();
    let moved = || postures.iter().copied().filter(|posture| *posture != Posture::Erect);
    let mut all = vec![Q::ChainLength, Q::SegmentLength, Q::InflectionCount, Q::InflectionPair];
    for end in 0..2 {
        all.extend([Q::InflectionY(end), Q::InflectionZ(end), Q::InflectionArc(end)]);
    }
    for &posture in &postures {
        for level in movement.levels().iter().skip(1) {
            let of_vertebra = [Q::LocationY, Q::LocationZ, Q::Tilt];
            all.extend(of_vertebra.map(|quantity| quantity(posture, level)));
        }
        for region in Region::ALL {
            all.extend([Q::Cobb, Q::TiltRange, Q::Ferguson].map(|angle| angle(posture, region)));
        }
    }
    let in_space = movement.space.iter().flat_map(|space| &space.vertebrae);
    all.extend(in_space.map(|vertebra| Q::Pitch(vertebra.level)));
    if let Some(found) = movement.spatial_measures() {
        all.extend(found.sagittal.iter().map(|angle| Q::Sagittal(angle.part)));
        let curves = found.curves.iter();
        all.extend(curves.flat_map(|c| [Q::LargestCurve(c.region), Q::Convexity(c.region)]));
        all.push(Q::SpinalLength);
    }
    let is_free = |posture: &Posture| {
        movement.film(*posture).is_some_and(|film| film.outline.length.is_free())
    };
    all.extend(moved().filter(is_free).map(Q::FilmScale));
    for posture in moved() {
        for window in 0..2 {
            let of_window = [Q::LeastSegment, Q::LeastDistanceSegments, Q::LeastDistance];
            all.extend(of_window.map(|quantity| quantity(posture, window)));
        }
        all.extend([Q::ComparisonAngle(posture), Q::ComparisonDistance(posture)]);
    }
    for &kind in kinds {
        let groups = nominal.model(kind);
        let groups = groups.map_or(Region::ALL.len(), |model| model.groups.len());
        all.extend((0..groups).map(|group| Q::LogMultiplier(kind, group)));
        all.extend([Q::MeanLocationError(kind, true), Q::MeanLocationError(kind, false)]);
        for posture in moved() {
            let of_line = [Q::LineTilt, Q::LineOffset, Q::Force, Q::LocationError];
            all.extend(of_line.map(|quantity| quantity(kind, posture)));
            all.push(Q::ContradictedJoints(kind, posture));
            all.extend(Region::ALL.map(|region| Q::FergusonError(kind, posture, region)));
        }
    }
    all
}

impl AnalysisQuantity {
    /// Whether it is a multiplier that ended at a bound of the fit.
    pub(super) fn is_at_bound(self, analysis: &Analysis) -> bool {
        let Self::LogMultiplier(kind, group) = self else { return false };
        let bound = analysis.model(kind).and_then(|model| model.fit.bounds.get(group));
        bound.is_some_and(|bound| *bound != StiffnessBound::Inside)
    }

    /// Its value in an analysis, in its unit as people see it; `measures` are that analysis's numbers in space, and `nominal` is the
    /// analysis of the case itself.
    pub(super) fn value(
        self,
        analysis: &Analysis,
        measures: Option<&SpatialMeasures>,
        nominal: &Analysis,
    ) -> Result<f64, Absent> {
        match self {
            Self::ChainLength
            | Self::SegmentLength
            | Self::InflectionCount
            | Self::InflectionPair
            | Self::InflectionY(_)
            | Self::InflectionZ(_)
            | Self::InflectionArc(_) => self.of_curve(analysis),
            Self::LocationY(..)
            | Self::LocationZ(..)
            | Self::Tilt(..)
            | Self::Cobb(..)
            | Self::TiltRange(..)
            | Self::Ferguson(..) => self.of_film(analysis),
            Self::Pitch(_)
            | Self::Sagittal(_)
            | Self::LargestCurve(_)
            | Self::Convexity(_)
            | Self::SpinalLength => self.in_space(analysis, measures).ok_or(Absent::NotMeasured),
            Self::FilmScale(posture) => Ok(found(analysis, posture)?.outline.length.scale.factor),
            Self::LeastSegment(..)
            | Self::LeastDistanceSegments(..)
            | Self::LeastDistance(..)
            | Self::ComparisonAngle(_)
            | Self::ComparisonDistance(_) => self.of_motion(analysis),
            _ => self.of_model(analysis, nominal),
        }
    }

    fn in_space(self, analysis: &Analysis, measures: Option<&SpatialMeasures>) -> Option<f64> {
        Some(match self {
            Self::Pitch(level) => {
                analysis.movement.space.as_ref()?.vertebra(level)?.orientation.pitch.deg()
            }
            Self::Sagittal(part) => measures?.sagittal(part)?.axes_3d.deg(),
            Self::LargestCurve(region) => measures?.curve(region)?.angle_3d.deg(),
            Self::Convexity(region) => measures?.curve(region)?.convexity_3d.deg(),
            Self::SpinalLength => {
                measures?.length.length_3d_mm
                    * analysis.movement.scale().pixels_per_mm.unwrap_or(1.0)
            }
            _ => return None,
        })
    }

    fn of_curve(self, analysis: &Analysis) -> Result<f64, Absent> {
        let movement = &analysis.movement;
        let scale = movement.scale();
        let length = |mm: f64| mm * scale.pixels_per_mm.unwrap_or(1.0);
        let at = |end: usize| {
            movement.inflections.pair.map(|pair| pair[end]).ok_or(Absent::NoInflections)
        };
        Ok(match self {
            Self::ChainLength => length(movement.chain.segment_mm * movement.chain.segments as f64),
            Self::SegmentLength => length(movement.chain.segment_mm),
            Self::InflectionCount => movement.inflections.all.len() as f64,
            Self::InflectionPair => f64::from(u8::from(movement.inflections.pair.is_some())),
            Self::InflectionY(end) => length(at(end)?.erect.y_mm),
            Self::InflectionZ(end) => length(at(end)?.erect.z_mm),
            Self::InflectionArc(end) => length(movement.erect().fit.curve.length_mm(at(end)?.t_mm)),
            _ => return Err(Absent::NotMeasured),
        })
    }

    fn of_film(self, analysis: &Analysis) -> Result<f64, Absent> {
        if let Self::Cobb(posture, region)
        | Self::TiltRange(posture, region)
        | Self::Ferguson(posture, region) = self
        {
            let curve = analysis.movement.clinical.iter().find(|curve| curve.region == region);
            let angle = curve.and_then(|curve| match self {
                Self::Cobb(..) => curve.cobb_in(posture),
                Self::TiltRange(..) => Some(curve.angles_in(posture)?.tilt_range),
                _ => curve.ferguson.iter().find(|(p, _)| *p == posture).map(|(_, angle)| *angle),
            });
            return angle.map(Angle::deg).ok_or(Absent::NotMeasured);
        }
        let (Self::LocationY(posture, level)
        | Self::LocationZ(posture, level)
        | Self::Tilt(posture, level)) = self
        else {
            return Err(Absent::NotMeasured);
        };
        let film = found(analysis, posture)?;
        let index = analysis.movement.levels().index_of(level).ok_or(Absent::NotMeasured)?;
        let vertebra = &film.outline.vertebrae[index];
        let factor = film.outline.scale.pixels_per_mm.unwrap_or(1.0);
        Ok(match self {
            Self::LocationY(..) => vertebra.location.y_mm * factor,
            Self::LocationZ(..) => vertebra.location.z_mm * factor,
            _ => vertebra.tilt.deg(),
        })
    }

    fn of_motion(self, analysis: &Analysis) -> Result<f64, Absent> {
        let (posture, window) = match self {
            Self::LeastSegment(posture, window)
            | Self::LeastDistanceSegments(posture, window)
            | Self::LeastDistance(posture, window) => (posture, window),
            Self::ComparisonAngle(posture) | Self::ComparisonDistance(posture) => (posture, 0),
            _ => return Err(Absent::NotMeasured),
        };
        let film = found(analysis, posture)?;
        if let Self::LeastSegment(..) = self {
            let motion = film.motion.as_ref().ok_or(Absent::NotMeasured)?;
            return Ok(motion.least[window] as f64);
        }
        if analysis.movement.inflections.pair.is_none() {
            return Err(Absent::NoInflections);
        }
        let line = || film.line_comparison(LineKind::Inflection).ok_or(Absent::NotMeasured);
        let estimate =
            || film.inflection_estimates.map(|pair| pair[window]).ok_or(Absent::NotMeasured);
        let factor = analysis.movement.scale().pixels_per_mm.unwrap_or(1.0);
        Ok(match self {
            Self::ComparisonAngle(_) => line()?.angle.deg(),
            Self::ComparisonDistance(_) => line()?.distance_mm,
            Self::LeastDistance(..) => estimate()?.distance_mm * factor,
            _ => estimate()?.distance_segments as f64,
        })
    }

    fn of_model(self, analysis: &Analysis, nominal: &Analysis) -> Result<f64, Absent> {
        let kind = self.line().ok_or(Absent::NotMeasured)?;
        let model = fitted_model(analysis, kind)?;
        match self {
            Self::LogMultiplier(_, group) => {
                model.fit.log_multipliers.get(group).copied().ok_or(Absent::NotMeasured)
            }
            Self::MeanLocationError(_, fitted) => mean_error(model, fitted),
            _ => self.of_simulation(model, kind, nominal),
        }
    }

    fn of_simulation(
        self,
        model: &LineModel,
        kind: LineKind,
        nominal: &Analysis,
    ) -> Result<f64, Absent> {
        let posture = self.posture().ok_or(Absent::NotMeasured)?;
        let simulation = model.simulation(posture).ok_or(Absent::NotMeasured)?;
        if !simulation.is_usable() {
            return Err(Absent::ForceNotFound);
        }
        let line = &simulation.line;
        // A line that is nearly horizontal may be given in the opposite direction.
        let own = nominal.model(kind);
        let own = own.and_then(|model| model.simulation(posture));
        let sense = own.map_or(1.0, |own| own.line.direction.dot(line.direction).signum());
        Ok(match self {
            Self::LineTilt(..) => line.lateral_tilt().deg(),
            Self::LineOffset(..) => sense * line.lever_arm_mm(found(nominal, posture)?.middle()),
            Self::Force(..) => sense * simulation.force_n,
            Self::LocationError(..) => simulation.shape.mean_location_error_mm(),
            Self::ContradictedJoints(..) => simulation.contradicted.len() as f64,
            Self::FergusonError(_, _, region) => {
                simulation.ferguson_difference[region.index()].abs().deg()
            }
            _ => return Err(Absent::NotMeasured),
        })
    }

    /// Whether it is a distance or an absolute error, which any noise makes larger on the mean.
    #[must_use]
    pub const fn grows_with_noise(self) -> bool {
        matches!(
            self,
            Self::LeastDistanceSegments(..)
                | Self::LeastDistance(..)
                | Self::ComparisonAngle(_)
                | Self::ComparisonDistance(_)
                | Self::LocationError(..)
                | Self::MeanLocationError(..)
                | Self::FergusonError(..)
        )
    }

    /// Period of an angle, in degrees; a line's is half a turn.
    pub(super) const fn period_deg(self) -> Option<f64> {
        match self {
            Self::Tilt(..)
            | Self::Pitch(_)
            | Self::Sagittal(_)
            | Self::LargestCurve(_)
            | Self::Convexity(_)
            | Self::Cobb(..)
            | Self::TiltRange(..)
            | Self::Ferguson(..) => Some(360.0),
            Self::LineTilt(..) => Some(180.0),
            _ => None,
        }
    }
}

fn found(analysis: &Analysis, posture: Posture) -> Result<&FilmMovement, Absent> {
    analysis.movement.film(posture).ok_or(Absent::NotMeasured)
}

/// The model of a line whose fit converged.
pub(super) fn fitted_model(analysis: &Analysis, kind: LineKind) -> Result<&LineModel, Absent> {
    let model = analysis.model(kind);
    let model = model.ok_or(match kind {
        LineKind::Inflection if analysis.movement.inflections.pair.is_none() => {
            Absent::NoInflections
        }
        _ => Absent::NotMeasured,
    })?;
    match model.fit.status {
        FitStatus::Converged => Ok(model),
        _ => Err(Absent::FitNotConverged),
    }
}

fn mean_error(model: &LineModel, fitted: bool) -> Result<f64, Absent> {
    // A mean over the films that happened to succeed is another quantity.
    let mut films = model.simulations.iter().filter(|s| s.fitted == fitted);
    if !films.all(Simulation::is_usable) {
        return Err(Absent::ForceNotFound);
    }
    model.mean_location_error_mm(fitted).ok_or(Absent::NotMeasured)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_never_negative_and_vanishes_without_noise_has_no_interval() {
        let (film, line) = (Posture::LeftBending, LineKind::Inflection);
        // Lengths of a difference, and absolute values of one.
        let grow = [
            AnalysisQuantity::LeastDistanceSegments(film, 0),
            AnalysisQuantity::LeastDistance(film, 1),
            AnalysisQuantity::ComparisonAngle(film),
            AnalysisQuantity::ComparisonDistance(film),
            AnalysisQuantity::LocationError(line, film),
            AnalysisQuantity::MeanLocationError(line, true),
            AnalysisQuantity::FergusonError(line, film, Region::MainThoracic),
        ];
        assert!(grow.into_iter().all(AnalysisQuantity::grows_with_noise));
        // Places and signed numbers, which noise carries to both sides.
        let keep = [
            AnalysisQuantity::LeastSegment(film, 0),
            AnalysisQuantity::InflectionArc(0),
            AnalysisQuantity::LineOffset(line, film),
            AnalysisQuantity::FilmScale(film),
        ];
        assert!(!keep.into_iter().any(AnalysisQuantity::grows_with_noise));
    }
}
