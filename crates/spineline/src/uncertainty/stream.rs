//! Random streams: one per case and replicate.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::SeedableRng;

/// The random stream of one replicate of a case.
///
/// The 256 bits of ChaCha's key are the seed, the 64-bit FNV-1a hash of the case's identifier (both little-endian) and zeros;
/// the number of the stream is the replicate's. So patients of a cohort have independent noise, and a patient has the
/// same noise in any cohort.
///
/// # References
/// [fnv] for the hash.
pub(super) fn stream(seed: u64, case_id: &str, index: u64) -> ChaCha12Rng {
    let mut key = [0; 32];
    key[..8].copy_from_slice(&seed.to_le_bytes());
    key[8..16].copy_from_slice(&fnv1a(case_id.as_bytes()).to_le_bytes());
    let mut rng = ChaCha12Rng::from_seed(key);
    rng.set_stream(index);
    rng
}

/// The 64-bit FNV-1a hash.
fn fnv1a(bytes: &[u8]) -> u64 {
    const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0000_0100_0000_01b3;
    bytes.iter().fold(OFFSET_BASIS, |hash, &byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    #[test]
    fn the_hash_equals_the_published_test_vectors() {
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn the_noise_of_two_patients_is_not_correlated() {
        const COUNT: u64 = 4000;
        let first =
            |seed, id: &str, index| -> f64 { StandardNormal.sample(&mut stream(seed, id, index)) };
        let correlation = |(seed, id): (u64, &str), (other_seed, other): (u64, &str)| {
            let products =
                (0..COUNT).map(|index| first(seed, id, index) * first(other_seed, other, index));
            products.sum::<f64>() / COUNT as f64
        };
        // The mean of products of independent numbers has the deviation 1/√n; four of these.
        let limit = 4.0 / (COUNT as f64).sqrt();
        assert!(correlation((1, "p01"), (1, "p02")).abs() < limit);
        assert!(correlation((1, "p01"), (2, "p01")).abs() < limit);
        assert!((correlation((1, "p01"), (1, "p01")) - 1.0).abs() < 2.0 * limit);
    }
}
