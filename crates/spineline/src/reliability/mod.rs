//! Step 1, reliability: readings of the same subjects → reliability and measurement error.
//!
//! The paper's Pearson correlations are reported with the statistics that answer another question: whether readings *agree*
//! (ICC for absolute agreement), and by how much they differ (SEM, MDC95, limits of agreement). A correlation ignores
//! a constant difference between readers, and it and every ICC grow with the spread of the subjects. The errors do not:
//! they are the main result.
//!
//! A [`RatedQuantity`] is a table of subjects × observers × repeats; [`assess`] computes for it, for every [`Design`], every
//! [`StatisticKind`]. A missing value has a reason ([`Undefined`]); NaN never occurs. [`film_quantities`] makes the
//! tables of marked films.
//!
//! # Equations
//! For ratings `x_ij` of `n` subjects by `k` raters, with the means `x_i.` of a subject, `x_.j` of a rater and `x_..` of all:
//!
//! ```text
//! MSR = k sum_i (x_i. - x_..)^2 / (n - 1)                                   between subjects
//! MSC = n sum_j (x_.j - x_..)^2 / (k - 1)                                   between raters
//! MSE = sum_ij (x_ij - x_i. - x_.j + x_..)^2 / ((n - 1) (k - 1))            rest
//!
//! ICC(2,1) = (MSR - MSE) / (MSR + (k - 1) MSE + k (MSC - MSE) / n)          agreement, one rater
//! ICC(3,1) = (MSR - MSE) / (MSR + (k - 1) MSE)                              consistency, one rater
//! ICC(2,k) = (MSR - MSE) / (MSR + (MSC - MSE) / n)                          agreement, mean of k raters
//!
//! SEM_agreement   = sqrt(MSE + max(0, MSC - MSE) / n)
//! SEM_consistency = sqrt(MSE)
//! MDC95           = 1.96 sqrt(2) SEM
//! ```
//!
//! The variance between raters, `(MSC - MSE) / n`, is estimated below zero where their means differ by less than the rest explains. A
//! variance is not, so it is zero in SEM and MDC95; agreement is then consistency. The coefficients keep their published formula, which
//! other programs print too; [`Remark::NoRaterVariance`] says so.
//!
//! Intervals of ICC(2,1) and ICC(3,1) are by F quantiles [shrout-fleiss-1979], for ICC(2,1) with Satterthwaite's degrees of freedom;
//! the interval of ICC(2,k) follows by Spearman and Brown's formula.
//!
//! # Departures from the paper
//! Subjects are pooled over films and vertebrae, as the paper did, though vertebrae of one film are not independent:
//! intervals are too narrow.
//!
//! # References
//! [shrout-fleiss-1979], [mcgraw-wong-1996], [koo-li-2016], [bland-altman-1986], [de-vet-2006].

mod agreement;
mod films;
mod icc;
mod quantile;
mod ratings;
mod study;
#[cfg(test)]
mod tests;
mod words;

pub use agreement::BlandAltman;
pub use films::{FilmQuantities, film_quantities};
pub use ratings::RatedQuantity;
pub use study::{Design, DesignReliability, QuantityReliability, Remark, assess};
pub use words::{shown_coefficient, shown_measure};

use crate::anatomy::named;

/// Why the value of a statistic is missing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Undefined {
    /// A second observer is missing.
    #[error("one observer only: give readings of a second one")]
    OneObserver,
    /// Nothing to compare a reading with.
    #[error("one repeat only: let the observer read again")]
    OneRepeat,
    /// No spread between the subjects, or between the readings of one rater: the ratio is 0/0.
    #[error("the readings have no variance, so they cannot be compared")]
    ZeroVariance,
    /// Fewer subjects than the statistic needs.
    #[error("{}, and at least {least} are needed", crate::warning::counted(*n, "subject"))]
    TooFewSubjects {
        /// Subjects that all raters rated.
        n: usize,
        /// The least number.
        least: usize,
    },
    /// Too few subjects were rated by all raters.
    #[error("only {complete} of {subjects} subjects were read by all: fill the gaps")]
    MissingCells {
        /// Subjects that all raters rated.
        complete: usize,
        /// All subjects.
        subjects: usize,
    },
    /// The estimated variances add up to zero or less, so that their ratio is not a coefficient.
    #[error(
        "the sum of the estimated variances is not positive: readings disagree more within than between subjects"
    )]
    VarianceNotPositive,
    /// The interval's equation has no finite solution.
    #[error(
        "the equation of the interval has no finite solution: the readings are too few or disagree too much"
    )]
    NoInterval,
    /// A mean over pairs that share raters has no simple interval.
    #[error(
        "the pairs share observers or repeats, so their mean has no simple interval; see the pairs"
    )]
    DependentPairs,
    /// A reading is not a finite number, or the numbers are too large to be squared.
    #[error("a reading is not a number, or too large to compute with")]
    NotFinite,
}

impl Undefined {
    /// Stable name.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::OneObserver => "one_observer",
            Self::OneRepeat => "one_repeat",
            Self::ZeroVariance => "zero_variance",
            Self::TooFewSubjects { .. } => "too_few_subjects",
            Self::MissingCells { .. } => "missing_cells",
            Self::VarianceNotPositive => "variance_not_positive",
            Self::NoInterval => "no_interval",
            Self::DependentPairs => "dependent_pairs",
            Self::NotFinite => "not_finite",
        }
    }
}

named! {
    /// What is estimated, the errors first. The text has the symbol, then its definition or model.
    pub enum StatisticKind {
        /// Standard error of measurement with raters' offsets and random error: another rater's reading of the same subject.
        SemAgreement = "sem_agreement" as "SEM, agreement",
        /// Smallest change between two readings that is more than this error, with 95 % confidence.
        Mdc95Agreement = "mdc95_agreement" as "MDC95, agreement",
        /// Standard error of measurement with random error alone: the same rater's, or raters whose offsets do not matter.
        SemConsistency = "sem_consistency" as "SEM, consistency",
        /// Smallest change between two readings that is more than this error, with 95 % confidence.
        Mdc95Consistency = "mdc95_consistency" as "MDC95, consistency",
        /// Intraclass correlation ICC(2,1) of [shrout-fleiss-1979], ICC(A,1) of [mcgraw-wong-1996].
        IccAgreement = "icc_2_1" as "ICC(2,1) = ICC(A,1): two-way random, absolute agreement, single rater",
        /// ICC(3,1), ICC(C,1).
        IccConsistency = "icc_3_1" as "ICC(3,1) = ICC(C,1): two-way mixed, consistency, single rater",
        /// ICC(2,k), ICC(A,k).
        IccAverage = "icc_2_k" as "ICC(2,k) = ICC(A,k): two-way random, absolute agreement, mean of k raters",
        /// Pearson's correlation, mean over the pairs of raters: the paper's.
        Pearson = "pearson" as "Pearson r, mean over pairs of raters (the paper's)",
    }
}

impl StatisticKind {
    /// Its formula. MSR, MSC and MSE are the mean squares of subjects, raters and rest of the two-way table of n subjects
    /// and k raters.
    #[must_use]
    pub const fn definition(self) -> &'static str {
        match self {
            Self::SemAgreement => {
                "sqrt(MSE + max(0, MSC - MSE)/n): raters' offsets and random error"
            }
            Self::SemConsistency => "sqrt(MSE): random error alone, without raters' offsets",
            Self::Mdc95Agreement | Self::Mdc95Consistency => "1.96 sqrt(2) SEM",
            Self::IccAgreement => "(MSR - MSE)/(MSR + (k - 1) MSE + k (MSC - MSE)/n)",
            Self::IccConsistency => "(MSR - MSE)/(MSR + (k - 1) MSE)",
            Self::IccAverage => "(MSR - MSE)/(MSR + (MSC - MSE)/n)",
            Self::Pearson => "covariance over the product of standard deviations",
        }
    }

    /// Whether it is an intraclass correlation.
    pub(crate) const fn is_icc(self) -> bool {
        matches!(self, Self::IccAgreement | Self::IccConsistency | Self::IccAverage)
    }

    /// Whether it carries the unit of the readings; else it has none.
    #[must_use]
    pub const fn has_unit(self) -> bool {
        !self.is_icc() && !matches!(self, Self::Pearson)
    }
}

/// A statistic that could be estimated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatisticEstimate {
    /// Its value.
    pub value: f64,
    /// Standard deviation over the pairs of raters, where it is a mean over more than one.
    pub sd: Option<f64>,
    /// Its 95 % confidence interval.
    pub interval: Result<[f64; 2], Undefined>,
}

/// One statistic of one design.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Statistic {
    /// Which.
    pub kind: StatisticKind,
    /// Its value, or why it is missing.
    pub outcome: Result<StatisticEstimate, Undefined>,
}
