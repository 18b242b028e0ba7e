use crate::anatomy::named;
use crate::evaluate::paired::{EffectSize, SignFlip, effect_size, holm, sign_flip};
use crate::evaluate::statistics::{PairedT, Summary};
use crate::personalize::TestOutcome;

named! {
    /// Outcome of a comparison of errors for the first model against the second. All outputs use these words.
    pub enum ComparisonOutcome {
        /// Its error is smaller, significantly after Holm's correction.
        Better = "better",
        /// Its error is larger: significantly after Holm's correction, or the whole 95 % interval of the difference is above zero
        /// over at least six patients. A claim that a model is better needs the correction; that it is worse does not.
        Worse = "worse",
        /// The data show no difference.
        NoDifference = "no_significant_difference" as "no significant difference",
        /// Too few patients have both.
        NotTested = "not_tested" as "not tested",
    }
}

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
    /// 95 % percentile interval of the mean difference, resampling patients; `None` for fewer than
    /// [`Resampling::FEWEST`](crate::evaluate::statistics::Resampling::FEWEST). With fewer than twenty it is somewhat narrow.
    pub bootstrap: Option<[f64; 2]>,
    /// Mean over the deviation of the patients' differences.
    pub effect: Option<EffectSize>,
    /// Mean of the patients' mean differences; NaN without a difference.
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

    /// The outcome for the first by the differences, first minus second, and the probability after Holm's correction.
    #[must_use]
    pub fn outcome(&self, holm_p: Option<f64>) -> ComparisonOutcome {
        let is_larger = self.mean_difference > 0.0;
        let is_clearly_larger = self.bootstrap.is_some_and(|[low, _]| low > 0.0);
        match TestOutcome::of(holm_p) {
            TestOutcome::NotTested => ComparisonOutcome::NotTested,
            TestOutcome::Rejected if !is_larger => ComparisonOutcome::Better,
            TestOutcome::Rejected => ComparisonOutcome::Worse,
            TestOutcome::Kept if is_clearly_larger => ComparisonOutcome::Worse,
            TestOutcome::Kept => ComparisonOutcome::NoDifference,
        }
    }
}

/// Sign-flip probabilities of a family of comparisons after Holm's correction; `None` without a test.
pub(super) fn corrected_by_holm(family: &[PairedComparison]) -> Vec<Option<f64>> {
    let flips: Vec<Option<f64>> =
        family.iter().map(|one| one.sign_flip.map(|test| test.p_two_sided)).collect();
    let adjusted = holm(&flips.iter().flatten().copied().collect::<Vec<f64>>());
    let mut adjusted = adjusted.into_iter();
    flips.into_iter().map(|flip| flip.and_then(|_| adjusted.next())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_larger_error_with_a_whole_interval_above_zero_is_worse() {
        let outcome = |mean_difference, interval, holm_p| {
            let differences = [mean_difference; 6];
            let pooled = Summary::of(&differences);
            let one = PairedComparison::of_differences(pooled, &differences, Some(interval), 0);
            one.outcome(holm_p)
        };
        assert_eq!(outcome(2.5, [0.7, 4.7], Some(0.3)), ComparisonOutcome::Worse);
        assert_eq!(outcome(2.5, [0.7, 4.7], Some(0.01)), ComparisonOutcome::Worse);
        assert_eq!(outcome(2.5, [-0.1, 4.7], Some(0.3)), ComparisonOutcome::NoDifference);
        // To be better takes Holm's correction.
        assert_eq!(outcome(-2.5, [-4.7, -0.7], Some(0.3)), ComparisonOutcome::NoDifference);
        assert_eq!(outcome(-2.5, [-4.7, -0.7], Some(0.01)), ComparisonOutcome::Better);
        assert_eq!(outcome(2.5, [0.7, 4.7], None), ComparisonOutcome::NotTested);
    }
}
