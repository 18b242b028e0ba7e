//! From the landmarks of one film to its outline.

use std::collections::BTreeMap;

use super::corners::normal_tilt;
use super::film_checks::{check_body_sizes, check_crests, check_scale_sd};
use super::interpolation::interpolate;
use super::lengths::check_lengths;
use super::means::average;
use super::outline_checks::{check_marked, warn_of_gaps, warn_of_interpolated, warn_of_source};
use super::placing::{program_corners, warn_of_unusable_ends};
use super::{
    AmplitudeEnds, Film, FilmLandmarks, FilmLength, FilmReadings, IliacCrests, ImageGeometry,
    LengthScale, MeasureError, MeasureFault, MeasuredVertebra, Noise, Outline, Placement, Reading,
    SharedErrors, SpacingPlane, TiltRule, common_levels, measure_readings, seen_levels,
    warn_of_shortened_chain,
};
use crate::anatomy::{Level, Levels, Morphometry, Posture};
use crate::number::fixed;
use crate::spatial::{Angle, Frontal};
use crate::warning::{WarningCode, Warnings};

/// Angle between the iliac line and the lowest vertebra of the model, above which the crests are doubted: the few segments
/// between them bend by less (assumption).
const MAX_ILIAC_ANGLE: Angle = Angle::from_deg(40.0);

/// Depth of the middle of the crests below L4, beyond which they are doubted: their line usually crosses L4 or the disc below it (assumption).
const MAX_ILIAC_DEPTH_MM: f64 = 150.0;

/// Measures one film: every reading, their mean, and the global frame.
///
/// Locations are in mm in the global frame `G`: origin at L4's midpoint, +Z cranial along L4's axis, +Y to the patient's
/// left. Tilts are against L4, right-handed about +X (anterior).
///
/// # Errors
/// [`MeasureError`], which names film, reading, vertebra, value and limit. Nothing is repaired.
///
/// ```
/// use spineline::anatomy::Level;
/// use spineline::measure::{TiltRule, measure_film};
/// use spineline::warning::Warnings;
/// use spineline_phantom::{Readers, Scenario, generate};
///
/// let case = generate(0, Scenario::Bend, &Readers::exact(), 1)?.case;
/// let outline = measure_film(&case.films[0], TiltRule::default(), &mut Warnings::default())?;
/// assert_eq!(outline.vertebrae.len(), Level::MODEL.len());
/// // L4 is the origin.
/// assert!(outline.vertebrae[0].location.norm_mm() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn measure_film(
    film: &Film,
    rule: TiltRule,
    warnings: &mut Warnings,
) -> Result<Outline, MeasureError> {
    let FilmReadings { readings, .. } = FilmReadings::measure(film, rule)?;
    film.warn_of_copies(warnings);
    let seen = [(film.posture, seen_levels(&readings))];
    let levels = common_levels(&seen)?;
    warn_of_shortened_chain(levels, &seen, warnings);
    outline_of(&film.with_copies_as_one(), &readings, levels, rule, None, warnings)
}

/// The outline of a film whose readings were measured before; its base and its top are marked. Its noise comes from the
/// readings, if it is not known from elsewhere.
pub(crate) fn outline_of(
    film: &Film,
    readings: &[Reading<Placement>],
    levels: Levels,
    rule: TiltRule,
    noise: Option<Noise>,
    warnings: &mut Warnings,
) -> Result<Outline, MeasureError> {
    let posture = film.posture;
    warn_of_unusable_ends(film, warnings);
    let program = program_corners(film, warnings);
    let PlacedFilm { readings: placed, scale, iliac_normal, iliac_middle, iliac_tips } =
        place_film(film, readings, warnings)?;
    let on_film = average(&placed);
    let (base, _) = *on_film
        .get(&levels.base())
        .ok_or(MeasureFault::BaseMissing { lowest: Levels::HIGHEST_BASE }.at(posture))?;
    let mut in_global: BTreeMap<Level, MeasuredVertebra> = on_film
        .iter()
        .map(|(&level, (placement, readings))| {
            (level, in_global_frame(level, placement, *readings, &base))
        })
        .collect();
    check_marked(posture, &mut in_global, &scale, warnings)?;
    let noise = noise.unwrap_or_else(|| {
        let observers: Vec<&str> = readings.iter().map(|one| one.id.observer.as_str()).collect();
        Noise::of_means(&observers, &placed, &on_film)
    });
    let shared_errors = SharedErrors::of_film(film, &program, rule, &in_global, base.tilt, &scale);
    let vertebrae = vertebrae_of(posture, levels, &in_global, &noise)?;
    warn_of_interpolated(posture, &vertebrae, &scale, warnings);
    let iliac_normal = iliac_normal.map(|normal| (normal - base.tilt).wrapped());
    let to_global = |place: Frontal| (place - base.location).rotated(-base.tilt);
    let of_angle = iliac_normal.and_then(|normal| doubt_of_iliac_angle(levels.base(), normal));
    let of_place =
        iliac_tips.and_then(|tips| doubt_of_crests(tips.map(to_global), &vertebrae, &scale));
    let doubts = of_angle.into_iter().chain(of_place);
    doubts.for_each(|text| warnings.film(WarningCode::IliacLineUnusual, posture, text));
    warn_of_gaps(posture, &vertebrae, placed.len(), warnings);
    Ok(Outline {
        posture,
        others: in_global.into_values().filter(|v| levels.index_of(v.level).is_none()).collect(),
        vertebrae,
        iliac_normal,
        iliac_middle: iliac_middle.map(to_global),
        vertical: matches!(film.landmarks, FilmLandmarks::Corners { .. }).then(|| -base.tilt),
        l4_on_film: base.tilt,
        l4_midpoint_on_film: base.location,
        amplitude_ends: AmplitudeEnds::default(),
        noise,
        shared_errors,
        scale,
        length: FilmLength::ERECT,
        readings: placed.len(),
    })
}

/// Why the direction of the iliac line is doubted.
fn doubt_of_iliac_angle(base: Level, normal: Angle) -> Option<String> {
    let why = if normal.abs() > Angle::from_deg(90.0) {
        "the left and right crests may be exchanged"
    } else {
        "check the tips of both crests"
    };
    let text = || {
        let (angle, limit) = (normal.abs().text(0), MAX_ILIAC_ANGLE.text(0));
        format!("the angle between the iliac line and {base} is {angle} (limit {limit}): {why}")
    };
    (normal.abs() > MAX_ILIAC_ANGLE).then(text)
}

/// Why the places of the two tips of the crests are doubted; in the global frame, in which the base, the first vertebra, is the origin.
fn doubt_of_crests(
    tips: [Frontal; 2],
    vertebrae: &[MeasuredVertebra],
    scale: &LengthScale,
) -> Option<String> {
    let [left, right] = tips;
    let base = vertebrae.first()?.level;
    let l2_mm = vertebrae.iter().find(|vertebra| vertebra.level == Level::L2)?.location.z_mm;
    let middle_mm = 0.5 * (left.z_mm + right.z_mm);
    let below_l4_mm = -middle_mm - Morphometry::spacing_mm(Level::L4, base);
    let found = if middle_mm > l2_mm {
        "the middle of the iliac crests lies above L2".to_owned()
    } else if below_l4_mm > MAX_ILIAC_DEPTH_MM {
        let (depth, limit) = (scale.text(below_l4_mm, 0), scale.text(MAX_ILIAC_DEPTH_MM, 0));
        format!("the middle of the iliac crests lies {depth} below L4 (limit {limit})")
    } else if left.y_mm * right.y_mm > 0.0 {
        format!("both iliac crests lie on one side of {base}")
    } else {
        return None;
    };
    Some(format!("{found}: check the tips of both crests"))
}

/// A vertebra in the global frame: the base's (L4's) midpoint is the origin, and its own axis is +Z.
fn in_global_frame(
    level: Level,
    placement: &Placement,
    readings: usize,
    base: &Placement,
) -> MeasuredVertebra {
    let in_global = Placement {
        location: (placement.location - base.location).rotated(-base.tilt),
        tilt: (placement.tilt - base.tilt).wrapped(),
        endplates: placement.endplates.map(|tilts| tilts.against(base.tilt)),
        ..*placement
    };
    MeasuredVertebra::of_mean(level, in_global, readings)
}

/// The vertebrae of the model on a film, those without landmarks from their neighbours.
fn vertebrae_of(
    posture: Posture,
    levels: Levels,
    marked: &BTreeMap<Level, MeasuredVertebra>,
    noise: &Noise,
) -> Result<Vec<MeasuredVertebra>, MeasureError> {
    let vertebra = |level: Level| {
        if let Some(found) = marked.get(&level) {
            return Ok(*found);
        }
        let below = marked.range(levels.base()..level).next_back();
        let above = marked.range(level..=levels.top()).next();
        match below.zip(above) {
            Some(((_, low), (_, high))) => Ok(interpolate(level, [low, high], noise)),
            None => {
                let highest = below.map(|(&level, _)| level);
                Err(MeasureFault::TopMissing { highest }.at(posture))
            }
        }
    };
    levels.iter().map(vertebra).collect()
}

/// The readings of a film in millimetres, each in the film's own frame.
struct PlacedFilm {
    readings: Vec<BTreeMap<Level, Placement>>,
    scale: LengthScale,
    iliac_normal: Option<Angle>,
    iliac_middle: Option<Frontal>,
    /// The left and the right tip.
    iliac_tips: Option<[Frontal; 2]>,
}

/// Checks all landmarks of a film, of whichever vertebrae: what [`measure_film`] refuses before it asks whether all are there.
///
/// # Errors
/// As [`measure_film`], but for what concerns several vertebrae in their order.
pub fn check_landmarks(film: &Film) -> Result<(), MeasureError> {
    place_film(film, &measure_readings(film, TiltRule::default())?, &mut Warnings::default())
        .map(|_| ())
}

fn place_film(
    film: &Film,
    readings: &[Reading<Placement>],
    warnings: &mut Warnings,
) -> Result<PlacedFilm, MeasureError> {
    let posture = film.posture;
    let readings = readings.iter().map(|reading| reading.vertebrae.clone()).collect();
    let (image, iliac_crests) = match &film.landmarks {
        FilmLandmarks::Corners { image, iliac_crests, .. } => (image, iliac_crests),
        FilmLandmarks::Placements { spacing_plane, scale_relative_sd, source, .. } => {
            warn_of_source(posture, *source, warnings);
            check_scale_sd(posture, *scale_relative_sd)?;
            check_lengths(film)?;
            let scale = LengthScale::stated(*spacing_plane, *scale_relative_sd);
            return Ok(PlacedFilm {
                readings,
                scale,
                iliac_normal: None,
                iliac_middle: None,
                iliac_tips: None,
            });
        }
    };
    let (readings, scale) = match image.scale() {
        Some(spacing) => {
            check_scale_sd(posture, spacing.relative_sd)?;
            check_lengths(film)?;
            check_body_sizes(film)?;
            (readings, LengthScale::of(&spacing))
        }
        None => scaled_from_pixels(posture, image, readings, warnings),
    };
    // A wrong scale makes crests too close, too: it is named first.
    if let Some(crests) = iliac_crests {
        check_crests(posture, image, crests)?;
    }
    let iliac_normal = iliac_crests.map(|crests| iliac_normal(image, crests));
    let per_mm = 1.0 / scale.units_per_mm;
    let iliac_middle = iliac_crests.map(|crests| crests.middle(image) * per_mm);
    let iliac_tips = iliac_crests
        .map(|crests| [crests.left, crests.right].map(|tip| image.frontal(tip) * per_mm));
    Ok(PlacedFilm { readings, scale, iliac_normal, iliac_middle, iliac_tips })
}

/// Readings in pixels, as if this spine had the typical length: no angle of this film depends on it. Rotations from another film do, so
/// that [`Outline::in_millimetres_of`] takes the erect film's length before films are compared.
fn scaled_from_pixels(
    posture: Posture,
    image: &ImageGeometry,
    mut placed: Vec<BTreeMap<Level, Placement>>,
    warnings: &mut Warnings,
) -> (Vec<BTreeMap<Level, Placement>>, LengthScale) {
    let stated = image.spacing.map(|spacing| fixed(spacing.aspect(), 3));
    let shape = match stated {
        Some(aspect) => format!("are {aspect} times as high as wide, as stated,"),
        None => "are assumed square".to_owned(),
    };
    let text = format!(
        "the film has no spacing: its pixels {shape} for angles, and lengths are not reported in millimetres"
    );
    warnings.film(WarningCode::NoSpacing, posture, text);
    let means = average(&placed);
    let (mut typical_mm, mut length_px) = (0.0, 0.0);
    let marked: Vec<(Level, Frontal)> = means.iter().map(|(&l, (p, _))| (l, p.location)).collect();
    for pair in marked.windows(2) {
        // Vertebrae without landmarks are skipped on both sides of the ratio.
        typical_mm += Morphometry::spacing_mm(pair[0].0, pair[1].0);
        length_px += pair[0].1.distance_mm(pair[1].1);
    }
    let units_per_mm =
        if typical_mm > 0.0 && length_px > 0.0 { length_px / typical_mm } else { 1.0 };
    for placement in placed.iter_mut().flat_map(BTreeMap::values_mut) {
        placement.location = placement.location * (1.0 / units_per_mm);
        if let Some(program) = &mut placement.program {
            program.location_mm /= units_per_mm;
        }
    }
    let scale = LengthScale {
        plane: SpacingPlane::Pixels,
        source: image.spacing.map(|spacing| spacing.source),
        relative_sd: None,
        units_per_mm,
    };
    (placed, scale)
}

fn iliac_normal(image: &ImageGeometry, crests: IliacCrests) -> Angle {
    normal_tilt(image.frontal(crests.left) - image.frontal(crests.right))
}
