//! The values of the quantities in an analysis.

use super::{AnalysisQuantity, QuantityKind};
use crate::action::LineKind;
use crate::analysis::{Analysis, FilmMovement, LineModel};
use crate::anatomy::named;
use crate::clinical::SpatialMeasures;
use crate::evaluate::Simulation;
use crate::personalize::{FitStatus, StiffnessBound};
use crate::spatial::Angle;

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

impl AnalysisQuantity {
    /// Whether it is a multiplier that bounds of a converged fit determine: its bound, or the bounds of all others.
    pub(super) fn is_at_bound(self, analysis: &Analysis) -> bool {
        let Some((line, place)) = self.line.zip(self.multiplier) else { return false };
        let Ok(LineModel { fit, .. }) = fitted_model(analysis, line) else { return false };
        let is_bound = fit.bounds.get(place).is_some_and(|&one| one != StiffnessBound::Inside);
        is_bound || fit.has_one_inside(analysis.options.gauge)
    }

    /// Its value in an analysis, in its unit as people see it; `measures` are that analysis's numbers in space, and `nominal` is the
    /// analysis of the case itself.
    pub(super) fn value(
        self,
        analysis: &Analysis,
        measures: Option<&SpatialMeasures>,
        nominal: &Analysis,
    ) -> Result<f64, Absent> {
        use QuantityKind as K;
        if let Some(line) = self.line {
            return self.of_model(fitted_model(analysis, line)?, nominal);
        }
        match self.kind {
            K::LocationY | K::LocationZ | K::Tilt => self.of_vertebra(analysis),
            K::Cobb | K::TiltRange | K::Ferguson => {
                self.curve_angle(analysis).map(Angle::deg).ok_or(Absent::NotMeasured)
            }
            K::FilmScale => Ok(self.film(analysis)?.outline.length.scale.factor),
            K::LeastSegment
            | K::LeastDistanceSegments
            | K::LeastDistance
            | K::ComparisonAngle
            | K::ComparisonDistance => self.of_motion(analysis),
            K::ChainLength
            | K::SegmentLength
            | K::InflectionCount
            | K::InflectionPair
            | K::InflectionY
            | K::InflectionZ
            | K::InflectionArc => self.of_curve(analysis),
            _ => self.in_space(analysis, measures).ok_or(Absent::NotMeasured),
        }
    }

    /// The film that it belongs to.
    fn film(self, analysis: &Analysis) -> Result<&FilmMovement, Absent> {
        let film = self.posture.and_then(|posture| analysis.movement.film(posture));
        film.ok_or(Absent::NotMeasured)
    }

    /// A length in its unit as people see it.
    fn length(self, mm: f64, analysis: &Analysis) -> f64 {
        self.scale(analysis).units_per_mm * mm
    }

    fn in_space(self, analysis: &Analysis, measures: Option<&SpatialMeasures>) -> Option<f64> {
        if self.kind == QuantityKind::Pitch {
            let vertebra = analysis.movement.space.as_ref()?.vertebra(self.level?)?;
            return Some(vertebra.orientation.pitch.deg());
        }
        let measures = measures?;
        Some(match self.kind {
            QuantityKind::LargestCurve => measures.curve(self.region?)?.angle_3d.value.deg(),
            QuantityKind::Convexity => measures.curve(self.region?)?.convexity_3d.value.deg(),
            QuantityKind::SpinalLength => self.length(measures.length.length_3d_mm.value, analysis),
            kind => {
                let mut angles = measures.sagittal.iter();
                angles.find(|one| QuantityKind::sagittal(one.part) == kind)?.axes_3d.value.deg()
            }
        })
    }

    fn of_curve(self, analysis: &Analysis) -> Result<f64, Absent> {
        let movement = &analysis.movement;
        let (chain, pair) = (&movement.chain, movement.inflections.pair);
        let inflection = || {
            let found = pair.zip(self.end).map(|(pair, end)| pair[end]);
            found.ok_or(Absent::NoInflections)
        };
        let length_mm = match self.kind {
            QuantityKind::InflectionCount => return Ok(movement.inflections.all.len() as f64),
            QuantityKind::InflectionPair => return Ok(f64::from(u8::from(pair.is_some()))),
            QuantityKind::ChainLength => chain.segment_mm * chain.segments as f64,
            QuantityKind::SegmentLength => chain.segment_mm,
            QuantityKind::InflectionY => inflection()?.erect.y_mm,
            QuantityKind::InflectionZ => inflection()?.erect.z_mm,
            QuantityKind::InflectionArc => movement.erect().fit.curve.length_mm(inflection()?.t_mm),
            _ => return Err(Absent::NotMeasured),
        };
        Ok(self.length(length_mm, analysis))
    }

    fn curve_angle(self, analysis: &Analysis) -> Option<Angle> {
        let (posture, region) = self.posture.zip(self.region)?;
        let curve = analysis.movement.clinical.iter().find(|curve| curve.region == region)?;
        match self.kind {
            QuantityKind::Cobb => curve.cobb_in(posture),
            QuantityKind::TiltRange => Some(curve.angles_in(posture)?.tilt_range),
            QuantityKind::Ferguson => {
                curve.ferguson.iter().find(|(p, _)| *p == posture).map(|(_, angle)| *angle)
            }
            _ => None,
        }
    }

    fn of_vertebra(self, analysis: &Analysis) -> Result<f64, Absent> {
        let film = self.film(analysis)?;
        let index = self.level.and_then(|level| analysis.movement.levels().index_of(level));
        let vertebra = &film.outline.vertebrae[index.ok_or(Absent::NotMeasured)?];
        Ok(match self.kind {
            QuantityKind::LocationY => self.length(vertebra.location.y_mm, analysis),
            QuantityKind::LocationZ => self.length(vertebra.location.z_mm, analysis),
            QuantityKind::Tilt => vertebra.tilt.deg(),
            _ => return Err(Absent::NotMeasured),
        })
    }

    fn of_motion(self, analysis: &Analysis) -> Result<f64, Absent> {
        let film = self.film(analysis)?;
        // A comparison of lines has no window.
        let window = self.end.unwrap_or_default();
        if self.kind == QuantityKind::LeastSegment {
            let motion = film.motion.as_ref().ok_or(Absent::NotMeasured)?;
            return Ok(motion.least[window] as f64);
        }
        if analysis.movement.inflections.pair.is_none() {
            return Err(Absent::NoInflections);
        }
        let line = || film.line_comparison(LineKind::Inflection).ok_or(Absent::NotMeasured);
        let estimate =
            || film.inflection_estimates.map(|pair| pair[window]).ok_or(Absent::NotMeasured);
        Ok(match self.kind {
            QuantityKind::ComparisonAngle => line()?.angle.deg(),
            QuantityKind::ComparisonDistance => line()?.distance_mm,
            QuantityKind::LeastDistance => self.length(estimate()?.distance_mm, analysis),
            QuantityKind::LeastDistanceSegments => estimate()?.distance_segments as f64,
            _ => return Err(Absent::NotMeasured),
        })
    }

    fn of_model(self, model: &LineModel, nominal: &Analysis) -> Result<f64, Absent> {
        match self.kind {
            QuantityKind::LogMultiplier => {
                let value = self.multiplier.and_then(|place| model.fit.log_multipliers.get(place));
                value.copied().ok_or(Absent::NotMeasured)
            }
            QuantityKind::MeanErrorFitted => mean_error(model, true),
            QuantityKind::MeanErrorHeldOut => mean_error(model, false),
            _ => self.of_simulation(model, nominal),
        }
    }

    fn of_simulation(self, model: &LineModel, nominal: &Analysis) -> Result<f64, Absent> {
        let posture = self.posture.ok_or(Absent::NotMeasured)?;
        let simulation = model.simulation(posture).ok_or(Absent::NotMeasured)?;
        if !simulation.is_usable() {
            return Err(Absent::ForceNotFound);
        }
        let line = &simulation.line;
        // A line that is nearly horizontal may be given in the opposite direction.
        let own = nominal.model(model.kind).and_then(|model| model.simulation(posture));
        let sense = own.map_or(1.0, |own| own.line.direction.dot(line.direction).signum());
        Ok(match self.kind {
            QuantityKind::LineTilt => line.lateral_tilt().deg(),
            QuantityKind::LineOffset => sense * line.lever_arm_mm(self.film(nominal)?.middle()),
            QuantityKind::Force => sense * simulation.force_n,
            QuantityKind::LocationError => simulation.shape.mean_location_error_mm(),
            QuantityKind::ContradictedJoints => simulation.contradicted.len() as f64,
            QuantityKind::FergusonError => {
                let region = self.region.ok_or(Absent::NotMeasured)?;
                simulation.ferguson_difference[region.index()].abs().deg()
            }
            _ => return Err(Absent::NotMeasured),
        })
    }
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
