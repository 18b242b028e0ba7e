use std::collections::{BTreeMap, BTreeSet};

use rand_chacha::ChaCha12Rng;
use rand_distr::{Distribution, StandardNormal};
use serde::{Deserialize, Serialize};

use super::stream::stream;
use crate::analysis::{Analysis, Case};
use crate::anatomy::{FilmView, Level, Posture, named};
use crate::fault::faults;
use crate::measure::{
    CornerName, Corners, Film, FilmLandmarks, ImageGeometry, InterpolationError, Noise, Origin,
    Outline, Placement, ProgramCorners, Reading, ReadingSquares, VertebraLandmarks, seen_levels,
    shown_levels,
};
use crate::spatial::{Angle, Frontal, Pixel};

/// The noise of one reading.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LandmarkNoise {
    /// By the differences of the case's own readings; where it was read once, by the assumption for one careful reading
    /// ([`Noise::ONE_READING`]).
    #[default]
    Measured,
    /// Every coordinate of every corner has this standard deviation, in pixels of its film.
    Pixels(f64),
}

named! {
    /// Where the deviation of a reading comes from.
    pub enum NoiseSource {
        /// The standard deviation of the case's readings of this film, or, for corners, of all its films.
        Readings = "readings",
        /// The assumption for one careful reading, without repeats.
        Assumed = "assumed",
        /// The user.
        Given = "given",
    }
}

/// Standard deviation of one reading of one film.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct FilmNoise {
    /// The film.
    pub posture: Posture,
    /// Where it comes from.
    pub source: NoiseSource,
    /// The landmarks that are perturbed.
    pub landmarks: VertebraNoise,
    /// Corners of all readings that a program found: they move together, by their own covariance.
    pub program_corners: usize,
}

/// Standard deviation of a film's landmarks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum VertebraNoise {
    /// Corners and crests on a picture.
    Corners {
        /// Of a corner's column and of its row.
        sd_px: [f64; 2],
        /// The same in millimetres; `None` where the film has no spacing.
        sd_mm: Option<[f64; 2]>,
        /// Of an axis set by hand; `None` where it follows from the corners' deviation and the body's height.
        axis_sd: Option<Angle>,
    },
    /// Locations and tilts of another program.
    Placements {
        /// Of a coordinate of a location.
        location_sd_mm: f64,
        /// Of a tilt.
        tilt_sd: Angle,
    },
}

faults! {
    /// Noise that cannot be laid on a case.
    #[derive(Debug, Clone, PartialEq, thiserror::Error)]
    #[non_exhaustive]
    pub enum UncertaintyError {
        /// A deviation below zero, or none.
        #[error("the noise standard deviation is {sd_px} px and must be ≥ 0 px")]
        #[help("give a standard deviation in pixels, such as 3")]
        #[at(value = *sd_px, limit = 0.0)]
        Deviation {
            /// What was given.
            sd_px: f64,
        },
        /// Pixels of a film without a picture.
        #[error(
            "{posture} film: it has locations and tilts but no corners, so noise in pixels does not apply"
        )]
        #[help("use the measured noise")]
        #[at(film = FilmView::from(*posture))]
        NoPicture {
            posture: Posture,
        },
    }
}

/// A case whose landmarks can be perturbed again and again.
#[derive(Debug, Clone)]
pub(super) struct NoisyCase {
    case: Case,
    pub films: Vec<FilmNoise>,
    /// Of every film, the corners of every reading that a program found.
    program: Vec<Vec<Option<ProgramCorners>>>,
    /// Vertebrae between the ends of a film that it does not show, in the model or beyond.
    interpolated: Vec<(Posture, Level)>,
    /// Of a column and a row of a corner on the lateral film; zero where nothing was measured on it.
    lateral_sd_px: [f64; 2],
    seed: u64,
}

impl NoisyCase {
    /// Films, and the readings of each, in a fixed order: the numbers do not depend on the order of the case.
    pub fn new(
        case: &Case,
        nominal: &Analysis,
        noise: LandmarkNoise,
        seed: u64,
    ) -> Result<Self, UncertaintyError> {
        let mut case = case.clone();
        case.films.sort_by_key(|film| film.posture);
        for film in &mut case.films {
            // A copy moves with its original.
            *film = film.with_copies_as_one().into_owned();
            match &mut film.landmarks {
                FilmLandmarks::Corners { readings, .. } => readings.sort_by(|a, b| a.id.cmp(&b.id)),
                FilmLandmarks::Placements { readings, .. } => {
                    readings.sort_by(|a, b| a.id.cmp(&b.id))
                }
            }
        }
        if let Some(lateral) = &mut case.lateral {
            *lateral = lateral.with_copies_as_one();
            lateral.readings.sort_by(|a, b| a.id.cmp(&b.id));
        }
        let program: Vec<_> = case.films.iter().map(program_corners).collect();
        let mut films = case
            .films
            .iter()
            .zip(&nominal.movement.films)
            .map(|(film, posture)| film_noise(&case, film, &posture.outline, noise))
            .collect::<Result<Vec<FilmNoise>, _>>()?;
        for (film, corners) in films.iter_mut().zip(&program) {
            film.program_corners =
                corners.iter().flatten().map(|corners| corners.corners().len()).sum();
        }
        let levels = nominal.movement.levels();
        let interpolated = nominal.movement.readings.iter().flat_map(|film| {
            let seen = (film.posture, seen_levels(&film.readings));
            let shown = shown_levels(&seen, levels);
            let hidden = shown.iter().filter(|level| !seen.1.contains(level));
            hidden.map(|level| (film.posture, level)).collect::<Vec<_>>()
        });
        let lateral_sd_px = lateral_sd_px(&case, nominal, noise);
        let interpolated = interpolated.collect();
        Ok(Self { case, films, program, interpolated, lateral_sd_px, seed })
    }

    /// The case of one replicate, and errors of its interpolated vertebrae: every replicate has its own random stream.
    pub fn replicate(&self, index: u64) -> (Case, Vec<InterpolationError>) {
        let mut draw = Draw(stream(self.seed, &self.case.id, index));
        let mut case = self.case.clone();
        let films = case.films.iter_mut().zip(&self.films).zip(&self.program);
        for ((film, noise), program) in films {
            match (&mut film.landmarks, &noise.landmarks) {
                (
                    FilmLandmarks::Corners { image, iliac_crests, readings },
                    VertebraNoise::Corners { sd_px, axis_sd, .. },
                ) => {
                    for (reading, corners) in readings.iter_mut().zip(program) {
                        let found = corners.as_ref().map_or(&[][..], ProgramCorners::corners);
                        for (&level, landmark) in &mut reading.vertebrae {
                            let is_moved = |name| !found.contains(&(level, name));
                            move_landmarks(landmark, image, is_moved, *sd_px, *axis_sd, &mut draw);
                        }
                    }
                    move_together(image, readings, program, &mut draw);
                    for crest in iliac_crests.iter_mut().flat_map(|c| [&mut c.left, &mut c.right]) {
                        *crest = draw.pixel(*crest, *sd_px);
                    }
                }
                (
                    FilmLandmarks::Placements { readings, .. },
                    VertebraNoise::Placements { location_sd_mm, tilt_sd },
                ) => {
                    for place in readings.iter_mut().flat_map(|r| r.vertebrae.values_mut()) {
                        let off = Frontal::new(draw.normal(), draw.normal()) * *location_sd_mm;
                        place.location = place.location + off;
                        place.tilt = place.tilt + *tilt_sd * draw.normal();
                    }
                }
                _ => unreachable!("the noise of a film is made from its landmarks"),
            }
        }
        let error = |&(posture, level): &(Posture, Level)| InterpolationError {
            posture,
            level,
            deviations: [draw.normal(), draw.normal(), draw.normal()],
        };
        let errors = self.interpolated.iter().map(error).collect();
        // Last, so that the other films move as they do without a lateral film.
        let bodies = case.lateral.iter_mut().flat_map(|film| &mut film.readings);
        for body in bodies.flat_map(|reading| reading.vertebrae.values_mut()) {
            *body = body.points().map(|corner| draw.pixel(corner, self.lateral_sd_px)).into();
        }
        (case, errors)
    }
}

struct Draw(ChaCha12Rng);

impl Draw {
    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn pixel(&mut self, place: Pixel, [column_sd, row_sd]: [f64; 2]) -> Pixel {
        let (column, row) = (self.normal(), self.normal());
        Pixel::new(place.column_px + column_sd * column, place.row_px + row_sd * row)
    }
}

fn move_landmarks(
    landmark: &mut VertebraLandmarks,
    image: &ImageGeometry,
    is_moved: impl Fn(CornerName) -> bool,
    sd_px: [f64; 2],
    axis_sd: Option<Angle>,
    draw: &mut Draw,
) {
    if let Some(axis) = landmark.axis_clockwise {
        let sd = axis_sd.unwrap_or_else(|| equivalent_axis_sd(landmark, image, sd_px));
        landmark.axis_clockwise = Some(axis + sd * draw.normal());
    }
    for pedicle in landmark.pedicles.iter_mut().flatten() {
        *pedicle = draw.pixel(*pedicle, sd_px);
    }
    for name in CornerName::ALL.into_iter().filter(|&name| is_moved(name)) {
        let corner = name.of_mut(&mut landmark.corners);
        *corner = draw.pixel(*corner, sd_px);
    }
}

/// Moves the corners that a program found. Readings share its model, so that one corner has the same deviates in all of them.
fn move_together(
    image: &ImageGeometry,
    readings: &mut [Reading<VertebraLandmarks>],
    program: &[Option<ProgramCorners>],
    draw: &mut Draw,
) {
    let mut shared: BTreeMap<(Level, CornerName), [f64; 2]> = BTreeMap::new();
    for (reading, corners) in readings.iter_mut().zip(program) {
        let Some(corners) = corners else { continue };
        let own = corners.corners().iter();
        let deviates: Vec<[f64; 2]> = own
            .map(|&corner| *shared.entry(corner).or_insert_with(|| [draw.normal(), draw.normal()]))
            .collect();
        corners.move_by(image, &deviates, &mut reading.vertebrae);
        // Their noise is held at the case's, and must not be computed again.
        for landmark in reading.vertebrae.values_mut() {
            landmark.origins = Corners::all(Origin::Clicked);
        }
    }
}

/// The corners of every reading of a film that a program found.
fn program_corners(film: &Film) -> Vec<Option<ProgramCorners>> {
    let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { return Vec::new() };
    // Corners that were not completed count as clicked, as in the analysis, which warns of it.
    let of = |reading| ProgramCorners::of(image, Some(film.posture), reading).ok().flatten();
    readings.iter().map(of).collect()
}

/// Effect of the corners' standard deviation on the lateral tilt of the line through the endplates' centres: each centre is
/// the mean of two corners, so that their difference has the deviation of one corner.
fn equivalent_axis_sd(
    landmark: &VertebraLandmarks,
    image: &ImageGeometry,
    sd_px: [f64; 2],
) -> Angle {
    let corners = landmark.corners.map(|corner| image.frontal(corner));
    let axis = (corners.superior_left + corners.superior_right
        - corners.inferior_left
        - corners.inferior_right)
        * 0.5;
    let height = axis.norm_mm();
    let steps = image.steps();
    // Across the axis of the body.
    let across = [sd_px[0] * steps[0] * axis.z_mm, sd_px[1] * steps[1] * axis.y_mm];
    Angle::from_rad(across[0].hypot(across[1]) / (height * height))
}

fn film_noise(
    case: &Case,
    film: &Film,
    outline: &Outline,
    noise: LandmarkNoise,
) -> Result<FilmNoise, UncertaintyError> {
    let posture = film.posture;
    let image = match (&film.landmarks, noise) {
        (FilmLandmarks::Corners { image, .. }, _) => image,
        (FilmLandmarks::Placements { .. }, LandmarkNoise::Pixels(_)) => {
            return Err(UncertaintyError::NoPicture { posture });
        }
        (FilmLandmarks::Placements { readings, .. }, LandmarkNoise::Measured) => {
            return Ok(placement_noise(readings, outline));
        }
    };
    let steps = image.steps();
    let (source, sd_px, axis_sd) = match noise {
        LandmarkNoise::Pixels(sd_px) => {
            if !(sd_px.is_finite() && sd_px >= 0.0) {
                return Err(UncertaintyError::Deviation { sd_px });
            }
            (NoiseSource::Given, [sd_px; 2], None)
        }
        LandmarkNoise::Measured => match pooled_corners(case, image.scale().is_some()) {
            Some(sd) => (NoiseSource::Readings, steps.map(|step| sd / step), pooled_axes(case)),
            None => {
                // The crossing of a body's diagonals has half the deviation of a corner.
                let sd = 2.0 * outline.noise.location_mm * outline.scale.units_per_mm;
                (NoiseSource::Assumed, steps.map(|step| sd / step), Some(outline.noise.tilt))
            }
        },
    };
    let sd_mm = image.scale().map(|_| [sd_px[0] * steps[0], sd_px[1] * steps[1]]);
    let landmarks = VertebraNoise::Corners { sd_px, sd_mm, axis_sd };
    Ok(FilmNoise { posture, source, landmarks, program_corners: 0 })
}

/// Deviation of a corner of one reading of the lateral film.
fn lateral_sd_px(case: &Case, nominal: &Analysis, noise: LandmarkNoise) -> [f64; 2] {
    let Some((film, space)) = case.lateral.as_ref().zip(nominal.movement.space.as_ref()) else {
        return [0.0; 2];
    };
    if let LandmarkNoise::Pixels(sd_px) = noise {
        return [sd_px; 2];
    }
    let of_one = readings_per_level(&film.readings).sqrt();
    let sd = of_one * space.corner_sd_mm / space.alignment.scale;
    film.image.steps().map(|step| sd / step)
}

/// A film's deviation is for means over its readings; one reading has more.
fn placement_noise(readings: &[Reading<Placement>], outline: &Outline) -> FilmNoise {
    let of_means: Noise = outline.noise;
    let per_value = if of_means.is_measured() { readings_per_level(readings) } else { 1.0 };
    let root = per_value.sqrt();
    FilmNoise {
        posture: outline.posture,
        source: if of_means.is_measured() { NoiseSource::Readings } else { NoiseSource::Assumed },
        landmarks: VertebraNoise::Placements {
            location_sd_mm: of_means.location_mm * outline.scale.units_per_mm * root,
            tilt_sd: of_means.tilt * root,
        },
        program_corners: 0,
    }
}

/// How often a level is marked, mean over the levels.
fn readings_per_level<T>(readings: &[Reading<T>]) -> f64 {
    let marked: usize = readings.iter().map(|reading| reading.vertebrae.len()).sum();
    let levels: BTreeSet<Level> =
        readings.iter().flat_map(|reading| reading.vertebrae.keys().copied()).collect();
    marked as f64 / levels.len() as f64
}

/// Deviation of a corner's coordinate between the readings of one film, pooled over films, vertebrae and corners that persons placed;
/// over films with a spacing in millimetres, over those without in pixels. `None` where nothing was read twice.
fn pooled_corners(case: &Case, with_spacing: bool) -> Option<f64> {
    let mut pool = ReadingSquares::default();
    for film in &case.films {
        let FilmLandmarks::Corners { image, readings, .. } = &film.landmarks else { continue };
        if image.scale().is_some() != with_spacing {
            continue;
        }
        for landmarks in by_level(readings).values() {
            for corner in CornerName::ALL {
                let placed = || {
                    let placed =
                        landmarks.iter().filter(|(_, one)| corner.of(&one.origins).is_placed());
                    placed.map(|(by, one)| (*by, image.frontal(corner.of(&one.corners))))
                };
                pool.add(placed().map(|(observer, place)| (observer, place.y_mm)));
                pool.add(placed().map(|(observer, place)| (observer, place.z_mm)));
            }
        }
    }
    pool.spread().map(|found| found.variance.sqrt())
}

/// The same of axes set by hand.
fn pooled_axes(case: &Case) -> Option<Angle> {
    let mut pool = ReadingSquares::default();
    for film in &case.films {
        for landmarks in by_level(film.landmarks.corner_readings()).values() {
            let axes: Vec<(&str, Angle)> = landmarks
                .iter()
                .filter_map(|(observer, landmark)| Some((*observer, landmark.axis_clockwise?)))
                .collect();
            // Against one of them: the angles of a film held upside down would wrap.
            pool.add(axes.iter().map(|(by, axis)| (*by, (*axis - axes[0].1).wrapped().rad())));
        }
    }
    pool.spread().map(|found| Angle::from_rad(found.variance.sqrt()))
}

/// Marks of every level, with their observers.
fn by_level(
    readings: &[Reading<VertebraLandmarks>],
) -> BTreeMap<Level, Vec<(&str, &VertebraLandmarks)>> {
    let mut landmarks: BTreeMap<Level, Vec<(&str, &VertebraLandmarks)>> = BTreeMap::new();
    for reading in readings {
        for (&level, landmark) in &reading.vertebrae {
            landmarks.entry(level).or_default().push((&reading.id.observer, landmark));
        }
    }
    landmarks
}
