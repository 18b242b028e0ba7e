//! The seeds of the fuzz targets, whole and damaged, on a stable compiler.

mod numbers;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use spineline_fuzz_checks::{CHECKS, Check, Seed, seeds};

/// Damaged copies of every seed.
const COPIES: usize = 40;

fn check_of(seed: &Seed) -> Check {
    let found = CHECKS.iter().find(|(name, _)| *name == seed.target);
    found.unwrap_or_else(|| panic!("no check is called {}", seed.target)).1
}

#[test]
fn every_check_has_seeds() {
    let seeds = seeds().expect("our own formats");
    for (name, _) in CHECKS {
        assert!(seeds.iter().any(|seed| seed.target == name), "{name}");
    }
}

#[test]
fn every_seed_passes_its_check() {
    for seed in seeds().expect("our own formats") {
        check_of(&seed)(&seed.bytes);
    }
}

/// Oracle: the checks never panic, whatever is cut off, overwritten or repeated.
#[test]
fn damaged_seeds_pass_their_checks() {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    for seed in seeds().expect("our own formats") {
        let check = check_of(&seed);
        for _ in 0..COPIES {
            check(&damaged(&seed.bytes, &mut random));
        }
    }
}

/// A copy with one to four faults.
fn damaged(bytes: &[u8], random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut copy = bytes.to_vec();
    for _ in 0..random.random_range(1..=4) {
        if copy.is_empty() {
            break;
        }
        let place = random.random_range(0..copy.len());
        match random.random_range(0..4) {
            0 => copy.truncate(place),
            1 => copy[place] = random.random(),
            2 => copy[place] ^= 1 << random.random_range(0..8),
            _ => {
                let end = (place + random.random_range(1..64)).min(copy.len());
                let part = copy[place..end].to_vec();
                copy.splice(place..place, part);
            }
        }
    }
    copy
}
