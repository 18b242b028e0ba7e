//! The steps of one patient in their order. Each returns what it found; the analysis is put together once, at the end.

use super::checks::{
    check_age, check_outlines, check_postures, warn_of_length, warn_of_shifted_levels,
    warn_of_unknown_rotation,
};
use super::comparison::Remembered;
use super::findings::Findings;
use super::hypotheses::fit_hypotheses;
use super::models::fit_models;
use super::preference::{PreferredLine, prefer_lines};
use super::result::{Analysis, PostureAnalysis, is_read_once};
use super::standing::widths_mm;
use super::words::counted_inflections;
use super::wrong_film::warn_of_wrong_films;
use super::{AnalysisOptions, Case, LineModel};
use crate::anatomy::{Posture, SagittalProfile};
use crate::chain::{Chain, ChainPose, SEGMENT_WINDOW};
use crate::clinical::{
    Balance, ClinicalCurve, LenkeType, Regions, lenke_type, measure_balance, measure_curves,
};
use crate::curve::{
    CurveFit, InflectionChoice, InflectionIntervals, Inflections, find_inflections, fit_curve,
};
use crate::error::Error;
use crate::hypothesis::HypothesisFit;
use crate::measure::{
    AxialRotation, Film, FilmLengthRule, FilmReadings, InterpolationError, Outline, OutlineNoise,
    SpatialOutline, TiltRule, axial_rotations, common_levels, outline_of, seen_levels,
    warn_of_alike_observers, warn_of_implausible_landmarks, warn_of_shortened_chain,
};
use crate::motion::{Motion, least_windows, mean_least};
use crate::multibody::{SpineModel, StiffnessLibrary};
use crate::personalize::NearbyLoads;
use crate::personalize::evidence::FilmEvidence;
use crate::spatial::Frontal;
use crate::warning::{Step, Warnings};

/// Runs all steps on one case, as far as its films reach.
///
/// An erect film alone gives the curve, its inflections and the clinical angles; every further film adds what it can.
/// What is missing says why in the warnings. Lengths are in mm, forces in N, moments in N·mm; locations are in the global
/// frame `G` of each film ([`crate::measure`]), whose origin is L4's midpoint.
///
/// # Errors
/// [`Error`]: bad input only. A fit or a search without result is a status beside its numbers.
///
/// ```
/// use spineline::analysis::{AnalysisOptions, analyze};
/// use spineline::anatomy::Posture;
/// use spineline_phantom::{Readers, Truth, generate};
///
/// let case = generate(0, Truth::Bend, &Readers::exact(), 1)?.case;
/// let analysis = analyze(&case, &AnalysisOptions::default())?;
/// assert_eq!(analysis.erect().outline.posture, Posture::Erect);
/// // One personalised model per line of action.
/// for model in &analysis.models {
///     println!("{}: {:?} mm", model.kind, model.mean_location_error_mm(false));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn analyze(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    analyze_known(case, options, None)
}

/// As [`analyze`], without lines of action and personalised models: steps 1 to 4 and the unloaded spine, in a small part of
/// the time.
///
/// # Errors
/// [`Error`]: bad input only.
pub fn analyze_movement(case: &Case, options: &AnalysisOptions) -> Result<Analysis, Error> {
    let mut warnings = Warnings::default();
    let movement = Movement::of(case, options, None, &mut warnings)?;
    Ok(movement.into_analysis(case, options, Mechanics::default(), warnings))
}

/// What is known from other readings of the same films.
#[derive(Debug, Clone)]
pub(crate) struct OtherReadings<'a> {
    /// Deviations of the films' measured values, in the order of the postures.
    pub noise: Vec<OutlineNoise>,
    /// Loads near which those of these readings are expected.
    pub loads: Option<NearbyLoads>,
    /// Models near which those of these readings are expected.
    pub models: &'a [LineModel],
}

/// As [`analyze`], with what is known from other readings of the films, and errors of interpolated vertebrae.
pub(crate) fn analyze_known(
    case: &Case,
    options: &AnalysisOptions,
    known: Option<(&OtherReadings<'_>, &[InterpolationError])>,
) -> Result<Analysis, Error> {
    let mut warnings = Warnings::default();
    let measured = known.map(|(known, errors)| (&known.noise[..], errors));
    let movement = Movement::of(case, options, measured, &mut warnings)?;
    let others = known.map(|(known, _)| known);
    let mechanics = Mechanics::of(movement.findings(options), others, &mut warnings);
    let mut analysis = movement.into_analysis(case, options, mechanics, warnings);
    // Nobody reads warnings of perturbed landmarks.
    if known.is_none() {
        let of_lines = analysis.kept_line_warnings();
        analysis.warnings.merge(&of_lines);
    }
    Ok(analysis)
}

/// Steps 1 to 4, and the unloaded spine.
struct Movement {
    readings: Vec<FilmReadings>,
    curves: Curves,
    chain: Chain,
    inflection_intervals: Option<InflectionIntervals>,
    inflection_segments: Option<[usize; 2]>,
    mean_least_segments: Option<[usize; 2]>,
    spine: SpineModel,
    space: Option<SpatialOutline>,
    axial: Vec<AxialRotation>,
    library: StiffnessLibrary,
    postures: Vec<PostureAnalysis>,
}

impl Movement {
    fn of(
        case: &Case,
        options: &AnalysisOptions,
        known: Option<(&[OutlineNoise], &[InterpolationError])>,
        warnings: &mut Warnings,
    ) -> Result<Self, Error> {
        let (readings, outlines) = measure(case, options.tilt, known, warnings)?;
        let outlines = at_erect_length(outlines, options.film_lengths, warnings);
        let (curves, fits) = fit_curves(&outlines, options, warnings)?;
        let (chain, poses) = lay_chain(&fits)?;
        // Replicates show what noise does; what the form of the curve leaves open is that of the case. What a user has picked is
        // not doubted.
        let automatic = options.inflections == InflectionChoice::Automatic;
        let pair = curves.inflections.pair.filter(|_| automatic && known.is_none());
        let inflection_intervals =
            pair.and_then(|pair| fits[0].inflection_intervals(&outlines[0], pair));
        let inflection_segments = curves
            .inflections
            .pair
            .map(|pair| pair.map(|inflection| poses[0].nearest_segment(inflection.erect)));
        // Step 6 comes before step 4: the rotations of joints on the films need the unloaded spine.
        let UnloadedSpine { spine, space, axial } = unloaded_spine(case, &outlines[0], warnings)?;
        if space.is_some() && axial.is_empty() {
            warn_of_unknown_rotation(&curves.clinical, warnings);
        }
        let library = options.library.between(outlines[0].levels()).under(options.support);
        let motions = motions(&outlines, &fits[0], &poses);
        let mean_least_segments = mean_least_segments(&outlines, &motions);
        let segments = [inflection_segments, mean_least_segments];
        let evidence = outlines
            .iter()
            .map(|outline| {
                let moved = outline.posture != Posture::Erect;
                let measure = || FilmEvidence::measure(&spine, &library, &outlines[0], outline);
                moved.then(measure)
            })
            .collect();
        let postures = postures((outlines, fits, poses), motions, evidence, segments);
        Ok(Self {
            readings,
            curves,
            chain,
            inflection_intervals,
            inflection_segments,
            mean_least_segments,
            spine,
            space,
            axial,
            library,
            postures,
        })
    }

    fn findings<'a>(&'a self, options: &'a AnalysisOptions) -> Findings<'a> {
        Findings {
            postures: &self.postures,
            inflections: &self.curves.inflections,
            inflection_intervals: self.inflection_intervals,
            inflection_segments: self.inflection_segments,
            chain: &self.chain,
            regions: &self.curves.regions,
            spine: &self.spine,
            library: &self.library,
            options,
        }
    }

    fn into_analysis(
        self,
        case: &Case,
        options: &AnalysisOptions,
        mechanics: Mechanics,
        warnings: Warnings,
    ) -> Analysis {
        let widths_mm = widths_mm(case, &self.postures[0].outline);
        let mut postures = self.postures;
        for (posture, line) in postures.iter_mut().zip(mechanics.preferred_lines) {
            posture.preferred_line = line;
        }
        Analysis {
            case_id: case.id.clone(),
            synthetic: case.synthetic,
            readings: self.readings,
            postures,
            inflections: self.curves.inflections,
            inflection_intervals: self.inflection_intervals,
            inflection_segments: self.inflection_segments,
            mean_least_segments: self.mean_least_segments,
            chain: self.chain,
            regions: self.curves.regions,
            clinical: self.curves.clinical,
            balance: self.curves.balance,
            lenke: self.curves.lenke,
            spine: self.spine,
            widths_mm,
            library: self.library,
            space: self.space,
            axial: self.axial,
            models: mechanics.models,
            hypotheses: mechanics.hypotheses,
            options: options.clone(),
            warnings,
            comparison: Remembered::default(),
        }
    }
}

/// Steps 5, 7 and 8: lines of action, personalisation and evaluation; empty where not requested.
#[derive(Default)]
struct Mechanics {
    /// By posture; empty where no line was estimated.
    preferred_lines: Vec<Option<PreferredLine>>,
    models: Vec<LineModel>,
    hypotheses: Vec<HypothesisFit>,
}

impl Mechanics {
    fn of(
        findings: Findings<'_>,
        known: Option<&OtherReadings<'_>>,
        warnings: &mut Warnings,
    ) -> Self {
        let near = known.and_then(|known| known.loads.as_ref());
        // Of other readings nothing but the comparison with the inflection line is read.
        let are_read = known.is_none() || findings.inflections.pair.is_some();
        let preferred_lines =
            if are_read { prefer_lines(findings, near, warnings) } else { Vec::new() };
        let models = fit_models(findings, known.map_or(&[][..], |known| known.models), warnings);
        let hypotheses = fit_hypotheses(findings, warnings);
        Self { preferred_lines, models, hypotheses }
    }
}

/// Step 1: the readings and the outline of every film, the erect one first.
fn measure(
    case: &Case,
    tilt: TiltRule,
    known: Option<(&[OutlineNoise], &[InterpolationError])>,
    warnings: &mut Warnings,
) -> Result<(Vec<FilmReadings>, Vec<Outline>), Error> {
    check_age(case.subject.age_years)?;
    check_postures(&case.films)?;
    let mut films: Vec<&Film> = case.films.iter().collect();
    films.sort_by_key(|film| film.posture);
    let measure = |film: &&Film| FilmReadings::measure(film, tilt);
    let readings: Vec<FilmReadings> = films.iter().map(measure).collect::<Result<_, _>>()?;
    let seen: Vec<_> =
        readings.iter().map(|film| (film.posture, seen_levels(&film.readings))).collect();
    let levels = common_levels(&seen)?;
    warn_of_shortened_chain(levels, &seen, warnings);
    // Nobody reads doubts about perturbed landmarks, and they take a tenth of the time of a replicate.
    let reports_doubts = known.is_none();
    let mut held = known.into_iter().flat_map(|(noise, _)| noise);
    let mut outlines = Vec::new();
    for (film, measured) in films.iter().zip(&readings) {
        let noise = held.next().map(|noise| noise.film);
        outlines.push(outline_of((film, &measured.readings), levels, (tilt, noise), warnings)?);
        if reports_doubts {
            warn_of_implausible_landmarks(film, warnings);
        }
    }
    if let Some((noise, errors)) = known {
        for (outline, noise) in outlines.iter_mut().zip(noise) {
            noise.give_to(outline);
            errors.iter().for_each(|error| error.add_to(outline));
        }
    }
    if reports_doubts {
        for film in &films[1..] {
            warn_of_shifted_levels(films[0], film, warnings);
        }
    }
    if reports_doubts {
        warn_of_alike_observers(&readings, warnings);
    }
    if reports_doubts && is_read_once(&readings) {
        let text = "every film was read once, so the reliability of the readings is not known: add readings of a second observer, or repeat the reading";
        warnings.push(Step::Measure, "reliability_one_reading", text);
    }
    check_outlines(&outlines, warnings)?;
    if reports_doubts {
        warn_of_wrong_films((&films, case.synthetic), &outlines, warnings);
    }
    Ok((readings, outlines))
}

/// Brings all films to the length of the erect one.
fn at_erect_length(
    outlines: Vec<Outline>,
    rule: FilmLengthRule,
    warnings: &mut Warnings,
) -> Vec<Outline> {
    let erect = outlines[0].clone();
    let scaled: Vec<Outline> = outlines
        .into_iter()
        .map(|film| match film.posture {
            Posture::Erect => film,
            _ => film.at_erect_length(&erect, rule),
        })
        .collect();
    scaled.iter().for_each(|film| warn_of_length(film, warnings));
    scaled
}

/// What step 2 and the clinical readings found on the erect curve.
struct Curves {
    inflections: Inflections,
    regions: Regions,
    clinical: Vec<ClinicalCurve>,
    balance: Option<Balance>,
    lenke: Option<LenkeType>,
}

/// Step 2: the curve of every film, and what the erect one shows.
fn fit_curves(
    outlines: &[Outline],
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Result<(Curves, Vec<CurveFit>), Error> {
    let fits = outlines
        .iter()
        .map(|outline| fit_curve(outline, options.order_rule, warnings))
        .collect::<Result<Vec<CurveFit>, _>>()?;
    let inflections = inflections_of(&fits[0], options, warnings);
    let locations: Vec<Frontal> = outlines[0].locations().collect();
    let regions = Regions::from_inflections(&fits[0], &inflections, &locations, warnings);
    let clinical = measure_curves(&regions, &outlines.iter().collect::<Vec<_>>(), &options.ends);
    let balance = measure_balance(&outlines[0], &regions, &clinical);
    // Regions that end at usual vertebrae are no curves, and give no type.
    let lenke = inflections.pair.and_then(|_| lenke_type(&clinical));
    Ok((Curves { inflections, regions, clinical, balance, lenke }, fits))
}

/// Step 3: one segment length for all films, and the chain laid on every curve.
fn lay_chain(fits: &[CurveFit]) -> Result<(Chain, Vec<ChainPose>), Error> {
    let lengths: Vec<f64> =
        fits.iter().map(|fit| fit.curve.length_mm(fit.curve.end_mm())).collect();
    let chain = Chain::fit(lengths[0], &lengths[1..], SEGMENT_WINDOW)?;
    let poses = fits.iter().map(|fit| chain.lay(&fit.curve)).collect();
    Ok((chain, poses))
}

/// The unloaded spine, with what the lateral film and the pedicles show of it.
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
    let film = case.films.iter().find(|film| film.posture == Posture::Erect);
    let space = match film.zip(case.lateral.as_ref()) {
        Some((film, lateral)) => SpatialOutline::measure((film, erect), lateral, warnings)?,
        None => None,
    };
    let axial = match film {
        Some(film) => axial_rotations(film, erect)?,
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

/// Step 4: the movement of every posture from the erect one, which has none.
fn motions(outlines: &[Outline], erect: &CurveFit, poses: &[ChainPose]) -> Vec<Option<Motion>> {
    let windows = least_windows(erect, &poses[0]);
    let motion = |(outline, pose): (&Outline, &ChainPose)| {
        (outline.posture != Posture::Erect).then(|| Motion::between(&poses[0], pose, &windows))
    };
    outlines.iter().zip(poses).map(motion).collect()
}

/// MMS_Mean per window, where both bends were filmed.
fn mean_least_segments(outlines: &[Outline], motions: &[Option<Motion>]) -> Option<[usize; 2]> {
    let motion = |posture: Posture| {
        let mut films = outlines.iter().zip(motions);
        films
            .find(|(outline, _)| outline.posture == posture)
            .and_then(|(_, motion)| motion.as_ref())
    };
    Some(mean_least(motion(Posture::LeftBending)?, motion(Posture::RightBending)?))
}

/// What steps 1 to 4 found, by posture; `segments` are those at the inflections and MMS_Mean.
fn postures(
    (outlines, fits, poses): (Vec<Outline>, Vec<CurveFit>, Vec<ChainPose>),
    motions: Vec<Option<Motion>>,
    evidence: Vec<Option<FilmEvidence>>,
    segments: [Option<[usize; 2]>; 2],
) -> Vec<PostureAnalysis> {
    let erect = poses[0].clone();
    let films = outlines.into_iter().zip(fits).zip(poses);
    films
        .zip(motions.into_iter().zip(evidence))
        .map(|(((outline, fit), pose), (motion, evidence))| {
            let [inflection_estimates, mean_least_estimates] = segments.map(|segments| {
                motion
                    .as_ref()
                    .zip(segments)
                    .and_then(|(m, segments)| m.estimates(&erect, segments))
            });
            PostureAnalysis {
                inflection_estimates,
                mean_least_estimates,
                inflection_points: segments[0].and_then(|[caudal, cranial]| {
                    Some([*pose.joints.get(caudal)?, *pose.joints.get(cranial)?])
                }),
                evidence,
                preferred_line: None,
                motion,
                outline,
                fit,
                pose,
            }
        })
        .collect()
}

fn inflections_of(
    erect: &CurveFit,
    options: &AnalysisOptions,
    warnings: &mut Warnings,
) -> Inflections {
    let found = find_inflections(erect, options.min_curve);
    match options.inflections {
        InflectionChoice::ByHand(sites) => {
            warnings.push(
                Step::Motion,
                "inflections_by_hand",
                "the two inflections were chosen by hand",
            );
            found.picked(erect, sites)
        }
        InflectionChoice::Automatic => {
            if found.all.len() != 2 {
                warn_of_inflections(&found, warnings);
            }
            found
        }
    }
}

fn warn_of_inflections(found: &Inflections, warnings: &mut Warnings) {
    let curves: Vec<String> =
        found.curves.iter().map(|part| format!("{:.0}°", part.turn.abs().deg())).collect();
    let then = if found.pair.is_some() {
        "the pair around the largest curve is used"
    } else {
        "there is no inflection line; the other lines are still compared"
    };
    let text = format!(
        "the erect curve has {} (curves of {}), not two: {then}",
        counted_inflections(found.all.len()),
        curves.join(", ")
    );
    warnings.film(Step::Motion, "inflections_not_two", Posture::Erect, text);
}
