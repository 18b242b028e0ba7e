use crate::evaluate::paired::{EffectSize, SignFlip, effect_size, holm, sign_flip};
use crate::evaluate::statistics::{PairedT, Resampling, Summary, paired_t};

/// Two samples of the same things, one value of each per thing.
///
/// The pooled test is the paper's and takes vertebrae of one patient for independent, so its `p` is far too small. All else
/// takes one mean difference per patient. Use [`Self::sign_flip`] for significance, since it has the fewest assumptions;
/// [`Self::bootstrap`] for how large the difference is, in its own unit; [`Self::effect`] beside it. The t-test on
/// patients is there because readers know it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairedComparison {
    /// Over all pairs, as the paper did.
    pub pooled: Option<PairedT>,
    /// Over one mean difference per patient.
    pub patients: Option<PairedT>,
    /// Chance: a permutation test over one mean difference per patient.
    pub sign_flip: Option<SignFlip>,
    /// 95 % percentile interval of the mean difference, resampling patients. With fewer than twenty it is somewhat narrow.
    pub bootstrap: Option<[f64; 2]>,
    /// Mean over the deviation of the patients' differences.
    pub effect: Option<EffectSize>,
    /// Mean of the patients' mean differences; NaN where there is none.
    pub mean_difference: f64,
}

impl PairedComparison {
    /// By patient: values of both, in the same order; patients without any are left out.
    #[must_use]
    pub fn new(a: &[Vec<f64>], b: &[Vec<f64>], resampling: &Resampling) -> Self {
        let flat = |v: &[Vec<f64>]| v.iter().flatten().copied().collect::<Vec<f64>>();
        let (mut means_a, mut means_b) = (Vec::new(), Vec::new());
        for (a, b) in a.iter().zip(b).filter(|(a, _)| !a.is_empty()) {
            means_a.push(Summary::of(a).mean);
            means_b.push(Summary::of(b).mean);
        }
        let differences: Vec<f64> = means_a.iter().zip(&means_b).map(|(a, b)| a - b).collect();
        let clusters: Vec<Vec<f64>> = differences.iter().map(|d| vec![*d]).collect();
        Self {
            pooled: paired_t(&flat(a), &flat(b)),
            patients: paired_t(&means_a, &means_b),
            sign_flip: sign_flip(&differences, resampling.seed()),
            bootstrap: resampling.interval(&clusters),
            effect: effect_size(&differences),
            mean_difference: Summary::of(&differences).mean,
        }
    }

    /// Patients that have both.
    #[must_use]
    pub fn patients(&self) -> usize {
        self.sign_flip.map_or(0, |test| test.n)
    }
}

/// Sign-flip probabilities of a family of comparisons after Holm's correction; `None` where there is no such test.
pub(super) fn corrected_by_holm<'a>(
    family: impl Iterator<Item = &'a PairedComparison>,
) -> Vec<Option<f64>> {
    let flips: Vec<Option<f64>> =
        family.map(|one| one.sign_flip.map(|test| test.p_two_sided)).collect();
    let adjusted = holm(&flips.iter().flatten().copied().collect::<Vec<f64>>());
    let mut adjusted = adjusted.into_iter();
    flips.into_iter().map(|flip| flip.and_then(|_| adjusted.next())).collect()
}
