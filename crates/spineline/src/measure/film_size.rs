//! The size of a spine or its bodies on a film, against a typical adult's.

use std::fmt;

use crate::anatomy::{Level, named};
use crate::number::fixed;

/// The length by the median step may differ from the length of all steps by this factor: proportions of spines vary (assumption).
const NEAR: f64 = 1.25;

named! {
    /// The probable unit of lengths that are wrong by this factor.
    pub enum SuspectedUnit {
        /// Metres.
        Metres = "metres",
        /// Centimetres.
        Centimetres = "centimetres",
        /// Inches.
        Inches = "inches",
        /// Micrometres.
        Micrometres = "micrometres",
        /// Numbers of pixels.
        Pixels = "numbers of pixels",
    }
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

/// What was measured of a film.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measured {
    /// The spine from one vertebra to another along its midpoints.
    Spine([Level; 2]),
    /// The bodies.
    Bodies,
}

/// A length on a film against the same of a typical adult.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FilmSize {
    pub(super) measured: Measured,
    /// In millimetres; for bodies, the median size over the size of a typical adult.
    pub(super) length: f64,
    /// Length or size over the same of a typical adult.
    pub(super) ratio: f64,
    pub(super) limits: [f64; 2],
    /// Whether the lengths come from a picture and its spacing; else they were given.
    pub(super) by_spacing: bool,
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

    pub(super) fn is_outside(&self) -> bool {
        !(self.limits[0]..=self.limits[1]).contains(&self.length)
    }

    /// Whether it misses a limit, and another measure of it is beyond that limit too, or near it.
    pub(super) fn is_on_one_side(&self, other: f64) -> bool {
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
    pub(super) fn words(&self, of: &str) -> String {
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
