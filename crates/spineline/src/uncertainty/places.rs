//! The film, vertebra, line and so on of a quantity.

use super::AnalysisQuantity;
use crate::action::LineKind;
use crate::analysis::Analysis;
use crate::anatomy::{Level, Posture, Region};

/// The two ends of the line, and the two windows of least rotation.
const ENDS: [&str; 2] = ["caudal", "cranial"];

/// Whatever of these a quantity has.
#[derive(Debug, Clone, Copy)]
struct Place {
    line: Option<LineKind>,
    posture: Option<Posture>,
    level: Option<Level>,
    region: Option<Region>,
    group: Option<usize>,
    end: Option<usize>,
}

impl Place {
    const NONE: Self =
        Self { line: None, posture: None, level: None, region: None, group: None, end: None };

    const fn of_film(posture: Posture) -> Self {
        Self { posture: Some(posture), ..Self::NONE }
    }

    const fn of_line(line: LineKind) -> Self {
        Self { line: Some(line), ..Self::NONE }
    }
}

impl AnalysisQuantity {
    const fn place(self) -> Place {
        match self {
            Self::ChainLength
            | Self::SegmentLength
            | Self::InflectionCount
            | Self::InflectionPair => Place::NONE,
            Self::Sagittal(_) | Self::SpinalLength => Place::of_film(Posture::Erect),
            Self::LargestCurve(region) | Self::Convexity(region) => {
                Place { region: Some(region), ..Place::of_film(Posture::Erect) }
            }
            Self::InflectionY(end) | Self::InflectionZ(end) | Self::InflectionArc(end) => {
                Place { end: Some(end), ..Place::NONE }
            }
            Self::LocationY(posture, level)
            | Self::LocationZ(posture, level)
            | Self::Tilt(posture, level) => Place { level: Some(level), ..Place::of_film(posture) },
            Self::Pitch(level) => Place { level: Some(level), ..Place::of_film(Posture::Erect) },
            Self::Cobb(posture, region)
            | Self::TiltRange(posture, region)
            | Self::Ferguson(posture, region) => {
                Place { region: Some(region), ..Place::of_film(posture) }
            }
            Self::LeastSegment(posture, end)
            | Self::LeastDistanceSegments(posture, end)
            | Self::LeastDistance(posture, end) => {
                Place { end: Some(end), ..Place::of_film(posture) }
            }
            Self::FilmScale(posture)
            | Self::ComparisonAngle(posture)
            | Self::ComparisonDistance(posture) => Place::of_film(posture),
            Self::LogMultiplier(line, group) => {
                Place { group: Some(group), ..Place::of_line(line) }
            }
            Self::MeanLocationError(line, _) => Place::of_line(line),
            Self::LineTilt(line, posture)
            | Self::LineOffset(line, posture)
            | Self::Force(line, posture)
            | Self::LocationError(line, posture)
            | Self::ContradictedJoints(line, posture) => {
                Place { line: Some(line), ..Place::of_film(posture) }
            }
            Self::FergusonError(line, posture, region) => {
                Place { line: Some(line), region: Some(region), ..Place::of_film(posture) }
            }
        }
    }

    /// The line of action that it belongs to.
    #[must_use]
    pub const fn line(self) -> Option<LineKind> {
        self.place().line
    }

    /// The film that it belongs to.
    #[must_use]
    pub const fn posture(self) -> Option<Posture> {
        self.place().posture
    }

    /// The vertebra, where it has one.
    #[must_use]
    pub const fn level(self) -> Option<Level> {
        self.place().level
    }

    /// The region, or the name of the joints that share a multiplier, where it has one.
    #[must_use]
    pub fn group(self, analysis: &Analysis) -> Option<String> {
        let Place { line, region, group, .. } = self.place();
        if let Some(region) = region {
            return Some(region.key().to_owned());
        }
        let group = group?;
        let model = analysis.models.iter().find(|model| Some(model.kind) == line);
        let name = model.and_then(|model| model.groups.names().get(group).cloned());
        Some(name.unwrap_or_else(|| format!("group {}", group + 1)))
    }

    /// `caudal` or `cranial`: which inflection or window.
    #[must_use]
    pub fn end(self) -> Option<&'static str> {
        ENDS.get(self.place().end?).copied()
    }
}
