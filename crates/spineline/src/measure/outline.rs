use std::collections::{BTreeMap, BTreeSet};

use super::corners::normal_tilt;
use super::frame::body_shape;
use super::interpolation::interpolate;
use super::is_observer_code;
use super::lengths::check_lengths;
use super::means::average;
use super::outline_checks::{check_marked, warn_of_gaps, warn_of_interpolated, warn_of_source};
use super::placing::{program_corners, warn_of_unusable_ends};
use super::{
    EndplateTilts, Film, FilmLandmarks, FilmLength, FilmPlace, IliacCrests, ImageGeometry,
    Interpolation, LengthScale, MeasureError, MeasureFault, Noise, Placement, ProgramNoise,
    Reading, ReadingId, SharedErrors, Spacing, SpacingPlane, TiltRule, VertebraOrigin,
    common_levels, measure_readings, seen_levels, warn_of_shortened_chain,
};
use crate::anatomy::{FilmView, Level, Levels, Morphometry, Posture};
use crate::number::fixed;
use crate::spatial::{Angle, Frontal, Pixel};
use crate::warning::{WarningCode, Warnings};

/// One vertebra in the global frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredVertebra {
    /// Which one.
    pub level: Level,
    /// Midpoint, mean over the readings.
    pub location: Frontal,
    /// Tilt against L4, mean over the readings.
    pub tilt: Angle,
    /// Tilts of its endplates against L4, means over the readings; `None` where its corners are not known.
    pub endplates: Option<EndplateTilts>,
    /// Readings that marked it; none for an interpolated vertebra.
    pub readings: usize,
    /// For a vertebra that no reading marked: from what it was interpolated, and how uncertain it is.
    pub interpolated: Option<Interpolation>,
    /// What corners that a program found add to its noise; `None` where a person placed all of them.
    pub program: Option<ProgramNoise>,
    /// How its corners came about in all readings; `None` where they are not known, and for an interpolated vertebra.
    pub origin: Option<VertebraOrigin>,
}

impl MeasuredVertebra {
    /// The noise of an interpolated vertebra, or the noise that corners found by a program add.
    pub(crate) fn own_noise(&self) -> Option<Noise> {
        let interpolated = self.interpolated.map(|found| (found.location_sd_mm, found.tilt_sd));
        let own = interpolated.or(self.program.map(|found| (found.location_mm, found.tilt)));
        own.map(|(location_mm, tilt)| Noise { location_mm, tilt, tilt_degrees_of_freedom: None })
    }

    /// Whether some reading marked it.
    #[must_use]
    pub const fn is_measured(&self) -> bool {
        self.interpolated.is_none()
    }
}

/// The measured spine of one posture, in the global frame `G`.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Position of the patient.
    pub posture: Posture,
    /// The vertebrae of the model, caudal first: L4…T2, or the part of it that all films of the patient show ([`Levels`]).
    /// One that this film does not show between its neighbours is interpolated.
    pub vertebrae: Vec<MeasuredVertebra>,
    /// Marked levels that are not part of the model: L5, T1, and what another film of the patient does not show.
    pub others: Vec<MeasuredVertebra>,
    /// Lateral tilt of the normal of the iliac line in `G`; `None` where the crests were not marked.
    pub iliac_normal: Option<Angle>,
    /// Midpoint between the tips of the iliac crests; `None` where they were not marked.
    pub iliac_middle: Option<Frontal>,
    /// Tilt of the film's vertical in `G`; `None` for locations and tilts of another program, whose frame need not be upright.
    pub vertical: Option<Angle>,
    /// Tilt of L4 (of the base where that is another vertebra) on the film, which `G` has taken out.
    pub l4_on_film: Angle,
    /// Midpoint of L4 (of the base) in the film's own frame, which is the origin of `G`.
    pub l4_midpoint_on_film: Frontal,
    /// Deviation of the measured values.
    pub noise: Noise,
    /// Errors that vertebrae share whose corners a program found; `None` where a person placed all corners.
    pub shared_errors: Option<SharedErrors>,
    /// What its lengths are measured in.
    pub scale: LengthScale,
    /// Its length against the erect film's; locations are at the erect length, as far as the rule of lengths takes them there.
    pub length: FilmLength,
    /// Number of readings.
    pub readings: usize,
}

impl Outline {
    /// The vertebrae of the model.
    ///
    /// # Panics
    /// For an outline that was put together from other vertebrae than neighbours among L4 to T2.
    #[must_use]
    pub fn levels(&self) -> Levels {
        let ends = self.vertebrae.first().zip(self.vertebrae.last());
        let levels = ends.and_then(|(base, top)| Levels::between(base.level, top.level));
        levels.expect("an outline has neighbouring vertebrae of the model")
    }

    /// The vertebrae of the model that this film shows, with their places in it.
    pub fn measured(&self) -> impl Iterator<Item = (usize, &MeasuredVertebra)> {
        self.vertebrae.iter().enumerate().filter(|(_, vertebra)| vertebra.is_measured())
    }

    /// The vertebrae of the model that this film does not show, which are interpolated.
    pub fn interpolated(&self) -> impl Iterator<Item = (&MeasuredVertebra, &Interpolation)> {
        self.vertebrae.iter().filter_map(|v| Some((v, v.interpolated.as_ref()?)))
    }

    /// A vertebra of the model, or another one that was marked.
    #[must_use]
    pub fn vertebra(&self, level: Level) -> Option<&MeasuredVertebra> {
        self.vertebrae.iter().chain(&self.others).find(|vertebra| vertebra.level == level)
    }

    /// The noise of a vertebra that some reading marked: the noise of the film, or more where a program found its corners.
    #[must_use]
    pub fn noise_of(&self, vertebra: &MeasuredVertebra) -> Noise {
        vertebra.program.map_or(self.noise, |program| program.beside(self.noise))
    }

    /// The locations of the model's vertebrae.
    pub fn locations(&self) -> impl Iterator<Item = Frontal> {
        self.vertebrae.iter().map(|vertebra| vertebra.location)
    }

    /// The location of the model's top vertebra.
    #[must_use]
    pub fn top(&self) -> Frontal {
        self.vertebrae[self.vertebrae.len() - 1].location
    }

    /// Lateral tilt of the line from base to top (L4→T2) relative to the normal of the iliac line, or against L4's axis where no crest was marked.
    ///
    /// This is the amplitude of a bend [petit-2004], between the ends of the model. Positive to the right.
    #[must_use]
    pub fn amplitude(&self) -> Angle {
        self.top().lateral_tilt() - self.iliac_normal.unwrap_or(Angle::ZERO)
    }

    /// Length of the polygon through the midpoints.
    #[must_use]
    pub fn polygon_mm(&self) -> f64 {
        self.vertebrae.windows(2).map(|pair| pair[0].location.distance_mm(pair[1].location)).sum()
    }
}

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
    let readings = measure_readings(film, rule)?;
    let seen = [(film.posture, seen_levels(&readings))];
    let levels = common_levels(&seen)?;
    warn_of_shortened_chain(levels, &seen, warnings);
    outline_of(film, &readings, levels, rule, None, warnings)
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
    let PlacedFilm { readings: placed, scale, iliac_normal, iliac_middle } =
        place_film(film, readings, warnings)?;
    let on_film = average(&placed);
    let (base, _) = *on_film
        .get(&levels.base())
        .ok_or(MeasureFault::BaseMissing { lowest: Levels::HIGHEST_BASE }.at(posture))?;
    // The global frame: the base's (L4's) midpoint is the origin, and its own axis is +Z.
    let mut in_global: BTreeMap<Level, MeasuredVertebra> = on_film
        .iter()
        .map(|(&level, &(placement, readings))| {
            let location = (placement.location - base.location).rotated(-base.tilt);
            let tilt = (placement.tilt - base.tilt).wrapped();
            let vertebra = MeasuredVertebra {
                level,
                location,
                tilt,
                endplates: placement.endplates.map(|tilts| tilts.against(base.tilt)),
                readings,
                interpolated: None,
                program: placement.program,
                origin: placement.origin,
            };
            (level, vertebra)
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
    if let Some(normal) = iliac_normal.filter(|normal| normal.abs() > Angle::from_deg(60.0)) {
        let text = format!(
            "the angle between the iliac line and {} is {}: the left and right crests may be exchanged",
            levels.base(),
            normal.abs().text(0)
        );
        warnings.film(WarningCode::IliacLineUnusual, posture, text);
    }
    warn_of_gaps(posture, &vertebrae, placed.len(), warnings);
    Ok(Outline {
        posture,
        others: in_global.into_values().filter(|v| levels.index_of(v.level).is_none()).collect(),
        vertebrae,
        iliac_normal,
        iliac_middle: iliac_middle.map(|middle| (middle - base.location).rotated(-base.tilt)),
        vertical: matches!(film.landmarks, FilmLandmarks::Corners { .. }).then(|| -base.tilt),
        l4_on_film: base.tilt,
        l4_midpoint_on_film: base.location,
        noise,
        shared_errors,
        scale,
        length: FilmLength::ERECT,
        readings: placed.len(),
    })
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
            return Ok(PlacedFilm { readings, scale, iliac_normal: None, iliac_middle: None });
        }
    };
    if let Some(crests) = iliac_crests {
        check_crests(posture, image, crests)?;
    }
    let iliac_normal = iliac_crests.map(|crests| iliac_normal(image, crests));
    let (readings, scale) = match image.scale() {
        Some(spacing) => {
            check_scale_sd(posture, spacing.relative_sd)?;
            check_lengths(film)?;
            check_body_sizes(film)?;
            (readings, LengthScale::of(&spacing))
        }
        None => scaled_from_pixels(posture, image, readings, warnings),
    };
    let per_mm = 1.0 / scale.pixels_per_mm.unwrap_or(1.0);
    let iliac_middle = iliac_crests
        .map(|crests| (image.frontal(crests.left) + image.frontal(crests.right)) * (0.5 * per_mm));
    Ok(PlacedFilm { readings, scale, iliac_normal, iliac_middle })
}

pub(super) fn check_spacing(posture: Posture, image: &ImageGeometry) -> Result<(), MeasureError> {
    check_pixels(posture.into(), image.spacing)?;
    image.check_size().map_err(|fault| MeasureFault::FilmTooLarge { fault }.at(posture))
}

/// Refuses distances between pixels that no film has.
pub(super) fn check_pixels(film: FilmView, spacing: Option<Spacing>) -> Result<(), MeasureError> {
    let Some(spacing) = spacing else { return Ok(()) };
    for (direction, value) in [("column", spacing.column_mm), ("row", spacing.row_mm)] {
        if !Spacing::is_possible(value) {
            return Err(MeasureFault::Spacing { direction, value }.at(film));
        }
    }
    Ok(())
}

/// Refuses a standard deviation of a scale that is below zero or says that the scale is not known.
fn check_scale_sd(posture: Posture, relative_sd: Option<f64>) -> Result<(), MeasureError> {
    let most = LengthScale::MAX_RELATIVE_SD;
    match relative_sd.filter(|sd| !(0.0..=most).contains(sd)) {
        Some(value) => Err(MeasureFault::ScaleSd { value, most }.at(posture)),
        None => Ok(()),
    }
}

/// Widths and heights of vertebral bodies on films, from small children to the largest adults on a film magnified by
/// half, with a wide margin (assumption): what lies outside is an error of the scale or of a corner.
const BODY_WIDTHS_MM: [f64; 2] = [5.0, 150.0];
const BODY_HEIGHTS_MM: [f64; 2] = [2.0, 100.0];

/// Refuses bodies of a size that no vertebra has, on a film with a scale.
fn check_body_sizes(film: &Film) -> Result<(), MeasureError> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return Ok(()) };
    for reading in readings {
        // No result needs L5 or T1, which are left out where they are unusable.
        for (&level, landmark) in
            reading.vertebrae.iter().filter(|(l, _)| l.model_index().is_some())
        {
            let [height_mm, width_mm] = body_shape(image, landmark);
            for (side, size_mm, [least_mm, most_mm]) in
                [("wide", width_mm, BODY_WIDTHS_MM), ("high", height_mm, BODY_HEIGHTS_MM)]
            {
                if !(least_mm..=most_mm).contains(&size_mm) {
                    let fault = MeasureFault::BodySize { level, side, size_mm, least_mm, most_mm };
                    return Err(fault.at(FilmPlace::reading(film.posture, &reading.id)));
                }
            }
        }
    }
    Ok(())
}

pub(super) fn check_readings<T>(
    posture: Posture,
    readings: &[Reading<T>],
) -> Result<(), MeasureError> {
    if readings.is_empty() {
        return Err(MeasureFault::NoReading.at(posture));
    }
    check_observers(posture.into(), readings)
}

/// Every reading has an observer that is a code, and no reading has the observer and repeat of an earlier one.
pub(super) fn check_observers<T>(
    film: FilmView,
    readings: &[Reading<T>],
) -> Result<(), MeasureError> {
    if let Some(one) = readings.iter().find(|one| !is_observer_code(&one.id.observer)) {
        return Err(MeasureFault::Observer { id: one.id.clone() }.at(film));
    }
    let mut seen = BTreeSet::new();
    match readings.iter().find(|one| !seen.insert(&one.id)) {
        Some(twice) => Err(MeasureFault::DuplicateReading { id: twice.id.clone() }.at(film)),
        None => Ok(()),
    }
}

pub(super) fn check_placements(
    posture: Posture,
    readings: &[Reading<Placement>],
) -> Result<(), MeasureError> {
    for reading in readings {
        for (&level, placement) in &reading.vertebrae {
            if !(placement.location.is_finite() && placement.tilt.rad().is_finite()) {
                return Err(MeasureFault::NotFinite.at(FilmPlace::vertebra(
                    posture,
                    &reading.id,
                    level,
                )));
            }
        }
    }
    Ok(())
}

/// Readings in pixels, as if this spine had the typical length: no angle depends on it.
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
    let pixels_per_mm =
        if typical_mm > 0.0 && length_px > 0.0 { length_px / typical_mm } else { 1.0 };
    for placement in placed.iter_mut().flat_map(BTreeMap::values_mut) {
        placement.location = placement.location * (1.0 / pixels_per_mm);
        if let Some(program) = &mut placement.program {
            program.location_mm /= pixels_per_mm;
        }
    }
    let scale = LengthScale {
        plane: SpacingPlane::Pixels,
        source: image.spacing.map(|spacing| spacing.source),
        relative_sd: None,
        pixels_per_mm: Some(pixels_per_mm),
    };
    (placed, scale)
}

/// Crests must lie on the picture, apart, and on their sides.
fn check_crests(
    posture: Posture,
    image: &ImageGeometry,
    crests: &IliacCrests,
) -> Result<(), MeasureError> {
    const MIN_DISTANCE_MM: f64 = 50.0;
    let outside = [crests.left, crests.right].into_iter().find(|&crest| !image.contains(crest));
    if let Some(Pixel { column_px, row_px }) = outside {
        let (columns, rows) = (image.columns, image.rows);
        return Err(MeasureFault::CrestOffImage { column_px, row_px, columns, rows }.at(posture));
    }
    let apart_mm = image.frontal(crests.left).distance_mm(image.frontal(crests.right));
    // Without a spacing, how far apart they are says nothing.
    if (image.scale().is_some() && apart_mm < MIN_DISTANCE_MM) || apart_mm == 0.0 {
        return Err(MeasureFault::Crests { apart_mm, limit_mm: MIN_DISTANCE_MM }.at(posture));
    }
    Ok(())
}

fn iliac_normal(image: &ImageGeometry, crests: IliacCrests) -> Angle {
    normal_tilt(image.frontal(crests.left) - image.frontal(crests.right))
}

/// The identity of a reading in errors and tests.
impl ReadingId {
    /// An identity from its parts.
    #[must_use]
    pub fn new(observer: impl Into<String>, repeat: u32) -> Self {
        Self { observer: observer.into(), repeat }
    }
}
