//! Films on smaller grids of square cells.

use spineline::spatial::Pixel;

use crate::picture::Picture;

/// Size of the first network's input: columns, rows.
const COARSE: [usize; 2] = [192, 384];

/// Grey values on square cells, row by row.
#[derive(Debug, Clone)]
pub struct Grid {
    pub columns: usize,
    pub rows: usize,
    pub values: Vec<f32>,
}

/// The first network's input, and the place of the film in it.
pub struct Coarse {
    pub grid: Grid,
    /// The film's upper left corner in cells: column, row.
    pub corner: [f64; 2],
    /// Cells per pixel of the film: columns, rows.
    pub scale: [f64; 2],
}

impl Coarse {
    /// The cell of a place on the film: column, row.
    pub fn cell(&self, place: Pixel) -> [f64; 2] {
        let place = [place.column_px, place.row_px];
        [0, 1].map(|axis| self.corner[axis] + (place[axis] + 0.5) * self.scale[axis])
    }

    /// The place on the film of a cell.
    pub fn place(&self, cell: [f64; 2]) -> Pixel {
        let [column, row] =
            [0, 1].map(|axis| (cell[axis] - self.corner[axis]) / self.scale[axis] - 0.5);
        Pixel::new(column, row)
    }
}

impl Grid {
    /// The mean of the film over each cell of the largest grid that fits and has the film's shape.
    pub fn reduced(picture: &Picture<'_>, [max_columns, max_rows]: [usize; 2]) -> Self {
        let height = picture.rows as f64 * picture.pixel_aspect;
        let scale = (max_rows as f64 / height).min(max_columns as f64 / picture.columns as f64);
        let cells = |size: f64, max: usize| ((size * scale + 0.5) as usize).clamp(1, max);
        let (columns, rows) = (cells(picture.columns as f64, max_columns), cells(height, max_rows));
        let (across, down) = (shares(picture.columns, columns), shares(picture.rows, rows));
        let mut values = Vec::with_capacity(columns * rows);
        let mut line = vec![0.0_f64; picture.columns];
        for row in &down {
            line.fill(0.0);
            for (share, at) in row.weights.iter().zip(row.first..) {
                let pixels = &picture.values[at * picture.columns..][..picture.columns];
                line.iter_mut()
                    .zip(pixels)
                    .for_each(|(sum, &value)| *sum += share * f64::from(value));
            }
            values.extend(across.iter().map(|column| {
                let pixels = &line[column.first..][..column.weights.len()];
                let mean: f64 = pixels.iter().zip(&column.weights).map(|(p, w)| p * w).sum();
                mean as f32
            }));
        }
        Self { columns, rows, values }
    }

    /// Scales grey values so that percentile 1 is -1 and percentile 99 is +1, and cuts them there.
    fn normalised(&self) -> Self {
        let mut sorted = self.values.clone();
        sorted.sort_by(f32::total_cmp);
        let rank = |share: f64| sorted[(share * (sorted.len() - 1) as f64 + 0.5) as usize];
        let (low, high) = (rank(0.01), rank(0.99));
        let range = (high - low).max(1e-6);
        let value = |grey: &f32| ((grey - low) / range * 2.0 - 1.0).clamp(-1.0, 1.0);
        Self { values: self.values.iter().map(value).collect(), ..*self }
    }

    /// The value at a place between the middles of cells; beyond the edge, the value at the edge.
    pub fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let along = |place: f64, cells: usize| {
            let place = (place - 0.5).clamp(0.0, (cells - 1) as f64);
            let low = (place as usize).min(cells.saturating_sub(2));
            (low, (low + 1).min(cells - 1), place - low as f64)
        };
        let (left, right, u) = along(x, self.columns);
        let (top, below, v) = along(y, self.rows);
        let value = |row: usize, column: usize| f64::from(self.values[row * self.columns + column]);
        let upper = value(top, left) * (1.0 - u) + value(top, right) * u;
        let lower = value(below, left) * (1.0 - u) + value(below, right) * u;
        upper * (1.0 - v) + lower * v
    }
}

/// The film as input of the first network, with zeros around it.
pub fn coarse_input(picture: &Picture<'_>) -> Coarse {
    let film = Grid::reduced(picture, COARSE).normalised();
    let [columns, rows] = COARSE;
    let (left, top) = ((columns - film.columns) / 2, (rows - film.rows) / 2);
    let mut grid = Grid { columns, rows, values: vec![0.0; columns * rows] };
    for (row, line) in film.values.chunks_exact(film.columns).enumerate() {
        grid.values[(top + row) * columns + left..][..film.columns].copy_from_slice(line);
    }
    let scale =
        [film.columns as f64 / picture.columns as f64, film.rows as f64 / picture.rows as f64];
    Coarse { grid, corner: [left as f64, top as f64], scale }
}

/// The pixels under a cell, with the part of the cell that each covers.
struct Shares {
    first: usize,
    weights: Vec<f64>,
}

fn shares(pixels: usize, cells: usize) -> Vec<Shares> {
    let size = pixels as f64 / cells as f64;
    let of = |cell: usize| {
        let (low, high) = (cell as f64 * size, (cell + 1) as f64 * size);
        let first = (low as usize).min(pixels - 1);
        let last = (high.ceil() as usize).clamp(first + 1, pixels);
        let covered =
            |pixel: usize| (high.min(pixel as f64 + 1.0) - low.max(pixel as f64)).max(0.0);
        let weights: Vec<f64> = (first..last).map(covered).collect();
        let sum: f64 = weights.iter().sum();
        Shares { first, weights: weights.iter().map(|weight| weight / sum).collect() }
    };
    (0..cells).map(of).collect()
}
