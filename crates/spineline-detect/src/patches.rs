//! Patches around vertebrae, turned along the spine, and their corners with deviations, by the second network.
//!
//! Places are cells of the film's fine grid: column, row.

use crate::grid::Grid;
use crate::kernel::Map;
use crate::peaks::{from, length, softmax};
use crate::weights;

/// Samples along a side of a patch.
const PATCH: usize = 64;
/// Side of a patch over the distance between neighbouring centres.
const SIDE: f64 = 2.5;
/// Grey values more than this number of deviations from the mean are cut.
const CUT: f64 = 3.0;
/// Factor on the predicted standard deviation. The validation films have 68.3 % of errors within 0.97 of it,
/// so it is 1.
const SD_FACTOR: f64 = 1.0;

/// The corners of a vertebra.
pub struct Body {
    /// Upper left, upper right, lower left, lower right as seen.
    pub corners: [[f64; 2]; 4],
    /// Standard deviation of a coordinate of a corner: root of the mean of the corners' variances.
    pub sd: f64,
}

impl Body {
    /// Distance between the middles of the endplates.
    pub fn height(&self) -> f64 {
        let [ul, ur, ll, lr] = self.corners;
        length([0, 1].map(|i| (ll[i] + lr[i] - ul[i] - ur[i]) / 2.0))
    }
}

/// The frame of a patch: `place = origin + x * x_axis + y * y_axis`, in samples.
struct Frame {
    origin: [f64; 2],
    x_axis: [f64; 2],
    y_axis: [f64; 2],
}

impl Frame {
    fn place(&self, x: f64, y: f64) -> [f64; 2] {
        [0, 1].map(|i| self.origin[i] + x * self.x_axis[i] + y * self.y_axis[i])
    }
}

/// Bodies around centres, which run downwards.
pub fn corners(fine: &Grid, centres: &[[f64; 2]]) -> Vec<Body> {
    let frames = frames(centres);
    frames.iter().map(|frame| body(frame, &weights::patch(patch(fine, frame)))).collect()
}

/// A frame around every centre, along the spine, with a size by the distance of its neighbours.
fn frames(centres: &[[f64; 2]]) -> Vec<Frame> {
    let steps: Vec<[f64; 2]> = centres.windows(2).map(|pair| from(pair[0], pair[1])).collect();
    let frame = |(place, centre): (usize, &[f64; 2])| {
        let before = steps[place.saturating_sub(1)];
        let after = steps[place.min(steps.len() - 1)];
        let sum = [before[0] + after[0], before[1] + after[1]];
        let down = sum.map(|part| part / length(sum).max(1e-9));
        let sample = SIDE * (length(before) + length(after)) / 2.0 / PATCH as f64;
        let (x_axis, y_axis) =
            ([sample * down[1], -sample * down[0]], down.map(|part| sample * part));
        let half = PATCH as f64 / 2.0;
        let origin = [0, 1].map(|i| centre[i] - half * (x_axis[i] + y_axis[i]));
        Frame { origin, x_axis, y_axis }
    };
    centres.iter().enumerate().map(frame).collect()
}

/// Grey values of a patch with mean 0 and standard deviation 1.
fn patch(fine: &Grid, frame: &Frame) -> Grid {
    let place = |index: usize| {
        let (x, y) = ((index % PATCH) as f64 + 0.5, (index / PATCH) as f64 + 0.5);
        fine.at(frame.place(x, y))
    };
    let grey: Vec<f64> = (0..PATCH * PATCH).map(place).collect();
    let count = grey.len() as f64;
    let mean = grey.iter().sum::<f64>() / count;
    let sd = (grey.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count).sqrt();
    let value = |grey: &f64| ((grey - mean) / (sd + 1e-3)).clamp(-CUT, CUT) as f32;
    Grid { columns: PATCH, rows: PATCH, values: grey.iter().map(value).collect() }
}

/// Means and deviations of the corners' places in the second network's map.
fn body(frame: &Frame, map: &Map) -> Body {
    let cell = PATCH as f64 / map.rows as f64;
    let sample = length(frame.x_axis);
    let mut variance = 0.0;
    let corners = [0, 1, 2, 3].map(|corner| {
        let logits: Vec<f64> =
            map.values.chunks_exact(map.channels).map(|cell| f64::from(cell[corner])).collect();
        let shares = softmax(&logits);
        let place =
            |index: usize| [(index % map.columns) as f64 + 0.5, (index / map.columns) as f64 + 0.5];
        let mut mean = [0.0; 2];
        for (index, share) in shares.iter().enumerate() {
            let at = place(index);
            mean = [mean[0] + share * at[0], mean[1] + share * at[1]];
        }
        let spread =
            |(index, share): (usize, &f64)| share * length(from(mean, place(index))).powi(2);
        let square: f64 = shares.iter().enumerate().map(spread).sum();
        variance += square / 2.0 * (cell * sample).powi(2) / 4.0;
        frame.place(mean[0] * cell, mean[1] * cell)
    });
    Body { corners, sd: SD_FACTOR * variance.sqrt() }
}
