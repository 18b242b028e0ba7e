use crate::evaluate::paired::{EffectSize, SignFlip, effect_size, holm, sign_flip};
use crate::evaluate::statistics::{PairedT, Summary};

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
    /// From the summary of the differences of all pairs, and one mean difference per patient with the interval of their mean.
    pub(super) fn of_differences(
        pooled: Summary,
        differences: &[f64],
        bootstrap: Option<[f64; 2]>,
        seed: u64,
    ) -> Self {
        let patients = Summary::of(differences);
        Self {
            pooled: PairedT::of_differences(pooled),
            patients: PairedT::of_differences(patients),
            sign_flip: sign_flip(differences, seed),
            bootstrap,
            effect: effect_size(differences),
            mean_difference: patients.mean,
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
