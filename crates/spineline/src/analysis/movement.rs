//! What the films show, and the unloaded spine: curves, rotations, and the lines of best fit to these rotations.

use super::checks::{check_unit, warn_of_unknown_rotation};
use super::clinic::Clinic;
use super::inflections::inflections_of;
use super::measured::{Measured, at_erect_length, measure, widths_mm};
use super::{AnalysisOptions, BestFitLine, Case, Grouping, Reference, Replicated};
use crate::anatomy::{Level, Levels, Posture, Region, SagittalProfile, trunk_weight_shares};
use crate::chain::{Chain, ChainPose, SEGMENT_WINDOW};
use crate::clinical::{
    Balance, ClinicalCurve, CobbEnds, CurvePlaces, LenkeType, RegionBounds, Regions,
    SpatialMeasures, film_tilts,
};
use crate::curve::{CurveFit, InflectionChoice, InflectionIntervals, Inflections, fit_curve};
use crate::error::{CaseError, Error};
use crate::measure::{
    AxialRotation, Film, FilmReadings, LengthScale, Outline, SpatialOutline, axial_rotations,
};
use crate::motion::{Motion, SegmentEstimate, least_windows, mean_least};
use crate::multibody::{FittedSprings, JointGroups, SpineModel, StiffnessLibrary};
use crate::personalize::Gauge;
use crate::personalize::evidence::FilmEvidence;
use crate::spatial::{Angle, Frontal, Vec3};
use crate::warning::{WarningCode, Warnings};

/// The film of one posture, with its curve and its movement.
#[derive(Debug, Clone, PartialEq)]
pub struct FilmMovement {
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
    pub best_fit_line: Option<BestFitLine>,
}

/// Curves, rotations from the erect posture, the lines of best fit to these rotations, and the unloaded spine. A result that a film or an
/// option does not allow is `None` or empty, with a warning.
#[derive(Debug, Clone, PartialEq)]
pub struct Movement {
    /// Every reading of every film by itself, the erect one first.
    pub readings: Vec<FilmReadings>,
    /// Postures that have a film, the erect one first.
    pub films: Vec<FilmMovement>,
    /// Inflections of the erect curve, and the curves between them.
    pub inflections: Inflections,
    /// Where the two inflections may lie where the erect curve departs from a polynomial; `None` without them, where they were picked by hand,
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
    /// Clinical curves of the regions, between the vertebrae that each film shows.
    pub clinical: Vec<ClinicalCurve>,
    /// The curve with the largest angle between any two vertebrae, where the regions do not end at inflections.
    pub whole_curve: Option<ClinicalCurve>,
    /// Balance of the spine over the pelvis; `None` where the erect film's vertical is not known.
    pub balance: Option<Balance>,
    /// Lenke's type as far as the films show it.
    pub lenke: Option<LenkeType>,
    /// The erect spine.
    pub spine: SpineModel,
    /// The same with springs that carry the weight of the trunk, of which all other films are free; `None` where nothing is carried.
    pub loaded_spine: Option<SpineModel>,
    /// Axial rotations of the vertebrae whose pedicles are marked on the erect film; empty, and unknown, without marks.
    pub axial: Vec<AxialRotation>,
    /// Widths of its bodies between the corners of the erect film, the base first; `None` where no person placed them. Empty if that
    /// film has no corners.
    pub widths_mm: Vec<Option<f64>>,
    /// Springs of its joints before personalisation: from the options, for the joints that the films show.
    pub library: StiffnessLibrary,
    /// The erect spine in space, from the erect and the lateral film; `None` without a lateral film, where the sagittal profile is a
    /// population's.
    pub space: Option<SpatialOutline>,
}

impl Movement {
    /// Steps 1 to 4 on one case, and the unloaded spine of step 6, which the rotations of joints need.
    pub(super) fn of(
        case: &Case,
        options: &AnalysisOptions,
        replicated: Option<Replicated<'_>>,
        warnings: &mut Warnings,
    ) -> Result<Self, Error> {
        if replicated.is_none() {
            check_unit(options, warnings)?;
        }
        let Measured { readings, outlines, whole } =
            measure(case, options.tilt, replicated, warnings)?;
        let mut outlines = at_erect_length(outlines, options.film_lengths, warnings);
        outlines.iter_mut().for_each(|film| film.amplitude_ends = options.amplitude);
        let fit = |outline| fit_curve(outline, options.order_rule, warnings);
        let fits = outlines.iter().map(fit).collect::<Result<Vec<CurveFit>, _>>()?;
        let inflections = inflections_of(&fits[0], options, warnings);
        let locations: Vec<Frontal> = outlines[0].locations().collect();
        let regions = Regions::from_inflections(&fits[0], &inflections, &locations, warnings);
        let Clinic { curves: clinical, whole_curve, balance, lenke } =
            Clinic::of(whole.as_ref().unwrap_or(&outlines), regions, options, warnings)?;
        let chain = chain_of(&fits)?;
        let unmoved = |(outline, fit)| FilmMovement::unmoved(outline, fit, &chain);
        let films: Vec<FilmMovement> = outlines.into_iter().zip(fits).map(unmoved).collect();
        let erect = &films[0];
        let UnloadedSpine { spine, space, axial } = unloaded_spine(case, &erect.outline, warnings)?;
        let loaded_spine = loaded_spine(&spine, &erect.outline, options, warnings)?;
        if space.is_some() && axial.is_empty() {
            warn_of_unknown_rotation(&clinical, warnings);
        }
        // Replicates show what noise does; the form of the curve is uncertain for the case itself. What a user has picked is
        // not doubted.
        let automatic = options.inflections == InflectionChoice::Automatic;
        let pair = inflections.pair.filter(|_| automatic && replicated.is_none());
        let mut movement = Self {
            inflection_intervals: pair
                .and_then(|pair| erect.fit.inflection_intervals(&erect.outline, pair)),
            inflection_segments: inflections
                .pair
                .map(|pair| pair.map(|inflection| erect.pose.nearest_segment(inflection.erect))),
            mean_least_segments: None,
            balance,
            lenke,
            widths_mm: widths_mm(case, &erect.outline),
            library: options.library.between(erect.outline.levels()).under(options.support),
            readings,
            films,
            inflections,
            chain,
            regions,
            clinical,
            whole_curve,
            spine,
            loaded_spine,
            axial,
            space,
        };
        movement.measure_rotations();
        Ok(movement)
    }

    /// Step 4: the movement of every posture from the erect one.
    fn measure_rotations(&mut self) {
        let (spine, erect) = (self.spine_of_films(), &self.erect().outline);
        let measured =
            |film: &FilmMovement| FilmEvidence::measure(spine, &self.library, erect, &film.outline);
        let evidence: Vec<FilmEvidence> = self.films.iter().skip(1).map(measured).collect();
        let Some((erect, moved)) = self.films.split_first_mut() else { return };
        let windows = least_windows(&erect.fit, &erect.pose);
        for (film, evidence) in moved.iter_mut().zip(evidence) {
            film.motion = Some(Motion::between(&erect.pose, &film.pose, &windows));
            film.evidence = Some(evidence);
        }
        let bend = |posture: Posture| {
            moved.iter().find(|film| film.outline.posture == posture)?.motion.as_ref()
        };
        let bends = bend(Posture::LeftBending).zip(bend(Posture::RightBending));
        self.mean_least_segments = bends.map(|(left, right)| mean_least(left, right));
        for film in moved {
            let estimates = |segments: Option<[usize; 2]>| {
                film.motion.as_ref()?.estimates(&erect.pose, segments?)
            };
            film.inflection_estimates = estimates(self.inflection_segments);
            film.mean_least_estimates = estimates(self.mean_least_segments);
        }
        for film in &mut self.films {
            film.inflection_points = self.inflection_segments.and_then(|[caudal, cranial]| {
                Some([*film.pose.joints.get(caudal)?, *film.pose.joints.get(cranial)?])
            });
        }
    }

    /// The erect posture.
    #[must_use]
    pub fn erect(&self) -> &FilmMovement {
        &self.films[0]
    }

    /// One posture, where it has a film.
    #[must_use]
    pub fn film(&self, posture: Posture) -> Option<&FilmMovement> {
        self.films.iter().find(|film| film.outline.posture == posture)
    }

    /// The bending films.
    pub fn bends(&self) -> impl Iterator<Item = &FilmMovement> {
        self.films.iter().filter(|film| film.outline.posture.bend().is_some())
    }

    /// The vertebrae of the model: L4 to T2, or those that all films show.
    #[must_use]
    pub fn levels(&self) -> Levels {
        self.erect().outline.levels()
    }

    /// The unit of the chain, its inflections and the clinical curves: the erect film's.
    #[must_use]
    pub fn scale(&self) -> &LengthScale {
        &self.erect().outline.scale
    }

    /// A film without a spacing, if any: lines and models then lack lengths.
    #[must_use]
    pub fn film_without_scale(&self) -> Option<Posture> {
        let without = |film: &&FilmMovement| !film.outline.scale.has_millimetres();
        self.films.iter().find(without).map(|film| film.outline.posture)
    }

    /// The largest curve of the erect film.
    #[must_use]
    pub fn main_curve(&self) -> Option<&ClinicalCurve> {
        let size = |curve: &ClinicalCurve| curve.erect_size().abs().rad();
        let of_regions = || self.clinical.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        self.whole_curve.as_ref().or_else(of_regions)
    }

    /// Between which vertebrae the curves are measured, for shapes of the model: as on the films, or as chosen on the model where it
    /// lacks an end.
    #[must_use]
    pub fn curve_places(&self) -> Vec<CurvePlaces> {
        let erect = film_tilts(&self.erect().outline);
        let place = |(bounds, curve): (&RegionBounds, &ClinicalCurve)| {
            let CobbEnds { inferior, superior } = curve.ends;
            let [inferior, superior] = [inferior, superior].map(|end| self.levels().index_of(end));
            match inferior.zip(superior) {
                Some((inferior, superior)) => {
                    CurvePlaces::between(*bounds, [inferior, superior], &erect)
                }
                None => CurvePlaces::choose(*bounds, &erect),
            }
        };
        self.regions.bounds.iter().zip(&self.clinical).map(place).collect()
    }

    /// Kyphosis, lordosis, planes of maximum curvature and length of the erect spine in space; `None` without a lateral film.
    ///
    /// Computed on request, because no other result depends on it.
    #[must_use]
    pub fn spatial_measures(&self) -> Option<SpatialMeasures> {
        self.space.as_ref().map(|space| SpatialMeasures::of(space, &self.clinical, &self.axial))
    }

    /// Which joints share a multiplier.
    pub(super) fn joint_groups(&self, grouping: Grouping) -> JointGroups {
        match grouping {
            Grouping::Regional => JointGroups::regional(&self.regions),
            Grouping::FixedRegions => {
                let locations: Vec<Frontal> = self.erect().outline.locations().collect();
                JointGroups::regional(&Regions::usual(self.levels(), &locations))
            }
            Grouping::PerJoint => JointGroups::per_joint(self.levels()),
        }
    }

    /// The end vertebrae of the curves on the erect film.
    #[must_use]
    pub fn end_vertebrae(&self) -> Vec<(Region, CobbEnds)> {
        self.clinical.iter().map(|curve| (curve.region, curve.ends)).collect()
    }

    /// The spine of the films other than the erect one, with the moments that its springs carry on that one.
    #[must_use]
    pub fn spine_of_films(&self) -> &SpineModel {
        self.loaded_spine.as_ref().unwrap_or(&self.spine)
    }

    pub(super) fn springs<'a>(&'a self, groups: &'a JointGroups) -> FittedSprings<'a> {
        let (model, erect) = (self.spine_of_films(), &self.erect().outline);
        FittedSprings { model, erect, library: &self.library, groups }
    }

    /// Sagittal place of the lines: the mean depth of the vertebrae at the inflections; without inflections, the depth of the base,
    /// which is zero.
    pub(super) fn depth_mm(&self) -> f64 {
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

impl FilmMovement {
    /// A film with its chain, before it is compared with the erect one.
    fn unmoved(outline: Outline, fit: CurveFit, chain: &Chain) -> Self {
        Self {
            pose: chain.lay(&fit.curve),
            outline,
            fit,
            motion: None,
            inflection_estimates: None,
            mean_least_estimates: None,
            inflection_points: None,
            evidence: None,
            best_fit_line: None,
        }
    }

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

/// Step 3: one segment length for all films.
fn chain_of(fits: &[CurveFit]) -> Result<Chain, Error> {
    let lengths: Vec<f64> =
        fits.iter().map(|fit| fit.curve.length_mm(fit.curve.end_mm())).collect();
    Ok(Chain::fit(lengths[0], &lengths[1..], SEGMENT_WINDOW)?)
}

/// The unloaded spine, with the results of the lateral film and the pedicles.
struct UnloadedSpine {
    spine: SpineModel,
    space: Option<SpatialOutline>,
    axial: Vec<AxialRotation>,
}

fn unloaded_spine(
    case: &Case,
    erect: &Outline,
    warnings: &mut Warnings,
) -> Result<UnloadedSpine, Error> {
    let once = case.film(Posture::Erect).map(Film::with_copies_as_one);
    let film = once.as_deref();
    let space = match film.zip(case.lateral.as_ref()) {
        Some((film, lateral)) => SpatialOutline::measure(film, erect, lateral, warnings)?,
        None => None,
    };
    let axial = match film {
        Some(film) => axial_rotations(film, erect, warnings)?,
        None => Vec::new(),
    };
    let mut profile = SagittalProfile::default();
    for found in &axial {
        let place = found.level.model_index().and_then(|i| profile.axial_deg.get_mut(i));
        if let Some(axial_deg) = place {
            *axial_deg = found.stokes.deg();
        }
    }
    let spine = match &space {
        Some(space) => SpineModel::in_space(erect, &profile, space),
        None => SpineModel::from_outline(erect, &profile),
    };
    Ok(UnloadedSpine { spine, space, axial })
}

/// Weight of 1 kg, in N.
const STANDARD_GRAVITY_M_S2: f64 = 9.806_65;

/// The spine whose springs carry the weight of the trunk, along the vertical of the erect film.
fn loaded_spine(
    spine: &SpineModel,
    erect: &Outline,
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Result<Option<SpineModel>, CaseError> {
    let Reference::Loaded { body_mass_kg } = options.reference else { return Ok(None) };
    if matches!(options.gauge, Gauge::KnownForce { .. }) {
        return Err(CaseError::WeightAndKnownForce);
    }
    if erect.vertical.is_none() {
        let text = "the film has locations and tilts but no picture: the weight acts along the vertical of their frame";
        warnings.film(WarningCode::VerticalAssumed, Posture::Erect, text);
    }
    let weight_n = body_mass_kg * STANDARD_GRAVITY_M_S2;
    let down = Frontal::new(0.0, -1.0).rotated(-erect.l4_on_film) * weight_n;
    let weight = |share| Vec3::new(0.0, down.y_mm, down.z_mm) * share;
    let weights_n: Vec<Vec3> =
        trunk_weight_shares(erect.levels()).into_iter().map(weight).collect();
    Ok(Some(spine.clone().carrying(&weights_n)))
}
