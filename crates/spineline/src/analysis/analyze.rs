use super::checks::{check_outlines, check_postures, warn_of_shifted_levels};
use super::hypotheses::fit_hypotheses;
use super::models::fit_models;
use super::preference::{PreferredLine, prefer_lines};
use super::{AnalysisOptions, Case, Grouping, LineModel};
use crate::anatomy::{Level, Posture};
use crate::chain::{Chain, ChainPose};
use crate::clinical::{ClinicalCurve, LenkeType, Regions, lenke_type, measure_curves};
use crate::curve::{CurveFit, InflectionChoice, Inflections, find_inflections, fit_curve};
use crate::error::Error;
use crate::hypothesis::HypothesisFit;
use crate::measure::{Film, FilmReadings, LengthScale, Noise, Outline, SpacingPlane, outline_of};
use crate::motion::{Estimate, Motion, least_windows, mean_least};
use crate::multibody::{JointGroups, SpineModel};
use crate::personalize::PreferredLoads;
use crate::personalize::evidence::FilmEvidence;
use crate::reliability::{QuantityReliability, assess, film_quantities};
use crate::spatial::{Angle, Frontal};
use crate::warning::{Step, Warnings};

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
    pub inflection_estimates: Option<[Estimate; 2]>,
    /// MMS_Mean against the least-rotating ones.
    pub mean_least_estimates: Option<[Estimate; 2]>,
    /// Where the two inflection segments lie in this posture.
    pub inflection_points: Option<[Frontal; 2]>,
    /// Rotations and joint centres; `None` for the erect posture.
    pub evidence: Option<FilmEvidence>,
    /// The line that the film's rotations prefer.
    pub preferred_line: Option<PreferredLine>,
}

/// Everything that was found out about one patient.
#[derive(Debug, Clone, PartialEq)]
pub struct Analysis {
    /// Identifier of the case.
    pub case_id: String,
    /// Whether the films are made up.
    pub synthetic: bool,
    /// Every reading of every film by itself, the erect one first.
    pub readings: Vec<FilmReadings>,
    /// Postures that have a film, the erect one first.
    pub postures: Vec<PostureAnalysis>,
    /// Inflections and lobes of the erect curve.
    pub inflections: Inflections,
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
    /// Lenke's type as far as the films tell it.
    pub lenke: Option<LenkeType>,
    /// The unloaded spine.
    pub spine: SpineModel,
    /// Whether its sagittal profile was measured on a lateral film; else it is a population's.
    pub lateral_measured: bool,
    /// One personalised model per line of action.
    pub models: Vec<LineModel>,
    /// Other loads and bases that were asked for.
    pub hypotheses: Vec<HypothesisFit>,
    /// Choices.
    pub options: AnalysisOptions,
    /// Soft problems.
    pub warnings: Warnings,
}

impl Analysis {
    /// One posture, where it has a film.
    #[must_use]
    pub fn posture(&self, posture: Posture) -> Option<&PostureAnalysis> {
        self.postures.iter().find(|p| p.outline.posture == posture)
    }

    /// How well the readings repeat, by quantity; empty where every film was read once.
    ///
    /// Computed when it is asked for, since no other result depends on it.
    #[must_use]
    pub fn reliability(&self) -> Vec<QuantityReliability> {
        if is_read_once(&self.readings) {
            return Vec::new();
        }
        film_quantities(&[(&self.case_id, &self.readings)]).iter().map(assess).collect()
    }

    /// The erect posture.
    #[must_use]
    pub fn erect(&self) -> &PostureAnalysis {
        &self.postures[0]
    }

    /// A film without spacing, if there is one: then there are angles, but no lengths to put a line or a model on.
    #[must_use]
    pub fn film_without_scale(&self) -> Option<Posture> {
        let without = |p: &&PostureAnalysis| p.outline.scale.plane == SpacingPlane::Pixels;
        self.postures.iter().find(without).map(|p| p.outline.posture)
    }

    /// Which joints share a multiplier.
    pub(super) fn joint_groups(&self) -> JointGroups {
        match self.options.grouping {
            Grouping::Regional => JointGroups::regional(&self.regions),
            Grouping::PerJoint => JointGroups::per_joint(),
        }
    }

    /// What the lengths of the chain, its inflections and the clinical curves are measured in: they are the erect film's.
    #[must_use]
    pub fn scale(&self) -> &LengthScale {
        &self.erect().outline.scale
    }
}

/// Runs all steps on one case, as far as its films reach.
///
/// An erect film alone gives the curve, its inflections and the clinical angles; every further film adds what it can.
/// What is missing says why in the warnings.
///
/// # Errors
/// [`Error`]: bad input only.
pub fn analyze(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    analyze_known(case, options, None)
}

/// As [`analyze`], without lines of action and personalised models: steps 1 to 4, in a small part of the time.
///
/// # Errors
/// [`Error`]: bad input only.
pub fn analyze_movement(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    movement(case, options, None)
}

/// What other readings of the same films have told.
#[derive(Debug, Clone)]
pub(crate) struct OtherReadings<'a> {
    /// Deviations of the films' measured values, in the order of the postures.
    pub noise: Vec<Noise>,
    /// Loads near which those of these readings are thought to be.
    pub loads: Option<PreferredLoads>,
    /// Models near which those of these readings are thought to be.
    pub models: &'a [LineModel],
}

/// As [`analyze`], with what is known from other readings of the films.
pub(crate) fn analyze_known(
    case: &Case,
    options: &AnalysisOptions,
    known: Option<&OtherReadings<'_>>,
) -> Result<Analysis, Error> {
    let mut analysis = movement(case, options, known.map(|known| &known.noise[..]))?;
    // 5, 7 and 8: lines of action, personalisation, evaluation
    prefer_lines(&mut analysis, known.and_then(|known| known.loads.as_ref()));
    fit_models(&mut analysis, known.map_or(&[][..], |known| known.models));
    fit_hypotheses(&mut analysis);
    Ok(analysis)
}

/// Steps 1 to 4, and the unloaded spine.
fn movement(
    case: &Case,
    options: &AnalysisOptions,
    noise: Option<&[Noise]>,
) -> Result<Analysis, Error> {
    let mut warnings = Warnings::default();
    // 1 measure
    check_postures(&case.films)?;
    let mut films: Vec<&Film> = case.films.iter().collect();
    films.sort_by_key(|film| film.posture);
    let (mut readings, mut outlines) = (Vec::new(), Vec::new());
    for film in &films {
        let measured = FilmReadings::measure(film)?;
        outlines.push(outline_of(film, &measured.readings, &mut warnings)?);
        readings.push(measured);
    }
    for (outline, noise) in outlines.iter_mut().zip(noise.into_iter().flatten()) {
        outline.noise = *noise;
    }
    for film in &films[1..] {
        warn_of_shifted_levels(films[0], film, &mut warnings);
    }
    if is_read_once(&readings) {
        let text = "every film was read once, so how well readings repeat is not known: let a second observer read, or read again";
        warnings.push(Step::Measure, "reliability_one_reading", text);
    }
    check_outlines(&outlines, &mut warnings)?;
    // 2 curve
    let fits = outlines
        .iter()
        .map(|outline| fit_curve(outline, options.order_rule, &mut warnings))
        .collect::<Result<Vec<CurveFit>, _>>()?;
    let inflections = inflections_of(&fits[0], options, &mut warnings);
    let locations: Vec<Frontal> = outlines[0].locations().collect();
    let regions = Regions::from_inflections(&fits[0], &inflections, &locations, &mut warnings);
    let clinical = measure_curves(&regions, &outlines.iter().collect::<Vec<_>>());
    // Regions that end at usual vertebrae are no curves, and give no type.
    let lenke = inflections.pair.and_then(|_| lenke_type(&clinical));
    // 3 chain
    let lengths: Vec<f64> =
        fits.iter().map(|fit| fit.curve.length_mm(fit.curve.end_mm())).collect();
    let chain = Chain::fit(lengths[0], &lengths[1..], options.segment_window.clone())?;
    let poses: Vec<ChainPose> = fits.iter().map(|fit| chain.lay(&fit.curve)).collect();
    let inflection_segments = inflections
        .pair
        .map(|pair| pair.map(|inflection| poses[0].nearest_segment(inflection.erect)));
    // 6 the unloaded spine: rotations of joints on the films need it
    let profile = match &case.lateral {
        Some(film) => film.measure_profile(&options.profile, &mut warnings)?,
        None => None,
    };
    let lateral_measured = profile.is_some();
    let profile = profile.unwrap_or_else(|| options.profile.clone());
    let spine = SpineModel::from_outline(&outlines[0], &profile);
    // 4 motion
    let windows = least_windows(&fits[0], &poses[0]);
    let erect = (outlines[0].clone(), poses[0].clone());
    let mut postures: Vec<PostureAnalysis> = outlines
        .into_iter()
        .zip(fits)
        .zip(poses)
        .map(|((outline, fit), pose)| {
            let moved = outline.posture != Posture::Erect;
            let motion = moved.then(|| Motion::between(&erect.1, &pose, &windows));
            let measure = || FilmEvidence::measure(&spine, &options.library, &erect.0, &outline);
            PostureAnalysis {
                inflection_estimates: motion
                    .as_ref()
                    .zip(inflection_segments)
                    .and_then(|(motion, segments)| motion.estimates(&erect.1, segments)),
                mean_least_estimates: None,
                inflection_points: inflection_segments.and_then(|[caudal, cranial]| {
                    Some([*pose.joints.get(caudal)?, *pose.joints.get(cranial)?])
                }),
                evidence: moved.then(measure),
                preferred_line: None,
                motion,
                outline,
                fit,
                pose,
            }
        })
        .collect();
    let mean_least_segments = add_mean_least(&mut postures, &erect.1);
    Ok(Analysis {
        case_id: case.id.clone(),
        synthetic: case.synthetic,
        readings,
        postures,
        inflections,
        inflection_segments,
        mean_least_segments,
        chain,
        regions,
        clinical,
        lenke,
        spine,
        lateral_measured,
        models: Vec::new(),
        hypotheses: Vec::new(),
        options: options.clone(),
        warnings,
    })
}

/// Whether no film has a second reading.
fn is_read_once(films: &[FilmReadings]) -> bool {
    films.iter().all(|film| film.readings.len() < 2)
}

fn inflections_of(
    erect: &CurveFit,
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Inflections {
    let found = find_inflections(erect, options.min_lobe);
    match options.inflections {
        InflectionChoice::ByHand(sites) => {
            warnings.push(
                Step::Motion,
                "inflections_by_hand",
                "the two inflections were picked by hand",
            );
            found.picked(erect, sites)
        }
        InflectionChoice::Automatic => {
            if found.all.len() != 2 {
                let lobes: Vec<String> = found
                    .lobes
                    .iter()
                    .map(|lobe| format!("{:.0}°", lobe.turn.abs().deg()))
                    .collect();
                let then = if found.pair.is_some() {
                    "the pair around the largest curve is used"
                } else {
                    "there is no inflection line; the other lines still are compared"
                };
                let text = format!(
                    "the erect curve has {} (lobes of {}), not two: {then}",
                    counted(found.all.len()),
                    lobes.join(", ")
                );
                warnings.film(Step::Motion, "inflections_not_two", Posture::Erect, text);
            }
            found
        }
    }
}

/// A number of inflections in words.
pub(super) fn counted(inflections: usize) -> String {
    match inflections {
        0 => "no inflection".to_owned(),
        1 => "one inflection".to_owned(),
        n => format!("{n} inflections"),
    }
}

/// Adds MMS_Mean to every posture where both bends were filmed.
fn add_mean_least(postures: &mut [PostureAnalysis], erect: &ChainPose) -> Option<[usize; 2]> {
    let motion = |posture: Posture| {
        postures.iter().find(|p| p.outline.posture == posture).and_then(|p| p.motion.as_ref())
    };
    let segments = mean_least(motion(Posture::LeftBending)?, motion(Posture::RightBending)?);
    for posture in postures {
        posture.mean_least_estimates =
            posture.motion.as_ref().and_then(|motion| motion.estimates(erect, segments));
    }
    Some(segments)
}

impl PostureAnalysis {
    /// The middle between the inflections of a posture, or of its spine: where a line is described from.
    #[must_use]
    pub fn middle(&self) -> Frontal {
        match self.inflection_points {
            Some([caudal, cranial]) => (caudal + cranial) * 0.5,
            None => self.outline.vertebrae[Level::MODEL.len() / 2].location,
        }
    }

    /// Mean rotation of the segments from the erect posture.
    #[must_use]
    pub fn mean_rotation(&self) -> Option<Angle> {
        self.motion.as_ref().map(Motion::mean_rotation)
    }
}
