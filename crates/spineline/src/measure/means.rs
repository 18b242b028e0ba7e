//! Means over readings.

use std::collections::BTreeMap;

use super::{EndplateTilts, Noise, Placement, ProgramNoise, ReadingSquares};
use crate::anatomy::Level;
use crate::spatial::{Angle, Frontal};

/// Mean over the readings that marked a level, and their number.
pub(super) fn average(
    placed: &[BTreeMap<Level, Placement>],
) -> BTreeMap<Level, (Placement, usize)> {
    let mut values: BTreeMap<Level, Vec<Placement>> = BTreeMap::new();
    for reading in placed {
        for (&level, &placement) in reading {
            values.entry(level).or_insert_with(|| Vec::with_capacity(placed.len())).push(placement);
        }
    }
    values.into_iter().map(|(level, all)| (level, mean_placement(all))).collect()
}

/// Mean of some placements, of which there is at least one, and their number.
fn mean_placement(mut all: Vec<Placement>) -> (Placement, usize) {
    // Sums in a fixed order: the order of the readings must not reach the last bit.
    all.sort_by(|a, b| {
        let key = |p: &Placement| [p.location.y_mm, p.location.z_mm, p.tilt.rad()];
        key(a).partial_cmp(&key(b)).expect("readings were checked to be finite")
    });
    let n = all.len() as f64;
    let location = all.iter().fold(Frontal::default(), |sum, p| sum + p.location) * (1.0 / n);
    // Against one of them, so that a film held upside down averages as any other.
    let mean = |first: Angle, tilts: &mut dyn Iterator<Item = Angle>| {
        first + tilts.fold(Angle::ZERO, |sum, tilt| sum + (tilt - first).wrapped()) * (1.0 / n)
    };
    let tilt = mean(all[0].tilt, &mut all.iter().map(|p| p.tilt));
    let have_endplates = all.iter().all(|p| p.endplates.is_some());
    let endplates = all[0].endplates.filter(|_| have_endplates).map(|first| {
        let tilts = || all.iter().filter_map(|p| p.endplates);
        EndplateTilts {
            superior: mean(first.superior, &mut tilts().map(|tilts| tilts.superior)),
            inferior: mean(first.inferior, &mut tilts().map(|tilts| tilts.inferior)),
        }
    });
    let programs: Vec<Option<ProgramNoise>> = all.iter().map(|p| p.program).collect();
    let program = ProgramNoise::of_mean(&programs);
    let origins = all.iter().map(|p| p.origin);
    let origin = origins.reduce(|one, other| Some(one?.and(other?))).flatten();
    (Placement { location, tilt, endplates, program, origin }, all.len())
}

impl Noise {
    /// Of means, from the standard deviation of the readings of vertebrae whose corners were placed by all: completed corners are alike
    /// in all readings and do not depend on readers.
    pub(super) fn of_means(
        observers: &[&str],
        placed: &[BTreeMap<Level, Placement>],
        means: &BTreeMap<Level, (Placement, usize)>,
    ) -> Self {
        let means: BTreeMap<&Level, &(Placement, usize)> =
            means.iter().filter(|(_, (mean, _))| mean.program.is_none()).collect();
        let [mut location, mut tilt] = [ReadingSquares::default(), ReadingSquares::default()];
        for (level, (mean, _)) in &means {
            let own = || {
                let marked = placed.iter().zip(observers);
                marked.filter_map(|(reading, by)| Some((*by, reading.get(*level)?)))
            };
            location.add(own().map(|(by, place)| (by, place.location.y_mm - mean.location.y_mm)));
            location.add(own().map(|(by, place)| (by, place.location.z_mm - mean.location.z_mm)));
            tilt.add(own().map(|(by, place)| (by, (place.tilt - mean.tilt).wrapped().rad())));
        }
        let Some((of_location, of_tilt)) = location.spread().zip(tilt.spread()) else {
            return Noise::ONE_READING;
        };
        let read: usize = means.values().map(|(_, readings)| readings).sum();
        let readings_per_value = read as f64 / means.len() as f64;
        let [location_mm, tilt] =
            [&of_location, &of_tilt].map(|found| (found.variance / readings_per_value).sqrt());
        Noise {
            location_mm: location_mm.max(Noise::FLOOR_LOCATION_MM),
            tilt: Angle::from_rad(tilt.max(Noise::FLOOR_TILT.rad())),
            tilt_degrees_of_freedom: Some(of_tilt.freedom),
        }
    }
}
