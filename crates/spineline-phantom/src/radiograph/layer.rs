//! A grid of attenuation, with larger cells than the picture, for smooth or thick parts.

use spineline::measure::{ImageGeometry, Spacing};

/// Distance of the grid's nodes.
const GRID_MM: f32 = 0.4;

/// A point of the film: to the patient's left and up, in mm from the first pixel.
pub(super) type Point = [f32; 2];

/// The spacing of a phantom's film, which is always known.
pub(super) fn spacing(image: &ImageGeometry) -> Spacing {
    image.spacing.expect("a phantom's film has a spacing")
}

/// Attenuation on a grid.
pub(super) struct Layer {
    columns: usize,
    rows: usize,
    /// Sign of the patient's left along increasing columns.
    sense: f32,
    values: Vec<f32>,
}

/// A part of a grid.
pub(super) struct Patch {
    column: usize,
    row: usize,
    columns: usize,
    values: Vec<f32>,
}

impl Layer {
    /// An empty grid that covers a picture of this size.
    pub fn covering(width_mm: f32, height_mm: f32, sense: f32) -> Self {
        let count = |mm: f32| (mm / GRID_MM).ceil() as usize + 2;
        let (columns, rows) = (count(width_mm), count(height_mm));
        Self { columns, rows, sense, values: vec![0.0; columns * rows] }
    }

    /// The same grid from a function of place.
    pub fn fill(&mut self, value: impl Fn(Point) -> f32 + Sync) {
        use rayon::prelude::*;
        let (columns, sense) = (self.columns, self.sense);
        self.values.par_chunks_mut(columns).enumerate().for_each(|(row, line)| {
            for (column, node) in line.iter_mut().enumerate() {
                *node = value([sense * column as f32 * GRID_MM, -(row as f32) * GRID_MM]);
            }
        });
    }

    pub fn add(&mut self, patch: &Patch) {
        for (line, values) in patch.values.chunks(patch.columns.max(1)).enumerate() {
            let start = (patch.row + line) * self.columns + patch.column;
            for (node, value) in self.values[start..].iter_mut().zip(values) {
                *node += value;
            }
        }
    }

    /// A bent tube: `profile` gives the attenuation from the distance to the nearest point of its axis, the radius
    /// there, and the position along the axis (0…1). The axis is given by points with radii.
    pub fn tube(&self, axis: &[(Point, f32)], profile: impl Fn(f32, f32, f32) -> f32) -> Patch {
        let nodes: Vec<(f32, f32, f32)> = axis
            .iter()
            .map(|&([y, z], r)| (self.sense * y / GRID_MM, -z / GRID_MM, r / GRID_MM))
            .collect();
        let reach = |low: f32, high: f32, count: usize| {
            let low = low.floor().clamp(0.0, count as f32) as usize;
            low..(high.ceil().clamp(-1.0, count as f32 - 1.0) + 1.0).max(low as f32) as usize
        };
        let span = |nodes: &[(f32, f32, f32)]| {
            let over = |f: &dyn Fn(&(f32, f32, f32)) -> f32, pick: fn(f32, f32) -> f32| {
                nodes.iter().map(f).reduce(pick).unwrap_or(0.0)
            };
            (
                reach(over(&|n| n.0 - n.2, f32::min), over(&|n| n.0 + n.2, f32::max), self.columns),
                reach(over(&|n| n.1 - n.2, f32::min), over(&|n| n.1 + n.2, f32::max), self.rows),
            )
        };
        let (across, down) = span(&nodes);
        let columns = across.len();
        let pieces = nodes.len().max(2) as f32 - 1.0;
        // For the nearest piece: distance in units of the radius, radius, and position along the axis.
        let mut nearest = vec![(f32::INFINITY, 1.0_f32, 0.0_f32); columns * down.len()];
        for (number, piece) in nodes.windows(2).enumerate() {
            let (dx, dy) = (piece[1].0 - piece[0].0, piece[1].1 - piece[0].1);
            let square = (dx * dx + dy * dy).max(1e-6);
            let (piece_across, piece_down) = span(piece);
            for row in piece_down {
                for column in piece_across.clone() {
                    let (x, y) = (column as f32 - piece[0].0, row as f32 - piece[0].1);
                    let part = ((x * dx + y * dy) / square).clamp(0.0, 1.0);
                    let radius = piece[0].2 + part * (piece[1].2 - piece[0].2);
                    let distance = (x - part * dx).hypot(y - part * dy) / radius;
                    let known = &mut nearest[(row - down.start) * columns + column - across.start];
                    if distance < known.0 {
                        let along = (number as f32 + part) / pieces;
                        *known = (distance, radius, along);
                    }
                }
            }
        }
        let values = nearest
            .into_iter()
            .map(|(distance, radius, along)| {
                if distance < 1.0 {
                    profile(distance * radius * GRID_MM, radius * GRID_MM, along)
                } else {
                    0.0
                }
            })
            .collect();
        Patch { column: across.start, row: down.start, columns, values }
    }

    /// Adds the values along one row of a picture, between the grid's nodes.
    pub fn sample_row(&self, image: &ImageGeometry, row: usize, line: &mut [f32]) {
        let place = (row as f64 * spacing(image).row_mm / f64::from(GRID_MM)) as f32;
        let above = (place as usize).min(self.rows - 2);
        let down = place - above as f32;
        let upper = &self.values[above * self.columns..][..self.columns];
        let lower = &self.values[(above + 1) * self.columns..][..self.columns];
        let step = (spacing(image).column_mm / f64::from(GRID_MM)) as f32;
        for (column, value) in line.iter_mut().enumerate() {
            let place = column as f32 * step;
            let left = (place as usize).min(self.columns - 2);
            let right = place - left as f32;
            let at = |k: usize| upper[k] + down * (lower[k] - upper[k]);
            let (here, next) = (at(left), at(left + 1));
            *value += here + right * (next - here);
        }
    }
}

/// Attenuation of a tube with a wall, seen from the side.
pub(super) fn tube_profile(
    wall_mm: f32,
    wall_per_mm: f32,
    inner_per_mm: f32,
) -> impl Fn(f32, f32) -> f32 {
    move |distance, radius| {
        let chord = |r: f32| 2.0 * (r * r - distance * distance).max(0.0).sqrt();
        let inner = chord((radius - wall_mm).max(0.0));
        (chord(radius) - inner) * wall_per_mm + inner * inner_per_mm
    }
}

/// Attenuation that fades from the axis outwards.
pub(super) fn soft_profile(strength: f32) -> impl Fn(f32, f32) -> f32 {
    move |distance, radius| {
        let q = 1.0 - (distance / radius).powi(2);
        strength * q * q
    }
}
