//! Texture: tissue and quantum noise.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// A random value in -1…1 of a node of a lattice.
fn node(column: i32, row: i32, seed: u32) -> f32 {
    // A hash of three words by multiplication and shift.
    let mut h = (column as u32).wrapping_mul(0x9E37_79B1)
        ^ (row as u32).wrapping_mul(0x85EB_CA77)
        ^ seed.wrapping_mul(0xC2B2_AE3D);
    h = (h ^ (h >> 15)).wrapping_mul(0x2C1B_3C6D);
    h = (h ^ (h >> 12)).wrapping_mul(0x297A_2D39);
    ((h ^ (h >> 15)) as f32) * (2.0 / 4_294_967_295.0) - 1.0
}

/// A smooth random field in -1…1 whose lattice has distance one.
pub(super) fn clutter(x: f32, y: f32, seed: u32) -> f32 {
    let (left, top) = (x.floor(), y.floor());
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (tx, ty) = (ease(x - left), ease(y - top));
    let (c, r) = (left as i32, top as i32);
    let above = node(c, r, seed) * (1.0 - tx) + node(c + 1, r, seed) * tx;
    let below = node(c, r + 1, seed) * (1.0 - tx) + node(c + 1, r + 1, seed) * tx;
    above * (1.0 - ty) + below * ty
}

/// The field with finer fields added, each with half the size and strength of the one before.
pub(super) fn rough(x: f32, y: f32, octaves: u32, seed: u32) -> f32 {
    let (mut sum, mut size, mut strength) = (0.0, 1.0, 1.0);
    for octave in 0..octaves {
        sum += strength * clutter(x * size, y * size, seed.wrapping_add(octave));
        size *= 2.0;
        strength *= 0.5;
    }
    sum
}

/// Quanta per pixel without attenuation.
const QUANTA: f32 = 1.3e5;

/// Quantum noise of one row, from a separate stream, so that rows may be drawn in any order.
pub(super) struct Quanta {
    stream: ChaCha12Rng,
}

impl Quanta {
    pub fn of_row(seed: u64, row: usize) -> Self {
        let mut stream = ChaCha12Rng::seed_from_u64(seed);
        stream.set_stream(row as u64);
        Self { stream }
    }

    /// Adds quantum noise to the attenuation: its variance is one over the number of quanta.
    ///
    /// The detector blurs a little along the row.
    pub fn scatter(&self, soft: &[f32], bone: &mut [f32]) {
        let mut stream = self.stream.clone();
        let mut before = normal(&mut stream);
        let mut here = normal(&mut stream);
        for (bone, soft) in bone.iter_mut().zip(soft) {
            let after = normal(&mut stream);
            let blurred = 0.25 * before + 0.5 * here + 0.25 * after;
            *bone += blurred * (0.5 * (*bone + soft)).exp() / QUANTA.sqrt();
            (before, here) = (here, after);
        }
    }
}

/// Nearly normal: the sum of four uniform numbers, scaled to a variance of one.
fn normal(stream: &mut ChaCha12Rng) -> f32 {
    let bits = stream.next_u64();
    let sum: u32 = (0..4).map(|part| (bits >> (16 * part)) as u32 & 0xFFFF).sum();
    (sum as f32 - 131_070.0) * (1.732_050_8 / 65_536.0)
}
