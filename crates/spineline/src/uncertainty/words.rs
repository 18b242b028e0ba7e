//! Names of the quantities, and noise in words.

use super::{AnalysisQuantity, FilmNoise, NoiseSource, QuantityUnit, VertebraNoise};
use crate::analysis::Analysis;
use crate::anatomy::Posture;
use crate::clinical::SagittalPart;
use crate::multibody::group_title;
use crate::number::fixed;
use crate::personalize::MULTIPLIER_COVERAGE;

impl AnalysisQuantity {
    /// What its interval does not hold, in words; `None` where [`Uncertainty::CAVEAT`](super::Uncertainty::CAVEAT) says all.
    #[must_use]
    pub const fn interval_caveat(self) -> Option<&'static str> {
        match self {
            Self::LogMultiplier(..) => Some(MULTIPLIER_COVERAGE),
            _ => None,
        }
    }

    /// Whether a report shows it; only files have numbers of single vertebrae and regions.
    #[must_use]
    pub const fn is_reported(self) -> bool {
        match self {
            Self::LocationY(..)
            | Self::LocationZ(..)
            | Self::Tilt(..)
            | Self::Pitch(_)
            | Self::SegmentLength
            | Self::LeastSegment(..)
            | Self::LeastDistance(..)
            | Self::LocationError(..)
            | Self::FergusonError(..) => false,
            Self::ContradictedJoints(_, posture) => {
                matches!(posture, Posture::LeftBending | Posture::RightBending)
            }
            _ => true,
        }
    }

    /// The name of its kind, as in files; posture, level, region, line, group and end are separate.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::ChainLength => "chain_length",
            Self::SegmentLength => "segment_length",
            Self::LocationY(..) => "location_y",
            Self::LocationZ(..) => "location_z",
            Self::Tilt(..) => "tilt",
            Self::Pitch(_) => "pitch_3d",
            Self::Sagittal(part) => match part {
                SagittalPart::KyphosisT5T12 => "kyphosis_t5_t12_3d",
                SagittalPart::KyphosisT1T12 => "kyphosis_t1_t12_3d",
                SagittalPart::LordosisL1L5 => "lordosis_l1_l5_3d",
            },
            Self::LargestCurve(_) => "curve_largest_3d",
            Self::Convexity(_) => "curve_convexity_3d",
            Self::SpinalLength => "spinal_length_3d",
            Self::Cobb(..) => "cobb",
            Self::TiltRange(..) => "tilt_range",
            Self::Ferguson(..) => "ferguson",
            Self::FilmScale(_) => "film_scale",
            Self::InflectionCount => "inflection_count",
            Self::InflectionPair => "inflection_pair",
            Self::InflectionY(_) => "inflection_y",
            Self::InflectionZ(_) => "inflection_z",
            Self::InflectionArc(_) => "inflection_arc",
            Self::LeastSegment(..) => "least_segment",
            Self::LeastDistanceSegments(..) => "least_distance_segments",
            Self::LeastDistance(..) => "least_distance",
            Self::ComparisonAngle(_) => "line_comparison_angle",
            Self::ComparisonDistance(_) => "line_comparison_distance",
            Self::LineTilt(..) => "line_lateral_tilt",
            Self::LineOffset(..) => "line_offset",
            Self::Force(..) => "force",
            Self::LogMultiplier(..) => "log_multiplier",
            Self::LocationError(..) => "location_error",
            Self::MeanLocationError(_, true) => "mean_location_error_fitted",
            Self::MeanLocationError(_, false) => "mean_location_error_held_out",
            Self::FergusonError(..) => "ferguson_error",
            Self::ContradictedJoints(..) => "contradicted_joints",
        }
    }

    /// Its unit.
    #[must_use]
    pub fn unit(self, analysis: &Analysis) -> QuantityUnit {
        let film = match self {
            Self::LocationY(posture, _) | Self::LocationZ(posture, _) => {
                analysis.movement.film(posture)
            }
            _ => None,
        };
        let scale = film.map_or(analysis.movement.scale(), |film| &film.outline.scale);
        let length = if scale.pixels_per_mm.is_some() {
            QuantityUnit::Pixels
        } else {
            QuantityUnit::Millimetres
        };
        match self {
            Self::ChainLength
            | Self::SegmentLength
            | Self::LocationY(..)
            | Self::LocationZ(..)
            | Self::InflectionY(_)
            | Self::InflectionZ(_)
            | Self::InflectionArc(_)
            | Self::LeastDistance(..)
            | Self::SpinalLength
            | Self::ComparisonDistance(_)
            | Self::LineOffset(..)
            | Self::LocationError(..)
            | Self::MeanLocationError(..) => length,
            Self::Tilt(..)
            | Self::Pitch(_)
            | Self::Sagittal(_)
            | Self::LargestCurve(_)
            | Self::Convexity(_)
            | Self::Cobb(..)
            | Self::TiltRange(..)
            | Self::Ferguson(..)
            | Self::ComparisonAngle(_)
            | Self::LineTilt(..)
            | Self::FergusonError(..) => QuantityUnit::Degrees,
            Self::Force(kind, _) => {
                let gauge = analysis.options.gauge;
                let is_absolute =
                    analysis.model(kind).is_some_and(|model| model.is_absolute(gauge));
                if is_absolute { QuantityUnit::Newtons } else { QuantityUnit::RelativeForce }
            }
            Self::LeastSegment(..) | Self::LeastDistanceSegments(..) => QuantityUnit::Segments,
            Self::FilmScale(_)
            | Self::InflectionCount
            | Self::InflectionPair
            | Self::LogMultiplier(..)
            | Self::ContradictedJoints(..) => QuantityUnit::One,
        }
    }

    /// In words, with its place.
    #[must_use]
    pub fn label(self, analysis: &Analysis) -> String {
        let what = match self {
            Self::ChainLength => "length of the erect chain",
            Self::SegmentLength => "length of a segment",
            Self::LocationY(..) => "lateral coordinate, to the patient's left",
            Self::LocationZ(..) => "height",
            Self::Tilt(..) => "tilt relative to the base, positive to the right",
            Self::Pitch(_) => "pitch in space (3-D), flexion positive",
            Self::Sagittal(part) => match part {
                SagittalPart::KyphosisT5T12 => "kyphosis T5–T12 in space (3-D), axes",
                SagittalPart::KyphosisT1T12 => "kyphosis T1–T12 in space (3-D), axes",
                SagittalPart::LordosisL1L5 => "lordosis L1–L5 in space (3-D), axes",
            },
            Self::LargestCurve(_) => "curve in its plane of maximum curvature (3-D)",
            Self::Convexity(_) => "direction of its convexity (3-D), 0 front, 90 left, 180 back",
            Self::SpinalLength => "length of the spine in space (3-D)",
            Self::Cobb(..) => "Cobb angle between endplates, positive where convex to the left",
            Self::TiltRange(..) => {
                "difference of the tilts of the end vertebrae, positive where convex to the left"
            }
            Self::Ferguson(..) => "Ferguson angle, positive where convex to the left",
            Self::FilmScale(_) => "scale of the film against the erect one",
            Self::InflectionCount => "inflections of the erect curve",
            Self::InflectionPair => "share of replicates with two inflections that define a line",
            Self::InflectionY(_) => "inflection on the erect film, to the patient's left",
            Self::InflectionZ(_) => "inflection on the erect film, height",
            Self::InflectionArc(_) => "inflection on the erect film, along the curve",
            Self::LeastSegment(..) => "least-rotating segment",
            Self::LeastDistanceSegments(..) | Self::LeastDistance(..) => {
                "distance from the inflection to the least-rotating segment"
            }
            Self::ComparisonAngle(_) => {
                "angle between the line of best fit to the rotations and the inflection line"
            }
            Self::ComparisonDistance(_) => {
                "distance of the line of best fit to the rotations from the inflections"
            }
            Self::LineTilt(..) => "lateral tilt of the line of action, positive to the right",
            Self::LineOffset(..) => {
                "distance of the line of action from the midpoint of the inflections"
            }
            Self::Force(..) => "force along the line",
            Self::LogMultiplier(..) => "ln of the stiffness multiplier",
            Self::LocationError(..) => "mean location error",
            Self::MeanLocationError(_, true) => "mean location error, fitted films",
            Self::MeanLocationError(_, false) => "mean location error, held-out films",
            Self::FergusonError(..) => "Ferguson error",
            Self::ContradictedJoints(..) => "counter-rotating joints",
        };
        let places = [
            self.line().map(|line| line.to_string()),
            self.posture().map(|posture| posture.to_string()),
            self.level().map(|level| level.to_string()),
            self.group(analysis).map(|group| group_title(&group)),
            self.end().map(str::to_owned),
        ];
        let places: Vec<String> = places.into_iter().flatten().collect();
        if places.is_empty() { what.to_owned() } else { format!("{what} ({})", places.join(", ")) }
    }
}

/// Noise of films, a sentence for all films that have the same.
pub(super) fn noise_words(noise: &[FilmNoise]) -> Vec<String> {
    let mut sentences: Vec<(String, Vec<String>)> = Vec::new();
    for film in noise {
        let (words, posture) = (words_of(film), film.posture.to_string());
        match sentences.iter_mut().find(|(other, _)| *other == words) {
            Some((_, postures)) => postures.push(posture),
            None => sentences.push((words, vec![posture])),
        }
    }
    sentences.iter().map(|(words, postures)| format!("{}: {words}", postures.join(", "))).collect()
}

fn words_of(noise: &FilmNoise) -> String {
    let source = match noise.source {
        NoiseSource::Readings => "from the variation of the readings of this case",
        NoiseSource::Assumed => "assumed for one careful reading, because no film was read twice",
        NoiseSource::Given => "as given",
    };
    let size = match noise.landmarks {
        VertebraNoise::Corners { sd_px: [column, row], sd_mm, axis_sd } => {
            let mm = sd_mm.map_or_else(String::new, |[y, z]| {
                format!(" ({} × {} mm)", fixed(y, 2), fixed(z, 2))
            });
            let axis =
                axis_sd.map_or_else(String::new, |sd| format!(", axes set by hand {}", sd.text(2)));
            format!("corners {} × {} px{mm}{axis}", fixed(column, 2), fixed(row, 2))
        }
        VertebraNoise::Placements { location_sd_mm, tilt_sd } => {
            format!("locations {} mm, tilts {}", fixed(location_sd_mm, 2), tilt_sd.text(2))
        }
    };
    let program = match noise.program_corners {
        0 => String::new(),
        count => format!(
            "; {count} corners that a program found move together, by the covariance of the completion or their stated deviation"
        ),
    };
    format!("{size} per reading, {source}{program}")
}
