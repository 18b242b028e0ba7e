//! The weights of both networks, and their layers in order.

use std::sync::LazyLock;

use crate::grid::Grid;
use crate::kernel::{Convolution, Map};

// Half-precision numbers, little-endian; and a line per layer: network, name, kind, inputs, channels in and out, kernel, stride, whether
// rectified, offset, count.
#[cfg(feature = "weights")]
use spineline_weights::{LAYERS, NETWORKS};

// A program without the weights refuses every film.
#[cfg(not(feature = "weights"))]
const NETWORKS: &[u8] = &[];
#[cfg(not(feature = "weights"))]
const LAYERS: &str = "";

enum Kind {
    Convolution(Convolution),
    Pool,
    Double,
    Add,
}

struct Layer {
    /// Indices of its input maps; the network's input is at zero.
    sources: Vec<usize>,
    kind: Kind,
    is_rectified: bool,
}

/// Layers in order.
struct Network(Vec<Layer>);

static FILM: LazyLock<Network> = LazyLock::new(|| Network::named("film"));
static PATCH: LazyLock<Network> = LazyLock::new(|| Network::named("patch"));

/// The first network: centre, offsets of four corners, and levels of every cell.
pub fn film(grid: Grid) -> Map {
    FILM.run(grid)
}

/// The second network: four corners in every cell.
pub fn patch(grid: Grid) -> Map {
    PATCH.run(grid)
}

impl Network {
    fn named(network: &str) -> Self {
        let lines = LAYERS.lines().filter(|line| !line.starts_with('#'));
        let own = lines
            .map(|line| line.split(' ').collect())
            .filter(|words: &Vec<&str>| words[0] == network);
        let mut names = vec![network];
        let mut layers = Vec::new();
        for words in own {
            let source = |name: &str| {
                names
                    .iter()
                    .position(|known| *known == name)
                    .expect("a layer takes those before it")
            };
            let sources = words[3].split(',').map(source).collect();
            let numbers: Vec<usize> =
                words[4..].iter().map(|word| word.parse().expect("a number of the list")).collect();
            let kind = match words[2] {
                "conv" => Kind::Convolution(convolution(&numbers)),
                "pool" => Kind::Pool,
                "up" => Kind::Double,
                "add" => Kind::Add,
                other => panic!("unknown kind of layer: {other}"),
            };
            layers.push(Layer { sources, kind, is_rectified: numbers[4] == 1 });
            names.push(words[1]);
        }
        Self(layers)
    }

    fn run(&self, grid: Grid) -> Map {
        let Grid { rows, columns, values } = grid;
        let mut maps = vec![Map { rows, columns, channels: 1, values }];
        for layer in &self.0 {
            let input = &maps[layer.sources[0]];
            let map = match &layer.kind {
                Kind::Convolution(convolution) => convolution.of(input),
                Kind::Pool => input.pooled(),
                Kind::Double => input.doubled(),
                Kind::Add => input.clone().plus(&maps[layer.sources[1]]),
            };
            maps.push(if layer.is_rectified { map.rectified() } else { map });
        }
        maps.pop().expect("the input is one")
    }
}

fn convolution(numbers: &[usize]) -> Convolution {
    let &[inputs, outputs, size, stride, _, offset, count] = numbers else {
        panic!("a line of the list has seven numbers")
    };
    let values: Vec<f32> = NETWORKS[2 * offset..2 * (offset + count)]
        .chunks_exact(2)
        .map(|bytes| single(u16::from_le_bytes([bytes[0], bytes[1]])))
        .collect();
    let (stored, bias) = values.split_at(count - outputs);
    let mut weights = vec![0.0; stored.len()];
    for output in 0..outputs {
        for input in 0..inputs {
            for place in 0..size * size {
                weights[(place * inputs + input) * outputs + output] =
                    stored[(output * inputs + input) * size * size + place];
            }
        }
    }
    Convolution { inputs, outputs, size, stride, weights, bias: bias.to_vec() }
}

/// A number of half precision (IEEE 754): sign, five bits of exponent, ten of fraction.
fn single(bits: u16) -> f32 {
    let sign = if bits & 0x8000 == 0 { 1.0 } else { -1.0 };
    let (exponent, fraction) = (i32::from(bits >> 10 & 0x1f), f32::from(bits & 0x3ff));
    match exponent {
        0 => sign * fraction * 2.0_f32.powi(-24),
        _ => sign * (1.0 + fraction / 1024.0) * 2.0_f32.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_precision_is_read() {
        // One, minus two, the largest number, the smallest normal and the smallest number, a third.
        for (bits, value) in [
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x7bff, 65504.0),
            (0x0400, 6.103_515_6e-5),
            (0x0001, 5.960_464_5e-8),
            (0x3555, 0.333_251_95),
            (0x0000, 0.0),
        ] {
            assert_eq!(single(bits), value, "{bits:#06x}");
        }
    }

    #[test]
    fn every_value_belongs_to_one_layer() {
        let mut next = 0;
        for line in LAYERS.lines().filter(|line| !line.starts_with('#')) {
            let words: Vec<&str> = line.split(' ').collect();
            let number = |place: usize| words[place].parse::<usize>().expect("a number");
            assert_eq!(number(9), next, "{line}");
            next += number(10);
        }
        assert_eq!(NETWORKS.len(), 2 * next);
    }
}
