//! Lengths of a spine and sizes of its bodies that a patient can have, and what other ones suggest.
//!
//! A spine is judged by its marked vertebrae: the length along their midpoints over the length of the same vertebrae of a typical
//! adult ([`Morphometry`]), with limits for the length from L4 to T2. Films in pixels are not judged.

use std::fmt;

use super::bodies::{ReadBodies, median};
use super::{Film, FilmLandmarks, MeasureError, MeasureFault, SpacingPlane};
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

/// The length by the median step may differ from the length of all steps by this factor: proportions of spines vary (assumption).
const NEAR: f64 = 1.25;

/// The probable unit of lengths that are wrong by this factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SuspectedUnit {
    /// Metres.
    Metres,
    /// Centimetres.
    Centimetres,
    /// Inches.
    Inches,
    /// Micrometres.
    Micrometres,
    /// Numbers of pixels.
    Pixels,
}

impl SuspectedUnit {
    /// The unit in which a length is nearest to the length of a typical adult; `None` where no unit is near.
    fn of(ratio: f64) -> Option<Self> {
        let units = [
            (Self::Metres, 1000.0),
            (Self::Centimetres, 10.0),
            (Self::Inches, 25.4),
            (Self::Micrometres, 0.001),
        ];
        let off = |factor: f64| (ratio * factor).ln().abs();
        let nearest = units.into_iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
        // A child's spine is half as long as an adult's.
        let unit = nearest.filter(|&(_, factor)| off(factor) < 0.9).map(|(unit, _)| unit);
        // Pixels of films are 0.07 to 0.6 mm wide.
        unit.or_else(|| (1.5..15.0).contains(&ratio).then_some(Self::Pixels))
    }
}

impl fmt::Display for SuspectedUnit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Metres => "metres",
            Self::Centimetres => "centimetres",
            Self::Inches => "inches",
            Self::Micrometres => "micrometres",
            Self::Pixels => "numbers of pixels",
        })
    }
}

/// What was measured of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Measured {
    /// The spine from one vertebra to another along its midpoints.
    Spine([Level; 2]),
    /// The bodies.
    Bodies,
}

/// A length on a film against the same of a typical adult.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSize {
    measured: Measured,
    /// In millimetres; for bodies, the median size over the size of a typical adult.
    length: f64,
    /// Length or size over the same of a typical adult.
    ratio: f64,
    limits: [f64; 2],
    /// Whether the lengths come from a picture and its spacing; else they were given.
    by_spacing: bool,
}

impl FilmSize {
    /// The probable unit of lengths that are wrong by this factor.
    #[must_use]
    pub fn suspected(&self) -> Option<SuspectedUnit> {
        SuspectedUnit::of(self.ratio)
    }

    /// What was measured: a length in millimetres, or the size of bodies over the size of a typical adult.
    #[must_use]
    pub const fn value(&self) -> f64 {
        self.length
    }

    /// The limit that it misses.
    #[must_use]
    pub fn limit(&self) -> f64 {
        let [least, most] = self.limits;
        if self.length < least { least } else { most }
    }

    fn is_outside(&self) -> bool {
        !(self.limits[0]..=self.limits[1]).contains(&self.length)
    }

    /// Whether it misses a limit, and another measure of it is beyond that limit too, or near it.
    fn is_on_one_side(&self, other: f64) -> bool {
        let [least, most] = self.limits;
        let is_short = self.length < least && other < NEAR * least;
        is_short || self.length > most && NEAR * other > most
    }

    /// What may be wrong.
    fn cause(&self) -> String {
        let given = if self.by_spacing { "the spacing or the landmarks" } else { "the locations" };
        match self.suspected() {
            Some(SuspectedUnit::Pixels) if self.by_spacing => {
                "the spacing may be too large, or the landmarks may be numbers of pixels where millimetres were meant".to_owned()
            }
            Some(unit) => format!("{given} look like {unit}, not millimetres"),
            None if self.by_spacing => {
                "the scale may belong to a picture of another size, or the radius of a ball may have been given for its diameter".to_owned()
            }
            None => "the locations may be in another unit than millimetres".to_owned(),
        }
    }

    /// What to do about it.
    pub(super) const fn help(&self) -> &'static str {
        if self.by_spacing {
            "correct the spacing of this film (`import` takes it as --spacing), the diameter of its ball, or the unit of its landmarks; without a spacing, angles are measured all the same"
        } else {
            "give the locations in millimetres"
        }
    }

    /// In words, with the limits called `of`.
    fn words(&self, of: &str) -> String {
        let [least, most] = self.limits;
        match self.measured {
            Measured::Spine([inferior, superior]) => format!(
                "{inferior} to {superior} are {} along the spine, and {of} have {} to {} mm there: {}",
                millimetres(self.length),
                fixed(least, 0),
                fixed(most, 0),
                self.cause()
            ),
            Measured::Bodies => format!(
                "its vertebral bodies have {} times the size of a typical adult, and {of} have {least} to {most} times: {}",
                significant(self.length),
                self.cause()
            ),
        }
    }
}

impl fmt::Display for FilmSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words("patients"))
    }
}

fn millimetres(mm: f64) -> String {
    format!("{} mm", significant(mm))
}

/// Three digits at least.
fn significant(value: f64) -> String {
    match value {
        value if value >= 100.0 => fixed(value, 0),
        value if value >= 1.0 => fixed(value, 2),
        value => fixed(value, 4),
    }
}

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
