//! The measured spine of one film, and its vertebrae.

use nalgebra::DMatrix;

use super::{
    EndplateTilts, FilmLength, LengthScale, Noise, Placement, ProgramNoise, VertebraOrigin,
};
use crate::anatomy::{Level, Levels, Posture, named};
use crate::spatial::{Angle, Frontal};

/// Where a vertebra without landmarks was taken from, and how uncertain it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interpolation {
    /// The next marked vertebrae below and above it.
    pub between: [Level; 2],
    /// Standard deviation of a coordinate of its location.
    pub location_sd_mm: f64,
    /// Standard deviation of its tilt.
    pub tilt_sd: Angle,
}

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
    /// A vertebra with its mean over a number of readings.
    #[must_use]
    pub const fn of_mean(level: Level, mean: Placement, readings: usize) -> Self {
        let Placement { location, tilt, endplates, program, origin } = mean;
        Self { level, location, tilt, endplates, readings, interpolated: None, program, origin }
    }

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

/// Covariance of the errors of locations and tilts by corners that a program found, over the vertebrae of a film.
///
/// Locations in mm along the axes of `G`, tilts in rad; the errors of the frame itself, which the base gives, are not taken in.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedErrors {
    pub(super) levels: Vec<Level>,
    /// Rows of each level: left, cranial, tilt.
    pub(super) covariance: DMatrix<f64>,
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
    /// The vertebrae between which its amplitude is measured.
    pub amplitude_ends: AmplitudeEnds,
}

named! {
    /// The vertebrae between which the amplitude of a film is measured.
    #[default(Model)]
    pub enum AmplitudeEnds {
        /// The ends of the model, L4 and T2.
        Model = "l4_t2",
        /// T1 and L5 where a film shows both, else the ends of the model (the paper).
        ///
        /// Models end at L4 and T2, so that simulated films keep the tilt of the line between these.
        T1L5 = "t1_l5",
    }
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

    /// Lateral tilt of the line between two vertebrae ([`Outline::amplitude_levels`]) relative to the normal of the iliac line, or
    /// against L4's axis where no crest was marked: the amplitude of a bend [petit-2004]. Positive to the right.
    #[must_use]
    pub fn amplitude(&self) -> Angle {
        let [lower, upper] = self.ends_of_amplitude();
        let line = upper.location - lower.location;
        line.lateral_tilt() - self.iliac_normal.unwrap_or(Angle::ZERO)
    }

    /// The vertebrae between which the amplitude is measured, the lower one first.
    #[must_use]
    pub fn amplitude_levels(&self) -> [Level; 2] {
        self.ends_of_amplitude().map(|vertebra| vertebra.level)
    }

    fn ends_of_amplitude(&self) -> [&MeasuredVertebra; 2] {
        let marked = |level| self.others.iter().find(|vertebra| vertebra.level == level);
        let marked = match self.amplitude_ends {
            AmplitudeEnds::Model => None,
            AmplitudeEnds::T1L5 => marked(Level::L5).zip(marked(Level::T1)),
        };
        match marked {
            Some((lower, upper)) => [lower, upper],
            None => [&self.vertebrae[0], &self.vertebrae[self.vertebrae.len() - 1]],
        }
    }

    /// Length of the polygon through the midpoints.
    #[must_use]
    pub fn polygon_mm(&self) -> f64 {
        self.vertebrae.windows(2).map(|pair| pair[0].location.distance_mm(pair[1].location)).sum()
    }
}
