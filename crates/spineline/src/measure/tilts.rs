//! Tilts that were given beside locations, against the curve of those locations.

use super::placing::{cranial_of, runs_down};
use super::{FilmPlace, MeasureError, MeasureFault, Placement, Reading};
use crate::anatomy::{Level, Posture};
use crate::spatial::{Angle, Frontal};

/// Vertebrae between two others from which the directions of a curve are compared with tilts.
const MIN_VERTEBRAE: usize = 6;
/// Standard deviation of these directions below which a spine is too straight for it.
const MIN_CURVE: Angle = Angle::from_deg(4.0);
/// Correlation from which tilts and directions show one curve.
const MIN_CORRELATION: f64 = 0.7;

/// How far tilts follow the curve of the locations, over the vertebrae between two others.
struct Following {
    tilt_sd: Angle,
    /// Tilt for each unit of the direction: about 1.
    slope: f64,
    correlation: f64,
}

impl Following {
    /// `None` where the curve is too short or too straight to tell.
    fn of(reading: &Reading<Placement>) -> Option<Self> {
        let placed: Vec<(&Level, &Placement)> = reading.vertebrae.iter().collect();
        let way = |three: &[(&Level, &Placement)]| {
            (three[2].1.location - three[0].1.location).lateral_tilt()
        };
        let first = placed.get(..3).map(way)?;
        let first_tilt = placed.get(1)?.1.tilt;
        let pairs: Vec<[f64; 2]> = placed
            .windows(3)
            .map(|three| {
                let turns = [way(three) - first, three[1].1.tilt - first_tilt];
                turns.map(|turn| turn.wrapped().deg())
            })
            .collect();
        let count = pairs.len() as f64;
        let mean = |i: usize| pairs.iter().map(|pair| pair[i]).sum::<f64>() / count;
        let means = [mean(0), mean(1)];
        let product = |i: usize, j: usize| {
            let of = |pair: &[f64; 2]| (pair[i] - means[i]) * (pair[j] - means[j]);
            pairs.iter().map(of).sum::<f64>() / count
        };
        let [directions, tilts, both] = [product(0, 0), product(1, 1), product(0, 1)];
        let is_curved = directions.sqrt() > MIN_CURVE.deg();
        (pairs.len() >= MIN_VERTEBRAE && is_curved).then(|| Self {
            tilt_sd: Angle::from_deg(tilts.sqrt()),
            slope: both / directions,
            correlation: both / (directions * tilts).sqrt(),
        })
    }
}

/// Refuses tilts that were filled in, tilts in radians, and tilts to the other side than the curve of their locations.
pub(super) fn check_tilts(
    posture: Posture,
    readings: &[Reading<Placement>],
) -> Result<(), MeasureError> {
    const PER_RADIAN: f64 = 1.0 / 57.3;
    const EQUAL: Angle = Angle::from_deg(1e-6);
    for reading in readings {
        let Some(Following { tilt_sd, slope, correlation }) = Following::of(reading) else {
            continue;
        };
        let place = FilmPlace::reading(posture, &reading.id);
        if tilt_sd <= EQUAL {
            return Err(MeasureFault::TiltsEqual.at(place));
        }
        if correlation.abs() < MIN_CORRELATION {
            continue;
        }
        if (0.4 * PER_RADIAN..2.5 * PER_RADIAN).contains(&slope.abs()) {
            return Err(MeasureFault::TiltsInRadians.at(place));
        }
        if slope < -0.5 {
            return Err(reversal_of(reading).at(place));
        }
    }
    Ok(())
}

/// Why tilts go to the other side than the curve of their locations. Exchanged coordinates, and a cranial one that counts downwards, mirror
/// the locations too, and turn them against tilts that still belong to an upright spine.
fn reversal_of(reading: &Reading<Placement>) -> MeasureFault {
    let placed = || reading.vertebrae.values();
    let cranial = cranial_of(placed().map(|one| one.location));
    let up: f64 = placed().map(|one| Frontal::leaning(one.tilt).z_mm).sum();
    // Cosine of the mean tilt, up to 45°.
    let is_upright = up > std::f64::consts::FRAC_1_SQRT_2 * placed().count() as f64;
    if is_upright && cranial.y_mm.abs() > cranial.z_mm.abs() {
        MeasureFault::LocationsExchanged
    } else if is_upright && runs_down(cranial) {
        MeasureFault::LocationsDownwards
    } else {
        MeasureFault::TiltsReversed
    }
}
