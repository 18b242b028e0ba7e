use crate::anatomy::named;
use crate::evaluate::paired::{
    EXACT_UP_TO, EffectSize, SignFlip, effect_size, holm, least_p, sign_flip,
};
use crate::evaluate::statistics::{PairedT, Summary};
use crate::personalize::{SIGNIFICANCE, TestOutcome};
use crate::warning::counted;

named! {
    /// Outcome of a comparison of errors for the first model against the second. All outputs use these words.
    pub enum ComparisonOutcome {
        /// Its error is smaller, significantly after Holm's correction.
        Better = "better",
        /// Its error is larger, significantly after Holm's correction.
        Worse = "worse",
        /// The data show no difference.
        NoDifference = "no_significant_difference" as "no significant difference",
        /// Too few patients have both for any significant difference.
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

    /// Whether at least two patients have both.
    #[must_use]
    pub const fn is_compared(&self) -> bool {
        self.sign_flip.is_some()
    }

    /// Patients that have both.
    #[must_use]
    pub fn patients(&self) -> usize {
        self.sign_flip.map_or(0, |test| test.n)
    }

    /// The outcome for the first by the differences, first minus second, and the probability after Holm's correction.
    #[must_use]
    pub fn outcome(&self, holm_p: Option<f64>) -> ComparisonOutcome {
        match TestOutcome::of(holm_p) {
            TestOutcome::NotTested => ComparisonOutcome::NotTested,
            TestOutcome::Rejected if self.mean_difference < 0.0 => ComparisonOutcome::Better,
            TestOutcome::Rejected => ComparisonOutcome::Worse,
            TestOutcome::Kept => ComparisonOutcome::NoDifference,
        }
    }
}

/// Sign-flip probabilities of a family of comparisons after Holm's correction; `None` where no difference of as many patients is
/// significant after it.
pub(super) fn corrected_by_holm(family: &[PairedComparison]) -> Vec<Option<f64>> {
    let tests: Vec<SignFlip> = family.iter().filter_map(|one| one.sign_flip).collect();
    let adjusted = |p: fn(&SignFlip) -> f64| holm(&tests.iter().map(p).collect::<Vec<f64>>());
    let found = adjusted(|test| test.p_two_sided).into_iter().zip(adjusted(|test| least_p(test.n)));
    let mut found = found.map(|(p, least)| (least < SIGNIFICANCE).then_some(p));
    family.iter().map(|one| one.sign_flip.and_then(|_| found.next().flatten())).collect()
}

/// The number of patients that are enough for a significant difference in a family of this number of tests, in words.
///
/// # Definition
/// The smallest `n` whose least sign-flip probability, `2 / 2^n`, times the number of tests is below [`SIGNIFICANCE`]. Tests of at least `n`
/// patients are tested, whatever the number of patients of the others.
#[must_use]
pub fn enough_words(tests: usize) -> String {
    let family = counted(tests, "test");
    let is_enough = |&n: &usize| tests as f64 * least_p(n) < SIGNIFICANCE;
    let needs = if tests == 1 { "needs" } else { "need" };
    (2..=EXACT_UP_TO).find(is_enough).map_or_else(
        || format!("no number of patients is enough for {family}"),
        |n| format!("{family} {needs} {n} patients with films that both predict"),
    )
}

/// Why comparisons of a family of this number of tests are not tested: the number of patients that are enough, and the largest number that a
/// comparison has.
#[must_use]
pub fn too_few_words<'a>(
    tests: usize,
    untested: impl IntoIterator<Item = &'a PairedComparison>,
) -> String {
    let most = untested.into_iter().map(PairedComparison::patients).max().unwrap_or_default();
    format!("{}; at most {most} have them", enough_words(tests))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(differences: &[f64]) -> PairedComparison {
        PairedComparison::of_differences(Summary::of(differences), differences, None, 0)
    }

    #[test]
    fn better_and_worse_take_the_correction() {
        let outcome = |mean, holm_p| comparison(&[mean; 6]).outcome(holm_p);
        assert_eq!(outcome(2.5, Some(0.3)), ComparisonOutcome::NoDifference);
        assert_eq!(outcome(2.5, Some(0.01)), ComparisonOutcome::Worse);
        assert_eq!(outcome(-2.5, Some(0.3)), ComparisonOutcome::NoDifference);
        assert_eq!(outcome(-2.5, Some(0.01)), ComparisonOutcome::Better);
        assert_eq!(outcome(2.5, None), ComparisonOutcome::NotTested);
    }

    #[test]
    fn a_family_whose_patients_are_too_few_is_not_tested() {
        // Oracle: of n patients p is at least 2/2^n, and Holm multiplies the least p of 18 tests by 18.
        let family = |patients: usize| vec![comparison(&vec![1.0; patients]); 18];
        assert!(corrected_by_holm(&family(9)).iter().all(Option::is_none));
        assert_eq!(corrected_by_holm(&family(10)), [Some(18.0 / 512.0); 18]);
        let both = "patients with films that both predict";
        assert_eq!(enough_words(18), format!("18 tests need 10 {both}"));
        // 30 · 2/1024 is above 0.05. The number of patients who have the films counts, whatever the number of patients of the cohort.
        let mut thirty = vec![comparison(&[1.0; 10]); 30];
        thirty[4] = comparison(&[1.0; 7]);
        let words = too_few_words(30, &thirty);
        assert_eq!(words, format!("30 tests need 11 {both}; at most 10 have them"));
        assert!(words.len() <= 100, "{words}");
        // One test needs six patients: 2/32 is above 0.05.
        assert_eq!(enough_words(1), format!("1 test needs 6 {both}"));
        // Without a difference the p value is 1, which is a result.
        let mut mixed = family(10);
        mixed[3] = comparison(&[0.0; 10]);
        mixed[5] = comparison(&[1.0]);
        let corrected = corrected_by_holm(&mixed);
        assert_eq!((corrected[3], corrected[5]), (Some(1.0), None));
    }
}
