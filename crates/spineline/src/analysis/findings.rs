use super::{AnalysisOptions, Grouping, PostureAnalysis};
use crate::anatomy::{Level, Levels, Posture};
use crate::chain::Chain;
use crate::clinical::Regions;
use crate::curve::{InflectionIntervals, Inflections};
use crate::measure::SpacingPlane;
use crate::multibody::{JointGroups, SpineModel, StiffnessLibrary};

/// What steps 1 to 4 found of one patient: all that the lines of action and the models need.
#[derive(Clone, Copy)]
pub(super) struct Findings<'a> {
    /// Postures that have a film, the erect one first.
    pub postures: &'a [PostureAnalysis],
    /// Inflections of the erect curve, and the curves between them.
    pub inflections: &'a Inflections,
    /// Where the two inflections may lie if the erect curve is no polynomial.
    pub inflection_intervals: Option<InflectionIntervals>,
    /// The inflections as segments of the chain.
    pub inflection_segments: Option<[usize; 2]>,
    /// Segment number and length.
    pub chain: &'a Chain,
    /// Regions of the spine.
    pub regions: &'a Regions,
    /// The unloaded spine.
    pub spine: &'a SpineModel,
    /// Springs of its joints before personalisation.
    pub library: &'a StiffnessLibrary,
    /// Choices.
    pub options: &'a AnalysisOptions,
}

impl<'a> Findings<'a> {
    /// The erect posture.
    pub fn erect(self) -> &'a PostureAnalysis {
        &self.postures[0]
    }

    /// The vertebrae of the model.
    pub fn levels(self) -> Levels {
        self.erect().outline.levels()
    }

    /// The bending films.
    pub fn bends(self) -> impl Iterator<Item = &'a PostureAnalysis> {
        self.postures.iter().filter(|p| p.outline.posture.bend().is_some())
    }

    /// A film without spacing, if there is one.
    pub fn film_without_scale(self) -> Option<Posture> {
        let without = |p: &&PostureAnalysis| p.outline.scale.plane == SpacingPlane::Pixels;
        self.postures.iter().find(without).map(|p| p.outline.posture)
    }

    /// Which joints share a multiplier.
    pub fn joint_groups(self) -> JointGroups {
        match self.options.grouping {
            Grouping::Regional => JointGroups::regional(self.regions),
            Grouping::PerJoint => JointGroups::per_joint(self.levels()),
        }
    }

    /// Sagittal place of the lines: the mean depth of the vertebrae at the inflections; without inflections that of
    /// the base, which is zero.
    pub fn depth_mm(self) -> f64 {
        let Some(pair) = self.inflections.pair else { return 0.0 };
        let levels = self.levels();
        let at =
            |level: Level| levels.index_of(level).map_or(0.0, |i| self.spine.midpoints_mm[i].x);
        pair.iter()
            .map(|inflection| 0.5 * (at(inflection.between.0) + at(inflection.between.1)))
            .sum::<f64>()
            / 2.0
    }
}
