//! Layers of the networks in plain arithmetic: sums in a fixed order, so that the same input gives the same bits
//! everywhere.

/// Channels of every cell of a grid: row by row, cell by cell, channel by channel.
#[derive(Debug, Clone)]
pub struct Map {
    pub rows: usize,
    pub columns: usize,
    pub channels: usize,
    pub values: Vec<f32>,
}

/// A convolution with zeros around the map.
#[derive(Debug)]
pub struct Convolution {
    pub inputs: usize,
    pub outputs: usize,
    pub size: usize,
    pub stride: usize,
    /// By row and column of the kernel, input and output.
    pub weights: Vec<f32>,
    pub bias: Vec<f32>,
}

/// Cells that are computed together, so that each weight is read once for them.
const TOGETHER: usize = 8;

impl Map {
    /// The channels of a cell.
    pub fn cell(&self, row: usize, column: usize) -> &[f32] {
        &self.values[(row * self.columns + column) * self.channels..][..self.channels]
    }

    pub fn rectified(mut self) -> Self {
        self.values.iter_mut().for_each(|value| *value = value.max(0.0));
        self
    }

    pub fn plus(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(sum, value)| *sum += value);
        self
    }

    /// The largest value of two by two cells.
    pub fn pooled(&self) -> Self {
        let (rows, columns) = (self.rows / 2, self.columns / 2);
        let mut values = Vec::with_capacity(rows * columns * self.channels);
        for row in 0..rows {
            for column in 0..columns {
                let four = [(0, 0), (0, 1), (1, 0), (1, 1)]
                    .map(|(down, right)| self.cell(2 * row + down, 2 * column + right));
                let largest =
                    |channel: usize| four.iter().map(|cell| cell[channel]).fold(f32::MIN, f32::max);
                values.extend((0..self.channels).map(largest));
            }
        }
        Self { rows, columns, channels: self.channels, values }
    }

    /// Every cell four times.
    pub fn doubled(&self) -> Self {
        let (rows, columns) = (2 * self.rows, 2 * self.columns);
        let mut values = Vec::with_capacity(rows * columns * self.channels);
        for row in 0..rows {
            for column in 0..columns {
                values.extend_from_slice(self.cell(row / 2, column / 2));
            }
        }
        Self { rows, columns, channels: self.channels, values }
    }
}

impl Convolution {
    pub fn of(&self, map: &Map) -> Map {
        let (rows, columns) = (map.rows.div_ceil(self.stride), map.columns.div_ceil(self.stride));
        let mut values = self.bias.repeat(rows * columns);
        for (row, line) in values.chunks_exact_mut(columns * self.outputs).enumerate() {
            for (block, cells) in line.chunks_mut(TOGETHER * self.outputs).enumerate() {
                self.add_to(cells, map, row, block * TOGETHER);
            }
        }
        Map { rows, columns, channels: self.outputs, values }
    }

    /// Adds the weighted inputs to some neighbouring cells of a row.
    fn add_to(&self, cells: &mut [f32], map: &Map, row: usize, first: usize) {
        let padding = self.size / 2;
        for down in 0..self.size {
            let Some(from) = (row * self.stride + down).checked_sub(padding) else { continue };
            if from >= map.rows {
                continue;
            }
            for right in 0..self.size {
                let weights = (down * self.size + right) * self.inputs * self.outputs;
                let sources = |place: usize| {
                    ((first + place) * self.stride + right)
                        .checked_sub(padding)
                        .filter(|&column| column < map.columns)
                };
                for input in 0..self.inputs {
                    let weights = &self.weights[weights + input * self.outputs..][..self.outputs];
                    for (place, sums) in cells.chunks_exact_mut(self.outputs).enumerate() {
                        let Some(column) = sources(place) else { continue };
                        let value =
                            map.values[(from * map.columns + column) * map.channels + input];
                        // Half of all values are zero after rectification.
                        if value != 0.0 {
                            sums.iter_mut()
                                .zip(weights)
                                .for_each(|(sum, weight)| *sum += value * weight);
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One channel with these rows.
    fn map(rows: &[&[f32]]) -> Map {
        Map { rows: rows.len(), columns: rows[0].len(), channels: 1, values: rows.concat() }
    }

    #[test]
    fn a_convolution_is_the_sum_of_neighbours_with_zeros_around() {
        let sum = Convolution {
            inputs: 1,
            outputs: 1,
            size: 3,
            stride: 1,
            weights: vec![1.0; 9],
            bias: vec![0.5],
        };
        let out = sum.of(&map(&[&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]]));
        assert_eq!(out.values, [12.5, 21.5, 16.5, 12.5, 21.5, 16.5]);
        let every_second = Convolution { stride: 2, ..sum };
        let out = every_second.of(&map(&[&[1.0, 2.0, 3.0], &[4.0, 5.0, 6.0]]));
        assert_eq!((out.rows, out.columns), (1, 2));
        assert_eq!(out.values, [12.5, 16.5]);
    }

    #[test]
    fn a_kernel_of_one_weight_moves_the_map() {
        let mut weights = vec![0.0; 9];
        // The cell above and to the left.
        weights[0] = 2.0;
        let moved =
            Convolution { inputs: 1, outputs: 1, size: 3, stride: 1, weights, bias: vec![0.0] };
        let out = moved.of(&map(&[&[1.0, 2.0], &[3.0, 4.0]]));
        assert_eq!(out.values, [0.0, 0.0, 0.0, 2.0]);
    }

    #[test]
    fn channels_are_mixed_by_their_weights() {
        let mix = Convolution {
            inputs: 2,
            outputs: 3,
            size: 1,
            stride: 1,
            weights: vec![1.0, 2.0, 3.0, 10.0, 20.0, 30.0],
            bias: vec![0.0; 3],
        };
        let two = Map { rows: 1, columns: 1, channels: 2, values: vec![1.0, -1.0] };
        assert_eq!(mix.of(&two).values, [-9.0, -18.0, -27.0]);
    }

    #[test]
    fn pooling_takes_the_largest_and_doubling_repeats() {
        let small = map(&[&[1.0, -2.0], &[0.0, 5.0]]).pooled();
        assert_eq!(small.values, [5.0]);
        assert_eq!(small.doubled().values, [5.0; 4]);
    }
}
