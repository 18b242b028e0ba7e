//! One difference per patient: its mean, its interval and its significance.
//!
//! Everything here takes one number per patient, so that a patient counts once. Two errors of one film are differences of
//! the same vertebrae; their mean over a patient's films is that number.
//!
//! # References
//! [fisher-1935] for the sign-flip test; [holm-1979]; [owen-1968] and [cumming-finch-2001] for the interval of an effect.

use rand_chacha::ChaCha12Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use statrs::distribution::{ContinuousCDF, Normal};
use statrs::function::gamma::ln_gamma;

use super::statistics::{Summary, ranked};

/// A sign-flip test enumerates all arrangements up to this number of patients: half a million sums.
pub const EXACT_UP_TO: usize = 20;
/// Arrangements drawn for more patients.
const DRAWN: u32 = 50_000;

/// A sign-flip permutation test of "the mean difference is zero".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SignFlip {
    /// Patients.
    pub n: usize,
    /// Part of the arrangements whose mean is at least as far from zero as the one that was seen.
    pub p_two_sided: f64,
    /// Whether every arrangement was counted; else 50 000 were drawn, and the one that was seen counts with them.
    pub exact: bool,
}

/// The least probability that a sign-flip test of `n` patients can have.
pub(crate) fn least_p(n: usize) -> f64 {
    if n <= EXACT_UP_TO { 2.0_f64.powi(1 - n as i32) } else { 1.0 / f64::from(1 + DRAWN) }
}

/// Sign-flip test of some differences, one per patient; `None` for fewer than two.
///
/// # Definition
/// If two lines predict alike, the difference of a patient has either sign with the same probability. Of all `2^n` choices
/// of signs, `p` is the part with `|Σ ± d| ≥ |Σ d|`. Up to [`EXACT_UP_TO`] patients all are counted; beyond, they are drawn
/// from the seed for the sorted differences, so that the order of the patients does not change `p`. It assumes that differences are symmetric about zero, not that they are normal.
///
/// With `n` patients `p` cannot fall below `2 / 2^n`: five patients cannot reach 0.05.
///
/// ```
/// use spineline::evaluate::paired::sign_flip;
/// // Of the 8 arrangements of 1, 2 and 3 only + + + and - - - are as far from zero.
/// assert_eq!(sign_flip(&[1.0, 2.0, 3.0], 1).map(|test| test.p_two_sided), Some(0.25));
/// ```
#[must_use]
pub fn sign_flip(differences: &[f64], seed: u64) -> Option<SignFlip> {
    let differences = &ranked(differences);
    let n = differences.len();
    let size: f64 = differences.iter().map(|d| d.abs()).sum();
    if n < 2 || size.is_nan() {
        return None;
    }
    // Sums that differ by rounding alone are equal.
    let seen = differences.iter().sum::<f64>().abs() - 1e-9 * size;
    let exact = n <= EXACT_UP_TO;
    let p_two_sided = if exact {
        all_flips(differences, seen)
    } else {
        let as_far = drawn_flips(differences, seen, seed);
        f64::from(1 + as_far) / f64::from(1 + DRAWN)
    };
    Some(SignFlip { n, p_two_sided, exact })
}

/// Part of all choices of signs with a sum at least `seen` from zero. By symmetry the first keeps its sign; a Gray code
/// changes one of the others at a time.
fn all_flips(differences: &[f64], seen: f64) -> f64 {
    let choices = 1_u32 << (differences.len() - 1);
    let mut signed = differences.to_vec();
    let mut sum: f64 = signed.iter().sum();
    let mut as_far = 0_u32;
    for step in 1..=choices {
        as_far += u32::from(sum.abs() >= seen);
        let turned = 1 + step.trailing_zeros() as usize;
        if step < choices {
            sum -= 2.0 * signed[turned];
            signed[turned] = -signed[turned];
        }
    }
    f64::from(as_far) / f64::from(choices)
}

/// How many of [`DRAWN`] choices of signs have a sum at least `seen` from zero.
///
/// The signs of eight patients are one byte: the sum of each half is looked up among the 16 that it can have, which takes 32 bytes
/// per patient.
fn drawn_flips(differences: &[f64], seen: f64, seed: u64) -> u32 {
    /// Choices whose sums grow side by side, so that no addition waits for the one before.
    const AT_ONCE: usize = 8;
    let halves = |of_eight: &[f64]| {
        let (low, high) = of_eight.split_at(of_eight.len().min(4));
        [signed_sums(low), signed_sums(high)]
    };
    let sums: Vec<[[f64; 16]; 2]> = differences.chunks(8).map(halves).collect();
    let mut rng = ChaCha12Rng::seed_from_u64(seed);
    let mut signs = vec![vec![0_u8; sums.len()]; AT_ONCE];
    let mut as_far = 0;
    for first in (0..DRAWN).step_by(AT_ONCE) {
        let drawn = &mut signs[..AT_ONCE.min((DRAWN - first) as usize)];
        drawn.iter_mut().for_each(|signs| rng.fill_bytes(signs));
        let mut totals = [0.0_f64; AT_ONCE];
        for (place, [low, high]) in sums.iter().enumerate() {
            for (total, signs) in totals.iter_mut().zip(&*drawn) {
                let signs = usize::from(signs[place]);
                *total += low[signs & 15] + high[signs >> 4];
            }
        }
        as_far += totals[..drawn.len()].iter().filter(|sum| sum.abs() >= seen).count() as u32;
    }
    as_far
}

/// Sums of up to four numbers by their signs: a number is negative where its bit is set.
fn signed_sums(numbers: &[f64]) -> [f64; 16] {
    std::array::from_fn(|signs| {
        let signed = |(place, number): (usize, &f64)| {
            if signs >> place & 1 == 1 { -number } else { *number }
        };
        numbers.iter().enumerate().map(signed).sum()
    })
}

/// A standardised mean difference with its interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectSize {
    /// Mean difference over the standard deviation of the differences (Cohen's `d_z`).
    pub d: f64,
    /// 95 % interval by the noncentral t distribution; it assumes normal differences.
    pub interval: [f64; 2],
}

/// Effect size of some differences, one per patient; `None` for fewer than two or without spread.
///
/// # Definition
/// `t = d √n` is noncentral t on `n - 1` degrees with noncentrality `δ √n`. The interval's ends are the `δ` for which
/// `t` would be the upper and the lower 2.5 % point.
#[must_use]
pub fn effect_size(differences: &[f64]) -> Option<EffectSize> {
    let summary = Summary::of(differences);
    if !summary.has_spread() {
        return None;
    }
    let Summary { n, mean, sd } = summary;
    let root = (n as f64).sqrt();
    let (d, distribution) = (mean / sd, NoncentralT::new(n - 1));
    let end = |tail: f64| noncentrality(d * root, &distribution, tail) / root;
    Some(EffectSize { d, interval: [end(0.975), end(0.025)] })
}

/// The noncentrality at which `t` has the probability `tail` below it. It falls as the noncentrality grows.
fn noncentrality(t: f64, distribution: &NoncentralT, tail: f64) -> f64 {
    // No more than this many deviations of t at its noncentrality.
    let reach = 10.0 * (1.0 + t.abs());
    let (mut low, mut high) = (t - reach, t + reach);
    for _ in 0..45 {
        let middle = 0.5 * (low + high);
        if distribution.cdf(t, middle) > tail {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// The noncentral t distributions of some degrees of freedom.
///
/// # Definition
/// The probability of staying below `t` at the noncentrality `δ` is `∫ Φ(t s - δ) f(s) ds`, where `s` is the ratio of the estimated
/// to the true standard deviation, `s² ν` being chi-squared on `ν` degrees; by Simpson's rule over all `s` that matter.
///
/// # Accuracy
/// Better than 1e-8 against closed forms for `ν` = 1, 2 and any `ν` at `δ = 0`.
///
/// ```
/// use spineline::evaluate::paired::NoncentralT;
/// // Where t and its noncentrality are zero, half of all values are below.
/// assert!((NoncentralT::new(9).cdf(0.0, 0.0) - 0.5).abs() < 1e-8);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct NoncentralT {
    /// Every `s`, with its density times its weight in Simpson's rule.
    nodes: Vec<(f64, f64)>,
    step: f64,
}

impl NoncentralT {
    const PANELS: usize = 2000;

    /// Of these degrees of freedom, at least one.
    #[must_use]
    pub fn new(freedom: usize) -> Self {
        let nu = freedom as f64;
        // The logarithm of s has a deviation of about 1/√(2ν).
        let spread = 9.0 / (2.0 * nu).sqrt();
        let (low, high) = ((1.0 - spread).max(0.0), 1.0 + spread.max(9.0 / nu));
        let constant = (2.0_f64).ln() + 0.5 * nu * (0.5 * nu).ln() - ln_gamma(0.5 * nu);
        let density = |s: f64| {
            // At nought only one degree of freedom has any density.
            let power = if freedom == 1 { 0.0 } else { (nu - 1.0) * s.ln() };
            (constant + power - 0.5 * nu * s * s).exp()
        };
        let step = (high - low) / Self::PANELS as f64;
        let node = |i: usize| {
            let s = low + step * i as f64;
            let weight = match i {
                0 | Self::PANELS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            (s, weight * density(s))
        };
        Self { nodes: (0..=Self::PANELS).map(node).collect(), step }
    }

    /// Probability that a value of this noncentrality stays below `t`.
    #[must_use]
    pub fn cdf(&self, t: f64, noncentrality: f64) -> f64 {
        let normal = Normal::standard();
        let sum: f64 =
            self.nodes.iter().map(|(s, density)| density * normal.cdf(t * s - noncentrality)).sum();
        (sum * self.step / 3.0).clamp(0.0, 1.0)
    }
}

/// Holm's correction: the probabilities of a family of tests, so adjusted that calling those below 0.05 significant
/// errs anywhere in the family with a probability of at most 0.05, whatever their dependence.
///
/// ```
/// use spineline::evaluate::paired::holm;
/// // The smallest counts three times, the next twice, and none falls below the one before.
/// assert_eq!(holm(&[0.04, 0.01, 0.03]), [0.06, 0.03, 0.06]);
/// ```
#[must_use]
pub fn holm(probabilities: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..probabilities.len()).collect();
    order.sort_by(|&a, &b| probabilities[a].total_cmp(&probabilities[b]));
    let mut adjusted = vec![f64::NAN; probabilities.len()];
    let mut before = 0.0_f64;
    for (rank, &test) in order.iter().enumerate() {
        let times = (order.len() - rank) as f64;
        before = before.max((times * probabilities[test]).min(1.0));
        adjusted[test] = before;
    }
    adjusted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::statistics::Resampling;
    use rand_distr::{Distribution, StandardNormal};
    use statrs::distribution::{Continuous, StudentsT};

    #[test]
    fn all_flips_equal_the_count_by_hand() {
        let differences = [1.5, -0.25, 3.0, 0.75, 2.0, 1.0, -0.5];
        let seen: f64 = differences.iter().sum();
        let as_far = (0..128_u32)
            .filter(|signs| {
                let sign = |i: usize| if signs >> i & 1 == 1 { -1.0 } else { 1.0 };
                let sum: f64 = differences.iter().enumerate().map(|(i, d)| sign(i) * d).sum();
                sum.abs() >= seen
            })
            .count();
        let test = sign_flip(&differences, 1).expect("differences");
        assert_eq!((test.n, test.exact), (7, true));
        assert_eq!(test.p_two_sided, as_far as f64 / 128.0);
    }

    #[test]
    fn equal_differences_have_the_binomial_tail() {
        // Twelve differences of one size, ten of them up: |10 - 2| or more of 12 fair signs.
        let mut differences = [1.0; 12];
        differences[3] = -1.0;
        differences[8] = -1.0;
        let tail = 2.0 * (1.0 + 12.0 + 66.0) / 4096.0;
        assert_eq!(sign_flip(&differences, 1).map(|test| test.p_two_sided), Some(tail));
        // Without a difference all signs are as far from zero.
        assert_eq!(sign_flip(&[0.0, 0.0], 1).map(|test| test.p_two_sided), Some(1.0));
        assert_eq!(sign_flip(&[1.0], 1), None);
    }

    #[test]
    fn sums_looked_up_equal_the_signs_one_by_one() {
        // 31 is not a multiple of eight.
        let differences: Vec<f64> = (0..31).map(|i| (f64::from(i) * 0.7).sin() + 0.2).collect();
        let seen = differences.iter().sum::<f64>().abs();
        for seed in [1, 2] {
            let mut rng = ChaCha12Rng::seed_from_u64(seed);
            let one_by_one = (0..DRAWN)
                .filter(|_| {
                    let mut bytes = [0_u8; 4];
                    rng.fill_bytes(&mut bytes);
                    let signs = u32::from_le_bytes(bytes);
                    let signed = |(i, d): (usize, &f64)| if signs >> i & 1 == 1 { -d } else { *d };
                    differences.iter().enumerate().map(signed).sum::<f64>().abs() >= seen
                })
                .count();
            assert!(one_by_one > 0);
            assert_eq!(drawn_flips(&differences, seen, seed) as usize, one_by_one);
        }
    }

    #[test]
    fn drawn_flips_agree_with_the_binomial_and_depend_on_their_seed_only() {
        // Thirty signs, 21 up: two-sided tail of the fair binomial beyond 21, by its recurrence.
        let differences: Vec<f64> = (0..30).map(|i| if i < 21 { 1.0 } else { -1.0 }).collect();
        let (mut term, mut tail) = (0.5_f64.powi(30), 0.0);
        for k in 0..30 {
            term *= f64::from(30 - k) / f64::from(k + 1);
            tail += if k + 1 >= 21 { 2.0 * term } else { 0.0 };
        }
        let test = sign_flip(&differences, 7).expect("differences");
        assert!(!test.exact);
        let sd = (tail * (1.0 - tail) / f64::from(DRAWN)).sqrt();
        assert!((test.p_two_sided - tail).abs() < 4.0 * sd);
        assert_eq!(sign_flip(&differences, 7), Some(test));
    }

    #[test]
    fn a_permuted_cohort_has_an_identical_probability() {
        let differences: Vec<f64> = (0..31).map(|i| (f64::from(i) * 0.7).sin() + 0.2).collect();
        let permuted: Vec<f64> = (0..31).map(|i| differences[(7 * i + 2) % 31]).collect();
        assert_eq!(sign_flip(&permuted, 7), sign_flip(&differences, 7));
    }

    #[test]
    fn the_noncentral_t_meets_its_closed_forms() {
        let normal = Normal::standard();
        for t in [-3.0, -0.4, 0.0, 0.7, 2.5, 8.0] {
            for freedom in [1, 2, 3, 14, 17, 200] {
                let student = StudentsT::new(0.0, 1.0, freedom as f64).expect("degrees");
                let error = NoncentralT::new(freedom).cdf(t, 0.0) - student.cdf(t);
                assert!(error.abs() < 1e-8, "{t} {freedom} {error}");
            }
            for delta in [-2.0, 0.5, 3.0, 7.0] {
                // Owen: for two degrees of freedom it is Φ(-δ) + √(2π) A √B φ(δ√B) Φ(δ A √B).
                let root_b = (2.0 / (2.0 + t * t)).sqrt();
                let a = t / 2.0_f64.sqrt();
                let closed = normal.cdf(-delta)
                    + std::f64::consts::TAU.sqrt()
                        * a
                        * root_b
                        * normal.pdf(delta * root_b)
                        * normal.cdf(delta * a * root_b);
                let error = NoncentralT::new(2).cdf(t, delta) - closed;
                assert!(error.abs() < 1e-8, "{t} {delta} {error}");
            }
        }
        // Only the normal part puts values below zero.
        assert!((NoncentralT::new(9).cdf(0.0, 1.3) - normal.cdf(-1.3)).abs() < 1e-9);
    }

    #[test]
    fn an_effect_far_from_zero_has_an_interval_too() {
        // Mean 10, deviation 1 of 17: t = 41, and the interval is close to normal theory, d ± 1.96 √(1/n + d²/2n).
        let unit: Vec<f64> = (0..17).map(f64::from).collect();
        let Summary { mean, sd, .. } = Summary::of(&unit);
        let far: Vec<f64> = unit.iter().map(|x| 10.0 + (x - mean) / sd).collect();
        let effect = effect_size(&far).expect("spread");
        assert!((effect.d - 10.0).abs() < 1e-9);
        let half = 1.96 * (1.0 / 17.0 + 100.0 / 34.0_f64).sqrt();
        assert!((effect.interval[0] - (10.0 - half)).abs() < 0.4, "{effect:?}");
        assert!((effect.interval[1] - (10.0 + half)).abs() < 0.4, "{effect:?}");
        for alike in [[1.0, 1.0], [0.3 - 0.2, 0.4 - 0.3]] {
            assert_eq!(effect_size(&alike), None, "{alike:?}");
        }
    }

    #[test]
    fn holm_of_one_is_itself_and_of_none_is_none() {
        assert_eq!(holm(&[0.2]), [0.2]);
        assert!(holm(&[]).is_empty());
        assert_eq!(holm(&[0.9, 0.8]), [1.0, 1.0]);
    }

    #[test]
    fn over_cohorts_of_twelve_tests_err_and_intervals_cover_as_they_say() {
        const COHORTS: u32 = 2000;
        const INTERVALS: u32 = 300;
        let mut rng = ChaCha12Rng::seed_from_u64(11);
        let mut draw = || -> f64 { StandardNormal.sample(&mut rng) };
        let (mut rejected, mut family, mut covered) = (0, 0, 0);
        for cohort in 0..COHORTS {
            let differences: Vec<f64> = (0..12).map(|_| draw()).collect();
            let p = sign_flip(&differences, 1).expect("spread").p_two_sided;
            rejected += u32::from(p <= 0.05);
            // An interval takes a thousand times as long as a test.
            if cohort < INTERVALS {
                let shifted: Vec<f64> = differences.iter().map(|d| d + 0.8).collect();
                let interval = effect_size(&shifted).expect("spread").interval;
                covered += u32::from(interval[0] <= 0.8 && 0.8 <= interval[1]);
            }
            // A family of two that share half their data.
            let other: Vec<f64> = differences.iter().map(|d| 0.5 * (d + draw())).collect();
            let q = sign_flip(&other, 1).expect("spread").p_two_sided;
            family += u32::from(holm(&[p, q]).iter().any(|p| *p <= 0.05));
        }
        // Three binomial deviations at 5 % are 1.5 % of 2000, and 3.8 % of 300.
        let part = |count: u32| f64::from(count) / f64::from(COHORTS);
        assert!((0.035..=0.065).contains(&part(rejected)), "{rejected}");
        let covered = f64::from(covered) / f64::from(INTERVALS);
        assert!((0.912..=0.988).contains(&covered), "{covered}");
        assert!(part(family) <= 0.065, "{family}");
    }

    #[test]
    fn the_bootstrap_of_fifteen_patients_is_a_little_too_narrow() {
        let mut rng = ChaCha12Rng::seed_from_u64(5);
        let mut covered = 0;
        for seed in 0..300 {
            let means: Vec<f64> = (0..15).map(|_| StandardNormal.sample(&mut rng)).collect();
            let [low, high] = Resampling::new(400, seed).interval(&means).expect("clusters");
            covered += u32::from(low <= 0.0 && 0.0 <= high);
        }
        // Percentile intervals of n values cover like z with the deviation of n: 91 to 93 % at 15.
        assert!((0.86..=0.97).contains(&(f64::from(covered) / 300.0)), "{covered}");
    }
}
