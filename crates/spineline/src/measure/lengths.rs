//! Lengths of a spine and sizes of its bodies that a patient can have, and what other ones suggest.
//!
//! A spine is judged by its marked vertebrae: the length along their midpoints over the length of the same vertebrae of a typical
//! adult ([`Morphometry`]), with limits for the length from L4 to T2. Films in pixels are not judged.

use super::bodies::{ReadBodies, median};
use super::film_size::Measured;
use super::{Film, FilmLandmarks, FilmSize, MeasureError, MeasureFault, SpacingPlane};
use crate::anatomy::{Level, Morphometry};
use crate::number::fixed;
use crate::spatial::Frontal;
use crate::warning::{WarningCode, Warnings};

/// Lengths from L4 to T2 along the midpoints that a patient can have: a newborn has about 160 mm, and the tallest
/// person ever measured had about 620 mm, which a film magnifies to 720 mm (assumption, from the growth of the spine).
const POSSIBLE_MM: [f64; 2] = [120.0, 750.0];

/// Lengths from L4 to T2 that patients usually have, from the second year of life to the tallest adults on magnified films. Adolescents with
/// scoliosis have 389 ± 50 mm [jalalian-loa].
const USUAL_MM: [f64; 2] = [200.0, 550.0];

/// Possible and usual sizes of vertebral bodies over the sizes of a typical adult [panjabi-1991], median of a film. Wider
/// than the limits of lengths, because bodies are slender or stout too.
const POSSIBLE_BODIES: [f64; 2] = [0.25, 2.4];
const USUAL_BODIES: [f64; 2] = [0.45, 1.7];

/// Width over height of the bodies over the same ratio of a typical adult, median of a film. Above this limit, or below its inverse, pixels
/// may have another shape than stated. Of 433 erect films [wu-boostnet-2017] 6 exceed it, and none is below its inverse.
const MAX_STRETCH: f64 = 1.5;

/// Vertebrae from which a length or a median is judged: fewer say little.
const MIN_VERTEBRAE: usize = 4;

/// The vertebrae of a film in millimetres, as far as their sizes are judged.
pub(super) struct FilmSizes {
    /// Midpoints, means over the readings, caudal first.
    midpoints: Vec<(Level, Frontal)>,
    /// Width and height of every body over the same of a typical adult.
    bodies: Vec<[f64; 2]>,
    by_spacing: bool,
    has_millimetres: bool,
}

impl FilmSizes {
    /// Of a frontal film.
    pub fn of_film(film: &Film) -> Self {
        match &film.landmarks {
            FilmLandmarks::Corners { image, .. } => {
                let typical_width_mm =
                    |of: &Morphometry| 0.5 * (of.superior_width_mm + of.inferior_width_mm);
                Self::of_bodies(
                    &ReadBodies::of_film(film),
                    image.scale().is_some(),
                    typical_width_mm,
                )
            }
            FilmLandmarks::Placements { spacing_plane, readings, .. } => {
                let placed = readings.iter().flat_map(|reading| &reading.vertebrae);
                Self {
                    midpoints: means(placed.map(|(&level, placement)| (level, placement.location))),
                    bodies: Vec::new(),
                    by_spacing: false,
                    has_millimetres: *spacing_plane != SpacingPlane::Pixels,
                }
            }
        }
    }

    /// Of the bodies of a film; `typical_width_mm` is what a typical body shows across on its view.
    pub fn of_bodies(
        readings: &[ReadBodies<'_>],
        has_millimetres: bool,
        typical_width_mm: impl Fn(&Morphometry) -> f64,
    ) -> Self {
        let all = || readings.iter().flat_map(|reading| &reading.bodies);
        let bodies = all().map(|(level, body)| {
            let typical = Morphometry::of(*level);
            let width = body.mean_width_mm() / typical_width_mm(&typical);
            [width, body.height_mm() / typical.body_height_mm]
        });
        let centre = |corners: [Frontal; 4]| {
            corners.into_iter().fold(Frontal::default(), |sum, corner| sum + corner * 0.25)
        };
        Self {
            bodies: bodies.collect(),
            midpoints: means(all().map(|(level, body)| (*level, centre(body.points())))),
            by_spacing: true,
            has_millimetres,
        }
    }

    /// The first length outside of its limits.
    fn outside(&self, spine_mm: [f64; 2], bodies: [f64; 2]) -> Option<FilmSize> {
        if !self.has_millimetres {
            return None;
        }
        self.spine(spine_mm).or_else(|| self.bodies(bodies))
    }

    /// The spine, where it is longer or shorter than the limits.
    fn spine(&self, limits_mm: [f64; 2]) -> Option<FilmSize> {
        let (first, last) = (self.midpoints.first()?, self.midpoints.last()?);
        if self.midpoints.len() < MIN_VERTEBRAE {
            return None;
        }
        let steps = self.midpoints.windows(2).map(|pair| {
            [pair[0].1.distance_mm(pair[1].1), Morphometry::spacing_mm(pair[0].0, pair[1].0)]
        });
        let typical_mm = Morphometry::spacing_mm(first.0, last.0);
        let length: f64 = steps.clone().map(|[step_mm, _]| step_mm).sum();
        // One vertebra that lies elsewhere makes a spine long, but not its median step.
        let by_steps =
            typical_mm * median(steps.map(|[step_mm, typical_mm]| step_mm / typical_mm).collect());
        let share = typical_mm / Morphometry::spacing_mm(Level::L4, Level::T2);
        Some(FilmSize {
            measured: Measured::Spine([first.0, last.0]),
            length,
            ratio: length / typical_mm,
            limits: limits_mm.map(|mm| mm * share),
            by_spacing: self.by_spacing,
        })
        .filter(|size| size.is_on_one_side(by_steps))
    }

    /// The bodies, where they are larger or smaller than the limits.
    fn bodies(&self, limits: [f64; 2]) -> Option<FilmSize> {
        let sizes: Vec<f64> =
            self.bodies.iter().map(|[width, height]| (width * height).sqrt()).collect();
        let ratio = (!sizes.is_empty()).then(|| median(sizes))?;
        let by_spacing = self.by_spacing;
        let size =
            FilmSize { measured: Measured::Bodies, length: ratio, ratio, limits, by_spacing };
        size.is_outside().then_some(size)
    }

    /// The first length that no patient has.
    pub fn impossible(&self) -> Option<FilmSize> {
        self.outside(POSSIBLE_MM, POSSIBLE_BODIES)
    }

    /// What is doubtful: its code and words.
    pub fn doubts(&self) -> Vec<(WarningCode, String)> {
        let unusual = self.outside(USUAL_MM, USUAL_BODIES);
        let unusual = unusual.map(|size| {
            let text = format!("{}; check the scale of the film", size.words("patients usually"));
            (WarningCode::LengthUnusual, text)
        });
        let stretched = self.stretch().filter(|stretch| stretch.ln().abs() > MAX_STRETCH.ln());
        let stretched = stretched.map(|stretch| {
            let text = format!(
                "width over height of its vertebral bodies is {} times the ratio of a typical adult (limits {} and {MAX_STRETCH}): the pixels may have another shape than stated, which makes all angles wrong; check the spacing of columns and rows",
                fixed(stretch, 2),
                fixed(1.0 / MAX_STRETCH, 2)
            );
            (WarningCode::BodiesStretched, text)
        });
        unusual.into_iter().chain(stretched).collect()
    }

    /// Width over height of the bodies over the same ratio of a typical adult: their median.
    fn stretch(&self) -> Option<f64> {
        let shapes: Vec<f64> = self.bodies.iter().map(|[width, height]| width / height).collect();
        (shapes.len() >= MIN_VERTEBRAE).then(|| median(shapes))
    }
}

/// Mean place of every level, caudal first.
fn means(places: impl Iterator<Item = (Level, Frontal)>) -> Vec<(Level, Frontal)> {
    let mut sums: std::collections::BTreeMap<Level, (Frontal, f64)> = Default::default();
    for (level, place) in places {
        let (sum, count) = sums.entry(level).or_default();
        *sum = *sum + place;
        *count += 1.0;
    }
    sums.into_iter().map(|(level, (sum, count))| (level, sum * (1.0 / count))).collect()
}

/// Refuses a frontal film with lengths that no patient has.
pub(super) fn check_lengths(film: &Film) -> Result<(), MeasureError> {
    match FilmSizes::of_film(film).impossible() {
        Some(size) => Err(MeasureFault::Length { size }.at(film.posture)),
        None => Ok(()),
    }
}

/// Warns of a frontal film with lengths that few patients have.
pub(super) fn warn_of_lengths(film: &Film, warnings: &mut Warnings) {
    for (code, text) in FilmSizes::of_film(film).doubts() {
        warnings.film(code, film.posture, text);
    }
}
