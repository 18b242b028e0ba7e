//! One number of the paper, ours, and what to say of the two.

use spineline::analysis::probability;
use spineline::cohort::Cohort;
use spineline::evaluate::statistics::{PairedT, Summary};
use spineline::multibody::Support;
use spineline::personalize::TestOutcome;

/// Rows under one heading.
pub struct Section {
    pub title: String,
    /// `None` where the support does not matter.
    pub support: Option<Support>,
    pub rows: Vec<Row>,
    /// Why ours may differ.
    pub note: &'static str,
}

/// One number of the paper.
pub struct Row {
    pub quantity: String,
    pub unit: &'static str,
    pub paper: String,
    /// For rod, bend and pull.
    pub ours: [Cell; 3],
    /// Empty where the paper gives no such number.
    pub verdict: String,
}

/// One number of ours.
#[derive(Clone)]
pub struct Cell {
    pub text: String,
    pub mean: f64,
    pub sd: f64,
    pub n: usize,
    /// Of a test: first minus second mean.
    difference: f64,
}

impl Cell {
    pub fn of(summary: &Summary, places: usize) -> Self {
        let Summary { n, mean, sd } = *summary;
        let text =
            if n == 0 { "-".to_owned() } else { format!("{mean:.places$} ± {sd:.places$}") };
        Self { text, mean, sd, n, difference: f64::NAN }
    }

    pub fn value(value: f64, n: usize, text: String) -> Self {
        Self { text, mean: value, sd: f64::NAN, n, difference: f64::NAN }
    }

    /// The p-value of a test.
    pub fn p(test: Option<PairedT>, one_sided: bool) -> Self {
        match test {
            Some(t) => {
                let p = if one_sided { t.p_less } else { t.p_two_sided };
                let text = format!("p {}", probability(p));
                Self { difference: t.mean_difference, ..Self::value(p, t.n, text) }
            }
            None => Self::value(f64::NAN, 0, "-".to_owned()),
        }
    }
}

/// The loading scenarios in the order of the columns.
const SCENARIOS: [&str; 3] = ["rod", "bend", "pull"];
/// Numbers within this factor of the paper's count as the same, on other patients.
const ALIKE: f64 = 1.5;

impl Section {
    /// A section for which the support does not matter.
    pub fn new(title: &str, rows: Vec<Row>, note: &'static str) -> Self {
        Self { title: title.to_owned(), support: None, rows, note }
    }
}

/// A row with its verdict.
pub fn row(
    quantity: &str,
    unit: &'static str,
    paper: (&str, f64),
    cohorts: [&Cohort; 3],
    cell: impl Fn(&Cohort) -> Cell,
) -> Row {
    let ours = cohorts.map(cell);
    let verdict = verdict(paper.1, &ours);
    Row { quantity: quantity.to_owned(), unit, paper: paper.0.to_owned(), ours, verdict }
}

/// Which scenarios agree with the paper, and by how much the others differ.
fn verdict(paper: f64, ours: &[Cell; 3]) -> String {
    if !paper.is_finite() {
        return String::new();
    }
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    for (name, cell) in SCENARIOS.iter().zip(ours) {
        let ratio = cell.mean / paper;
        match ratio {
            r if !r.is_finite() => differs.push(format!("no result for {name}")),
            r if r > ALIKE => differs.push(format!("{} times the paper's for {name}", short(r))),
            r if r >= 1.0 / ALIKE => alike.push(*name),
            r if r > 0.0 => differs.push(format!("1/{} of it for {name}", short(1.0 / r))),
            _ => differs.push(format!("none for {name}")),
        }
    }
    sentence(&alike, &differs)
}

fn sentence(alike: &[&str], differs: &[String]) -> String {
    match (alike.is_empty(), differs.is_empty()) {
        (false, true) => "same for all scenarios".to_owned(),
        (true, _) => format!("differs: {}", differs.join(", ")),
        (false, false) => format!("same for {}; {}", alike.join(" and "), differs.join(", ")),
    }
}

fn short(ratio: f64) -> String {
    if ratio < 10.0 { format!("{ratio:.1}") } else { format!("{ratio:.0}") }
}

/// The verdict of a p-value: whether it lies on the same side of 0.05 as the paper's.
pub fn test_verdict(paper_rejects: bool, ours: &[Cell; 3]) -> String {
    let (mut alike, mut differs) = (Vec::new(), Vec::new());
    let paper = if paper_rejects { TestOutcome::Rejected } else { TestOutcome::Kept };
    for (name, cell) in SCENARIOS.iter().zip(ours) {
        let outcome = TestOutcome::of(Some(cell.mean).filter(|p| p.is_finite()));
        // The paper rejected where its first mean was the smaller one.
        if paper_rejects && outcome == paper && cell.difference > 0.0 {
            differs.push(format!("{outcome} in the other direction for {name}"));
        } else if outcome == paper {
            alike.push(*name);
        } else {
            differs.push(format!("{outcome} for {name}"));
        }
    }
    sentence(&alike, &differs)
}
