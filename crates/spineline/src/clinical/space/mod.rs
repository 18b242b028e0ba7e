//! Numbers of the erect spine in space, from the frontal and the lateral film.

mod numbers;

pub use numbers::{Dimension, SpatialNumber};

use super::{ClinicalCurve, CobbEnds};
use crate::anatomy::{Level, Region, named};
use crate::measure::{AxialRotation, SpatialOutline, SpatialVertebra};
use crate::spatial::{Angle, Vec3};

named! {
    /// A part of the spine whose sagittal angle is measured.
    pub enum SagittalPart {
        /// Kyphosis from T5 to T12.
        KyphosisT5T12 = "kyphosis_t5_t12",
        /// Kyphosis from T1 to T12.
        KyphosisT1T12 = "kyphosis_t1_t12",
        /// Lordosis from L1 to L5. The landmarks do not include the endplate of S1.
        LordosisL1L5 = "lordosis_l1_l5",
    }
}

impl SagittalPart {
    /// Names of the angles between endplates and between axes, in files and in words.
    const fn names(self) -> [(&'static str, &'static str); 2] {
        match self {
            Self::KyphosisT5T12 => [
                ("kyphosis_t5_t12_endplates", "kyphosis T5–T12, endplates"),
                ("kyphosis_t5_t12_axes", "kyphosis T5–T12, axes"),
            ],
            Self::KyphosisT1T12 => [
                ("kyphosis_t1_t12_endplates", "kyphosis T1–T12, endplates"),
                ("kyphosis_t1_t12_axes", "kyphosis T1–T12, axes"),
            ],
            Self::LordosisL1L5 => [
                ("lordosis_l1_l5_endplates", "lordosis L1–L5, endplates"),
                ("lordosis_l1_l5_axes", "lordosis L1–L5, axes"),
            ],
        }
    }

    /// The lower and the upper end vertebra.
    #[must_use]
    pub const fn ends(self) -> [Level; 2] {
        match self {
            Self::KyphosisT5T12 => [Level::T12, Level::T5],
            Self::KyphosisT1T12 => [Level::T12, Level::T1],
            Self::LordosisL1L5 => [Level::L5, Level::L1],
        }
    }

    /// Which turn from the lower to the upper vertebra is positive.
    const fn sense(self) -> f64 {
        match self {
            Self::KyphosisT5T12 | Self::KyphosisT1T12 => 1.0,
            Self::LordosisL1L5 => -1.0,
        }
    }
}

/// A number with its standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithSd<T> {
    /// The number.
    pub value: T,
    /// Its standard deviation.
    pub sd: T,
}

/// A kyphosis or lordosis, positive where it is one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SagittalAngle {
    /// Which.
    pub part: SagittalPart,
    /// 2-D: superior endplate of the upper against inferior endplate of the lower vertebra on the lateral film, as clinicians
    /// measure.
    pub endplates_2d: WithSd<Angle>,
    /// 2-D: between the axes of both vertebrae on the lateral film.
    pub axes_2d: WithSd<Angle>,
    /// 3-D: difference of the pitches of both axes in space.
    pub axes_3d: WithSd<Angle>,
}

/// The plane of maximum curvature of one curve.
///
/// # Definition
/// Of all vertical planes the one on which the axes of the curve's end vertebrae, as projected, make the largest angle. Vertical
/// is the films'.
///
/// # References
/// [stokes-1994].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaximumCurvature {
    /// Region of the curve.
    pub region: Region,
    /// Its end vertebrae.
    pub ends: CobbEnds,
    /// 2-D: the angle between the axes on the erect film.
    pub frontal_2d: WithSd<Angle>,
    /// 2-D: the same on the lateral film.
    pub lateral_2d: WithSd<Angle>,
    /// 3-D: the angle in the plane of maximum curvature.
    pub angle_3d: WithSd<Angle>,
    /// 3-D: the direction of the convexity in that plane: 0 to the front, 90° to the patient's left, 180° to the back.
    pub convexity_3d: WithSd<Angle>,
}

/// Length of the polygon through the midpoints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpinalLength {
    /// The lowest and the highest vertebra on both films.
    pub ends: [Level; 2],
    /// 2-D: on the erect film; the deviation by landmarks.
    pub length_2d_mm: WithSd<f64>,
    /// 3-D; the deviation by landmarks and the alignment of the lateral film, without the scale of the erect film.
    pub length_3d_mm: WithSd<f64>,
}

/// Numbers of the erect spine in space. Each names what it is: 2-D on one film, 3-D in space.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialMeasures {
    /// Kyphosis and lordosis, as far as both films show their end vertebrae.
    pub sagittal: Vec<SagittalAngle>,
    /// One per clinical curve whose end vertebrae are on both films.
    pub curves: Vec<MaximumCurvature>,
    /// Axial rotations of the apices of clinical curves whose pedicles are marked.
    pub apices: Vec<(Region, AxialRotation)>,
    /// Length of the spine.
    pub length: SpinalLength,
}

impl SpatialMeasures {
    /// Of the spine on both films, with its clinical curves and the axial rotations that pedicles give.
    #[must_use]
    pub fn of(space: &SpatialOutline, curves: &[ClinicalCurve], axial: &[AxialRotation]) -> Self {
        let parts = SagittalPart::ALL.into_iter();
        Self {
            sagittal: parts.filter_map(|part| sagittal_angle(space, part)).collect(),
            curves: curves.iter().filter_map(|curve| maximum_curvature(space, curve)).collect(),
            apices: curves
                .iter()
                .filter_map(|curve| {
                    let found = axial.iter().find(|found| found.level == curve.apex)?;
                    Some((curve.region, *found))
                })
                .collect(),
            length: spinal_length(space),
        }
    }

    /// A kyphosis or lordosis.
    #[must_use]
    pub fn sagittal(&self, part: SagittalPart) -> Option<&SagittalAngle> {
        self.sagittal.iter().find(|angle| angle.part == part)
    }

    /// The curve of a region.
    #[must_use]
    pub fn curve(&self, region: Region) -> Option<&MaximumCurvature> {
        self.curves.iter().find(|curve| curve.region == region)
    }
}

fn sagittal_angle(space: &SpatialOutline, part: SagittalPart) -> Option<SagittalAngle> {
    let place = |level: Level| space.vertebrae.iter().position(|v| v.level == level);
    let [low, high] = part.ends();
    let (i, j) = place(low).zip(place(high))?;
    let (low, high) = (&space.vertebrae[i], &space.vertebrae[j]);
    let turn = |low: Angle, high: Angle, sd: Angle| {
        let value = (high - low).wrapped() * part.sense();
        WithSd { value, sd }
    };
    let covariance = space.pitch_covariance();
    let variance = covariance[(i, i)] + covariance[(j, j)] - 2.0 * covariance[(i, j)];
    let endplate_sd = together(low.endplate_sd, high.endplate_sd);
    let lateral_sd = together(low.lateral_sd, high.lateral_sd);
    let sd = Angle::from_rad(variance.max(0.0).sqrt());
    Some(SagittalAngle {
        part,
        endplates_2d: turn(low.endplates[1], high.endplates[0], endplate_sd),
        axes_2d: turn(low.lateral_pitch, high.lateral_pitch, lateral_sd),
        axes_3d: turn(low.orientation.pitch, high.orientation.pitch, sd),
    })
}

/// Standard deviation of a difference.
fn together(low: Angle, high: Angle) -> Angle {
    Angle::from_rad(low.rad().hypot(high.rad()))
}

/// The angles of the axes of a curve's ends on both films: lower and upper on the erect film, lower and upper on the lateral one.
type EndAngles4 = [Angle; 4];

fn maximum_curvature(space: &SpatialOutline, curve: &ClinicalCurve) -> Option<MaximumCurvature> {
    let low = space.vertebra(curve.ends.inferior)?;
    let high = space.vertebra(curve.ends.superior)?;
    let angles =
        [low.orientation.tilt, high.orientation.tilt, low.lateral_pitch, high.lateral_pitch];
    let largest = largest_angle(&angles);
    let turn_sd = space.alignment.turn_sd();
    // Four errors of landmarks, and the turn of the lateral film, which both of its angles share.
    let errors: [EndAngles4; 5] = [
        [low.tilt_sd, Angle::ZERO, Angle::ZERO, Angle::ZERO],
        [Angle::ZERO, high.tilt_sd, Angle::ZERO, Angle::ZERO],
        [Angle::ZERO, Angle::ZERO, low.lateral_sd, Angle::ZERO],
        [Angle::ZERO, Angle::ZERO, Angle::ZERO, high.lateral_sd],
        [Angle::ZERO, Angle::ZERO, turn_sd, turn_sd],
    ];
    let mut variances = [0.0; 2];
    for error in errors {
        let [more, less] = [0.5 * STEP, -0.5 * STEP].map(|step| {
            let mut moved = angles;
            moved.iter_mut().zip(error).for_each(|(angle, sd)| *angle = *angle + sd * step);
            largest_angle(&moved)
        });
        for ((variance, more), less) in variances.iter_mut().zip(more).zip(less) {
            *variance += ((more - less).wrapped().rad() / STEP).powi(2);
        }
    }
    let in_space =
        |i: usize| WithSd { value: largest[i], sd: Angle::from_rad(variances[i].sqrt()) };
    let on_film = |low: Angle, high: Angle, sd: Angle| WithSd { value: (high - low).abs(), sd };
    Some(MaximumCurvature {
        region: curve.region,
        ends: curve.ends,
        frontal_2d: on_film(angles[0], angles[1], together(low.tilt_sd, high.tilt_sd)),
        lateral_2d: on_film(angles[2], angles[3], together(low.lateral_sd, high.lateral_sd)),
        angle_3d: in_space(0),
        convexity_3d: in_space(1),
    })
}

/// Part of a standard deviation over which rates are taken.
const STEP: f64 = 1e-3;

/// The largest angle of two axes on a vertical plane, and the direction of the convexity there.
fn largest_angle(&[low_tilt, high_tilt, low_pitch, high_pitch]: &EndAngles4) -> [Angle; 2] {
    // Slopes of both axes to the front and to the left.
    let slopes = |tilt: Angle, pitch: Angle| [pitch.rad().tan(), -tilt.rad().tan()];
    let (low, high) = (slopes(low_tilt, low_pitch), slopes(high_tilt, high_pitch));
    let on_plane = |azimuth: f64| {
        let (sin, cos) = azimuth.sin_cos();
        let angle =
            |slope: [f64; 2]| Angle::from_sin_cos(slope[0] * cos + slope[1] * sin, 1.0).rad();
        angle(high) - angle(low)
    };
    // The upper axis turns to the concave side. Small slopes give the plane in closed form; from there the maximum is near.
    let start = Angle::from_sin_cos(high[1] - low[1], high[0] - low[0]).rad();
    let (mut from, mut to) = (start - 1.0, start + 1.0);
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    while to - from > 1e-9 {
        let [a, b] = [to - GOLDEN * (to - from), from + GOLDEN * (to - from)];
        if on_plane(a) > on_plane(b) { to = b } else { from = a }
    }
    let azimuth = 0.5 * (from + to);
    let convexity = Angle::from_rad(azimuth + std::f64::consts::PI).wrapped();
    [Angle::from_rad(on_plane(azimuth)), convexity]
}

fn spinal_length(space: &SpatialOutline) -> SpinalLength {
    let all = &space.vertebrae;
    let last = all.len() - 1;
    let links: Vec<Vec3> = all.windows(2).map(|pair| pair[1].place_mm - pair[0].place_mm).collect();
    let frontal: Vec<Vec3> = links.iter().map(|link| Vec3::new(0.0, link.y, link.z)).collect();
    let units: Vec<Vec3> = links.iter().map(|link| link.normalize()).collect();
    // The scale stretches depths, the turn takes depth from height.
    let pairs = || links.iter().zip(&units);
    let rates = nalgebra::Vector2::<f64>::new(
        pairs().map(|(link, unit)| unit.x * link.x).sum(),
        pairs().map(|(link, unit)| -unit.x * link.z).sum(),
    );
    let alignment = (rates.transpose() * space.alignment.covariance * rates)[(0, 0)];
    let length = |links: &[Vec3], variance: f64| WithSd {
        value: links.iter().map(|link| link.norm()).sum(),
        sd: (landmark_variance_mm2(all, links) + variance).sqrt(),
    };
    SpinalLength {
        ends: [all[0].level, all[last].level],
        length_2d_mm: length(&frontal, 0.0),
        length_3d_mm: length(&links, alignment),
    }
}

/// Variance of the sum of the lengths of some links by the landmarks of the vertebrae between them.
fn landmark_variance_mm2(vertebrae: &[SpatialVertebra], links: &[Vec3]) -> f64 {
    let unit = |place: Option<usize>| {
        place.and_then(|i| links.get(i)).map_or_else(Vec3::zeros, |link| link.normalize())
    };
    let own = |(i, vertebra): (usize, &SpatialVertebra)| {
        let rate = unit(i.checked_sub(1)) - unit(Some(i));
        rate.component_mul(&vertebra.place_sd_mm).norm_squared()
    };
    vertebrae.iter().enumerate().map(own).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_curve_in_one_plane_is_found_in_that_plane() {
        // Two axes that stand at 15° to either side within a vertical plane.
        for (azimuth, size) in [(0.0, 15.0), (30.0, 15.0), (90.0, 20.0), (-135.0, 10.0)] {
            let (azimuth, size) = (Angle::from_deg(azimuth), Angle::from_deg(size));
            let seen = |tilt: Angle| {
                let (sin, cos) = azimuth.rad().sin_cos();
                let slope = tilt.rad().tan();
                let tilt = Angle::from_sin_cos(-slope * sin, 1.0);
                (tilt, Angle::from_sin_cos(slope * cos, 1.0))
            };
            let (low, high) = (seen(-size), seen(size));
            let [angle, convexity] = largest_angle(&[low.0, high.0, low.1, high.1]);
            assert!((angle - size * 2.0).rad().abs() < 1e-9, "{angle}");
            let back = (convexity - azimuth).wrapped().abs();
            assert!((back.deg() - 180.0).abs() < 1e-5, "{convexity} for {azimuth}");
        }
    }
}
