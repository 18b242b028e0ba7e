//! One number of the paper, our number, and their comparison in words.

use spineline::cohort::Cohort;
use spineline::evaluate::statistics::{PairedT, Summary};
use spineline::multibody::Support;
use spineline::number::{fixed, probability, times, with_sd};
use spineline::personalize::TestOutcome;

use super::Columns;
use crate::paper::PaperMean;
use crate::phrases::none;

/// Numbers under one heading.
#[derive(Debug, Clone)]
pub struct Part {
    /// Heading.
    pub title: String,
    /// `None` where the support does not matter.
    pub support: Option<Support>,
    /// The numbers.
    pub rows: Vec<PaperNumber>,
    /// What the numbers are, and why ours may differ.
    pub note: String,
}

pub(super) const fn support_words(support: Support) -> &'static str {
    match support {
        Support::Free => "free support (the paper's)",
        Support::Frontal => "frontal support (in the frontal plane, as on a table)",
    }
}

/// One number of the paper beside ours.
#[derive(Debug, Clone)]
pub struct PaperNumber {
    /// What it measures; blanks at its start indent it.
    pub quantity: String,
    /// Unit of the means.
    pub unit: &'static str,
    /// As the paper prints it; `None` where the paper does not give it.
    pub paper: Option<String>,
    /// By group.
    pub ours: Vec<Cell>,
    /// Comparison with the paper; empty where the paper does not give it.
    pub verdict: String,
}

/// One number of ours.
#[derive(Debug, Clone)]
pub struct Cell {
    /// As it is printed.
    pub text: String,
    /// Mean, share or p value; NaN where it is missing.
    pub mean: f64,
    /// Standard deviation; NaN where it is missing.
    pub sd: f64,
    /// Number of values.
    pub n: usize,
    /// Of a test: first minus second mean.
    difference: f64,
}

impl Cell {
    pub(super) fn of(summary: &Summary, places: usize) -> Self {
        let Summary { n, mean, sd } = *summary;
        let text = if n == 0 { none() } else { with_sd(mean, sd, places) };
        Self { text, mean, sd, n, difference: f64::NAN }
    }

    pub(super) fn value(value: f64, n: usize, text: String) -> Self {
        Self { text, mean: value, sd: f64::NAN, n, difference: f64::NAN }
    }

    pub(super) fn missing() -> Self {
        Self::value(f64::NAN, 0, none())
    }

    pub(super) fn p(test: Option<PairedT>, one_sided: bool) -> Self {
        test.map_or_else(Self::missing, |t| {
            let p = if one_sided { t.p_less } else { t.p_two_sided };
            let text = format!("p {}", probability(p));
            Self { difference: t.mean_difference, ..Self::value(p, t.n, text) }
        })
    }

    /// The same with the number of films without a result.
    pub(super) fn without(self, films: usize) -> Self {
        if films == 0 {
            return self;
        }
        Self { text: format!("[{films} without] {}", self.text), ..self }
    }
}

/// A share in percent, without decimal places.
pub(super) fn percent(value: f64) -> String {
    if value.is_finite() { format!("{} %", fixed(value, 0)) } else { none() }
}

/// Numbers within this factor of the paper's count as the same, on other patients.
const ALIKE: f64 = 1.5;

/// What the verdicts below numbers mean.
pub(super) fn ratio_legend() -> String {
    format!(
        "Below a number of the paper: `same` means from {} to {} the paper's number; {} is twice that number.",
        times(1.0 / ALIKE),
        times(ALIKE),
        times(2.0)
    )
}

/// What the verdicts below p values mean.
pub(super) const TEST_LEGEND: &str =
    "Below a p of the paper: `same` means on the same side of 0.05.";

/// The paper's number as text and as a number.
pub(super) struct Paper {
    text: String,
    value: f64,
}

impl From<(&str, f64)> for Paper {
    fn from((text, value): (&str, f64)) -> Self {
        Self { text: text.to_owned(), value }
    }
}

impl From<PaperMean> for Paper {
    fn from(paper: PaperMean) -> Self {
        Self { text: paper.to_string(), value: paper.mean }
    }
}

/// A number of the paper with its verdict.
pub(super) fn compared(
    quantity: &str,
    unit: &'static str,
    paper: impl Into<Paper>,
    columns: &Columns<'_>,
    cell: impl Fn(&Cohort) -> Cell,
) -> PaperNumber {
    beside(quantity, unit, paper, columns, columns.map(cell))
}

/// As [`compared`], with our numbers.
pub(super) fn beside(
    quantity: &str,
    unit: &'static str,
    paper: impl Into<Paper>,
    columns: &Columns<'_>,
    ours: Vec<Cell>,
) -> PaperNumber {
    let paper = paper.into();
    let verdict = verdict(paper.value, &columns.of.names(), &ours);
    PaperNumber { quantity: quantity.to_owned(), unit, paper: Some(paper.text), ours, verdict }
}

/// A number that the paper does not give.
pub(super) fn ours(quantity: String, unit: &'static str, ours: Vec<Cell>) -> PaperNumber {
    PaperNumber { quantity, unit, paper: None, ours, verdict: String::new() }
}

/// Which groups agree with the paper, and by how much the others differ.
fn verdict(paper: f64, names: &[&str], ours: &[Cell]) -> String {
    if !paper.is_finite() {
        return String::new();
    }
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    for (name, cell) in names.iter().copied().zip(ours) {
        let ratio = cell.mean / paper;
        match ratio {
            r if !r.is_finite() => differs.push(format!("no result for {name}")),
            r if (1.0 / ALIKE..=ALIKE).contains(&r) => alike.push(name),
            r if r > 0.0 => differs.push(format!("{} for {name}", times(r))),
            r if r < 0.0 => differs.push(format!("the opposite sign for {name}")),
            _ => differs.push(format!("zero for {name}")),
        }
    }
    sentence(&alike, &differs)
}

fn sentence(alike: &[&str], differs: &[String]) -> String {
    match (alike.is_empty(), differs.is_empty()) {
        (false, true) => "same for all".to_owned(),
        (true, _) => format!("differs: {}", differs.join(", ")),
        (false, false) => format!("same for {}; {}", alike.join(" and "), differs.join(", ")),
    }
}

/// The verdict of a p-value: whether it lies on the same side of 0.05 as the paper's.
pub(super) fn test_verdict(paper_rejects: bool, names: &[&str], ours: &[Cell]) -> String {
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    let paper = if paper_rejects { TestOutcome::Rejected } else { TestOutcome::Kept };
    for (name, cell) in names.iter().copied().zip(ours) {
        let outcome = TestOutcome::of(Some(cell.mean).filter(|p| p.is_finite()));
        // The paper rejected where its first mean was the smaller one.
        if paper_rejects && outcome == paper && cell.difference > 0.0 {
            differs.push(format!("{outcome} in the other direction for {name}"));
        } else if outcome == paper {
            alike.push(name);
        } else {
            differs.push(format!("{outcome} for {name}"));
        }
    }
    sentence(&alike, &differs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use spineline::number::NO_BREAK;

    fn cells(means: [f64; 3]) -> [Cell; 3] {
        means.map(|mean| Cell::value(mean, 1, String::new()))
    }

    #[test]
    fn a_ratio_within_the_factor_is_the_same_and_another_is_written_as_a_factor() {
        let said = |means| verdict(2.0, &["a", "b", "c"], &cells(means)).replace(NO_BREAK, " ");
        assert_eq!(said([1.34, 2.0, 2.99]), "same for all");
        assert_eq!(said([-1.0, 2.0, 2.0]), "same for b and c; the opposite sign for a");
        assert_eq!(said([1.0, 2.0, 7.0]), "same for b; 0.50 × for a, 3.5 × for c");
        assert_eq!(
            said([f64::NAN, 0.0, 0.02]),
            "differs: no result for a, zero for b, 0.010 × for c"
        );
        assert!(ratio_legend().replace(NO_BREAK, " ").contains("from 0.67 × to 1.5 × the paper's"));
    }
}
