//! The quantities of an analysis whose distribution is computed.

use serde::{Deserialize, Serialize};

use crate::action::LineKind;
use crate::analysis::{Analysis, LineModel};
use crate::anatomy::{Level, Posture, Region, named};
use crate::clinical::SagittalPart;
use crate::measure::LengthScale;
use crate::personalize::MULTIPLIER_COVERAGE;

named! {
    /// What is measured. Its film, vertebra and so on are in [`AnalysisQuantity`].
    pub enum QuantityKind {
        /// Length of the erect chain.
        ChainLength = "chain_length" as "length of the erect chain",
        /// Length of a segment.
        SegmentLength = "segment_length" as "length of a segment",
        /// Lateral place of a vertebra in `G`, to the patient's left.
        LocationY = "location_y" as "lateral coordinate, to the patient's left",
        /// Height of a vertebra in `G`.
        LocationZ = "location_z" as "height",
        /// Tilt of a vertebra against L4.
        Tilt = "tilt" as "tilt relative to the base, positive to the right",
        /// Pitch of a vertebra in space, from the erect and the lateral film.
        Pitch = "pitch_3d" as "pitch in space (3-D), flexion positive",
        /// Kyphosis from T5 to T12 in space, between axes.
        KyphosisT5T12 = "kyphosis_t5_t12_3d" as "kyphosis T5–T12 in space (3-D), axes",
        /// Kyphosis from T1 to T12 in space, between axes.
        KyphosisT1T12 = "kyphosis_t1_t12_3d" as "kyphosis T1–T12 in space (3-D), axes",
        /// Lordosis from L1 to L5 in space, between axes.
        LordosisL1L5 = "lordosis_l1_l5_3d" as "lordosis L1–L5 in space (3-D), axes",
        /// Size of a curve in its plane of maximum curvature.
        LargestCurve = "curve_largest_3d" as "curve in its plane of maximum curvature (3-D)",
        /// Direction of the convexity in that plane.
        Convexity = "curve_convexity_3d" as "direction of its convexity (3-D), 0 front, 90 left, 180 back",
        /// Length of the spine in space.
        SpinalLength = "spinal_length_3d" as "length of the spine in space (3-D)",
        /// Cobb angle, between endplates.
        Cobb = "cobb" as "Cobb angle between endplates, positive where convex to the left",
        /// Difference of the tilts of the end vertebrae.
        TiltRange = "tilt_range" as "difference of the tilts of the end vertebrae, positive where convex to the left",
        /// Ferguson angle.
        Ferguson = "ferguson" as "Ferguson angle, positive where convex to the left",
        /// Scale of a film against the erect one, from all its vertebrae, where it is not fixed.
        FilmScale = "film_scale" as "scale of the film against the erect one",
        /// Number of inflections of the erect curve.
        InflectionCount = "inflection_count" as "inflections of the erect curve",
        /// 1 where two inflections carry a line, else 0: the mean is how often they do.
        InflectionPair = "inflection_pair" as "share of replicates with two inflections that define a line",
        /// Lateral place of an inflection on the erect film.
        InflectionY = "inflection_y" as "inflection on the erect film, to the patient's left",
        /// Its height.
        InflectionZ = "inflection_z" as "inflection on the erect film, height",
        /// Its distance from L4 along the erect curve.
        InflectionArc = "inflection_arc" as "inflection on the erect film, along the curve",
        /// The least-rotating segment of a window.
        LeastSegment = "least_segment" as "least-rotating segment",
        /// From the inflection's segment to it, in segments.
        LeastDistanceSegments = "least_distance_segments" as "distance from the inflection to the least-rotating segment",
        /// The same along the erect film.
        LeastDistance = "least_distance" as "distance from the inflection to the least-rotating segment",
        /// Angle between the line of best fit to the rotations and the inflection line.
        ComparisonAngle = "line_comparison_angle" as "angle between the line of best fit to the rotations and the inflection line",
        /// Distance of the line of best fit to the rotations from the middle of the inflections.
        ComparisonDistance = "line_comparison_distance" as "distance of the line of best fit to the rotations from the inflections",
        /// Lateral tilt of a line of action.
        LineTilt = "line_lateral_tilt" as "lateral tilt of the line of action, positive to the right",
        /// Signed distance of a line of action from where the middle of the inflections was found in the case itself.
        LineOffset = "line_offset" as "distance of the line of action from the midpoint of the inflections",
        /// Force along the line, at the level that the scale constraint fixes; positive in the direction of the unperturbed case's line.
        Force = "force" as "force along the line",
        /// `ln α` of a group.
        LogMultiplier = "log_multiplier" as "ln of the stiffness multiplier",
        /// Mean location error of a posture.
        LocationError = "location_error" as "mean location error",
        /// Mean location error over fitted films.
        MeanErrorFitted = "mean_location_error_fitted" as "mean location error, fitted films",
        /// Mean location error over held-out films.
        MeanErrorHeldOut = "mean_location_error_held_out" as "mean location error, held-out films",
        /// Absolute Ferguson error.
        FergusonError = "ferguson_error" as "Ferguson error",
        /// Joints that turn against the force.
        ContradictedJoints = "contradicted_joints" as "counter-rotating joints",
    }
}

/// One number of an analysis: its kind, and the film, vertebra, region, line and end that it belongs to, where it has these.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AnalysisQuantity {
    /// What is measured.
    pub kind: QuantityKind,
    /// The film; of a number in space the erect one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub posture: Option<Posture>,
    /// The vertebra.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub level: Option<Level>,
    /// The region of a curve.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<Region>,
    /// The line of action.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<LineKind>,
    /// Which multiplier of the line's model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub multiplier: Option<usize>,
    /// Which inflection, or which window of least rotation: 0 is the caudal one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<usize>,
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

/// The two ends of the line, and the two windows of least rotation.
const ENDS: [&str; 2] = ["caudal", "cranial"];

impl QuantityKind {
    /// The kyphosis or lordosis of a part in space.
    #[must_use]
    pub const fn sagittal(part: SagittalPart) -> Self {
        match part {
            SagittalPart::KyphosisT5T12 => Self::KyphosisT5T12,
            SagittalPart::KyphosisT1T12 => Self::KyphosisT1T12,
            SagittalPart::LordosisL1L5 => Self::LordosisL1L5,
        }
    }

    /// This number of a whole case.
    #[must_use]
    pub const fn of_case(self) -> AnalysisQuantity {
        AnalysisQuantity {
            kind: self,
            posture: None,
            level: None,
            region: None,
            line: None,
            multiplier: None,
            end: None,
        }
    }

    /// This number of a film.
    #[must_use]
    pub const fn on(self, posture: Posture) -> AnalysisQuantity {
        AnalysisQuantity { posture: Some(posture), ..self.of_case() }
    }

    /// Its unit where the films have a spacing and the forces are absolute.
    const fn full_unit(self) -> QuantityUnit {
        match self {
            Self::ChainLength
            | Self::SegmentLength
            | Self::LocationY
            | Self::LocationZ
            | Self::InflectionY
            | Self::InflectionZ
            | Self::InflectionArc
            | Self::LeastDistance
            | Self::SpinalLength
            | Self::ComparisonDistance
            | Self::LineOffset
            | Self::LocationError
            | Self::MeanErrorFitted
            | Self::MeanErrorHeldOut => QuantityUnit::Millimetres,
            Self::Tilt
            | Self::Pitch
            | Self::KyphosisT5T12
            | Self::KyphosisT1T12
            | Self::LordosisL1L5
            | Self::LargestCurve
            | Self::Convexity
            | Self::Cobb
            | Self::TiltRange
            | Self::Ferguson
            | Self::ComparisonAngle
            | Self::LineTilt
            | Self::FergusonError => QuantityUnit::Degrees,
            Self::Force => QuantityUnit::Newtons,
            Self::LeastSegment | Self::LeastDistanceSegments => QuantityUnit::Segments,
            Self::FilmScale
            | Self::InflectionCount
            | Self::InflectionPair
            | Self::LogMultiplier
            | Self::ContradictedJoints => QuantityUnit::One,
        }
    }

    /// Whether it is a distance, an absolute error or the number of counter-rotating joints, which any noise makes larger on the mean.
    #[must_use]
    pub const fn grows_with_noise(self) -> bool {
        matches!(
            self,
            Self::LeastDistanceSegments
                | Self::LeastDistance
                | Self::ComparisonAngle
                | Self::ComparisonDistance
                | Self::LocationError
                | Self::MeanErrorFitted
                | Self::MeanErrorHeldOut
                | Self::FergusonError
                | Self::ContradictedJoints
        )
    }

    /// Period of an angle, in degrees; a line's is half a turn. An absolute angle does not have one.
    pub(super) fn period_deg(self) -> Option<f64> {
        match self {
            Self::LineTilt => Some(180.0),
            _ if self.grows_with_noise() => None,
            _ => (self.full_unit() == QuantityUnit::Degrees).then_some(360.0),
        }
    }
}

impl AnalysisQuantity {
    /// The same of a vertebra.
    #[must_use]
    pub const fn at(self, level: Level) -> Self {
        Self { level: Some(level), ..self }
    }

    /// The same of a curve.
    #[must_use]
    pub const fn in_region(self, region: Region) -> Self {
        Self { region: Some(region), ..self }
    }

    /// The same of a line of action.
    #[must_use]
    pub const fn along(self, line: LineKind) -> Self {
        Self { line: Some(line), ..self }
    }

    /// The same of a multiplier of the line's model, by its place.
    #[must_use]
    pub const fn of_multiplier(self, multiplier: usize) -> Self {
        Self { multiplier: Some(multiplier), ..self }
    }

    /// The same of an inflection or a window: 0 is the caudal one.
    #[must_use]
    pub const fn at_end(self, end: usize) -> Self {
        Self { end: Some(end), ..self }
    }

    fn model(self, analysis: &Analysis) -> Option<&LineModel> {
        self.line.and_then(|line| analysis.model(line))
    }

    /// The region, or the name of the joints that share a multiplier, where it has one.
    #[must_use]
    pub fn group(self, analysis: &Analysis) -> Option<String> {
        if let Some(region) = self.region {
            return Some(region.key().to_owned());
        }
        let place = self.multiplier?;
        let name = self.model(analysis).and_then(|model| model.groups.names().get(place).cloned());
        Some(name.unwrap_or_else(|| format!("group {}", place + 1)))
    }

    /// `caudal` or `cranial`: which inflection or window.
    #[must_use]
    pub fn end_name(self) -> Option<&'static str> {
        ENDS.get(self.end?).copied()
    }

    /// The scale of its lengths: for a vertebra the scale of its film, else the scale of the erect film.
    pub(super) fn scale(self, analysis: &Analysis) -> &LengthScale {
        let movement = &analysis.movement;
        let film = self.level.and(self.posture).and_then(|posture| movement.film(posture));
        film.map_or(movement.scale(), |film| &film.outline.scale)
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self, analysis: &Analysis) -> QuantityUnit {
        let gauge = analysis.options.gauge;
        let is_absolute = || self.model(analysis).is_some_and(|model| model.is_absolute(gauge));
        match self.kind.full_unit() {
            QuantityUnit::Millimetres if !self.scale(analysis).has_millimetres() => {
                QuantityUnit::Pixels
            }
            QuantityUnit::Newtons if !is_absolute() => QuantityUnit::RelativeForce,
            unit => unit,
        }
    }

    /// What its interval does not hold, in words; `None` where [`Uncertainty::CAVEAT`](super::Uncertainty::CAVEAT) says all.
    #[must_use]
    pub fn interval_caveat(self) -> Option<&'static str> {
        self.multiplier.map(|_| MULTIPLIER_COVERAGE)
    }

    /// Whether a report shows it; only files have numbers of single vertebrae and regions.
    #[must_use]
    pub const fn is_reported(self) -> bool {
        match self.kind {
            QuantityKind::LocationY
            | QuantityKind::LocationZ
            | QuantityKind::Tilt
            | QuantityKind::Pitch
            | QuantityKind::SegmentLength
            | QuantityKind::LeastSegment
            | QuantityKind::LeastDistance
            | QuantityKind::LocationError
            | QuantityKind::FergusonError => false,
            QuantityKind::ContradictedJoints => {
                matches!(self.posture, Some(Posture::LeftBending | Posture::RightBending))
            }
            _ => true,
        }
    }
}

/// All quantities of an analysis of these films with these lines.
pub(super) fn all_of(nominal: &Analysis, lines: &[LineKind]) -> Vec<AnalysisQuantity> {
    use QuantityKind as K;
    let movement = &nominal.movement;
    let postures: Vec<Posture> = movement.films.iter().map(|p| p.outline.posture).collect();
    let moved = || postures.iter().copied().filter(|posture| *posture != Posture::Erect);
    let of_erect = [K::ChainLength, K::SegmentLength, K::InflectionCount, K::InflectionPair];
    let mut all = of_erect.map(K::of_case).to_vec();
    for end in 0..2 {
        let of_inflection = [K::InflectionY, K::InflectionZ, K::InflectionArc];
        all.extend(of_inflection.map(|kind| kind.of_case().at_end(end)));
    }
    for &posture in &postures {
        for level in movement.levels().iter().skip(1) {
            let of_vertebra = [K::LocationY, K::LocationZ, K::Tilt];
            all.extend(of_vertebra.map(|kind| kind.on(posture).at(level)));
        }
        for region in Region::ALL {
            let angles = [K::Cobb, K::TiltRange, K::Ferguson];
            all.extend(angles.map(|kind| kind.on(posture).in_region(region)));
        }
    }
    let in_space = |kind: K| kind.on(Posture::Erect);
    let vertebrae = movement.space.iter().flat_map(|space| &space.vertebrae);
    all.extend(vertebrae.map(|vertebra| in_space(K::Pitch).at(vertebra.level)));
    if let Some(found) = movement.spatial_measures() {
        all.extend(found.sagittal.iter().map(|angle| in_space(K::sagittal(angle.part))));
        for curve in &found.curves {
            let of_curve = [K::LargestCurve, K::Convexity].map(in_space);
            all.extend(of_curve.map(|quantity| quantity.in_region(curve.region)));
        }
        all.push(in_space(K::SpinalLength));
    }
    let is_free = |posture: &Posture| {
        movement.film(*posture).is_some_and(|film| film.outline.length.is_free())
    };
    all.extend(moved().filter(is_free).map(|posture| K::FilmScale.on(posture)));
    for posture in moved() {
        for window in 0..2 {
            let of_window = [K::LeastSegment, K::LeastDistanceSegments, K::LeastDistance];
            all.extend(of_window.map(|kind| kind.on(posture).at_end(window)));
        }
        all.extend([K::ComparisonAngle, K::ComparisonDistance].map(|kind| kind.on(posture)));
    }
    for &line in lines {
        let groups = nominal.model(line).map_or(Region::ALL.len(), |model| model.groups.len());
        let of_line = |kind: K| kind.of_case().along(line);
        all.extend((0..groups).map(|place| of_line(K::LogMultiplier).of_multiplier(place)));
        all.extend([K::MeanErrorFitted, K::MeanErrorHeldOut].map(of_line));
        for posture in moved() {
            let on_film = |kind: K| kind.on(posture).along(line);
            let of_film = [K::LineTilt, K::LineOffset, K::Force, K::LocationError];
            all.extend(of_film.map(on_film));
            all.push(on_film(K::ContradictedJoints));
            let of_region = |region| on_film(K::FergusonError).in_region(region);
            all.extend(Region::ALL.map(of_region));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whatever_is_never_negative_and_vanishes_without_noise_has_no_interval() {
        // Lengths of a difference, absolute values of one, and joints that noise alone can turn against a true line.
        let grow = [
            QuantityKind::LeastDistanceSegments,
            QuantityKind::LeastDistance,
            QuantityKind::ComparisonAngle,
            QuantityKind::ComparisonDistance,
            QuantityKind::LocationError,
            QuantityKind::MeanErrorFitted,
            QuantityKind::MeanErrorHeldOut,
            QuantityKind::FergusonError,
            QuantityKind::ContradictedJoints,
        ];
        assert!(grow.into_iter().all(QuantityKind::grows_with_noise));
        // Places and signed numbers, which noise carries to both sides.
        let keep = [
            QuantityKind::LeastSegment,
            QuantityKind::InflectionArc,
            QuantityKind::LineOffset,
            QuantityKind::FilmScale,
        ];
        assert!(!keep.into_iter().any(QuantityKind::grows_with_noise));
    }
}
