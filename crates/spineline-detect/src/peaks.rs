//! From the first network's map to centres of vertebrae.
//!
//! Places are cells of the first network's input: column, row; the spine runs downwards.

use crate::kernel::Map;

/// Levels from T1 down to L5.
pub const LEVELS: usize = 17;
/// Cells of the input per cell of the map.
const CELL: f64 = 4.0;
/// Unit of the offsets of corners.
const UNIT: f64 = 16.0;
/// First channels of corners and of levels; the centre's is zero.
const CORNERS: usize = 1;
const FIRST_LEVEL: usize = 9;

/// Centres below this probability are ignored.
const MIN_PROBABILITY: f64 = 0.10;
/// Two centres closer than this part of their mean height are one vertebra.
const MIN_DISTANCE: f64 = 0.5;

/// A vertebra as the first network sees it.
#[derive(Debug, Clone, Copy)]
pub struct Peak {
    pub centre: [f64; 2],
    /// Upper left, upper right, lower left, lower right as seen.
    pub corners: [[f64; 2]; 4],
    pub probability: f64,
    pub levels: [f64; LEVELS],
    /// Whether the network saw it; else it was interpolated.
    pub is_seen: bool,
}

impl Peak {
    /// From the middle of the upper endplate to the middle of the lower one.
    pub fn axis(&self) -> [f64; 2] {
        let [ul, ur, ll, lr] = self.corners;
        [0, 1].map(|i| (ll[i] + lr[i] - ul[i] - ur[i]) / 2.0)
    }

    pub fn height(&self) -> f64 {
        length(self.axis()).max(1.0)
    }

    pub fn between(upper: &Self, lower: &Self) -> Self {
        let mean = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|i| (a[i] + b[i]) / 2.0);
        Self {
            centre: mean(upper.centre, lower.centre),
            corners: [0, 1, 2, 3].map(|k| mean(upper.corners[k], lower.corners[k])),
            probability: 0.0,
            levels: [1.0 / LEVELS as f64; LEVELS],
            is_seen: false,
        }
    }
}

/// Local maxima of the centres' probability, the most probable first; of two on one vertebra, only the more
/// probable one.
pub fn peaks_of(map: &Map) -> Vec<Peak> {
    let probability = |row: usize, column: usize| sigmoid(f64::from(map.cell(row, column)[0]));
    let mut found = Vec::new();
    for row in 0..map.rows {
        for column in 0..map.columns {
            let own = probability(row, column);
            let rows = row.saturating_sub(1)..(row + 2).min(map.rows);
            let columns = column.saturating_sub(1)..(column + 2).min(map.columns);
            let is_largest =
                || rows.clone().all(|r| columns.clone().all(|c| probability(r, c) <= own));
            if own >= MIN_PROBABILITY && is_largest() {
                found.push(peak_at(map, row, column, own));
            }
        }
    }
    found.sort_by(|a, b| b.probability.total_cmp(&a.probability));
    let mut kept: Vec<Peak> = Vec::new();
    for peak in found {
        let is_apart = |other: &Peak| {
            let least = MIN_DISTANCE * (peak.height() + other.height()) / 2.0;
            length(from(other.centre, peak.centre)) > least
        };
        if kept.iter().all(is_apart) {
            kept.push(peak);
        }
    }
    kept
}

fn peak_at(map: &Map, row: usize, column: usize, probability: f64) -> Peak {
    let cell = map.cell(row, column);
    let middle = [(column as f64 + 0.5) * CELL, (row as f64 + 0.5) * CELL];
    let corners = [0, 1, 2, 3]
        .map(|k| [0, 1].map(|axis| middle[axis] + UNIT * f64::from(cell[CORNERS + 2 * k + axis])));
    let centre = [0, 1].map(|axis| corners.iter().map(|corner| corner[axis]).sum::<f64>() / 4.0);
    let levels: [f64; LEVELS] = std::array::from_fn(|level| f64::from(cell[FIRST_LEVEL + level]));
    let shares = softmax(&levels);
    Peak {
        centre,
        corners,
        probability,
        levels: std::array::from_fn(|level| shares[level]),
        is_seen: true,
    }
}

fn sigmoid(x: f64) -> f64 {
    1.0 / (1.0 + (-x.clamp(-30.0, 30.0)).exp())
}

/// Shares with a sum of one.
pub fn softmax(values: &[f64]) -> Vec<f64> {
    let largest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let powers: Vec<f64> = values.iter().map(|value| (value - largest).exp()).collect();
    let sum: f64 = powers.iter().sum();
    powers.iter().map(|power| power / sum).collect()
}

pub fn from(start: [f64; 2], end: [f64; 2]) -> [f64; 2] {
    [end[0] - start[0], end[1] - start[1]]
}

pub fn length(vector: [f64; 2]) -> f64 {
    vector[0].hypot(vector[1])
}
