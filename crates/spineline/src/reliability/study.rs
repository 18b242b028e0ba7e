use super::agreement::{bland_altman, mdc95, pairs, pearson, sem};
use super::icc::MeanSquares;
use super::ratings::{Ratings, Reader};
use super::{BlandAltman, RatedQuantity, Statistic, StatisticEstimate, StatisticKind, Undefined};
use crate::measure::{alike_names, alike_words};
use crate::warning::{counted, first_named};

/// Who is compared with whom.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Design {
    /// Observers, each by the mean over his repeats: the paper's inter-observer design.
    #[error("between observers, means of repeats")]
    InterObserverMeans,
    /// Observers, each by one reading: how far two people's single readings are apart.
    #[error("between observers, repeat {repeat} alone")]
    InterObserverSingle {
        /// The repeat that is taken of each.
        repeat: u32,
    },
    /// The repeats of one observer.
    #[error("within observer {observer}")]
    IntraObserver {
        /// Which observer.
        observer: String,
    },
}

impl Design {
    /// Stable name.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::InterObserverMeans => "inter_observer_means",
            Self::InterObserverSingle { .. } => "inter_observer_single",
            Self::IntraObserver { .. } => "intra_observer",
        }
    }
}

/// A remark for readers of the numbers.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Remark {
    /// Subjects that somebody did not read are left out.
    #[error(
        "{dropped} of {subjects} subjects were not read equally often by all observers and are left out: {}",
        first_named(first.iter().cloned(), *dropped)
    )]
    Dropped {
        /// How many.
        dropped: usize,
        /// Of how many.
        subjects: usize,
        /// Names of the first ones.
        first: Vec<String>,
    },
    /// Observers' means rest on different numbers of repeats, so their errors differ.
    #[error("observers read {} to {} times, so their means are not equally precise", repeats[0], repeats[1])]
    UnequalRepeats {
        /// Fewest and most repeats.
        repeats: [usize; 2],
    },
    /// Limits between means are narrower than between single readings.
    #[error(
        "SEM, MDC95 and limits of agreement are for means over repeats; single readings differ more"
    )]
    MeansAreSteadier,
    /// Names of observers that differ by capitals and marks alone count as several observers.
    #[error("{}", alike_words(names))]
    AlikeNames {
        /// The names.
        names: Vec<String>,
    },
    /// Subjects whose names differ by capitals and marks alone count as several.
    #[error("{words}")]
    AlikeSubjects {
        /// Their names, in words.
        words: String,
    },
    /// The variance between raters is estimated below zero.
    #[error(
        "the means of the observers, or of the repeats of one, differ by less than the random error explains: the variance between them is estimated below zero and counts as zero in SEM and MDC95 for agreement, which equal those for consistency; the ICCs keep their published formula"
    )]
    NoRaterVariance,
    /// A coefficient is negative: readings differ more within subjects than between them. It is shown as it is.
    #[error(
        "the ICC is negative: readings differ more within subjects than subjects differ; it is reported unchanged"
    )]
    NegativeIcc,
    /// All raters agree to the last digit, so the error's size is not known; rounding may hide it.
    #[error("all readings agree exactly, so the error cannot be estimated")]
    PerfectAgreement,
    /// Two subjects make an interval without information.
    #[error("two subjects: the intervals are too wide to be informative")]
    TwoSubjects,
    /// Vertebrae that a program marked and no person reviewed are left out.
    #[error("{} found by a program, and not accepted or moved by a person, left out", counted(*readings, "vertebra reading"))]
    NotReviewed {
        /// Readings of a vertebra.
        readings: usize,
    },
    /// Readers accepted corners that a program had proposed.
    #[error("{} with corners that readers accepted from the program: readers share its model, so their agreement is better than by clicks", counted(*readings, "vertebra reading"))]
    Accepted {
        /// Readings of a vertebra.
        readings: usize,
    },
    /// Readings with the landmarks of another one of their film are left out.
    #[error(
        "{} with the same landmarks as another one of the film left out, since copies do not show the errors of readers: {}",
        counted(readings.len(), "reading"),
        first_named(readings.iter().cloned(), readings.len())
    )]
    Copied {
        /// The readings.
        readings: Vec<String>,
    },
    /// Films in pixels are left out of lengths in millimetres.
    #[error(
        "{} in pixels left out of lengths: {}",
        counted(films.len(), "film"),
        first_named(films.iter().cloned(), films.len())
    )]
    InPixels {
        /// The films.
        films: Vec<String>,
    },
}

impl Remark {
    /// Stable name.
    #[must_use]
    pub const fn key(&self) -> &'static str {
        match self {
            Self::Dropped { .. } => "subjects_dropped",
            Self::UnequalRepeats { .. } => "unequal_repeats",
            Self::MeansAreSteadier => "means_are_steadier",
            Self::AlikeNames { .. } => "observers_alike",
            Self::AlikeSubjects { .. } => "subjects_alike",
            Self::NoRaterVariance => "no_rater_variance",
            Self::NegativeIcc => "negative_icc",
            Self::PerfectAgreement => "perfect_agreement",
            Self::TwoSubjects => "two_subjects",
            Self::NotReviewed { .. } => "not_reviewed",
            Self::Accepted { .. } => "accepted",
            Self::Copied { .. } => "copied",
            Self::InPixels { .. } => "in_pixels",
        }
    }
}

/// All statistics of one quantity in one design.
#[derive(Debug, Clone, PartialEq)]
pub struct DesignReliability {
    /// Who is compared.
    pub design: Design,
    /// Names of the raters: observers, or one observer's repeats.
    pub raters: Vec<String>,
    /// Subjects that all raters rated: the n of every statistic.
    pub subjects: usize,
    /// Subjects that were left out because somebody did not read them.
    pub dropped: usize,
    /// Readings in one rater's value, by rater.
    pub repeats: Vec<usize>,
    /// In the order of [`StatisticKind::ALL`].
    pub statistics: Vec<Statistic>,
    /// One per pair of raters; empty where the statistics say why.
    pub bland_altman: Vec<BlandAltman>,
    /// What to know about them.
    pub remarks: Vec<Remark>,
}

impl DesignReliability {
    /// One statistic.
    ///
    /// # Errors
    /// Why it is missing.
    pub fn statistic(&self, kind: StatisticKind) -> Result<StatisticEstimate, Undefined> {
        let found = self.statistics.iter().find(|statistic| statistic.kind == kind);
        found.expect("every design has every statistic").outcome
    }
}

/// One quantity in every design that its readings allow, and in those that they do not, with the reason.
#[derive(Debug, Clone, PartialEq)]
pub struct QuantityReliability {
    /// Stable name of the quantity.
    pub key: String,
    /// Unit of its readings, and of SEM, MDC95 and limits of agreement.
    pub unit: String,
    /// What it is, and what its subjects are.
    pub meaning: String,
    /// Between observers first, then within each.
    pub designs: Vec<DesignReliability>,
}

impl QuantityReliability {
    /// The name in words, such as `tilt step`.
    #[must_use]
    pub fn words(&self) -> String {
        self.key.replace('_', " ")
    }
}

/// Computes every statistic of every design of a table of readings.
#[must_use]
pub fn assess(quantity: &RatedQuantity) -> QuantityReliability {
    let readers = quantity.readers();
    let all = |observer: &str, repeats: &[u32]| -> Vec<Reader> {
        repeats.iter().map(|&repeat| (observer.to_owned(), repeat)).collect()
    };
    let names: Vec<String> = readers.keys().map(|&name| name.to_owned()).collect();
    let means = readers.iter().map(|(name, repeats)| all(name, repeats)).collect();
    let mut designs =
        vec![assess_design(quantity, Design::InterObserverMeans, names.clone(), means)];
    if readers.values().any(|repeats| repeats.len() > 1) {
        // The first that all made; without one the table has gaps, and says so.
        let shared = readers
            .values()
            .flatten()
            .copied()
            .filter(|repeat| readers.values().all(|repeats| repeats.contains(repeat)));
        let repeat = shared.min().unwrap_or(1);
        let raters = names.iter().map(|name| all(name, &[repeat])).collect();
        let design = Design::InterObserverSingle { repeat };
        designs.push(assess_design(quantity, design, names, raters));
    }
    for (name, repeats) in &readers {
        let raters = repeats.iter().map(|&repeat| all(name, &[repeat])).collect();
        let names = repeats.iter().map(|repeat| format!("{name}, repeat {repeat}")).collect();
        let design = Design::IntraObserver { observer: (*name).to_owned() };
        designs.push(assess_design(quantity, design, names, raters));
    }
    let (key, unit) = (quantity.key.clone(), quantity.unit.clone());
    QuantityReliability { key, unit, meaning: quantity.meaning.clone(), designs }
}

fn assess_design(
    quantity: &RatedQuantity,
    design: Design,
    names: Vec<String>,
    raters: Vec<Vec<Reader>>,
) -> DesignReliability {
    let (rows, left_out) = quantity.complete(&raters);
    let (subjects, of) = (rows.len(), quantity.subjects());
    let table = match (&design, raters.len() < 2) {
        (Design::IntraObserver { .. }, true) => Err(Undefined::OneRepeat),
        (_, true) => Err(Undefined::OneObserver),
        (_, false) => Ratings::new(rows, of),
    };
    let squares = table.as_ref().map_err(|reason| *reason).and_then(MeanSquares::of);
    let statistics: Vec<Statistic> = StatisticKind::ALL
        .into_iter()
        .map(|kind| Statistic { kind, outcome: outcome(kind, &table, squares) })
        .collect();
    let bland_altman = table.as_ref().map_or_else(
        |_| Vec::new(),
        |table| {
            pairs(names.len()).filter_map(|(i, j)| bland_altman(table, &names, i, j).ok()).collect()
        },
    );
    let repeats: Vec<usize> = raters.iter().map(Vec::len).collect();
    let mut found = DesignReliability {
        design,
        raters: names,
        subjects,
        dropped: of - subjects,
        repeats,
        statistics,
        bland_altman,
        remarks: Vec::new(),
    };
    found.remarks = remarks(quantity, &found, squares.ok(), left_out);
    found
}

fn outcome(
    kind: StatisticKind,
    table: &Result<Ratings, Undefined>,
    squares: Result<MeanSquares, Undefined>,
) -> Result<StatisticEstimate, Undefined> {
    let squares = squares?;
    match kind {
        StatisticKind::SemAgreement => Ok(sem(squares.agreement_variance())),
        StatisticKind::Mdc95Agreement => Ok(mdc95(sem(squares.agreement_variance()))),
        StatisticKind::SemConsistency => Ok(sem(squares.consistency_variance())),
        StatisticKind::Mdc95Consistency => Ok(mdc95(sem(squares.consistency_variance()))),
        StatisticKind::IccAgreement => squares.icc_agreement(),
        StatisticKind::IccConsistency => squares.icc_consistency(),
        StatisticKind::IccAverage => squares.icc_average(),
        StatisticKind::Pearson => pearson(table.as_ref().map_err(|reason| *reason)?),
    }
}

fn remarks(
    quantity: &RatedQuantity,
    found: &DesignReliability,
    squares: Option<MeanSquares>,
    left_out: Vec<String>,
) -> Vec<Remark> {
    let mut remarks = Vec::new();
    if !matches!(found.design, Design::IntraObserver { .. }) {
        let alike = alike_names(found.raters.iter().map(String::as_str)).into_iter();
        remarks.extend(alike.map(|names| Remark::AlikeNames {
            names: names.into_iter().map(str::to_owned).collect(),
        }));
        let alike = quantity.alike_subjects();
        remarks.extend(alike.map(|words| Remark::AlikeSubjects { words }));
    }
    if quantity.not_reviewed > 0 {
        remarks.push(Remark::NotReviewed { readings: quantity.not_reviewed });
    }
    if quantity.accepted > 0 {
        remarks.push(Remark::Accepted { readings: quantity.accepted });
    }
    if !quantity.copied.is_empty() {
        remarks.push(Remark::Copied { readings: quantity.copied.clone() });
    }
    if !quantity.left_out_in_pixels.is_empty() {
        remarks.push(Remark::InPixels { films: quantity.left_out_in_pixels.clone() });
    }
    if found.raters.len() < 2 {
        return remarks;
    }
    if found.dropped > 0 {
        let subjects = found.subjects + found.dropped;
        remarks.push(Remark::Dropped { dropped: found.dropped, subjects, first: left_out });
    }
    let fewest = found.repeats.iter().copied().min().unwrap_or(0);
    let most = found.repeats.iter().copied().max().unwrap_or(0);
    if fewest < most {
        remarks.push(Remark::UnequalRepeats { repeats: [fewest, most] });
    }
    if most > 1 {
        remarks.push(Remark::MeansAreSteadier);
    }
    let negative = |statistic: &Statistic| {
        statistic.kind.is_icc() && statistic.outcome.is_ok_and(|estimate| estimate.value < 0.0)
    };
    if found.statistics.iter().any(negative) {
        remarks.push(Remark::NegativeIcc);
    }
    if squares.is_some_and(|squares| squares.is_rater_variance_negative()) {
        remarks.push(Remark::NoRaterVariance);
    }
    if squares.is_some_and(|squares| squares.is_perfect()) {
        remarks.push(Remark::PerfectAgreement);
    }
    if found.subjects == 2 {
        remarks.push(Remark::TwoSubjects);
    }
    remarks
}
