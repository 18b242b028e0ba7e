use super::comparison::Remembered;
use super::findings::Findings;
use super::preference::PreferredLine;
use super::{AnalysisOptions, LineModel};
use crate::anatomy::{Levels, Posture};
use crate::chain::{Chain, ChainPose};
use crate::clinical::{
    Balance, ClinicalCurve, CobbEnds, CurvePlaces, LenkeType, RegionBounds, Regions,
    SpatialMeasures, film_tilts,
};
use crate::curve::{CurveFit, InflectionIntervals, Inflections};
use crate::hypothesis::HypothesisFit;
use crate::measure::{AxialRotation, FilmReadings, LengthScale, Outline, SpatialOutline};
use crate::motion::{Motion, SegmentEstimate};
use crate::multibody::{SpineModel, StiffnessLibrary};
use crate::personalize::evidence::FilmEvidence;
use crate::reliability::{QuantityReliability, assess, film_quantities};
use crate::spatial::{Angle, Frontal};
use crate::warning::Warnings;

/// One posture of an analysis.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureAnalysis {
    /// Measured vertebrae.
    pub outline: Outline,
    /// Fitted curve.
    pub fit: CurveFit,
    /// Chain laid on it.
    pub pose: ChainPose,
    /// Movement from the erect posture; `None` for the erect one.
    pub motion: Option<Motion>,
    /// The inflection segments against the least-rotating ones.
    pub inflection_estimates: Option<[SegmentEstimate; 2]>,
    /// MMS_Mean against the least-rotating ones.
    pub mean_least_estimates: Option<[SegmentEstimate; 2]>,
    /// Where the two inflection segments lie in this posture.
    pub inflection_points: Option<[Frontal; 2]>,
    /// Rotations and joint centres; `None` for the erect posture.
    pub evidence: Option<FilmEvidence>,
    /// The line of best fit to the film's rotations.
    pub preferred_line: Option<PreferredLine>,
}

/// The results of all steps for one patient; what a film or an option does not allow is `None` or empty, with a warning.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Identifier of the case.
    pub case_id: String,
    /// Whether the films are synthetic.
    pub synthetic: bool,
    /// Every reading of every film by itself, the erect one first.
    pub readings: Vec<FilmReadings>,
    /// Postures that have a film, the erect one first.
    pub postures: Vec<PostureAnalysis>,
    /// Inflections of the erect curve, and the curves between them.
    pub inflections: Inflections,
    /// Where the two inflections may lie if the erect curve is no polynomial; `None` without them, where they were picked by hand,
    /// and in Monte Carlo replicates.
    pub inflection_intervals: Option<InflectionIntervals>,
    /// The inflections as segments of the chain.
    pub inflection_segments: Option<[usize; 2]>,
    /// MMS_Mean per window, where both bends were filmed.
    pub mean_least_segments: Option<[usize; 2]>,
    /// Segment number and length.
    pub chain: Chain,
    /// Regions of the spine.
    pub regions: Regions,
    /// Clinical curves.
    pub clinical: Vec<ClinicalCurve>,
    /// How the spine stands over the pelvis; `None` where the erect film's vertical is not known.
    pub balance: Option<Balance>,
    /// Lenke's type as far as the films show it.
    pub lenke: Option<LenkeType>,
    /// The unloaded spine.
    pub spine: SpineModel,
    /// Axial rotations of the vertebrae whose pedicles are marked on the erect film; empty where none are, and zero is unknown.
    pub axial: Vec<AxialRotation>,
    /// Widths of its bodies between the corners of the erect film, the base first; `None` where nobody placed them. An empty list where that
    /// film has no corners.
    pub widths_mm: Vec<Option<f64>>,
    /// Springs of its joints before personalisation: those of the options, for the joints that the films show.
    pub library: StiffnessLibrary,
    /// The erect spine in space, from the erect and the lateral film; `None` without a lateral film, where the sagittal profile is a
    /// population's.
    pub space: Option<SpatialOutline>,
    /// One personalised model per line of action.
    pub models: Vec<LineModel>,
    /// Other loads and bases that were requested.
    pub hypotheses: Vec<HypothesisFit>,
    /// Choices.
    pub options: AnalysisOptions,
    /// Problems that do not stop the analysis.
    pub warnings: Warnings,
    /// What [`Analysis::comparison`] has found.
    pub(super) comparison: Remembered,
}

impl Analysis {
    /// One posture, where it has a film.
    #[must_use]
    pub fn posture(&self, posture: Posture) -> Option<&PostureAnalysis> {
        self.postures.iter().find(|p| p.outline.posture == posture)
    }

    /// The largest curve of the erect film.
    #[must_use]
    pub fn main_curve(&self) -> Option<&ClinicalCurve> {
        let size = |curve: &ClinicalCurve| curve.erect_size().abs().rad();
        self.clinical.iter().max_by(|a, b| size(a).total_cmp(&size(b)))
    }

    /// Between which vertebrae the curves are measured, for shapes of the model.
    #[must_use]
    pub fn curve_places(&self) -> Vec<CurvePlaces> {
        let erect = film_tilts(&self.erect().outline);
        let place = |(bounds, curve): (&RegionBounds, &ClinicalCurve)| {
            let CobbEnds { inferior, superior } = curve.ends;
            let levels = self.levels();
            let ends = [levels.index_of(inferior)?, levels.index_of(superior)?];
            Some(CurvePlaces::between(*bounds, ends, &erect))
        };
        self.regions.bounds.iter().zip(&self.clinical).filter_map(place).collect()
    }

    /// Kyphosis, lordosis, planes of maximum curvature and length of the erect spine in space; `None` without a lateral film.
    ///
    /// Computed on request, because no other result depends on it.
    #[must_use]
    pub fn spatial_measures(&self) -> Option<SpatialMeasures> {
        self.space.as_ref().map(|space| SpatialMeasures::of(space, &self.clinical, &self.axial))
    }

    /// How well the readings repeat, by quantity; empty where every film was read once.
    ///
    /// Computed on request, because no other result depends on it.
    #[must_use]
    pub fn reliability(&self) -> Vec<QuantityReliability> {
        if is_read_once(&self.readings) {
            return Vec::new();
        }
        film_quantities(&[(&self.case_id, &self.readings)]).iter().map(assess).collect()
    }

    /// The vertebrae of the model: L4 to T2, or those that all films show.
    #[must_use]
    pub fn levels(&self) -> Levels {
        self.erect().outline.levels()
    }

    /// The erect posture.
    #[must_use]
    pub fn erect(&self) -> &PostureAnalysis {
        &self.postures[0]
    }

    /// A film without spacing, if there is one: then there are angles, but no lengths to put a line or a model on.
    #[must_use]
    pub fn film_without_scale(&self) -> Option<Posture> {
        self.findings().film_without_scale()
    }

    /// What steps 1 to 4 found, as the later steps take it.
    pub(super) fn findings(&self) -> Findings<'_> {
        Findings {
            postures: &self.postures,
            inflections: &self.inflections,
            inflection_intervals: self.inflection_intervals,
            inflection_segments: self.inflection_segments,
            chain: &self.chain,
            regions: &self.regions,
            spine: &self.spine,
            library: &self.library,
            options: &self.options,
        }
    }

    /// What the lengths of the chain, its inflections and the clinical curves are measured in: they are the erect film's.
    #[must_use]
    pub fn scale(&self) -> &LengthScale {
        &self.erect().outline.scale
    }
}

impl PostureAnalysis {
    /// The middle between the inflections of a posture, or of its spine: where a line is described from.
    #[must_use]
    pub fn middle(&self) -> Frontal {
        match self.inflection_points {
            Some([caudal, cranial]) => (caudal + cranial) * 0.5,
            None => self.outline.vertebrae[self.outline.vertebrae.len() / 2].location,
        }
    }

    /// Mean rotation of the segments from the erect posture.
    #[must_use]
    pub fn mean_rotation(&self) -> Option<Angle> {
        self.motion.as_ref().map(Motion::mean_rotation)
    }
}

/// Whether no film has a second reading.
pub(super) fn is_read_once(films: &[FilmReadings]) -> bool {
    films.iter().all(|film| film.readings.len() < 2)
}
